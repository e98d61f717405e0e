"""Parameters of the simulator of decolourisation."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params
from graphos_core.preprocessing.decolorization import DecolorParams

LESSON = "preprocessing/decolorization"
_ENGINE = DecolorParams.declarations()
FIT_PIXELS = 3000
"""The weights are found on so many pixels: the simulated pictures have few colours."""


def _hue(name: str) -> About:
    return About(label=f"Hue of {name}", symbol=f"h_{name}", unit="°", low=0, high=360, step=1, group="Colours",
                 level="student", help=f"Angle of colour {name} in CIELAB: 0 red, 90 yellow, 180 green, 270 blue.",
                 effect="Larger: from red over yellow, green and blue back to red.")  # fmt: skip


def _light(name: str) -> About:
    return About(label=f"Lightness of {name}", symbol=f"L_{name}", unit="of 100", low=20, high=90, step=0.5,
                 group="Colours", level="student", help=f"CIELAB lightness of colour {name}.",
                 effect="Larger: brighter.")  # fmt: skip


def _place(name: str, way: str) -> About:
    return About(label=f"{name} in the photo, {way}", unit="%", low=0, high=100, step=0.5, group="Photo", level="expert",
                 help=f"Where colour {name} is taken from in a photo.",
                 effect="Larger: more to the right." if way == "across" else "Larger: further down.")  # fmt: skip


class DecolorizationParams(Params):
    """The colours of the picture and the parameters of the engine's decolourisation."""

    picture: Annotated[Literal["two", "three", "wheel", "photo"], About(
        label="Picture", group="Colours", level="novice",
        choices={"two": "two colours", "three": "three colours", "wheel": "all hues", "photo": "photo"},
        help="Simulated pictures, or a photo (of the open project, else simulated).",
        effect="All hues: more colours than one grey axis can keep apart.")] = "two"  # fmt: skip
    a_hue: Annotated[float, _hue("A")] = 30.0
    a_light: Annotated[float, _light("A")] = 55.0
    b_hue: Annotated[float, _hue("B")] = 150.0
    b_light: Annotated[float, _light("B")] = 60.0
    c_hue: Annotated[float, _hue("C")] = 285.0
    c_light: Annotated[float, _light("C")] = 55.5
    chroma: Annotated[float, About(
        label="Chroma", symbol="C", unit="units of L", low=5, high=70, step=1, group="Colours",
        help="How colourful the colours are: distance from grey in CIELAB.",
        effect="Smaller: greyer; the difference that could be kept shrinks.")] = 40.0  # fmt: skip
    noise: Annotated[float, About(
        label="Image noise", symbol=r"\sigma_g", unit="levels", low=0.0, high=20.0, step=0.5, group="Colours",
        help="Standard deviation of the noise of each channel in the simulated pictures.",
        effect="Larger: differences that are not there come in.")] = 1.5  # fmt: skip
    sigma: Annotated[float, _ENGINE["sigma"].about] = _ENGINE["sigma"].default
    iterations: Annotated[int, About(
        label="Iterations", symbol="n", unit="iterations", low=1, high=30, step=1, group="Method", level="student",
        help=_ENGINE["iterations"].about.help, effect=_ENGINE["iterations"].about.effect, learn=LESSON)] = 15  # fmt: skip
    a_x: Annotated[float, _place("A", "across")] = 40.0
    a_y: Annotated[float, _place("A", "down")] = 68.0
    b_x: Annotated[float, _place("B", "across")] = 20.0
    b_y: Annotated[float, _place("B", "down")] = 14.0
    c_x: Annotated[float, _place("C", "across")] = 55.0
    c_y: Annotated[float, _place("C", "down")] = 92.0

    @property
    def engine(self) -> DecolorParams:
        """The engine's own parameter sheet."""
        return DecolorParams(sigma=self.sigma, iterations=self.iterations, fit_pixels=FIT_PIXELS)
