"""Reading photos: which files of a folder are usable, their cameras, and their pixels. Photos are never changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from graphos_core.data import Array, Camera, Exif, Photo, PhotoSet
from graphos_core.errors import ItemFailure, UserError
from graphos_core.photo_files import PhotoFile, decode, inspect_photo, list_photo_files
from graphos_core.principal_distance import principal_distance
from graphos_core.run import Run, map_items
from graphos_core.text import Text


def read_photo_set(
    source: str | Path | Sequence[str | Path],
    *,
    run: Run,
    focal_px: float | None = None,
    principal_point: tuple[float, float] | None = None,
) -> PhotoSet:
    """Read the headers of all photos and group them into cameras.

    Every file is decoded once, so that a truncated photo is found now and not in the middle of the work.

    Parameters
    ----------
    source : folder, or list of files
        Of a folder the photos directly in it, sorted by name; hidden files and files that are no pictures are
        passed over. Of a list every file counts.
    run : Run
    focal_px : float, optional
        Principal distance for all cameras, px; otherwise see `graphos_core.principal_distance`.
    principal_point : (float, float), optional
        For all cameras, px; otherwise the middle ((w − 1)/2, (h − 1)/2).

    Returns
    -------
    PhotoSet
        Photos of one maker, model, focal length and upright size share a camera of model ``"basic"`` without
        distortion. Unusable files and repeated ones are listed in ``failures``.

    Raises
    ------
    UserError
        When the folder does not exist, has no photos, or none of them is usable.
    """
    paths = list_photo_files(source)
    inspected = map_items(run, inspect_photo, paths, "photos")
    failures: list[ItemFailure] = []
    found: list[PhotoFile] = []
    twins: dict[str, str] = {}
    for item in inspected:
        if isinstance(item, ItemFailure):
            failures.append(item)
        elif item.digest in twins:
            reason = Text("It is the same file as {twin}; the second is left out.", twin=twins[item.digest])
            failures.append(ItemFailure(item.path.name, reason))
        else:
            twins[item.digest] = item.path.name
            found.append(item)
    if not found:
        raise UserError(
            Text("None of the {count} files can be used as a photo.", count=len(paths)),
            f"{failures[0].item}: {failures[0].reason}",
            Text("Give photos as JPEG, PNG or TIFF."),
        )
    return _group(found, tuple(failures), focal_px, principal_point)


def read_pixels(photo: Photo, *, grey: bool = False) -> Array:
    """Read the pixels of a photo, upright.

    Parameters
    ----------
    photo : Photo
    grey : bool
        Return luma ``0.299 R + 0.587 G + 0.114 B`` (ITU-R BT.601) instead of colour.

    Returns
    -------
    uint8 or uint16 (h, w) or (h, w, 3)
        As stored: grey photos stay grey, 16 bit stays 16 bit; colour is RGB; transparency is dropped.

    Raises
    ------
    UserError
        When the file is gone, cannot be decoded, or is another than when the photo was added.
    """
    try:
        pixels = decode(np.fromfile(photo.path, dtype=np.uint8))
    except OSError as problem:
        raise _changed(photo, str(problem.strerror or problem)) from problem
    if pixels is None:
        raise _changed(photo, Text("The file cannot be decoded."))
    pixels = _upright(pixels, photo.exif.orientation)
    if pixels.shape[:2] != (photo.height, photo.width):
        raise _changed(photo, Text("It has another size than when it was added."))
    if grey and pixels.ndim == 3:
        pixels = cv2.cvtColor(pixels, cv2.COLOR_RGB2GRAY)
    return np.ascontiguousarray(pixels)


def _changed(photo: Photo, why: str) -> UserError:
    return UserError(
        Text("The photo {name} cannot be read.", name=photo.name),
        why,
        Text("Put the photo back in its place, or add the photos again."),
    )


def _upright(pixels: Array, orientation: int) -> Array:
    """Undo the EXIF orientation (EXIF 2.32, tag 274): first transpose for 5 to 8, then mirror."""
    if orientation >= 5:
        pixels = pixels.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return pixels


def _group(
    found: list[PhotoFile],
    failures: tuple[ItemFailure, ...],
    focal_px: float | None,
    principal_point: tuple[float, float] | None,
) -> PhotoSet:
    cameras: dict[tuple[str, str, float | None, float | None, int, int], Camera] = {}
    photos = []
    for item in found:
        exif = item.exif
        key = (exif.make, exif.model, exif.focal_mm, exif.focal_35mm, item.width, item.height)
        if key not in cameras:
            cameras[key] = _first_camera(item, focal_px, principal_point)
        photos.append(
            Photo(
                name=item.path.name,
                path=str(item.path.resolve()),
                width=item.width,
                height=item.height,
                bits=item.bits,
                channels=item.channels,
                camera=list(cameras).index(key),
                digest=item.digest,
                exif=exif,
            )
        )
    return PhotoSet(photos=tuple(photos), cameras=_distinct_labels(list(cameras.values())), failures=failures)


def _first_camera(
    item: PhotoFile, focal_px: float | None, principal_point: tuple[float, float] | None
) -> Camera:
    distance = principal_distance(item.exif, item.width, item.height, focal_px)
    x0, y0 = principal_point or ((item.width - 1) / 2, (item.height - 1) / 2)
    return Camera(
        model="basic",
        width=item.width,
        height=item.height,
        values=np.array([distance.focal_px, x0, y0, 0.0, 0.0]),
        label=_label(item.exif),
        pixel_pitch_mm=distance.pixel_pitch_mm,
        focal_estimated=distance.estimated,
        focal_source=distance.source,
    )


def _label(exif: Exif) -> str:
    maker = exif.make.partition(" ")[0]
    name = exif.model if exif.model.lower().startswith(maker.lower()) else f"{maker} {exif.model}".strip()
    if not name:
        name = Text("Unknown camera")
    return f"{name}, {exif.focal_mm:g} mm" if exif.focal_mm else name


def _distinct_labels(cameras: list[Camera]) -> tuple[Camera, ...]:
    labels = [camera.label for camera in cameras]
    return tuple(
        replace(camera, label=f"{camera.label}, {camera.width} × {camera.height}")
        if labels.count(camera.label) > 1
        else camera
        for camera in cameras
    )
