"""Pictures of the simulator of the ratio test: both photos, the distances, their distribution, precision and recall."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_didactic.scene import AnyMark, Bars, Handle, Line, Picture, Points
from graphos_didactic.simulators.features.ratio_test_model import Judged
from graphos_didactic.simulators.features.ratio_test_params import FARTHEST
from graphos_didactic.simulators.pictured_pair import HEIGHT, WIDTH

GAP = 16
"""Between both photos, px."""
LEFT = WIDTH + GAP
"""Where photo B begins, px."""


def lines(a: Array, b: Array) -> Array:
    """Return lines from points of A to points of B, one after the other with rows of NaN between, (3 n, 2)."""
    there = np.asarray(b, dtype=np.float64) + np.array([LEFT, 0.0])
    gaps = np.full_like(there, np.nan)
    return np.stack([np.asarray(a, dtype=np.float64), there, gaps], axis=1).reshape(-1, 2)[:-1]


def photo_marks(seen: Judged) -> list[AnyMark]:
    """Show both photos beside each other."""
    size = (-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)
    right = (LEFT - 0.5, -0.5, LEFT + WIDTH - 0.5, HEIGHT - 0.5)
    return [
        Picture(panel="pair", pixels=seen.pair.photos.photo_a, extent=size),
        Picture(panel="pair", pixels=seen.pair.photos.photo_b, extent=right),
    ]


def _width(count: int) -> float:
    """Return how wide lines of so many matches are, px: many lines with an edge would hide the photos."""
    return 1.7 if count <= 60 else 1.0


def match_marks(seen: Judged, accepted: Array) -> list[AnyMark]:
    """Draw accepted matches as lines, true and false ones differently while the truth is shown, and missed ones."""
    found = seen.nearest.matches
    a, b = seen.pair.a.xy[found[:, 0]], seen.pair.b.xy[found[:, 1]]
    marks: list[AnyMark] = []
    true, false, missed = accepted & seen.true, accepted & ~seen.true, seen.true & ~accepted
    if accepted.any():
        marks.append(Line(panel="pair", thing="accepted", role="neutral", xy=lines(a[accepted], b[accepted]), width=0.8))  # fmt: skip
    if true.any():
        marks += [
            Line(panel="pair", thing="true", role="truth", xy=lines(a[true], b[true]), width=1.0, truth=True),
            Points(panel="pair", thing="true", role="truth", xy=a[true], size=5.0, truth=True),
        ]
    if false.any():
        marks += [
            Line(panel="pair", thing="false", role="error", xy=lines(a[false], b[false]), width=_width(int(false.sum())), dash="dash",
                 truth=True),
            Points(panel="pair", thing="false", role="error", xy=a[false], marker="cross", size=8.0, truth=True),
        ]  # fmt: skip
    if missed.any():
        marks.append(Points(panel="pair", thing="missed", role="third", xy=a[missed], marker="triangle", size=8.0,
                            truth=True))  # fmt: skip
    return marks


def looked_marks(seen: Judged) -> list[AnyMark]:
    """Mark the point looked at, its nearest and second nearest in B, and its true partner."""
    k = seen.looked_at
    if k is None:
        return []
    first, best = seen.nearest.matches[k]
    a, b = seen.pair.a.xy[first][None].astype(float), seen.pair.b.xy[best][None] + np.array([LEFT, 0.0])
    here = np.array([[seen.second_distance[k], seen.nearest.distance[k]]])
    marks: list[AnyMark] = [
        Points(panel="pair", thing="looked", role="accent", xy=a, marker="ring", size=17.0),
        Points(panel="pair", thing="looked", role="accent", xy=b, marker="ring", size=17.0, label="nearest"),
        Points(panel="distances", thing="looked", role="accent", xy=here, marker="ring", size=16.0),
    ]
    if seen.second is not None:
        c = seen.pair.b.xy[seen.second][None] + np.array([LEFT, 0.0])
        marks.append(Points(panel="pair", thing="looked", role="second", xy=c, marker="square", size=11.0, label="second"))  # fmt: skip
    partner = seen.pair.partners[first]
    if np.isfinite(partner).all():
        marks.append(Points(panel="pair", thing="looked", role="truth", xy=partner[None] + (LEFT, 0.0), marker="plus",
                            size=15.0, truth=True))  # fmt: skip
    return marks


def distance_marks(seen: Judged) -> list[AnyMark]:
    """Draw both distances of every candidate: true ones as discs, false ones as crosses, and the rule as a line."""
    xy = np.stack([seen.second_distance, seen.nearest.distance], axis=1).astype(float)
    known = np.isfinite(xy).all(axis=1)
    true = seen.true
    end = rule_end(seen)
    start = np.zeros(2) if seen.params.rule == "ratio" else np.array([0.0, end[1]])
    return [
        Points(panel="distances", thing="accepted", role="neutral", xy=xy[known], size=3.5),
        Points(panel="distances", thing="false", role="error", xy=xy[known & ~true], marker="cross", size=6.0, truth=True),
        Points(panel="distances", thing="true", role="truth", xy=xy[known & true], size=5.5, truth=True),
        Line(panel="distances", role="muted", xy=np.array([[0.0, 0.0], [FARTHEST, FARTHEST]]), width=1.0, dash="dot",
             label="d₁ = d₂"),
        Line(panel="distances", thing="threshold", role="accent", xy=np.stack([start, end]), width=2.4,
             label="accepted below"),
    ]  # fmt: skip


def rule_end(seen: Judged) -> Array:
    """Return where the line of the rule ends in the picture of the distances."""
    if seen.params.rule == "ratio":
        return np.array([0.86 * FARTHEST, 0.86 * FARTHEST * seen.params.ratio])
    return np.array([0.86 * FARTHEST, seen.params.limit])


def histogram_edges(seen: Judged) -> Array:
    """Return the edges of the histogram's classes, of the ratio or of the distance."""
    return np.linspace(0.0, 1.0, 41) if seen.params.rule == "ratio" else np.linspace(0.0, FARTHEST, 41)


