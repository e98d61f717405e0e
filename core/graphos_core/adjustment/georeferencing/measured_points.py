"""Control points measured in the photos, intersected in the frame of the block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array, Block, Control, ControlObservations
from graphos_core.geometry.rays import joined, rays_of
from graphos_core.geometry.triangulation import intersect_rays
from graphos_core.run import Run
from graphos_core.text import Text


@dataclass(frozen=True)
class MeasuredPoints:
    """Where the measured points are in the block.

    Attributes
    ----------
    xyz : float64 (n, 3)
        Object frame of the block, in its unit; NaN where not `found`. In the order of `Control.names`.
    found : bool (n,)
        Whether two rays or more from oriented photos intersect there.
    photos : int (n,)
        Oriented photos in which the point is measured.
    left_out : bool (m,)
        Measurements that do not fit the others of their point, or have no ray.
    """

    xyz: Array
    found: Array
    photos: Array
    left_out: Array


def intersect_measured(
    block: Block,
    control: Control | None,
    measured: ControlObservations | None,
    *,
    threshold_px: float,
    min_angle: float,
    run: Run,
) -> MeasuredPoints:
    """Intersect the measured points; measurements in unknown photos and those that do not fit are told.

    Parameters
    ----------
    block : Block
    control, measured : Control, ControlObservations or None
    threshold_px : float
        Largest distance of a used measurement from the point, px.
    min_angle : float
        Smallest admissible largest intersection angle, radians.
    run : Run
    """
    count = 0 if control is None else len(control.names)
    xyz, found, photos = np.full((count, 3), np.nan), np.zeros(count, dtype=bool), np.zeros(count, dtype=int)
    if control is None or measured is None or not len(measured.point):
        return MeasuredPoints(xyz, found, photos, np.zeros(0, dtype=bool))
    photo = _known_photos(block, measured, run)
    _tell_outside(block, control, measured, photo, run)
    parts = []
    for index in np.unique(photo[photo >= 0]):
        mine = np.flatnonzero(photo == index)
        parts.append((mine, rays_of(block.cameras[block.camera_of_photo[index]], measured.xy[mine])))
    rays = joined(parts, len(photo))
    use = np.flatnonzero((photo >= 0) & rays.valid)
    use = use[np.asarray(block.oriented)[photo[use]]]
    use = use[
        np.unique(measured.point[use].astype(np.int64) * len(block.names) + photo[use], return_index=True)[1]
    ]
    ids, start, sizes = np.unique(measured.point[use], return_index=True, return_counts=True)
    photos[ids] = sizes
    result = intersect_rays(
        np.append(start, len(use)), photo[use], rays[use], block.rotations, block.centres,
        threshold_px=threshold_px, min_angle=min_angle,
    )  # fmt: skip
    good = ids[result.ok]
    xyz[good], found[good] = result.points[result.ok], True
    misfit = np.repeat(result.ok, sizes) & ~result.used
    _tell_misfits(control, measured, use, misfit, run)
    left_out = np.ones(len(measured.point), dtype=bool)
    left_out[use[~misfit]] = False
    return MeasuredPoints(xyz, found, photos, left_out)


def photo_indices(block: Block, names: Sequence[str]) -> Array:
    """Return the index of each photo, by its name or, where unique, its file name; −1 where unknown."""
    index: dict[str, int] = {}
    for i, name in enumerate(block.names):
        short = name.rsplit("/", 1)[-1].casefold()
        index[short] = -1 if short in index else i
    exact = {name: i for i, name in enumerate(block.names)}
    found = [exact.get(n, index.get(n.rsplit("/", 1)[-1].casefold(), -1)) for n in names]
    return np.array(found, dtype=np.int64)


def _known_photos(block: Block, measured: ControlObservations, run: Run) -> Array:
    """Return the photo of each measurement, and tell those that are not in the project."""
    found = photo_indices(block, measured.photo)
    unknown = sorted({n for n, i in zip(measured.photo, found, strict=True) if i < 0})
    if unknown:
        run.warn(
            Text(
                "{count} measurements of control points are in photos that are not in the project: {names}.",
                count=int((found < 0).sum()),
                names=", ".join(unknown[:4]) + (" …" if len(unknown) > 4 else ""),
            )
        )
    return found


def _tell_outside(
    block: Block, control: Control, measured: ControlObservations, photo: Array, run: Run
) -> None:
    """Tell measurements that lie outside their photo: in another unit, or from another corner."""
    size = np.array([[c.width, c.height] for c in block.cameras])[np.asarray(block.camera_of_photo)[photo]]
    outside = (
        (photo >= 0) & (size > 0).all(axis=1) & ((measured.xy < -1.0) | (measured.xy > size)).any(axis=1)
    )
    if outside.any():
        first = int(np.flatnonzero(outside)[0])
        run.warn(Text(
            "{count} measurements of control points lie outside their photo, such as {point} in {photo}. Measurements are "
            "in px from the top left corner, x to the right, y downwards.", count=int(outside.sum()),
            point=control.names[measured.point[first]], photo=measured.photo[first],
        ))  # fmt: skip


def _tell_misfits(
    control: Control, measured: ControlObservations, use: Array, misfit: Array, run: Run
) -> None:
    for i in use[misfit]:
        run.warn(
            Text(
                "The measurement of {point} in {photo} does not fit the others and was left out.",
                point=control.names[measured.point[i]],
                photo=measured.photo[i],
            )
        )
