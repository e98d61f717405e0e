"""Parameters of the simulator of orientation and descriptor."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.features.descriptor import CELLS, PEAK_SHARE
from graphos_core.params import About, Params
from graphos_didactic.simulators.usual_controls import seed_about

LESSON = "features/descriptor"


class DescriptorParams(Params):
    """The keypoint in the first picture, and what is done to the second picture."""

    picture: Annotated[Literal["letter", "round", "photo"], About(
        label="Picture", group="First picture", level="novice",
        choices={"letter": "a letter", "round": "a round blob", "photo": "photo"},
        help="A letter, a blob that looks the same from all sides, or a photo (of the open project, else simulated).",
        effect="Round: no direction stands out.")] = "letter"  # fmt: skip
    x: Annotated[float, About(
        label="Point, across", unit="%", low=0, high=100, step=0.5, group="First picture", level="expert",
        help="Where the key point is, in parts of the picture's width.", effect="Higher: more to the right.")] = 47.0  # fmt: skip
    y: Annotated[float, About(
        label="Point, down", unit="%", low=0, high=100, step=0.5, group="First picture", level="expert",
        help="Where the key point is, in parts of the picture's height.", effect="Higher: further down.")] = 46.0  # fmt: skip
    size: Annotated[float, About(
        label="Diameter", symbol=r"2\sigma", unit="px", low=4.0, high=30.0, step=0.5, group="First picture",
        help="Scale of the key point; the patch is six times as wide.", learn=LESSON,
        effect="Larger: a larger patch, described on a more blurred layer.")] = 16.0  # fmt: skip
    turn: Annotated[float, About(
        label="Turned", unit="°", low=-180, high=180, step=1, group="Second picture", level="novice",
        help="How far the second picture is turned, clockwise.", effect="Larger: turned more, clockwise.")] = 50.0  # fmt: skip
    gain: Annotated[float, About(
        label="Contrast times", unit="times", low=0.2, high=2.0, step=0.05, group="Second picture",
        help="Factor on the grey levels of the second picture.", learn=LESSON,
        effect="Larger: more contrast, until black and white are reached.")] = 0.6  # fmt: skip
    offset: Annotated[float, About(
        label="Brighter by", unit="grey levels", low=-100, high=100, step=5, group="Second picture",
        help="Added to the grey levels of the second picture.",
        effect="Larger: brighter; gradients stay.")] = 50.0  # fmt: skip
    noise: Annotated[float, About(
        label="Image noise", symbol=r"\sigma_g", unit="grey levels", low=0.0, high=30.0, step=1.0, group="Second picture",
        help="Standard deviation of the sensor noise in the second picture.",
        effect="Larger: the descriptors drift apart, small patches first.")] = 2.0  # fmt: skip
    orientation: Annotated[Literal["histogram", "upright"], About(
        label="Orientation", group="Descriptor",
        choices={"histogram": "gradients", "upright": "upright"},
        help="Whether the patch is turned by the direction that its own gradients show.", learn=LESSON,
        effect="Always upright: a turned picture has another descriptor.")] = "histogram"  # fmt: skip
    share: Annotated[float, About(
        label="Further peaks from", unit="of the highest", low=0.5, high=1.0, step=0.05, group="Descriptor", level="expert",
        help="Peaks of the orientation histogram of at least this share make key points of their own.",
        effect="Lower: more key points at the same place.", learn=LESSON)] = PEAK_SHARE  # fmt: skip
    u: Annotated[float, About(
        label="Pixel, along", unit="cells", low=-CELLS / 2, high=CELLS / 2, step=0.05, group="Descriptor", level="expert",
        help="The pixel whose shares are shown, along the key point's direction.",
        effect="Higher: further along.")] = -0.7  # fmt: skip
    v: Annotated[float, About(
        label="Pixel, across", unit="cells", low=-CELLS / 2, high=CELLS / 2, step=0.05, group="Descriptor", level="expert",
        help="The pixel whose shares are shown, to the right of the key point's direction.",
        effect="Higher: further to the right of it.")] = 0.3  # fmt: skip
    seed: Annotated[int, seed_about("Seed of the image noise of the second picture.")] = 0
