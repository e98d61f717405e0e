"""The parameters of the simulator of random sampling among matches."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

MOST = 300
"""Samples that are drawn."""
FARTHEST = 150.0
"""The dragged match can be so far off in each coordinate, px."""
LESSON = "features/ransac-matches"


class SamplingParams(Params):
    """Matches of two photos, some of them false; samples are drawn one after the other."""

    draw: Annotated[
        int,
        About(
            label="Sample",
            symbol="i",
            unit="number",
            low=1,
            high=MOST,
            step=1,
            group="Search",
            level="novice",
            help="Up to which sample the search has come.",
            effect="Higher: more samples were tried, the best one can only get better.",
            learn=LESSON,
        ),
    ] = 28
    good: Annotated[
        float,
        About(
            label="Share of true matches",
            symbol="w",
            unit="part",
            low=0.1,
            high=1.0,
            step=0.05,
            group="Matches",
            level="novice",
            help="How many of the simulated matches are true.",
            effect="Lower: the needed number of samples grows with a high power.",
            learn=LESSON,
        ),
    ] = 0.6
    model: Annotated[
        Literal["homography", "fundamental"],
        About(
            label="Model",
            group="Search",
            level="novice",
            choices={"homography": "homography", "fundamental": "fundamental"},
            help="What all true matches have in common: a plane (4 matches in a sample), or epipolar geometry (7).",
            effect="More matches in a sample: more samples are needed.",
            learn="features/verification",
        ),
    ] = "homography"
    cost: Annotated[
        Literal["ransac", "msac", "lmeds", "magsac"],
        About(
            label="Judge by",
            group="Search",
            choices={
                "ransac": "RANSAC",
                "msac": "MSAC",
                "lmeds": "LMedS",
                "magsac": "MAGSAC++",
            },
            help="What makes a sample better: a count, truncated squares, the median, or no sharp limit.",
            effect="The count does not see how well the matches fit; the median breaks below half true matches.",
            learn=LESSON,
        ),
    ] = "ransac"
    order: Annotated[
        Literal["random", "best"],
        About(
            label="Draw",
            group="Search",
            choices={"random": "all alike", "best": "PROSAC"},
            help="Samples from all matches alike, or from the most distinctive first (PROSAC).",
            effect="Distinctive first: a good sample comes sooner, if the ratio of distances tells true from false.",
            learn="features/ratio-test",
        ),
    ] = "random"
    threshold: Annotated[
        float,
        About(
            label="Threshold",
            symbol="t",
            unit="px",
            low=0.2,
            high=20,
            step=0.2,
            group="Search",
            level="novice",
            help="Largest distance of a match that agrees with the model.",
            effect="Higher: false matches agree by chance. Lower: true ones are left out because of their noise.",
            learn="features/verification",
        ),
    ] = 3.0
    confidence: Annotated[
        float,
        About(
            label="Confidence",
            symbol="p",
            unit="probability",
            low=0.5,
            high=0.9999,
            step=0.01,
            group="Search",
            help="How sure it shall be that one sample was free of false matches.",
            effect="Higher: more samples.",
            learn=LESSON,
        ),
    ] = 0.99
    count: Annotated[
        int,
        About(
            label="Matches",
            symbol="n",
            unit="matches",
            low=20,
            high=120,
            step=5,
            group="Matches",
            help="Number of matches.",
            effect="More: no more samples are needed, only more to count.",
            learn=LESSON,
        ),
    ] = 50
    noise_px: Annotated[
        float,
        About(
            label="Noise",
            symbol=r"\sigma",
            unit="px",
            low=0,
            high=4,
            step=0.1,
            group="Matches",
            help="Standard deviation of a coordinate of a true match in photo B.",
            effect="Larger: models from few matches are off; fewer matches agree with them.",
        ),
    ] = 0.8
    depth: Annotated[
        float,
        About(
            label="Depth of the object",
            unit="%",
            low=-60,
            high=60,
            step=5,
            group="Matches",
            help="How far the simulated points reach behind the wall (above 0) or before it, in parts of the distance.",
            effect="0: a plane, a homography holds and the fundamental matrix is not determined. Away from 0: the other way round.",
            learn="features/epipolar",
        ),
    ] = 0.0
    off_x: Annotated[
        float,
        About(
            label="Dragged match, x",
            unit="px",
            low=-FARTHEST,
            high=FARTHEST,
            step=1,
            group="Dragged match",
            level="expert",
            help="How far the dragged match lies from its true place in photo B.",
            effect="Away from 0: it becomes a false match.",
        ),
    ] = 38.0
    off_y: Annotated[
        float,
        About(
            label="Dragged match, y",
            unit="px",
            low=-FARTHEST,
            high=FARTHEST,
            step=1,
            group="Dragged match",
            level="expert",
            help="How far the dragged match lies from its true place in photo B.",
            effect="Away from 0: it becomes a false match.",
        ),
    ] = -30.0
    seed: Annotated[
        int,
        About(
            label="Chance",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Matches",
            help="Seed of matches, noise and samples.",
            effect="Another number: other matches and another order of samples.",
        ),
    ] = 2
    source: Annotated[
        Literal["simulated", "photo"],
        About(
            label="Matches",
            group="Matches",
            choices={"simulated": "simulated", "photo": "of two photos"},
            help="Simulated matches, or SIFT matches of two photos of a pictured wall.",
            effect="Photos: false matches are where structure repeats.",
            learn="features/matching",
        ),
    ] = "simulated"
