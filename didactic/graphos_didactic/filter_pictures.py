"""Pictures of filters for lessons: the simulated façade under a difficulty, and what the engine's filter makes of it."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.params import unknown_name
from graphos_core.preprocessing.luminance import levels_of
from graphos_core.preprocessing.preview import displayed
from graphos_core.registry import find
from graphos_core.run import Run
from graphos_core.text import Text
from graphos_didactic.scene import AnyMark, Bars, Panel, Picture, Scene
from graphos_didactic.simulators.simulated_photo import simulated_photo

NOISE, BLUR, SHADE = 14.0, 1.5, 0.3
EDGES = np.linspace(0.0, 256.0, 65)


def filter_scene(what: str) -> Scene:
    """Return the scene of a filter with some parameters: ``"clahe,clip=4"``.

    Raises
    ------
    UserError
        For an unknown filter or parameter.
    ParamError
        For a value out of its declaration.
    """
    name, *assignments = [word for word in what.split(",") if word]
    algorithm = find("preprocessing", name)
    if algorithm.role != "filter":
        raise UserError(Text("{name} is no filter.", name=name))
    known = algorithm.params.declarations()
    values = {}
    for assignment in assignments:
        key, _, value = assignment.partition("=")
        if key not in known:
            raise UserError(unknown_name(key, known, "parameter"))
        values[key] = known[key].parse(value)
    before, difficulty = _difficult(name)
    after = algorithm.function(before, algorithm.params(**values), run=Run())
    return _scene(displayed(before, levels_of(before)), displayed(after, None), difficulty, algorithm.label)


@lru_cache(maxsize=8)
def _difficult(name: str) -> tuple[Array, str]:
    """Return the façade as the filter would meet it, and what is difficult about it."""
    photo = simulated_photo()
    values = photo.astype(np.float32)
    if name in ("bilateral", "nlm"):
        noisy = values + np.random.default_rng(0).normal(0.0, NOISE, values.shape[:2])[:, :, None]
        return np.clip(noisy, 0, 255).astype(np.uint8), f"noise of {NOISE:g} grey levels"
    if name == "sharpen":
        return cv2.GaussianBlur(photo, (0, 0), BLUR), f"blurred by {BLUR:g} px"
    if name in ("equalize", "clahe", "gamma"):
        values[:, values.shape[1] // 2 :] *= SHADE
        return values.astype(np.uint8), "right half in shadow"
    if name == "stretch":
        heat = 14000.0 + 3.0 * cv2.cvtColor(photo, cv2.COLOR_RGB2GRAY).astype(np.float32)
        heat[-60:, :90] += 9000.0
        heat += np.random.default_rng(0).normal(0.0, 9.0, heat.shape)
        return np.rint(heat).astype(np.uint16), "16 bit, one hot place"
    return photo, "simulated façade"


def _scene(before: Array, after: Array, difficulty: str, label: str) -> Scene:
    height, width = before.shape[:2]
    extent = (-0.5, -0.5, width - 0.5, height - 0.5)
    counts = [_shares(image) for image in (before, after)]
    top = float(min(max(share.max() for share in counts), 25.0)) * 1.1
    panels = [
        Panel(name=name, title=title, rect=(left, 0.0, 0.5, 0.68), kind="picture", x_range=(-0.5, width - 0.5),
              y_range=(-0.5, height - 0.5), equal=True, y_down=True)
        for name, title, left in (("before", f"Before · {difficulty}", 0.0), ("after", f"After · {label}", 0.5))
    ] + [
        Panel(name=f"{name} counts", title="", rect=(left, 0.68, 0.5, 0.32), x_range=(0.0, 255.0), y_range=(0.0, top),
              x_label="grey value", y_label="pixels [%]")
        for name, left in (("before", 0.0), ("after", 0.5))
    ]  # fmt: skip
    marks: list[AnyMark] = [
        Picture(panel="before", thing="before", pixels=before, extent=extent),
        Picture(panel="after", thing="after", pixels=after, extent=extent),
        Bars(panel="before counts", thing="before", role="neutral", edges=EDGES, heights=counts[0]),
        Bars(panel="after counts", thing="after", role="accent", edges=EDGES, heights=counts[1]),
    ]
    things = {"before": "the photo", "after": "the filtered photo"}
    return Scene(panels=tuple(panels), marks=tuple(marks), things=things)


def _shares(image: Array) -> Array:
    grey = image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    return 100.0 * np.histogram(grey, EDGES)[0] / grey.size
