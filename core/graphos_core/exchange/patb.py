"""Orientation files of PAT-B (``.ori``): three records per photo.

Number and X, Y, Z of the projection centre; a11 a12 a13 a21 a22; a23 a31 a32 a33 (PCI Geomatics, "Using Pat-B in
OrthoEngine"). The matrix is ``world_from_image`` with the image frame x right, y up, z backward unless the caller says
that it is the transpose: files of both kinds exist.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from graphos_core.data import Array, Block, Camera
from graphos_core.exchange.block_parts import Parts, Read, Written, nearest_rotation
from graphos_core.exchange.text_files import Lines, finite
from graphos_core.geometry.rotation import FLIP
from graphos_core.store import write_text
from graphos_core.text import Text


def read_patb(path: Path, camera: Camera, *, transposed: bool | None = None) -> Read:
    """Read an orientation file; all photos have the camera given.

    Parameters
    ----------
    path : Path
    camera : Camera
    transposed : bool or None
        Whether the matrix is ``image_from_world``. Both readings differ by the sign of all three small angles and
        cannot be told apart for vertical photos; None reads ``world_from_image`` and says so.

    Raises
    ------
    UserError
        When the file cannot be read, with the line.
    """
    lines = Lines(path)
    parts = Parts(cameras=[camera], unit="m")
    if transposed is None:
        parts.remarks.append(
            "The rotation matrices were read as world from image; some programs write the transpose."
        )
    while lines.more():
        name, centre = _head(lines)
        entries = [*lines.numbers(5, "a11 a12 a13 a21 a22")[:5], *lines.numbers(4, "a23 a31 a32 a33")[:4]]
        matrix = np.array(entries).reshape(3, 3)
        try:
            rotation = nearest_rotation(matrix.T if transposed else matrix)
        except ValueError:
            raise lines.wrong("the end of a rotation matrix") from None
        parts.add_photo(name, 0, FLIP @ rotation.T, centre)
    return parts.read()


def _head(lines: Lines) -> tuple[str, Array]:
    words = lines.take("the number of a photo and X, Y, Z")
    try:
        centre = np.array(finite(words[-3:]))
        if len(words) < 4:
            raise ValueError("too few")
    except ValueError:
        raise lines.wrong("the number of a photo and X, Y, Z") from None
    return words[0], centre


def write_patb(block: Block, path: Path) -> Written:
    """Write the oriented photos of a block, matrices as ``world_from_image``.

    Photos are numbered, because the format has numbers only; a list of numbers and names is written beside it.

    Raises
    ------
    UserError
        When a file cannot be written.
    """
    out, names = [], []
    photos = np.flatnonzero(block.oriented).tolist()
    for number, photo in enumerate(photos, 1):
        a = (FLIP @ block.rotations[photo]).T.ravel()
        centre = "".join(f"{v:16.5f}" for v in block.centres[photo])
        out += [
            f"{number:16d}{'':16s}{centre}",
            "".join(f"{v:16.12f}" for v in a[:5]),
            "".join(f"{v:16.12f}" for v in a[5:]),
        ]
        names.append(f"{number} {block.names[photo]}")
    listed = path.with_suffix(".names.txt")
    write_text(path, "\n".join(out) + "\n")
    write_text(listed, "\n".join(names) + "\n")
    remarks = (
        Text("PAT-B numbers the photos; their names are in {name}.", name=listed.name),
        "PAT-B has five decimals for coordinates; camera and points are not part of the file.",
    )
    return Written((path, listed), remarks)
