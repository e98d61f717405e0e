"""Pictures of the simulator of the scale space: photo, layers, pyramid, response along the scale."""

from __future__ import annotations

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.features.detectors.scale_space_extrema import EDGE, GREY, KEPT, UNSTABLE, WEAK
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_didactic.scene import AnyMark, Handle, Line, Marker, Picture, Points, Polygon, Role, Words
from graphos_didactic.simulators.features.scale_space_model import BLOB, Looked, blob_scale
from graphos_didactic.simulators.features.scale_space_params import OCTAVES

STYLES: dict[int, tuple[str, Marker, Role, float]] = {
    KEPT: ("kept", "circle", "first", 6.0),
    WEAK: ("weak", "cross", "second", 8.0),
    EDGE: ("edge", "triangle", "third", 9.0),
    UNSTABLE: ("unstable", "square", "muted", 6.0),
}
"""Thing, marker, role and size of each verdict."""
CELL = (64, 48)
"""Width and height of a picture of the pyramid, px."""
PER_MILLE = 1000.0
TURN = np.linspace(0.0, 2.0 * np.pi, 25)


def layer_marks(seen: Looked, step: int) -> list[AnyMark]:
    """Draw the photo, the Gaussian layer and the difference looked at; the same place is the same in all three."""
    rows, columns = seen.shape
    octave, layer = seen.octave, seen.layer
    pixel = seen.space.pixel(octave)
    blurred, difference = seen.space.gaussians[octave][layer], seen.space.differences[octave][layer]
    height, width = blurred.shape
    extent = (-pixel / 2, -pixel / 2, (width - 0.5) * pixel, (height - 0.5) * pixel)
    marks: list[AnyMark] = [
        Picture(panel="photo", thing="point", pixels=seen.grey.astype(np.uint8),
                extent=(-0.5, -0.5, columns - 0.5, rows - 0.5)),
        Picture(panel="blurred", thing="layer", pixels=np.clip(blurred, 0, 255).astype(np.uint8), extent=extent),
    ]  # fmt: skip
    if step >= 1:
        top = seen.strongest
        pixels = colours_of_values(difference / GREY, -top, top, "diverging")
        marks.append(Picture(panel="difference", thing="layer", pixels=pixels, extent=extent))
    return marks


def still_shown(seen: Looked, step: int) -> Array:
    """Return which extrema are left at a step: all, those whose fit rests, those with contrast; all at the end."""
    gone: list[int] = [[], [], [], [UNSTABLE], [UNSTABLE, WEAK], []][step]
    return ~np.isin(seen.extrema.verdict, gone)


def extremum_marks(seen: Looked, step: int) -> list[AnyMark]:
    """Draw the extrema in the photo, those of the layer in the difference; circles around what is kept."""
    found, shown = seen.extrema, still_shown(seen, step)
    if step == 5 and not seen.params.rejected:
        shown = found.verdict == KEPT
    place = found.xy
    if step == 2:  # not fitted yet: where the samples are
        place = np.stack([found.column, found.row], axis=1) * (0.5 * 2.0 ** found.octave[:, None])
    octave = found.octave == seen.octave
    here = octave & (found.layer == seen.layer)
    marks: list[AnyMark] = []
    for verdict, (thing, marker, role, size) in STYLES.items():
        if step < 5:
            thing, marker, role, size = "candidates", "circle", "second", 5.0
        some = shown & (found.verdict == verdict)
        for panel, which, scale in (("photo", some & octave, 1.0), ("difference", some & here, 1.5)):
            if which.any():
                marks.append(Points(panel=panel, thing=thing, role=role, marker=marker, size=size * scale, answer=True,
                                    xy=place[which]))  # fmt: skip
    kept = np.flatnonzero(shown & octave & (found.verdict == KEPT))
    if step == 5 and len(kept):
        marks.append(Line(panel="photo", thing="kept", role="first", width=1.6, answer=True,
                          xy=_circles(place[kept], found.diameter[kept] / 2)))  # fmt: skip
    return marks


