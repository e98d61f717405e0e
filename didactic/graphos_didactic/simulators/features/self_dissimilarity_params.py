"""Parameters of the simulator of maximal self-dissimilarity."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.features.detectors.msd import MsdParams
from graphos_core.params import About, Params
from graphos_didactic.simulators.usual_controls import seed_about

LESSON = "features/msd"
_ENGINE = MsdParams.declarations()
THRESHOLD = 50.0
"""Well above the noise of the first picture, so that its tiles are told from its marks."""
FACTOR = float(_ENGINE["scale_factor"].default)
"""Between the levels of the pyramid."""
MOST_LEVELS = 6


class SelfDissimilarityParams(Params):
    """The picture, the point looked at, and the detector's parameters."""

    picture: Annotated[Literal["tiles", "stripes", "photo"], About(
        label="Picture", group="Picture", level="novice",
        choices={"tiles": "tiles", "stripes": "stripes", "photo": "photo"},
        help="A simulated wall with marks of known place, stripes, or a photo (of the open project, else simulated).",
        effect="Stripes: every patch has its like beside it.")] = "tiles"  # fmt: skip
    noise: Annotated[float, About(
        label="Image noise", symbol=r"\sigma_g", unit="grey levels", low=0.0, high=30.0, step=0.5, group="Picture",
        help="Standard deviation of the sensor noise in the simulated pictures.",
        effect="Larger: nothing is like anything else any more: noise becomes salient.")] = 2.0  # fmt: skip
    patch: Annotated[int, About(
        label="Patch radius", symbol="r_p", unit="px", low=1, high=7, step=1, group="Detector", level="novice",
        help=_ENGINE["patch_radius"].about.help, effect=_ENGINE["patch_radius"].about.effect, learn=LESSON)] = 3  # fmt: skip
    search: Annotated[int, About(
        label="Search radius", symbol="r_s", unit="px", low=1, high=14, step=1, group="Detector", level="novice",
        help=_ENGINE["search_radius"].about.help, effect=_ENGINE["search_radius"].about.effect, learn=LESSON)] = 5  # fmt: skip
    neighbours: Annotated[int, About(
        label="Nearest patches", symbol="k", unit="patches", low=1, high=16, step=1, group="Detector",
        help=_ENGINE["neighbours"].about.help, effect=_ENGINE["neighbours"].about.effect, learn=LESSON)] = _ENGINE["neighbours"].default  # fmt: skip
    threshold: Annotated[float, About(
        label="Threshold", symbol=r"\lambda_0", unit="grey level²", low=0.0, high=2000.0, step=25.0, group="Detector",
        help=_ENGINE["threshold"].about.help, effect=_ENGINE["threshold"].about.effect, learn=LESSON)] = THRESHOLD  # fmt: skip
    nms: Annotated[int, About(
        label="Non-maximum radius", unit="px", low=1, high=15, step=1, group="Detector",
        help=_ENGINE["nms_radius"].about.help, effect=_ENGINE["nms_radius"].about.effect, learn=LESSON)] = 5  # fmt: skip
    level: Annotated[int, About(
        label="Level looked at", unit="number", low=0, high=MOST_LEVELS - 1, step=1, group="Place",
        help="Level of the pyramid; each is smaller than the one before by the same factor.",
        effect="Higher: a smaller picture, so the same patch covers more of the photo.")] = 1  # fmt: skip
    x: Annotated[float, About(
        label="Point, across", unit="%", low=0, high=100, step=0.5, group="Place", level="expert",
        help="Where the point is, in parts of the picture's width.", effect="Higher: more to the right.")] = 62.5  # fmt: skip
    y: Annotated[float, About(
        label="Point, down", unit="%", low=0, high=100, step=0.5, group="Place", level="expert",
        help="Where the point is, in parts of the picture's height.", effect="Higher: further down.")] = 60.0  # fmt: skip
    seed: Annotated[int, seed_about("Seed of the simulated image noise.")] = 0
