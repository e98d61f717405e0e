"""Intermediate adjustments of the growing block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.cameras import camera_model, ray_from_pixel
from graphos_core.data import Array, Block, Camera
from graphos_core.run import Run

FREED = (("focal_px", 3), ("k1", 3), ("k2", 5))
"""Camera parameters estimated while orienting, and from how many photos of the camera on."""

FREED_WIDE = (("focal_px", 3), ("k1", 3), ("x0", 4), ("y0", 4), ("k2", 5))
"""The same for fish-eye lenses: the whole hemisphere holds the principal point."""

OPTIONS = Options(robust="cauchy", scale_px=1.0, max_iterations=6, tolerance=1e-3, statistics=False)

LOCAL_OPTIONS = replace(OPTIONS, max_iterations=2)


class _Quiet(Run):
    """Passes on the wish to stop, and nothing else: intermediate iterations are not the caller's."""

    def __init__(self, outer: Run) -> None:
        super().__init__(threads=outer.threads, seed=outer.seed)
        self._outer = outer

    def stopping(self) -> bool:
        return self._outer.stopping()


def adjusted(block: Block, *, self_calibration: bool, run: Run) -> Block:
    """Adjust a block with a robust function, so that wrong observations hardly pull.

    With `self_calibration` the principal distance and radial distortion of each camera are free once enough of its
    photos are oriented; the principal point stays. Should a calibration run off, the cameras are held fixed.
    """
    free = _freed(block) if self_calibration else ()
    result = adjust_block(block, Freedom(interior=free), OPTIONS, run=_Quiet(run)).block
    camera_of_obs = np.asarray(block.camera_of_photo)[block.obs_photo]
    if any(free) and not all(
        _plausible(new, old, block.obs_xy[camera_of_obs == c])
        for c, (new, old) in enumerate(zip(result.cameras, block.cameras, strict=True))
    ):
        result = adjust_block(block, Freedom(), OPTIONS, run=_Quiet(run)).block
    kept = tuple(
        camera if names else replace(camera, sigmas=None)
        for camera, names in zip(result.cameras, free or ((),) * len(result.cameras), strict=True)
    )
    return replace(result, cameras=kept)


def adjusted_around(block: Block, free: Array, run: Run) -> Block:
    """Adjust some photos bool (n,) and the points of `block`, everything else held fixed."""
    held = np.asarray(block.oriented) & ~free
    return adjust_block(block, Freedom(fixed_photos=held), LOCAL_OPTIONS, run=_Quiet(run)).block


def _freed(block: Block) -> tuple[tuple[str, ...], ...]:
    """Return the names of the free parameters of each camera."""
    photos = np.bincount(block.camera_of_photo[block.oriented], minlength=len(block.cameras))
    free = []
    for camera, count in zip(block.cameras, photos, strict=True):
        model = camera_model(camera.model)
        possible = {p.name for p in model.parameters if p.default in ("free", "prior")}
        wanted = FREED_WIDE if model.wide else FREED
        free.append(tuple(name for name, least in wanted if count >= least and name in possible))
    return tuple(free)


def _plausible(new: Camera, old: Camera, measured: Array) -> bool:
    """Whether a calibration still maps the photo one to one with a principal distance of the same order.

    Of a central camera the whole format counts; beyond the image circle of a fish-eye there is nothing to map, so
    there the measured positions `measured` (m, 2) do.
    """
    if not 0.4 < new.focal_px / old.focal_px < 2.5:
        return False
    if camera_model(new.model).wide:
        return bool(np.isfinite(ray_from_pixel(new, measured)).all())
    x, y = new.width - 1.0, new.height - 1.0
    edge = np.array([[0, 0], [x, 0], [0, y], [x, y], [x / 2, 0], [x / 2, y], [0, y / 2], [x, y / 2]])
    return bool(np.isfinite(ray_from_pixel(new, edge)).all())
