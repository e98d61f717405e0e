"""Pictures of detectors for lessons: points on the simulated façade, which are found again, and which stay."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from scipy.spatial import cKDTree

from graphos_core.data import Features
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.features.detectors.selection import choose
from graphos_core.features_comparison.disturbances import rotation, scale
from graphos_core.features_comparison.measures import REPEATED_PX
from graphos_core.features_comparison.truth import mapped
from graphos_core.params import unknown_name
from graphos_core.preprocessing.grey import luma
from graphos_core.registry import find
from graphos_core.run import Run
from graphos_core.text import Text
from graphos_didactic.scene import AnyMark, Line, Panel, Picture, Points, Polygon, Role, Scene
from graphos_didactic.simulators.simulated_photo import simulated_photo

TURN_DEG, SMALLER = 25.0, 1.4
SHOWN = 120
"""Points that are drawn, evenly spread: more hide each other."""
SELECTIONS = {
    "scale": "by scale",
    "strength": "by strength",
    "grid": "evenly, by cells",
    "anms": "evenly, by distance",
}
CELLS = 12
CIRCLE = np.linspace(0.0, 2.0 * math.pi, 25)


def detector_scene(what: str) -> Scene:
    """Return the scene of a detector with some parameters, ``"harris,levels=1"``: which points are found again.

    Raises
    ------
    UserError
        For an unknown detector or parameter.
    ParamError
        For a value out of its declaration.
    """
    label, first = _detected(what, changed=False)
    _, second = _detected(what, changed=True)
    size = (first.width, first.height)
    shown = choose("anms", first.xy.astype(float), first.scale, first.response, SHOWN, size)
    there, inside = mapped(_changed()[1], first.xy[shown].astype(float), (second.width, second.height))
    away, partner = cKDTree(second.xy).query(there) if len(second.xy) else (np.full(len(there), np.inf),) * 2
    again = inside & (away <= REPEATED_PX)
    titles = (Text("{label} (solid: found again)", label=label), Text("{n} of {total} found again: {turn}°, {smaller}× smaller",
                          turn=f"{TURN_DEG:g}", smaller=SMALLER, n=int(again.sum()), total=len(shown)))  # fmt: skip
    images = (luma(simulated_photo()), _changed()[0])
    panels = tuple(_panel(name, title, left, 0.0, 0.5, 1.0, image) for name, title, left, image in zip(
        ("photo", "changed"), titles, (0.0, 0.5), images, strict=True))  # fmt: skip
    marks: list[AnyMark] = [_picture(panel.name, image) for panel, image in zip(panels, images, strict=True)]
    for i, found in zip(shown, again, strict=True):
        marks += _point("photo", f"point {i}", first, int(i), "first" if found else "error", found)
    for i, j in zip(shown[again], partner[again], strict=True):
        marks += _point("changed", f"point {i}", second, int(j), "first", True)
    things = {f"point {i}": "a point that is found again" if found else "a point that is lost"
              for i, found in zip(shown, again, strict=True)}  # fmt: skip
    return Scene(panels=panels, marks=tuple(marks), things=things)


def selection_scene(what: str) -> Scene:
    """Return the scene of the four ways to choose among a detector's points; parameters as in `detector_scene`."""
    _, found = _detected(what, changed=False)
    image = luma(simulated_photo())
    size = (found.width, found.height)
    panels: list[Panel] = []
    marks: list[AnyMark] = []
    things: dict[str, str] = {}
    for k, (how, label) in enumerate(SELECTIONS.items()):
        chosen = choose(how, found.xy.astype(float), found.scale, found.response, SHOWN, size)
        counts = np.histogram2d(
            found.xy[chosen, 0], found.xy[chosen, 1], CELLS, ((-0.5, size[0] - 0.5), (-0.5, size[1] - 0.5))
        )[0]
        title = Text("{n} {label}: {share} % of the cells", n=len(chosen), label=label,
                     share=f"{100 * (counts > 0).mean():.0f}")  # fmt: skip
        panels.append(_panel(how, title, 0.5 * (k % 2), 0.5 * (k // 2), 0.5, 0.5, image))
        marks += [
            _picture(how, image),
            Points(panel=how, thing=how, role="first", xy=found.xy[chosen].astype(float), size=6.0),
        ]
        things[how] = f"points chosen {label}"
    return Scene(panels=tuple(panels), marks=tuple(marks), things=things)


@lru_cache(maxsize=1)
def _changed() -> tuple[Array, Array]:
    """Return the façade, turned and smaller, and the homography to it."""
    turned, first = rotation(luma(simulated_photo()), TURN_DEG, np.random.default_rng(0))
    smaller, second = scale(cv2.GaussianBlur(turned, (0, 0), 0.3), SMALLER, np.random.default_rng(0))
    return smaller, second @ first


@lru_cache(maxsize=16)
def _detected(what: str, changed: bool) -> tuple[str, Features]:
    """Return the label of a detector and all its points on the façade, or on the changed one."""
    name, *assignments = [word for word in what.split(",") if word]
    algorithm = find("features", name)
    if algorithm.role != "detector":
        raise UserError(Text("{name} is no detector.", name=name))
    known = algorithm.params.declarations()
    values: dict[str, Any] = {"maximum": 20_000, "reduction": 1.0}
    for assignment in assignments:
        key, _, value = assignment.partition("=")
        if key not in known:
            raise UserError(unknown_name(key, known, "parameter"))
        values[key] = known[key].parse(value)
    image = _changed()[0] if changed else luma(simulated_photo())
    return algorithm.label, algorithm.function(image, image, algorithm.params(**values), run=Run())


def _panel(
    name: str, title: str, left: float, top: float, width: float, height: float, image: Array
) -> Panel:
    return Panel(
        name=name, title=title, rect=(left, top, width, height), kind="picture", x_range=(-0.5, image.shape[1] - 0.5),
        y_range=(-0.5, image.shape[0] - 0.5), equal=True, y_down=True,
    )  # fmt: skip


def _picture(panel: str, image: Array) -> Picture:
    extent = (-0.5, -0.5, image.shape[1] - 0.5, image.shape[0] - 0.5)
    return Picture(panel=panel, thing="", pixels=image, extent=extent)


def _point(panel: str, thing: str, features: Features, i: int, role: Role, again: bool) -> list[AnyMark]:
    """Return circle and direction of a point; dashed where it is lost, so that colour is not alone."""
    x, y = features.xy[i].astype(float)
    radius = max(2.0, float(features.scale[i]) / 2)
    circle = np.stack([x + radius * np.cos(CIRCLE), y + radius * np.sin(CIRCLE)], axis=1)
    angle = float(features.angle[i])
    end = (x + radius * math.cos(angle), y + radius * math.sin(angle))
    return [
        Polygon(
            panel=panel,
            thing=thing,
            role=role,
            xy=circle,
            fill=0.0,
            width=1.4,
            dash="solid" if again else "dot",
        ),
        Line(panel=panel, thing=thing, role=role, xy=np.array([(x, y), end]), width=1.2),
    ]
