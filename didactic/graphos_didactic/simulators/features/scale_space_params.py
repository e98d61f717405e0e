"""Parameters of the simulator of the scale space."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.features.detectors.sift import SiftParams
from graphos_core.params import About, Params
from graphos_didactic.simulators.usual_controls import seed_about

LESSON = "features/scale-space"
OCTAVES = 5
"""Octaves that are shown."""
MOST_LAYERS = 5
_ENGINE = SiftParams.declarations()


class ScaleSpaceParams(Params):
    """The picture, the place looked at, and the detector's own parameters."""

    picture: Annotated[Literal["blobs", "edges", "photo"], About(
        label="Picture", group="Picture", level="novice",
        choices={"blobs": "blobs", "edges": "straight edges", "photo": "photo"},
        help="Simulated blobs of known size, straight edges, or a photo (of the open project, else simulated).",
        effect="Edges: nothing can be found again along them.")] = "blobs"  # fmt: skip
    size: Annotated[float, About(
        label="Size of the blob", symbol="s", unit="px", low=1.5, high=14.0, step=0.5, group="Picture", level="novice",
        help="Standard deviation of the large blob on the left.",
        effect="Larger: its extremum moves up the scale.")] = 5.0  # fmt: skip
    stretch: Annotated[float, About(
        label="Stretched", unit="times", low=0.5, high=8.0, step=0.25, group="Picture",
        help="How many times longer than wide the blob is.",
        effect="Larger: the blob becomes an edge; the ratio of curvatures grows.")] = 1.0  # fmt: skip
    strength: Annotated[float, About(
        label="Strength of the blob", unit="grey levels", low=1.0, high=120.0, step=1.0, group="Picture",
        help="How much brighter its middle is than what surrounds it.",
        effect="Larger: stronger response. Smaller: below the contrast threshold.")] = 90.0  # fmt: skip
    noise: Annotated[float, About(
        label="Image noise", symbol=r"\sigma_g", unit="grey levels", low=0.0, high=20.0, step=0.5, group="Picture",
        help="Standard deviation of the sensor noise in the simulated pictures.",
        effect="Larger: more weak extrema, mostly small ones.")] = 2.0  # fmt: skip
    contrast: Annotated[float, _ENGINE["contrast"].about] = _ENGINE["contrast"].default
    edge: Annotated[float, _ENGINE["edge"].about] = _ENGINE["edge"].default
    layers: Annotated[int, About(
        label="Layers per octave", symbol="n", unit="layers", low=1, high=MOST_LAYERS, step=1, level="student",
        help=_ENGINE["layers"].about.help, effect=_ENGINE["layers"].about.effect, learn=LESSON)] = 3  # fmt: skip
    sigma: Annotated[float, _ENGINE["sigma"].about] = _ENGINE["sigma"].default
    rejected: Annotated[bool, About(
        label="Show what is rejected", group="Drawing", level="student",
        help="Whether the extrema that did not become keypoints are drawn too.",
        effect="Off: keypoints only.")] = True  # fmt: skip
    level: Annotated[int, About(
        label="Layer looked at", unit="number", low=1, high=OCTAVES * MOST_LAYERS, step=1, group="Place", level="student",
        help="Counted through all octaves; n layers make an octave.",
        effect="Higher: more blur, larger structures.")] = 8  # fmt: skip
    x: Annotated[float, About(
        label="Point, across", unit="%", low=0, high=100, step=0.5, group="Place", level="expert",
        help="Where the point is, in parts of the picture's width.", effect="Higher: more to the right.")] = 31.0  # fmt: skip
    y: Annotated[float, About(
        label="Point, down", unit="%", low=0, high=100, step=0.5, group="Place", level="expert",
        help="Where the point is, in parts of the picture's height.", effect="Higher: further down.")] = 50.0  # fmt: skip
    seed: Annotated[int, seed_about("Seed of the simulated image noise.")] = 0
