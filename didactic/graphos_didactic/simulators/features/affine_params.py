"""The parameters of the simulator of affine simulation."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

STEEPEST = 82.0
"""Largest tilt of camera B, degrees."""
LESSON = "features/affine"


class AffineParams(Params):
    """Where camera B stands on the hemisphere above the wall, and which views of photo A are simulated."""

    tilt: Annotated[
        float,
        About(
            label="Tilt of camera B",
            symbol=r"\theta",
            unit="°",
            low=0,
            high=STEEPEST,
            step=1,
            group="Camera B",
            level="novice",
            help="Angle between the direction of camera B and the wall's normal.",
            effect="Larger: the wall is compressed more; SIFT alone fails.",
            learn=LESSON,
        ),
    ] = 62.0
    swing: Annotated[
        float,
        About(
            label="Swing of camera B",
            symbol=r"\varphi",
            unit="°",
            low=-180,
            high=180,
            step=5,
            group="Camera B",
            level="novice",
            help="Direction of the tilt around the wall's normal: 0 to the right, 90 upwards.",
            effect="Another direction: the wall is compressed along another line.",
            learn=LESSON,
        ),
    ] = 25.0
    roll: Annotated[
        float,
        About(
            label="Roll of camera B",
            symbol=r"\psi",
            unit="°",
            low=-180,
            high=180,
            step=5,
            group="Camera B",
            help="How far camera B is turned about its axis.",
            effect="Any value: SIFT undoes it by itself.",
            learn="features/sift",
        ),
    ] = 5.0
    tilts: Annotated[
        int,
        About(
            label="Simulated tilts",
            symbol="k",
            unit="tilts",
            low=0,
            high=5,
            step=1,
            group="Simulation",
            level="novice",
            help="How many tilts beside the photo itself are simulated; each is √2 times the one before.",
            effect="More: steeper views are matched; time grows with the number of views.",
            learn=LESSON,
        ),
    ] = 3
    step: Annotated[
        float,
        About(
            label="Step of longitude",
            symbol="b",
            unit="°",
            low=36,
            high=180,
            step=12,
            group="Simulation",
            help="Directions of tilt t are b / t apart.",
            effect="Smaller: more views, the true one is nearer to one of them.",
            learn=LESSON,
        ),
    ] = 72.0
    ratio: Annotated[
        float,
        About(
            label="Ratio",
            symbol="q",
            unit="part",
            low=0.5,
            high=1.0,
            step=0.05,
            group="Simulation",
            help="Threshold of the ratio test between each simulated view and photo B.",
            effect="Higher: more matches, more false ones.",
            learn="features/ratio-test",
        ),
    ] = 0.75
    pattern: Annotated[
        Literal["photo", "windows", "texture"],
        About(
            label="On the wall",
            group="Photos",
            choices={"photo": "a photo", "windows": "equal windows", "texture": "rich texture"},
            help="A photo of the open project (else of the simulated façade), equal windows, or a rich texture.",
            effect="Equal windows: matches are false whatever is simulated.",
        ),
    ] = "photo"
    noise: Annotated[
        float,
        About(
            label="Noise of photo B",
            symbol=r"\sigma",
            unit="grey levels",
            low=0,
            high=40,
            step=1,
            group="Photos",
            help="Standard deviation of the grey values of photo B.",
            effect="Larger: fewer true matches.",
        ),
    ] = 4.0
    seed: Annotated[
        int,
        About(
            label="Noise",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Photos",
            help="Seed of the noise.",
            effect="Another number: other noise, same size.",
        ),
    ] = 0
    orbit: Annotated[
        float,
        About(
            label="View from",
            unit="°",
            low=-180,
            high=180,
            step=5,
            group="Drawing",
            level="expert",
            help="From where the hemisphere is seen.",
            effect="Larger: the observer walks to the right.",
        ),
    ] = -20.0
