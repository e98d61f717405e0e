"""The parameters of the simulator of networks for self-calibration."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

FEWEST, MOST = 3, 8
"""Photos of the network."""
LESSON = "adjustment/network-design"


class NetworkParams(Params):
    """A ring of photos above a field of targets; three targets in the corners are known, all else is unknown."""

    tilt: Annotated[
        float,
        About(
            label="Tilt",
            symbol=r"\nu",
            unit="°",
            low=0,
            high=55,
            step=1,
            group="Network",
            level="novice",
            help="Angle of all viewing directions from the vertical, towards the middle of the field.",
            effect="Larger: principal distance and distance of the camera are better separated.",
            learn=LESSON,
        ),
    ] = 20.0
    roll: Annotated[
        float,
        About(
            label="Roll of every second photo",
            symbol=r"\kappa",
            unit="°",
            low=0,
            high=90,
            step=5,
            group="Network",
            level="novice",
            help="How far the camera was turned about its axis of view for every second photo.",
            effect="Larger: principal point and tilts are better separated.",
            learn=LESSON,
        ),
    ] = 5.0
    depth: Annotated[
        float,
        About(
            label="Depth of the field",
            symbol=r"\Delta Z",
            unit="m",
            low=0,
            high=2,
            step=0.1,
            group="Network",
            level="novice",
            help="Height of the highest targets above the lowest.",
            effect="Larger: does what tilt does, as far as the field allows.",
            learn=LESSON,
        ),
    ] = 0.2
    photos: Annotated[
        int,
        About(
            label="Photos",
            symbol="n",
            unit="photos",
            low=FEWEST,
            high=MOST,
            step=1,
            group="Network",
            level="novice",
            help="How many photos stand on the ring.",
            effect="More: standard deviations fall slowly; correlations hardly.",
            learn=LESSON,
        ),
    ] = 4
    terms: Annotated[
        Literal["point", "radial", "decentring"],
        About(
            label="Unknown",
            group="Camera",
            choices={
                "point": "f, x₀, y₀",
                "radial": "with k₁, k₂",
                "decentring": "with k₁ k₂ p₁ p₂",
            },
            help="Which parameters of the camera are estimated.",
            effect="Further down: more unknowns, which imitate each other.",
            learn="adjustment/self-calibration",
        ),
    ] = "decentring"
    sigma_px: Annotated[
        float,
        About(
            label="Image precision",
            symbol=r"\sigma",
            unit="px",
            low=0.05,
            high=2,
            step=0.05,
            group="Measurement",
            help="Standard deviation of a measured image coordinate.",
            effect="Larger: all standard deviations grow with it, no correlation changes.",
            learn="adjustment/covariance",
        ),
    ] = 0.2
    seed: Annotated[
        int,
        About(
            label="Noise",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Measurement",
            help="Seed of the simulated measuring errors.",
            effect="Another number: other errors, same size.",
        ),
    ] = 0
    orbit: Annotated[
        float,
        About(
            label="Seen from",
            unit="°",
            low=-180,
            high=180,
            step=5,
            group="Drawing",
            help="From where the picture in space is seen.",
            effect="Larger: the observer walks to the right.",
        ),
    ] = 25.0
    photo: Annotated[
        bool,
        About(
            label="Show a photo",
            group="Drawing",
            help="Lay a photo on the field and show what one camera sees.",
            effect="On: a photo appears.",
        ),
    ] = False
    shown: Annotated[
        int,
        About(
            label="Which photo",
            unit="number",
            low=1,
            high=MOST,
            step=1,
            group="Drawing",
            help="Number of the photo that is shown.",
            effect="Another number: the field seen from elsewhere.",
        ),
    ] = 2