def _circles(centres: Array, radii: Array) -> Array:
    ring = np.stack([np.cos(TURN), np.sin(TURN)], axis=1)
    circles = centres[:, None] + radii[:, None, None] * ring
    apart = np.full((len(centres), 1, 2), np.nan)
    return np.concatenate([circles, apart], axis=1).reshape(-1, 2)[:-1]


def pyramid_marks(seen: Looked, step: int) -> list[AnyMark]:
    """Draw every layer of every octave as a small picture: octaves from top to bottom, layers from left to right."""
    sheet = seen.kept("sheet", step >= 1, lambda: _sheet(seen, step >= 1))
    extent = (0.0, 0.0, float(sheet.shape[1] // CELL[0]), float(OCTAVES))
    marks: list[AnyMark] = [Picture(panel="pyramid", thing="layer", pixels=sheet, extent=extent)]
    row, column = seen.octave, seen.layer
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + np.array([column, row])
    marks.append(Polygon(panel="pyramid", thing="layer", role="second", xy=corners, fill=0.0, width=3.0))
    if step >= 2:
        near = np.array([[-1, 0], [2, 0], [2, 1], [-1, 1]]) + np.array([column, row])
        marks.append(Polygon(panel="pyramid", role="second", xy=near, fill=0.0, width=1.6, dash="dash"))
    for octave in range(seen.octaves):
        text = f"{seen.space.blur(octave, 0.0):.1f} px"
        marks.append(Words(panel="pyramid", role="text", at=(0.0, octave + 0.84), text=text, anchor="left"))
    return marks


def _sheet(seen: Looked, differences: bool) -> Array:
    """Return all layers as one picture, uint8 (octaves · 48, layers · 64, 3)."""
    stacks = seen.space.differences if differences else seen.space.gaussians
    (width, height), top = CELL, seen.strongest
    sheet = np.full((OCTAVES * height, len(stacks[0]) * width, 3), 128, np.uint8)
    for octave, stack in enumerate(stacks):
        for i, image in enumerate(stack):
            small = cv2.resize(image, CELL, interpolation=cv2.INTER_AREA if octave < 2 else cv2.INTER_NEAREST)
            cell = sheet[octave * height : (octave + 1) * height, i * width : (i + 1) * width]
            if differences:
                cell[:] = colours_of_values(small / GREY, -top, top, "diverging")
            else:
                cell[:] = np.clip(small, 0, 255).astype(np.uint8)[..., None]
            cell[0], cell[:, 0] = 60, 60
    return sheet


def response_marks(seen: Looked, step: int) -> list[AnyMark]:
    """Draw the response at the point over the scale, the thresholds, the fit of the extremum and the truth."""
    p = seen.params
    limit, last = PER_MILLE * p.contrast / p.layers, float(seen.octaves + 1)
    marks: list[AnyMark] = [
        Line(panel="response", role="grid", width=1.4, xy=np.array([[0.0, 0.0], [last, 0.0]]))
    ]
    if step >= 4:
        marks += [
            Line(panel="response", thing="weak", role="second", dash="dash", label="± C / n" if sign > 0 else "",
                 xy=np.array([[0.0, sign * limit], [last, sign * limit]]))
            for sign in (1, -1)
        ]  # fmt: skip
    curve = seen.response * (1.0, PER_MILLE)
    if step >= 1:
        marks += [
            Line(panel="response", thing="point", role="accent", width=1.6, xy=curve, label="D at the point",
                 answer=True),
            Points(panel="response", thing="point", role="accent", xy=curve, size=6.0, answer=True),
        ]  # fmt: skip
    i = seen.chosen
    if step >= 3 and i is not None:
        verdict = int(seen.extrema.verdict[i])
        thing, marker, role, size = STYLES[verdict]
        peak = np.array([[seen.scale_of(i), PER_MILLE * seen.extrema.value[i]]])
        marks += [
            Line(panel="response", thing=thing, role=role, width=2.2, dash="dot", xy=seen.parabola(i) * (1.0, PER_MILLE), label="fit",
                 answer=True),
            Points(panel="response", thing=thing, role=role, marker=marker, size=size + 5, xy=peak, answer=True),
        ]  # fmt: skip
    if p.picture == "blobs":
        at = blob_scale(p.size, p.layers, p.sigma)
        marks.append(Line(panel="response", thing="truth", role="truth", dash="dashdot", width=1.8, truth=True, answer=True,
                          label="truth: blob of size s", xy=np.array([[at, -1e4], [at, 1e4]])))  # fmt: skip
    here = seen.octave + seen.layer / p.layers
    marks.append(
        Line(
            panel="response",
            thing="layer",
            role="second",
            width=2.2,
            xy=np.array([[here, -1e4], [here, 1e4]]),
        )
    )
    return marks


def response_top(seen: Looked) -> float:
    """Return the end of the axis of the response, ‰ of the grey range."""
    i = seen.chosen
    largest = np.abs(seen.response[:, 1]).max()
    if i is not None:
        largest = max(largest, abs(float(seen.extrema.value[i])))
    return PER_MILLE * float(max(1.2 * largest, 2.0 * seen.params.contrast / seen.params.layers, 0.004))


def _free_side(seen: Looked) -> float:
    """Return 1 when the strongest response at the point is negative, else −1: where there is room for a handle."""
    values = seen.response[:, 1]
    return 1.0 if values[np.abs(values).argmax()] < 0 else -1.0


def truth_marks(seen: Looked) -> list[AnyMark]:
    """Draw the outline of the blob of known size at one standard deviation."""
    p = seen.params
    if p.picture != "blobs":
        return []
    turned = np.radians(35.0)
    ring = np.stack([p.size * p.stretch * np.cos(TURN), p.size * np.sin(TURN)], axis=1)
    ring = ring @ np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]]) + BLOB
    return [Line(panel="photo", thing="truth", role="truth", dash="dashdot", width=1.8, truth=True, xy=ring)]


