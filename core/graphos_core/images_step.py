"""The step ``images``: every photo undistorted and filtered, where the recipe says so; the originals are only read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from graphos_core.data import Array, Photo
from graphos_core.errors import UserError
from graphos_core.images import read_pixels, read_shown
from graphos_core.preprocessing.chain import apply_filters
from graphos_core.preprocessing.undistortion import Resampling
from graphos_core.run import Run, map_items
from graphos_core.seen_photos import resamplings
from graphos_core.store import cannot_write
from graphos_core.text import Text

if TYPE_CHECKING:
    from graphos_core.pipeline import Pipeline
    from graphos_core.results import PreprocessingResult


@dataclass(frozen=True)
class Preparation:
    """What all photos need to be prepared.

    Attributes
    ----------
    photos : tuple of Photo
        As taken.
    ways : sequence of Resampling or None
        By camera.
    positions : mapping of int to float32 (h, w, 2)
        `Resampling.positions` by camera.
    chain : sequence of (Algorithm, Params)
        Filters.
    folder : Path
        Of the result that is being made.
    """

    photos: tuple[Photo, ...]
    ways: Sequence[Resampling | None]
    positions: Mapping[int, Array]
    chain: Sequence[tuple[Any, Any]]
    folder: Path


def compute_images(pipeline: Pipeline, folder: Path, run: Run) -> PreprocessingResult:
    """Undistort and filter all photos, several at a time; each filtered one is offered as ``("image", (index, image))``.

    Raises
    ------
    UserError
        When a photo is gone, or the disk is full.
    Stopped
        When the person asked to stop.
    """
    from graphos_core.results import PreprocessingResult

    chain = pipeline.recipe.algorithms("preprocessing", "filter")
    photos, ways = resamplings(pipeline)
    if not chain and not any(ways):
        return PreprocessingResult()
    positions = {}
    for index, way in enumerate(ways):
        run.check()
        if way is not None:
            positions[index] = way.positions()
    job = partial(_prepare, how=Preparation(photos.photos, ways, positions, chain, folder), run=run)
    done = map_items(run, job, list(range(len(photos.photos))), "photos")
    undistorted = tuple(photo for photo, _ in done) if any(ways) else ()
    return PreprocessingResult(
        files=tuple(name for _, name in done) if chain else (), undistorted=undistorted
    )


def _prepare(index: int, how: Preparation, run: Run) -> tuple[Photo, str]:
    """Prepare one photo; return it as undistorted, and the name of its filtered image."""
    run.check()
    photo = how.photos[index]
    image, way = read_pixels(photo), how.ways[photo.camera]
    if way is not None:
        positions = how.positions[photo.camera]
        shown = way.shown(read_shown(photo), positions)
        image = way.apply(image, positions)
        name = _write_with_alpha(how.folder, f"undistorted_{index:05d}", image, shown, photo)
        photo = replace(photo, path=name, hidden=int(shown.size - np.count_nonzero(shown)),
                        exif=replace(photo.exif, orientation=1))  # fmt: skip
    if not how.chain:
        return photo, ""
    image = apply_filters(image, how.chain, run)
    name = f"{index:05d}.png"
    _write(how.folder / name, ".png", image if image.ndim == 2 else image[:, :, ::-1], photo)
    run.show("image", (index, image))
    return photo, name


def _write_with_alpha(folder: Path, stem: str, image: Array, shown: Array, photo: Photo) -> str:
    """Write an undistorted photo; what it does not show is transparent. Many bands need TIFF."""
    alpha = (shown * np.iinfo(image.dtype).max).astype(image.dtype)
    if image.ndim == 3 and image.shape[2] == 3:
        _write(folder / f"{stem}.png", ".png", np.dstack([image[:, :, ::-1], alpha]), photo)
        return f"{stem}.png"
    import tifffile

    bands = np.dstack([image, alpha])
    extra = ["unspecified"] * (bands.shape[2] - 2) + ["unassalpha"]
    try:
        tifffile.imwrite(folder / f"{stem}.tif", bands, photometric="minisblack", planarconfig="contig",
                         extrasamples=extra, compression="zlib", compressionargs={"level": 1})  # fmt: skip
    except OSError as problem:
        raise cannot_write(Path(f"The undistorted image of {photo.name}"), problem) from problem
    return f"{stem}.tif"


def _write(path: Path, ending: str, image: Array, photo: Photo) -> None:
    done, encoded = cv2.imencode(ending, image)
    if not done:
        raise UserError(Text("The filtered image of {name} could not be encoded.", name=photo.name),
                        todo="Run preprocessing with other parameters.")  # fmt: skip
    try:
        path.write_bytes(encoded.tobytes())
    except OSError as problem:
        raise cannot_write(Path(f"The filtered image of {photo.name}"), problem) from problem
