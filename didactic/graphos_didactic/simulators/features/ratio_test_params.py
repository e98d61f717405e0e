"""The parameters of the simulator of the ratio test."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params
from graphos_didactic.simulators.pictured_pair import HEIGHT, WIDTH

LESSON = "features/ratio-test"
FARTHEST = 500.0
"""Largest distance of two descriptors that is shown, in units of a descriptor's bytes."""


class RatioTestParams(Params):
    """The threshold, the wall, where photo B is taken from, and the point that is looked at."""

    ratio: Annotated[
        float,
        About(
            label="Ratio",
            symbol="q",
            unit="part",
            low=0.3,
            high=1.0,
            step=0.01,
            group="Test",
            level="novice",
            help="A match is accepted if its distance is less than q times that of the second best candidate.",
            effect="Higher: more matches, more false ones. Lower: fewer, safer ones.",
            learn=LESSON,
        ),
    ] = 0.8
    rule: Annotated[
        Literal["ratio", "distance"],
        About(
            label="What is tested",
            group="Test",
            level="novice",
            choices={"ratio": "ratio d₁ / d₂", "distance": "d₁ alone"},
            help="The ratio of the two smallest distances, or the smallest distance by itself.",
            effect="Distance alone: one limit for plain and for distinctive points; more false matches at equal number.",
            learn=LESSON,
        ),
    ] = "ratio"
    limit: Annotated[
        float,
        About(
            label="Largest distance",
            symbol="T",
            unit="bytes",
            low=0,
            high=FARTHEST,
            step=5,
            group="Test",
            help="With “d₁ alone” a match is accepted if its descriptors differ by less.",
            effect="Higher: more matches, more false ones.",
            learn=LESSON,
        ),
    ] = 200.0
    mutual: Annotated[
        bool,
        About(
            label="Both directions",
            group="Test",
            help="A match must be the best one, and pass the ratio test, seen from either photo.",
            effect="On: fewer false matches, a few true ones go too.",
            learn="features/matching",
        ),
    ] = False
    pattern: Annotated[
        Literal["photo", "windows", "texture"],
        About(
            label="On the wall",
            group="Photos",
            level="novice",
            choices={"photo": "a photo", "windows": "equal windows", "texture": "rich texture"},
            help="A photo of the open project (else of the simulated façade), equal windows, or a rich texture.",
            effect="Equal windows: the nearest descriptor belongs to any of them.",
        ),
    ] = "photo"
    tilt: Annotated[
        float,
        About(
            label="Photo B from the side",
            symbol=r"\theta",
            unit="°",
            low=0,
            high=70,
            step=1,
            group="Photos",
            level="novice",
            help="Angle between the direction of photo B and the wall's normal.",
            effect="Larger: true matches get larger distances.",
        ),
    ] = 32.0
    aside: Annotated[
        float,
        About(
            label="Photo B aimed aside",
            unit="px",
            low=-220,
            high=220,
            step=5,
            group="Photos",
            help="How far from the middle of photo A camera B looks, in pixels of photo A.",
            effect="Away from 0: more points of A have no partner in B.",
        ),
    ] = 90.0
    noise: Annotated[
        float,
        About(
            label="Noise of photo B",
            symbol=r"\sigma",
            unit="grey levels",
            low=0,
            high=60,
            step=1,
            group="Photos",
            help="Standard deviation of the grey values of photo B.",
            effect="Larger: the two distributions grow together.",
        ),
    ] = 8.0
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
    tolerance: Annotated[
        float,
        About(
            label="True within",
            symbol=r"\varepsilon",
            unit="px",
            low=0.5,
            high=10,
            step=0.5,
            group="Truth",
            level="expert",
            help="A match is true if it lies this near to where the wall's point really is.",
            effect="Larger: inaccurate matches count as true.",
        ),
    ] = 3.0
    look_x: Annotated[
        float,
        About(
            label="Point looked at, across",
            unit="px",
            low=0,
            high=WIDTH - 1,
            step=1,
            group="Point",
            level="expert",
            help="The feature of photo A nearest to here is looked at.",
            effect="Higher: more to the right.",
        ),
    ] = 227.0
    look_y: Annotated[
        float,
        About(
            label="Point looked at, down",
            unit="px",
            low=0,
            high=HEIGHT - 1,
            step=1,
            group="Point",
            level="expert",
            help="The feature of photo A nearest to here is looked at.",
            effect="Higher: further down.",
        ),
    ] = 58.0