def handle_marks(seen: Looked, step: int) -> list[AnyMark]:
    """Return the handles: the point in three pictures, the size of the blob, the layer in pyramid and plot."""
    rows, columns = seen.shape
    x, y = seen.at

    def move(x: float, y: float) -> dict[str, float]:
        return {"x": 100.0 * x / (columns - 1), "y": 100.0 * y / (rows - 1)}

    marks: list[AnyMark] = [
        Handle(panel=panel, name=f"point_{panel}", thing="point", label="Point", role="accent", at=(x, y),
               parameters=("x", "y"), move=move, nudge=(2.0, 2.0))
        for panel in (("photo", "blurred", "difference") if step >= 1 else ("photo", "blurred"))
    ]  # fmt: skip
    p = seen.params
    if p.picture == "blobs":
        marks.append(Handle(panel="photo", name="size", thing="truth", label="Size of the blob", role="truth", freedom="y",
                            at=(BLOB[0], BLOB[1] - 4.0 * p.size), parameters=("size",), nudge=(0.0, -1.0),
                            move=lambda _, y: {"size": (BLOB[1] - y) / 4.0}))  # fmt: skip
    n = p.layers

    def choose(x: float, y: float) -> dict[str, float]:
        octave = min(max(int(y), 0), seen.octaves - 1)
        return {"level": octave * n + min(max(int(x), 1), n)}

    marks += [
        Handle(panel="pyramid", name="cell", thing="layer", label="Layer looked at", role="second", freedom="slide",
               at=(seen.layer + 0.5, seen.octave + 0.5), parameters=("level",), move=choose, nudge=(1.0, 1.0)),
        Handle(panel="response", name="level", thing="layer", label="Layer looked at", role="second", freedom="x",
               at=(seen.octave + seen.layer / n, _free_side(seen) * 0.86 * response_top(seen)), parameters=("level",), nudge=(1.0 / n, 0.0),
               move=lambda x, _: {"level": min(max(round(x * n), 1), seen.octaves * n)}),
    ]  # fmt: skip
    return marks
