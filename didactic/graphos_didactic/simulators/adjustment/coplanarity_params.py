"""The parameters of the simulator of coplanarity and relative orientation."""

from __future__ import annotations

from typing import Annotated

from graphos_core.params import About, Params
from graphos_didactic.simulators.usual_controls import noise_about, orbit_about, photo_about, seed_about

LESSON = "adjustment/coplanarity"


def _base(label: str, symbol: str, low: float, high: float, effect: str) -> About:
    return About(label=label, symbol=symbol, unit="m", low=low, high=high, step=0.1, group="Camera B",
                 help="Component of the base: where camera B stands, seen from camera A.", effect=effect,
                 learn=LESSON)  # fmt: skip


def _turn(label: str, effect: str) -> About:
    return About(label=label, unit="°", low=-40, high=40, step=1, group="Camera B", learn=LESSON,
                 help="Direction of view of camera B.", effect=effect)  # fmt: skip


def _off(label: str, effect: str) -> About:
    return About(label=label, unit="px", low=-300, high=300, step=1, group="Measurement", level="expert",
                 help="Mistake of the measured point 1 in photo B.", effect=effect, learn=LESSON)  # fmt: skip


class CoplanarityParams(Params):
    """Camera A at (0, 0, 0), camera B beside it, before a folded wall; x to the right, y forward, z upwards, m."""

    base_x: Annotated[
        float, _base("Base, to the side", "b_x", -4, 4, "Away from zero: longer base, deeper model.")
    ] = 2.0
    base_y: Annotated[float, _base("Base, forward", "b_y", -2, 2, "Higher: camera B nearer to the wall.")] = (
        0.4
    )
    base_z: Annotated[float, _base("Base, upwards", "b_z", -2, 2, "Higher: the epipolar lines tilt.")] = 0.6
    turn: Annotated[float, _turn("Camera B turned", "Higher: it looks farther to the right.")] = -16.0
    tilt: Annotated[float, _turn("Camera B tilted", "Higher: it looks farther up.")] = -4.0
    fold: Annotated[
        float,
        About(label="Depth of the object", symbol="h", unit="m", low=0, high=4, step=0.1, group="Object",
              help="How far the wall is folded: its edges lie this much farther away than its middle.",
              effect="Towards zero: the wall becomes flat, eight points fail.", learn=LESSON),
    ] = 2.5  # fmt: skip
    count: Annotated[
        int,
        About(label="Points", symbol="n", unit="points", low=8, high=40, step=1, group="Object",
              help="Number of points measured in both photos.", effect="More: smaller errors, above all of the linear solution.",
              learn=LESSON),
    ] = 16  # fmt: skip
    sigma_px: Annotated[float, noise_about(4, LESSON)] = 0.8
    off_x: Annotated[float, _off("Point 1 moved in x", "Higher: to the right.")] = 0.0
    off_y: Annotated[float, _off("Point 1 moved in y", "Higher: downwards.")] = 0.0
    seed: Annotated[int, seed_about("Seed of the points and of the measuring errors.")] = 3
    orbit: Annotated[float, orbit_about()] = -25.0
    photo: Annotated[bool, photo_about("Put a photo on the folded wall.")] = False
