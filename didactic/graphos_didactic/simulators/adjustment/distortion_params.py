"""The parameters of the simulator of lens distortion."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params
from graphos_didactic.simulators.usual_controls import photo_about

LESSON = "adjustment/distortion"
WIDTH, HEIGHT = 4000, 3000
"""Format of the camera, px."""
BASE_PX = 2000.0
"""Length by which the polynomial models divide coordinates, px."""
ModelName = Literal[
    "pinhole", "basic", "radial", "brown", "complete", "brown_backward", "ebner", "polynomial3", "polynomial5",
    "fisheye_equidistant", "fisheye_equisolid", "spherical",
]  # fmt: skip
MODEL_LABELS = {
    "pinhole": "pinhole", "basic": "basic", "radial": "radial", "brown": "Brown", "complete": "complete",
    "brown_backward": "Brown back", "ebner": "Ebner", "polynomial3": "polynomial 3", "polynomial5": "polynomial 5",
    "fisheye_equidistant": "equidistant", "fisheye_equisolid": "equisolid", "spherical": "spherical",
}  # fmt: skip


def _k(number: int, high: float) -> About:
    return About(label=f"Radial k{number}", symbol=f"k_{number}", low=-high, high=high, step=high / 100, group="Radial",
                 help=f"Coefficient of the radial term with r to the power {2 * number + 1}.",
                 effect="Positive: cushion, points move outwards; negative: barrel.", learn=LESSON)  # fmt: skip


def _p(number: int) -> About:
    return About(label=f"Decentring p{number}", symbol=f"p_{number}", low=-0.01, high=0.01, step=0.0002, group="Decentring",
                 help="A lens element that stands a little off the axis.",
                 effect="Away from zero: points move towards one side, most in the corners.", learn=LESSON)  # fmt: skip


def _b(number: int, effect: str) -> About:
    return About(label=("Affinity b1", "Shear b2")[number - 1], symbol=f"b_{number}", low=-0.02, high=0.02, step=0.0005,
                 group="Affinity", help="Pixels that are not square, or axes not at right angles.", effect=effect,
                 learn=LESSON)  # fmt: skip


def _centre(axis: str) -> About:
    return About(label=f"Distortion centre {axis}", symbol=f"{axis}_1", unit="px", low=-400, high=400, step=10, group="Decentring",
                 level="expert", help="Centre of the distortion, from the principal point.",
                 effect="Away from zero: much like decentring, which is why both are not free at once.",
                 learn=LESSON)  # fmt: skip


def _true(label: str, symbol: str, high: float) -> About:
    return About(label=f"True {label}", symbol=symbol, low=-high, high=high, step=high / 100, group="True lens", level="expert",
                 help="The lens that was really there: the rings on the grid.", effect="Larger: the rings move.",
                 learn=LESSON)  # fmt: skip


class DistortionParams(Params):
    """A lens by its coefficients in units of the principal distance, and the lens that is really there."""

    model: Annotated[
        ModelName,
        About(label="Camera model", group="Model", choices=MODEL_LABELS,
              help="Which formula is used; only the coefficients that it has do anything.",
              effect="Another model: another shape of what can be described.", learn=LESSON),
    ] = "complete"  # fmt: skip
    focal_px: Annotated[
        float,
        About(label="Principal distance", symbol="f", unit="px", low=600, high=8000, step=100, group="Model",
              help="Scale at the principal point.",
              effect="Longer: smaller angles, so the same k bend less.", learn=LESSON),
    ] = 3000.0  # fmt: skip
    k1: Annotated[float, _k(1, 0.5)] = -0.16
    k2: Annotated[float, _k(2, 0.5)] = 0.05
    k3: Annotated[float, _k(3, 0.5)] = 0.0
    p1: Annotated[float, _p(1)] = 0.003
    p2: Annotated[float, _p(2)] = -0.002
    x1: Annotated[float, _centre("x")] = 0.0
    y1: Annotated[float, _centre("y")] = 0.0
    b1: Annotated[float, _b(1, "Positive: wider in x.")] = 0.004
    b2: Annotated[float, _b(2, "Positive: the picture leans.")] = 0.003
    term: Annotated[
        int,
        About(label="Polynomial term", symbol="i", unit="number", low=1, high=18, step=1, group="Polynomial",
              help="Which term of a polynomial model is used; after the last it begins again.",
              effect="Another number: another pattern.", learn=LESSON),
    ] = 3  # fmt: skip
    amount_px: Annotated[
        float,
        About(label="Its size", symbol="e_i", unit="px", low=-200, high=200, step=5, group="Polynomial",
              help="Displacement by that term at the base length from the principal point.",
              effect="Larger: stronger; negative: the other way.", learn=LESSON),
    ] = 60.0  # fmt: skip
    zero_px: Annotated[
        float,
        About(label="Balanced zero at", symbol="r_0", unit="px", low=300, high=2500, step=20, group="Profile",
              help="Radius at which the balanced distortion is zero.",
              effect="Farther out: another principal distance takes more of the distortion.", learn=LESSON),
    ] = 1660.0  # fmt: skip
    true_k1: Annotated[float, _true("k1", "k_1", 0.5)] = -0.1
    true_k2: Annotated[float, _true("k2", "k_2", 0.5)] = 0.02
    true_p1: Annotated[float, _true("p1", "p_1", 0.01)] = 0.0
    true_p2: Annotated[float, _true("p2", "p_2", 0.01)] = 0.0
    exaggeration: Annotated[
        int,
        About(label="Distortion drawn", unit="times", low=1, high=50, step=1, group="Drawing",
              help="How much larger than true the grid is bent.", effect="Larger: bigger drawing; the numbers stay."),
    ] = 2  # fmt: skip
    photo: Annotated[
        bool, photo_about("Draw a photo through this lens.", "On: the grid lies on the bent photo.")
    ] = False
