"""Reading photos: which files of a folder are usable, their cameras, and their pixels. Photos are never changed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from graphos_core.bands import visible
from graphos_core.data import Array, Camera, Exif, Photo, PhotoSet
from graphos_core.errors import ItemFailure, UserError
from graphos_core.photo_decoding import CannotDecode, Picture, decode, upright
from graphos_core.photo_files import PhotoFile, inspect_photo, list_photo_files
from graphos_core.principal_distance import principal_distance
from graphos_core.run import Run, map_items
from graphos_core.text import Text

TWIN_TOLERANCE = 3
"""Grey levels by which the fingerprints of one picture in two files may differ: JPEG's are of a reduced picture."""


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
    return _told_twins(_group(found, tuple(failures), focal_px, principal_point), found)


def told_remarks(photos: PhotoSet) -> list[Text]:
    """Return the remarks on photos as sentences; those that differ in numbers only are told once."""
    alike: dict[str, list[tuple[str, str]]] = {}
    for photo in photos.photos:
        for remark in photo.remarks:
            alike.setdefault(re.sub(r"[-+0-9.e]+", "#", remark), []).append((photo.name, remark))
    return [
        Text("{item}: {remark}", item=found[0][0], remark=found[0][1])
        if len(found) == 1
        else Text("{item}: {remark} Likewise {count} other photos.", item=found[0][0], remark=found[0][1],
                  count=len(found) - 1)
        for found in alike.values()
    ]  # fmt: skip


def read_pixels(photo: Photo, *, grey: bool = False) -> Array:
    """Read the pixels of a photo, upright.

    Parameters
    ----------
    photo : Photo
    grey : bool
        Return luma ``0.299 R + 0.587 G + 0.114 B`` (ITU-R BT.601) instead of colour; of many bands that of their
        false colours, see `graphos_core.bands`.

    Returns
    -------
    uint8 or uint16 (h, w), (h, w, 3) or (h, w, n)
        Grey photos stay grey, 16 bit stays 16 bit, colour is RGB, other bands come in the order of the file;
        transparency is dropped. See `graphos_core.photo_decoding` for what becomes of other kinds of values.

    Raises
    ------
    UserError
        When the file is gone, cannot be decoded, or is another than when the photo was added.
    """
    pixels = _read(photo).pixels
    if grey and pixels.ndim == 3:
        pixels = cv2.cvtColor(visible(pixels), cv2.COLOR_RGB2GRAY)
    return np.ascontiguousarray(pixels)


def read_shown(photo: Photo) -> Array | None:
    """Read where a photo has a value, upright: False where it is fully transparent, NaN or without data.

    Returns
    -------
    bool (h, w) or None
        None where every pixel has a value; the file is then not opened.

    Raises
    ------
    UserError
        As `read_pixels`.
    """
    return _read(photo).shown if photo.hidden else None


def _read(photo: Photo) -> Picture:
    try:
        picture = decode(photo.file.read_bytes())
    except OSError as problem:
        raise _changed(photo, str(problem.strerror or problem)) from problem
    except CannotDecode as problem:
        raise _changed(photo, problem.reason) from problem
    turned = replace(
        picture,
        pixels=upright(picture.pixels, photo.exif.orientation),
        shown=None if picture.shown is None else upright(picture.shown, photo.exif.orientation),
    )
    if turned.pixels.shape[:2] != (photo.height, photo.width):
        raise _changed(photo, Text("It has another size than when it was added."))
    return turned


def _changed(photo: Photo, why: str) -> UserError:
    return UserError(
        Text("The photo {name} cannot be read.", name=photo.name),
        why,
        Text("Put the photo back in its place, or add the photos again."),
    )


def _told_twins(photos: PhotoSet, found: Sequence[PhotoFile]) -> PhotoSet:
    """Return the photos with a remark on those whose pixels another one has too, in a file of other bytes.

    Likely ones are found by their fingerprints and then compared pixel by pixel.
    """
    told = list(photos.photos)
    prints = np.array([item.fingerprint.ravel() for item in found], np.int16)
    for index, photo in enumerate(told):
        alike = (
            np.flatnonzero(np.abs(prints[:index] - prints[index]).max(axis=1) <= TWIN_TOLERANCE)
            if index
            else ()
        )
        for other in (told[i] for i in alike):
            if (other.width, other.height, other.channels) != (photo.width, photo.height, photo.channels):
                continue
            if np.array_equal(read_pixels(other), read_pixels(photo)):
                remark = Text("It shows exactly the same pixels as {twin}: it adds nothing, and a pair of the two has "
                              "no base.", twin=other.name)  # fmt: skip
                told[index] = replace(photo, remarks=(*photo.remarks, remark))
                break
    return replace(photos, photos=tuple(told))


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
                hidden=item.hidden,
                remarks=item.remarks,
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
