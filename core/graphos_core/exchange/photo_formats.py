"""Formats of photos that a file does not tell: from the photos themselves, else from the extent of the image points."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from graphos_core.data import Array
from graphos_core.exchange.formulas import Format
from graphos_core.text import Text


def format_in_folder(folder: Path, name: str) -> Format | None:
    """Return the format of a photo that lies in a folder, by its name alone or its relative path; None if not."""
    from PIL import Image

    for path in (folder / name, folder / Path(name.replace("\\", "/")).name):
        try:
            if path.resolve().is_relative_to(folder.resolve()) and path.is_file():
                with Image.open(path) as image:
                    return Format(image.width, image.height)
        except (OSError, ValueError, Image.DecompressionBombError):
            continue
    return None


def centred_formats(
    names: list[str], folder: Path, photo: Array, xy: Array, remarks: list[str]
) -> list[Format]:
    """Return the format of every photo of a file whose image points count from the image centre.

    Parameters
    ----------
    names : list of str
    folder : Path
        Where the photos may lie.
    photo : int (m,)
    xy : float64 (m, 2)
        Image points from the image centre, px.
    remarks : list of str
        Takes a sentence when formats had to be taken from the image points.
    """
    known = [format_in_folder(folder, name) for name in names]
    guessed = [i for i, found in enumerate(known) if found is None]
    if not guessed:
        return [found for found in known if found is not None]
    reach = np.abs(xy).max(axis=0, initial=1.0) if len(xy) else np.array([1.0, 1.0])
    common = Format(int(2 * np.ceil(reach[0]) + 2), int(2 * np.ceil(reach[1]) + 2))
    remarks.append(Text(
        "The format of {count} photos is not in the file and the photos were not found beside it: {width} × {height} px "
        "was taken from the extent of the image points.",
        count=len(guessed), width=common.width, height=common.height,
    ))  # fmt: skip
    return [common if found is None else found for found in known]