def histogram_marks(seen: Judged, top: float) -> list[AnyMark]:
    """Draw the distribution of what is tested, for true and false candidates, and the threshold."""
    values = seen.nearest.ratio if seen.params.rule == "ratio" else seen.nearest.distance
    edges, true = histogram_edges(seen), seen.true
    at = seen.threshold
    return [
        Bars(panel="histogram", thing="accepted", role="neutral", edges=edges, fill=0.18, label="all",
             heights=np.histogram(values, edges)[0].astype(float)),
        Bars(panel="histogram", thing="false", role="error", label="false", edges=edges, fill=0.45, truth=True,
             heights=np.histogram(values[~true], edges)[0].astype(float)),
        Bars(panel="histogram", thing="true", role="truth", label="true", edges=edges, fill=0.5, truth=True,
             heights=np.histogram(values[true], edges)[0].astype(float)),
        Line(panel="histogram", thing="threshold", role="accent", xy=np.array([[at, 0.0], [at, top]]), width=2.4,
             label="threshold"),
    ]  # fmt: skip


def curve_marks(seen: Judged) -> list[AnyMark]:
    """Draw precision over recall for both rules, and where the present threshold is."""
    marks: list[AnyMark] = [
        Line(panel="curve", thing="threshold", role="accent", xy=seen.curve("ratio"), width=2.2, label="ratio d₁/d₂",
             truth=True, answer=True),
        Line(panel="curve", thing="missed", role="second", xy=seen.curve("distance"), width=2.0, dash="dash",
             label="d₁ alone", truth=True, answer=True),
    ]  # fmt: skip
    here = np.array([[seen.counts.recall, seen.counts.precision]])
    if np.isfinite(here).all():
        marks.append(Points(panel="curve", thing="threshold", role="accent", xy=here, marker="diamond", size=13.0,
                            truth=True, answer=True))  # fmt: skip
    return marks


def handle_marks(seen: Judged, top: float) -> list[AnyMark]:
    """Return the handles: threshold in histogram and distances, point looked at, direction of photo B."""
    p, end = seen.params, rule_end(seen)
    ratio = p.rule == "ratio"
    name = ("ratio",) if ratio else ("limit",)
    marks: list[AnyMark] = [
        Handle(panel="histogram", name="threshold", thing="threshold", label="Threshold", role="accent", freedom="x",
               at=(seen.threshold, 0.62 * top), parameters=name, nudge=(0.01 if ratio else 5.0, 0.0),
               move=lambda x, _: {name[0]: x}),
        Handle(panel="pair", name="look", thing="looked", label="Point looked at", role="accent",
               at=(p.look_x, p.look_y), parameters=("look_x", "look_y"), nudge=(4.0, 4.0),
               move=lambda x, y: {"look_x": x, "look_y": y}),
    ]  # fmt: skip
    if ratio:
        marks.append(Handle(panel="distances", name="slope", thing="threshold", label="Slope of the line", role="accent",
                            freedom="y", at=(float(end[0]), float(end[1])), parameters=("ratio",), nudge=(0.0, 4.3),
                            move=lambda _, y: {"ratio": y / end[0]}))  # fmt: skip
    else:
        marks.append(Handle(panel="distances", name="limit", thing="threshold", label="Largest distance", role="accent",
                            freedom="y", at=(float(end[0]), float(end[1])), parameters=("limit",), nudge=(0.0, 5.0),
                            move=lambda _, y: {"limit": y}))  # fmt: skip
    middle = (LEFT + WIDTH / 2 - p.aside, 0.94 * HEIGHT)
    marks.append(Handle(panel="pair", name="aside", thing="looked", label="Photo B aimed aside", role="second",
                        freedom="x", at=(float(middle[0]), float(middle[1])), parameters=("aside",), nudge=(5.0, 0.0),
                        move=lambda x, _: {"aside": LEFT + WIDTH / 2 - x}))  # fmt: skip
    return marks
