"""The parameters of the simulator of robust weights."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_core.params import About, Params

RAYS = 9
"""Photos, each with one ray to the point."""
LARGEST_PX = 45.0
"""Largest blunder of a ray, px."""
MOST_DRAWS = 40
"""Samples drawn at most."""
LESSON = "adjustment/robust"


def _ray(number: int) -> About:
    return About(
        label=f"Ray {number}", symbol=rf"\Delta_{number}", unit="px", low=-LARGEST_PX, high=LARGEST_PX, step=1,
        group="Blunders", level="expert", help=f"Blunder of the measurement in photo {number}, beside its noise.",
        effect="Away from 0: the ray passes the point farther off.", learn="adjustment/outliers",
    )  # fmt: skip


class RobustParams(Params):
    """Nine photos in an arc above a point at (0, 0), seen in a section; some rays can be wrong."""

    function: Annotated[
        Literal["none", "huber", "l1", "cauchy", "geman-mcclure", "tukey", "danish"],
        About(
            label="Robust function",
            symbol=r"\rho",
            group="Robust weights",
            level="novice",
            choices={name: function.label for name, function in ROBUST.items()},
            help="How the weight of an observation falls with its residual.",
            effect="Further down the list: less mercy for large residuals, more need of a good start.",
            learn=LESSON,
        ),
    ] = "huber"
    scale: Annotated[
        float,
        About(
            label="Scale",
            symbol="c",
            unit="σ",
            low=0.5,
            high=12,
            step=0.5,
            group="Robust weights",
            level="novice",
            help="Residual at which the function takes effect, in standard deviations.",
            effect="Larger: nearer to least squares. Smaller: good rays lose weight too.",
            learn=LESSON,
        ),
    ] = 2.0
    start: Annotated[
        Literal["least squares", "ransac"],
        About(
            label="Start",
            group="Robust weights",
            level="novice",
            choices={"least squares": "least squares", "ransac": "best sample of RANSAC"},
            help="Where the reweighting begins.",
            effect="Best sample: redescending functions begin in the right valley.",
            learn="adjustment/ransac",
        ),
    ] = "least squares"
    iterations: Annotated[
        int,
        About(
            label="Reweighted",
            unit="times",
            low=0,
            high=60,
            step=1,
            group="Robust weights",
            help="How often weights are renewed and the point computed again.",
            effect="Higher: nearer to the end; watch the path.",
            learn=LESSON,
        ),
    ] = 40
    draws: Annotated[
        int,
        About(
            label="Samples drawn",
            symbol="n",
            unit="draws",
            low=1,
            high=MOST_DRAWS,
            step=1,
            group="RANSAC",
            level="novice",
            help="Pairs of rays drawn at random so far.",
            effect="Higher: a clean pair is found with more certainty.",
            learn="adjustment/ransac",
        ),
    ] = 12
    threshold: Annotated[
        float,
        About(
            label="Threshold",
            symbol="t",
            unit="σ",
            low=0.5,
            high=10,
            step=0.5,
            group="RANSAC",
            help="A ray votes for a point that it passes within this distance, in standard deviations.",
            effect="Larger: more votes, wrong ones too. Smaller: good rays are lost to noise.",
            learn="adjustment/ransac",
        ),
    ] = 4.0
    confidence: Annotated[
        float,
        About(
            label="Confidence",
            symbol="p",
            unit="probability",
            low=0.5,
            high=0.999,
            step=0.01,
            group="RANSAC",
            help="Wished probability that one sample at least is clean.",
            effect="Higher: more draws are needed.",
            learn="adjustment/ransac",
        ),
    ] = 0.99
    sigma_px: Annotated[
        float,
        About(
            label="Noise",
            symbol=r"\sigma",
            unit="px",
            low=0.1,
            high=4,
            step=0.1,
            group="Measurement",
            help="Standard deviation of every measurement.",
            effect="Larger: blunders are harder to tell from noise.",
            learn="adjustment/outliers",
        ),
    ] = 1.0
    seed: Annotated[
        int,
        About(
            label="Noise and draws",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Measurement",
            help="Seed of the noise and of the order of the samples.",
            effect="Another number: other noise, other samples.",
        ),
    ] = 3
    ray_1: Annotated[float, _ray(1)] = 0.0
    ray_2: Annotated[float, _ray(2)] = 0.0
    ray_3: Annotated[float, _ray(3)] = 0.0
    ray_4: Annotated[float, _ray(4)] = 0.0
    ray_5: Annotated[float, _ray(5)] = 0.0
    ray_6: Annotated[float, _ray(6)] = 0.0
    ray_7: Annotated[float, _ray(7)] = 28.0
    ray_8: Annotated[float, _ray(8)] = 0.0
    ray_9: Annotated[float, _ray(9)] = 0.0
    photo: Annotated[
        bool,
        About(
            label="Show a photo",
            group="Drawing",
            level="student",
            help="Lay a photo on the ground and show what one camera sees of it.",
            effect="On: a photo with the measured place appears; drag it there.",
        ),
    ] = False
    shown: Annotated[
        int,
        About(
            label="Which photo",
            unit="number",
            low=1,
            high=RAYS,
            step=1,
            group="Drawing",
            level="student",
            help="Number of the photo that is shown.",
            effect="Another number: the same point seen from elsewhere.",
        ),
    ] = 7


def blunders(params: RobustParams) -> list[float]:
    """Return the blunder of every ray, px."""
    return [float(getattr(params, f"ray_{k}")) for k in range(1, RAYS + 1)]
