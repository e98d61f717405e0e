"""What can be dragged in the simulator of robust weights: every ray, the number of draws, the scale."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from graphos_core.cameras import ray_from_pixel
from graphos_didactic.scene import Handle
from graphos_didactic.simulators.adjustment.robust_model import (
    ASIDE,
    CAMERA,
    CENTRES,
    DISTANCE,
    METRES_PER_PX,
    REACH_MM,
    ROTATIONS,
    Bundle,
    mm,
)
from graphos_didactic.simulators.adjustment.robust_params import RAYS, RobustParams, blunders

ENLARGED = 20.0
"""A blunder is drawn this many times too large in the photo."""
BEHIND = 0.82 * REACH_MM * 1e-3
"""The handle of a ray lies this far behind the point, m."""


def handle_marks(bundle: Bundle) -> list[Handle]:
    """Return the handles of the rays, of the draws and of the scale."""
    p = bundle.params
    handles = [_ray(bundle, k) for k in range(RAYS)]
    handles += [
        Handle(panel="votes", name="draws", thing="samples", label="Samples drawn", role="third", freedom="x",
               at=(float(p.draws), 0.55), parameters=("draws",), move=lambda x, _: {"draws": x}, nudge=(1.0, 0.0)),
        Handle(panel="weight", name="scale", thing="function", label="Scale c", role="estimate", freedom="x",
               at=(p.scale, 0.08), parameters=("scale",), move=lambda x, _: {"scale": x}, nudge=(0.25, 0.0)),
    ]  # fmt: skip
    if p.photo:
        handles.append(_in_photo(bundle))
    return handles


def _ray(bundle: Bundle, k: int) -> Handle:
    way = ray_from_pixel(CAMERA, bundle.pixels[k : k + 1])[0] @ ROTATIONS[k]
    at = mm(CENTRES[k] + way * (DISTANCE + BEHIND))
    return Handle(panel="zoom", name=f"ray_{k + 1}", thing=f"ray_{k + 1}", label=f"Ray {k + 1}", freedom="turn",
                  role="neutral" if bundle.good[k] else "second", at=(float(at[0]), float(at[1])),
                  parameters=(f"ray_{k + 1}",), move=_turned(bundle.params, k, bundle.errors_px), nudge=(4.0, 1.0))  # fmt: skip


def _turned(params: RobustParams, k: int, errors: np.ndarray) -> Callable[[float, float], dict[str, float]]:
    """Return the function that turns ray k towards a place of the zoom; its noise stays."""
    noise = float(errors[k]) - blunders(params)[k]

    def move(x: float, z: float) -> dict[str, float]:
        aside = float(ASIDE[k] @ np.array([x, z])) * 1e-3 / (1.0 + BEHIND / DISTANCE)
        shift = aside / METRES_PER_PX - noise
        return {f"ray_{k + 1}": 0.0 if abs(shift) < 1.0 else shift}

    return move


def _in_photo(bundle: Bundle) -> Handle:
    p = bundle.params
    k = p.shown - 1
    noise = float(bundle.errors_px[k]) - blunders(p)[k]
    true = (CAMERA.width - 1) / 2
    return Handle(panel="picture", name="measured", thing=f"ray_{p.shown}", label=f"Measured in photo {p.shown}",
                  role="second", freedom="x", parameters=(f"ray_{p.shown}",), nudge=(ENLARGED, 0.0),
                  at=(true + ENLARGED * float(bundle.errors_px[k]), (CAMERA.height - 1) / 2),
                  move=lambda x, _: {f"ray_{p.shown}": (x - true) / ENLARGED - noise})  # fmt: skip
