"""The photos as the steps after preprocessing see them, always together with the cameras that fit their pixels.

A photo set is closed in itself: its photos' files, its photos' masks and its cameras belong together. There are two:

- ``project.photo_set``: the photos as taken, with the cameras that are given or guessed for them;
- ``pipeline.photos``: the photos as later steps see them. Without undistortion that is the same set. With it, the files
  are the undistorted ones of the ``images`` result and the cameras are ideal.

So whoever takes photos and cameras from one set cannot mix raw pixels with an ideal camera. What people measured in
photos as taken (control points, masks) is carried over here.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np

from graphos_core.adjustment.orientation.groups import listed
from graphos_core.bands import visible
from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.cameras.undistortion import ideal_camera
from graphos_core.data import Array, Block, Camera, Known, Photo, PhotoSet
from graphos_core.errors import UserError
from graphos_core.images import read_pixels, read_shown
from graphos_core.masks import masks_key, photo_mask, read_masks
from graphos_core.preprocessing.grey import eight_bit
from graphos_core.preprocessing.undistortion import LESSON, Resampling
from graphos_core.project_file import inside, resolved
from graphos_core.run import Run
from graphos_core.text import Text

if TYPE_CHECKING:
    from graphos_core.pipeline import Pipeline


def calibrated_photos(pipeline: Pipeline) -> PhotoSet:
    """Return the photos as taken with the cameras by which they are undistorted.

    Raises
    ------
    UserError
        When undistortion is chosen without a calibration, or with one that is not for these photos.
    """
    from graphos_core.exchange.calibration_file import read_calibration, with_calibration

    raw = pipeline.project.photo_set
    _, params = pipeline.recipe.algorithm("preprocessing", "undistortion")
    name = getattr(params, "calibration", "")
    if name:
        return with_calibration(raw, read_calibration(resolved(pipeline.project.folder, name)))
    chosen = pipeline.recipe.chosen("preprocessing", "undistortion") != ("as_taken",)
    if chosen and not pipeline.project.settings.calibration:
        raise UserError(
            "Photos cannot be undistorted without a calibration.",
            "None is named, and none was given with the project.",
            "Name the file of an earlier calibration, such as runs/0001/cameras.toml, or take the photos as they are.",
            LESSON,
        )
    return raw


def resamplings(pipeline: Pipeline) -> tuple[PhotoSet, list[Resampling | None]]:
    """Return the photos as taken with calibrated cameras, and for each camera how its photos are undistorted."""
    photos = calibrated_photos(pipeline)
    algorithm, params = pipeline.recipe.algorithm("preprocessing", "undistortion")
    return photos, [algorithm.function(camera, params, run=Run()) for camera in photos.cameras]


def undistortion_key(pipeline: Pipeline) -> Any:
    """Return what identifies the calibration that undistorts, in keys; None for photos as taken."""
    photos, ways = resamplings(pipeline)
    if not any(ways):
        return None
    return cameras_key(photos)


def cameras_key(photos: PhotoSet) -> Any:
    """Return what identifies the cameras of photos in keys."""
    return [_camera_key(camera) for camera in photos.cameras]


def _camera_key(camera: Camera) -> Any:
    own = [camera.model, camera.width, camera.height, [float(v) for v in camera.values]]
    return [*own, [_camera_key(earlier) for earlier in camera.before]] if camera.before else own


def seen_photos(pipeline: Pipeline) -> PhotoSet:
    """Return the photos as later steps see them; before ``images`` has run, undistorted ones have no file yet."""
    photos, ways = resamplings(pipeline)
    if not any(ways):
        return pipeline.project.photo_set
    cameras = tuple(c if way is None else way.ideal for c, way in zip(photos.cameras, ways, strict=True))
    key = pipeline.key("images")
    folder = pipeline.project.store.path("images", key)
    made = pipeline.value("images").undistorted if pipeline.has("images") else ()
    stored = made or tuple(replace(photo, path="not undistorted yet") for photo in photos.photos)
    seen = [
        replace(photo, path=str(inside(folder, photo.path)), digest=_digest(photo, key)) for photo in stored
    ]
    return replace(photos, photos=tuple(seen), cameras=cameras)


def _digest(photo: Photo, key: str) -> str:
    return hashlib.sha256(f"{photo.digest} {key}".encode()).hexdigest()


def block_reader(photos: PhotoSet) -> Callable[[int], Array]:
    """Return a function that reads photo i as uint8 RGB (h, w, 3) or grey (h, w)."""
    return lambda index: eight_bit(visible(read_pixels(photos.photos[index])))


def files_path(pipeline: Pipeline, name: str) -> Path:
    """Return the path of a file that belongs to the preprocessing result."""
    return inside(pipeline.project.store.path("images", pipeline.key("images")), name)


def filter_input(pipeline: Pipeline, index: int) -> Array:
    """Return what the filters of photo `index` get, whether ``images`` has run or not: its pixels, undistorted if chosen.

    Raises
    ------
    UserError
        When the photo cannot be read, or undistortion has no calibration.
    """
    raw = pipeline.project.photo_set.photos[index]
    way = resamplings(pipeline)[1][raw.camera]
    if way is None:
        return read_pixels(raw)
    if pipeline.has("images"):
        return read_pixels(pipeline.photos.photos[index])
    return way.apply(read_pixels(raw), way.positions())


def photo_grey_and_colour(pipeline: Pipeline, index: int) -> tuple[Array, Array]:
    """Return photo `index` as features see it, uint8 grey (h, w), and its colours (h, w, 3)."""
    photo = pipeline.photos.photos[index]
    colour = eight_bit(visible(read_pixels(photo)))
    files = pipeline.value("images").files
    if files:
        grey = cv2.imdecode(
            np.fromfile(files_path(pipeline, files[index]), dtype=np.uint8), cv2.IMREAD_GRAYSCALE
        )
        if grey is None:
            raise UserError(Text("The preprocessed image of {name} cannot be read.", name=photo.name),
                            todo="Run preprocessing again.")  # fmt: skip
    else:
        grey = cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY) if colour.ndim == 3 else colour
    return np.asarray(grey), colour if colour.ndim == 3 else np.repeat(colour[:, :, None], 3, axis=2)


class SeenMasks:
    """The masks of the photos as later steps see them; called with the index of a photo.

    A mask is what is drawn or imported for a photo, carried into the undistorted photo where there is one, and without
    the pixels that have no value: transparent, NaN, outside of what the camera saw.

    Parameters
    ----------
    pipeline : Pipeline

    Attributes
    ----------
    covered : list of str
        Names of the photos asked for so far in which nothing may be measured.
    """

    def __init__(self, pipeline: Pipeline) -> None:
        self.folder = pipeline.project.folder
        self.masks = read_masks(self.folder)
        self.raw = pipeline.project.photo_set
        self.seen = pipeline.photos
        self.ways = resamplings(pipeline)[1]
        self.covered: list[str] = []
        self._positions: tuple[int, Array] | None = None

    def __call__(self, index: int) -> Array | None:
        """Return the mask of photo `index`: bool (h, w), True where something may be measured; None: everywhere.

        Raises
        ------
        UserError
            When a picture of a mask cannot be used.
        """
        free = self._free(index)
        if free is not None and not free.any():
            self.covered.append(self.seen.photos[index].name)
        return free

    def _free(self, index: int) -> Array | None:
        shown = read_shown(self.seen.photos[index])
        raw = self.raw.photos[index]
        mask = self.masks.get(raw.name)
        if not mask:
            return shown
        free = photo_mask(self.folder, mask, raw)
        way = self.ways[raw.camera]
        if way is not None:
            free = way.nearest(free, self._positions_of(raw.camera, way))
        return free if shown is None else free & shown

    def _positions_of(self, camera: int, way: Resampling) -> Array:
        if self._positions is None or self._positions[0] != camera:
            self._positions = (camera, way.positions())
        return self._positions[1]


def seen_masks_key(pipeline: Pipeline) -> Any:
    """Return what identifies the masks of the photos in keys; None where there are none."""
    return masks_key(pipeline.project.folder, [photo.name for photo in pipeline.project.photo_set.photos])


def pointless_warnings(empty: Sequence[str], covered: Sequence[str]) -> list[Text]:
    """Say which photos got no points: those whose mask covers everything, and those that show too little.

    Parameters
    ----------
    empty : sequence of str
        Names of the photos without points.
    covered : sequence of str
        Names of those whose mask leaves nothing.
    """
    plain = [name for name in empty if name not in covered]
    told = []
    if covered:
        told.append(Text("The mask of {names} covers the whole photo: it gets no points and cannot be oriented. Keep a "
                         "part of it, or switch the photo off.", names=listed(covered)))  # fmt: skip
    if plain:
        told.append(Text("No points were found in {names}: too little texture (one colour, out of focus, dark), or the "
                         "thresholds of the detector are too strict.", names=listed(plain)))  # fmt: skip
    return told


def seen_known(pipeline: Pipeline) -> Known:
    """Return what is known of the object, with image measurements in px of the photos as later steps see them.

    People measure in photos as taken; a measured position goes along its ray into the undistorted photo.
    """
    known = pipeline.project.known()
    raw, ways = resamplings(pipeline)
    measured = known.measured
    if measured is None or not any(ways):
        return known
    xy = np.array(measured.xy, dtype=float)
    cameras = {photo.name: photo.camera for photo in raw.photos}
    of = np.array([cameras.get(name, -1) for name in measured.photo])
    for camera, way in enumerate(ways):
        rows = np.flatnonzero(of == camera)
        if way is not None and rows.size:
            xy[rows] = pixel_from_ray(way.ideal, ray_from_pixel(way.camera, xy[rows]))
    return replace(known, measured=replace(measured, xy=xy))


def given_as_seen(pipeline: Pipeline) -> Block | None:
    """Return the given orientation, for undistorted photos with their ideal cameras in place of its own."""
    given, seen = pipeline.project.given_orientation(), pipeline.photos
    if given is None or not any(resamplings(pipeline)[1]):
        return given
    ideal = {(camera.width, camera.height): camera for camera in seen.cameras}
    cameras = tuple(
        ideal.get((camera.width, camera.height), ideal_camera(camera)) for camera in given.cameras
    )
    return replace(given, cameras=cameras)


def block_as_taken(pipeline: Pipeline, block: Block) -> Block:
    """Return a block of undistorted photos as one of the photos as taken: measured there, with the whole cameras.

    The correction that undistorted the photos becomes `Camera.before` of their adjusted cameras.
    """
    from graphos_core.cameras.chain import as_measured

    _, ways = resamplings(pipeline)
    if not any(ways):
        return block
    cameras, xy = list(block.cameras), np.array(block.obs_xy)
    raw_camera = [photo.camera for photo in pipeline.project.photo_set.photos]
    of_obs = block.camera_of_photo[block.obs_photo]
    for index, camera in enumerate(block.cameras):
        photo = next(iter(np.flatnonzero(block.camera_of_photo == index)), None)
        way = ways[raw_camera[int(photo)]] if photo is not None else None
        if way is None:
            continue
        calibration = replace(way.camera, before=(), sigmas=None)
        cameras[index] = replace(camera, before=(*way.camera.before, calibration, *camera.before))
        rows = np.flatnonzero(of_obs == index)
        xy[rows] = as_measured(cameras[index], xy[rows])
    return replace(block, cameras=tuple(cameras), obs_xy=xy)
