"""Pictures of the simulator of random sampling: photos with sample and model, counts, probability, residuals."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.consensus import samples_needed
from graphos_core.geometry.epipolar import epipolar_lines
from graphos_core.geometry.homography import transfer
from graphos_didactic.scene import AnyMark, Bars, Dash, Handle, Line, Picture, Points, Polygon, Role
from graphos_didactic.simulators.features.sampling_model import LOSSES, Search
from graphos_didactic.simulators.features.sampling_params import MOST
from graphos_didactic.simulators.format_edges import line_in_format
from graphos_didactic.simulators.pictured_pair import CAMERA, HEIGHT, WIDTH

GAP = 16
"""Between both photos, px."""
LEFT = WIDTH + GAP
"""Where photo B begins, px."""
SHOWN = 15.0
"""Largest residual that is shown, px."""
SIZES: tuple[tuple[int, Dash], ...] = ((4, "dash"), (5, "dashdot"), (7, "dot"))


def _outline() -> Array:
    step = np.linspace(0.0, 1.0, 9)[:-1]
    zero, one = np.zeros(8), np.ones(8)
    sides = [(step, zero), (one, step), (1 - step, one), (zero, 1 - step)]
    corners = np.concatenate([np.stack(side, axis=1) for side in sides])
    return np.array([0.12, 0.12]) * (WIDTH, HEIGHT) + 0.76 * corners * (WIDTH, HEIGHT)


OUTLINE = _outline()
"""A frame in photo A that a homography maps into photo B."""


def photo_marks(seen: Search) -> list[AnyMark]:
    """Show both formats, with photos where there are some."""
    box = np.array([[0, 0], [WIDTH - 1, 0], [WIDTH - 1, HEIGHT - 1], [0, HEIGHT - 1]])
    if seen.photos is None:
        return [
            Polygon(panel="pair", role="muted", xy=box + np.array([shift, 0]), fill=0.05, width=1.0) for shift in (0, LEFT)
        ]  # fmt: skip
    pair = seen.photos.photos
    return [
        Picture(panel="pair", pixels=pixels, extent=(shift - 0.5, -0.5, shift + WIDTH - 0.5, HEIGHT - 0.5))
        for pixels, shift in ((pair.photo_a, 0), (pair.photo_b, LEFT))
    ]


def match_marks(seen: Search, agreeing: Array | None) -> list[AnyMark]:
    """Draw matches in both photos: those that agree as discs, the others as crosses; false ones ringed by the truth."""
    a, b = seen.matches.a, seen.matches.b + np.array([LEFT, 0.0])
    marks: list[AnyMark] = []
    if agreeing is None:
        return [Points(panel="pair", thing="out", role="neutral", xy=xy, size=5.5) for xy in (a, b)]
    for xy in (a, b):
        marks += [
            Points(panel="pair", thing="agree", role="first", xy=xy[agreeing], size=6.5, answer=True),
            Points(
                panel="pair",
                thing="out",
                role="error",
                xy=xy[~agreeing],
                marker="cross",
                size=6.5,
                answer=True,
            ),
        ]
    false = b[~seen.good]
    if len(false):
        marks.append(
            Points(panel="pair", thing="false", role="truth", xy=false, marker="ring", size=13.0, truth=True)
        )
    return marks


def sample_marks(seen: Search) -> list[AnyMark]:
    """Connect the matches of the present sample."""
    picks = seen.drawn.picks[seen.now]
    a, b = seen.matches.a[picks], seen.matches.b[picks] + np.array([LEFT, 0.0])
    gaps = np.full_like(a, np.nan)
    return [
        Line(panel="pair", thing="sample", role="second", xy=np.stack([a, b, gaps], axis=1).reshape(-1, 2)[:-1], width=2.2,
             dash="dash"),
        Points(panel="pair", thing="sample", role="second", xy=np.concatenate([a, b]), marker="square", size=9.0),
    ]  # fmt: skip


def model_marks(
    seen: Search, matrix: Array | None, thing: str, role: Role, width: float, dash: Dash
) -> list[AnyMark]:
    """Draw what a model says: where the frame goes, or the epipolar lines of some points."""
    if matrix is None or not matrix.any():
        return []
    if seen.params.model == "homography":
        there = transfer(matrix, OUTLINE)
        if not np.isfinite(there).all() or np.abs(there).max() > 20 * WIDTH:
            return []
        return [
            Polygon(panel="pair", thing=thing, role="muted", xy=OUTLINE, fill=0.0, width=1.2, dash="dot"),
            Polygon(panel="pair", thing=thing, role=role, xy=there + np.array([LEFT, 0.0]), fill=0.0, width=width,
                    dash=dash, answer=True),
        ]  # fmt: skip
    marks: list[AnyMark] = []
    places = np.array([[WIDTH / 2, part * HEIGHT] for part in (0.1, 0.3, 0.5, 0.7, 0.9)])
    for line in epipolar_lines(matrix, places):
        ends = line_in_format(line, CAMERA) if np.isfinite(line).all() else None
        if ends is not None:
            marks.append(Line(panel="pair", thing=thing, role=role, xy=ends + np.array([LEFT, 0.0]), width=width,
                              dash=dash, answer=True))  # fmt: skip
    return marks


def count_marks(seen: Search, top: float) -> list[AnyMark]:
    """Draw how many matches agree with each sample so far, the best so far, and where the search may end."""
    upto = np.arange(1, seen.params.draw + 1)
    counts, best = seen.counts[: seen.params.draw], seen.counts[seen.best[: seen.params.draw]]
    clean = np.array([seen.clean(i) for i in range(seen.params.draw)], bool)
    marks: list[AnyMark] = [
        Points(panel="counts", thing="out", role="muted", xy=np.stack([upto, counts], axis=1).astype(float), size=4.0),
        Line(panel="counts", thing="best", role="accent", label="best so far", width=2.2,
             xy=np.stack([np.repeat(upto, 2)[1:], np.repeat(best, 2)[:-1]], axis=1).astype(float), answer=True),
        Line(panel="counts", thing="false", role="truth", label="true matches", dash="dashdot", width=1.6, truth=True,
             xy=np.array([[0.0, seen.good.sum()], [MOST, seen.good.sum()]])),
    ]  # fmt: skip
    if clean.any():
        xy = np.stack([upto[clean], counts[clean]], axis=1).astype(float)
        marks.append(
            Points(
                panel="counts", thing="clean", role="truth", xy=xy, marker="triangle", size=9.0, truth=True
            )
        )
    if seen.stop is not None and seen.stop <= seen.params.draw:
        at = float(seen.stop)
        marks.append(Line(panel="counts", thing="needed", role="third", dash="dash", width=1.8, label="may end",
                          xy=np.array([[at, 0.0], [at, top]]), answer=True))  # fmt: skip
    return marks


def probability_range(seen: Search) -> float:
    """Return how many samples the picture of the probability shows."""
    return float(np.clip(1.8 * min(seen.needed(seen.share), 1e9), 12.0, 20_000.0))


def probability_marks(seen: Search) -> list[AnyMark]:
    """Draw the probability of a clean sample over the number of samples, for three sizes of the sample."""
    reach = probability_range(seen)
    chances = 1.0 - np.geomspace(1.0, 1e-5, 120)[1:]
    marks: list[AnyMark] = []
    for size, dash in SIZES:
        needed = np.array([samples_needed(seen.share, size, float(p)) for p in chances])
        keep = np.isfinite(needed)
        xy = np.stack([needed[keep], 100 * chances[keep]], axis=1)
        mine = size == seen.model.sample
        marks.append(Line(panel="chance", thing="needed" if mine else "", role="accent" if mine else "muted",
                          width=2.6 if mine else 1.4, dash="solid" if mine else dash,
                          xy=np.concatenate([[[0.0, 0.0]], xy, [[max(reach, float(xy[-1, 0]) if len(xy) else 0.0) + 1.0,
                                                                100 * chances[-1]]]]) if len(xy) else np.zeros((2, 2)),
                          label=f"{size} matches" + (" (now)" if mine else ""), answer=mine))  # fmt: skip
    here = seen.needed(seen.share)
    if np.isfinite(here):
        ends = np.array([[here, 0.0], [here, 100 * seen.params.confidence]])
        marks.append(Line(panel="chance", thing="needed", role="third", dash="dash" if seen.model.sample != 4 else "dashdot",
                          width=1.8, xy=ends, answer=True))  # fmt: skip
    return marks


def residual_marks(seen: Search, top: float) -> list[AnyMark]:
    """Draw the distances of all matches from the present model, and what each distance costs."""
    squares = seen.drawn.squares[seen.leader]
    edges = np.linspace(0.0, SHOWN, 31)
    distances = np.minimum(np.sqrt(squares), SHOWN - 1e-6)
    marks: list[AnyMark] = [
        Bars(panel="residuals", thing="out", role="neutral", edges=edges, fill=0.25, label="all matches",
             heights=np.histogram(distances, edges)[0].astype(float)),
        Bars(panel="residuals", thing="false", role="error", edges=edges, fill=0.5, label="false ones", truth=True,
             heights=np.histogram(distances[~seen.good], edges)[0].astype(float)),
    ]  # fmt: skip
    if seen.params.cost in LOSSES:
        x = np.linspace(0.0, SHOWN, 151)
        loss = LOSSES[seen.params.cost](x**2, seen.params.threshold)
        marks.append(Line(panel="residuals", thing="cost", role="accent", xy=np.stack([x, 0.55 * top * loss], axis=1),
                          width=2.0, label="cost of one match"))  # fmt: skip
    elif np.isfinite(squares).all() and len(squares):
        middle = float(np.sqrt(np.median(squares)))
        marks.append(Line(panel="residuals", thing="cost", role="accent", xy=np.array([[middle, 0.0], [middle, top]]),
                          width=2.0, label="median"))  # fmt: skip
    reach = seen.reach(squares) if np.isfinite(squares).all() else seen.params.threshold
    marks.append(Line(panel="residuals", thing="agree", role="first", xy=np.array([[reach, 0.0], [reach, top]]), dash="dash",
                      width=2.0, label="agrees up to here"))  # fmt: skip
    return marks


def handle_marks(seen: Search, top: float, height: float) -> list[AnyMark]:
    """Return the handles: number of the sample, dragged match, threshold, confidence."""
    p = seen.params
    marks: list[AnyMark] = [
        Handle(panel="counts", name="draw", thing="sample", label="Sample", role="second", freedom="x",
               at=(float(p.draw), 0.06 * top), parameters=("draw",), nudge=(1.0, 0.0), move=lambda x, _: {"draw": x}),
    ]  # fmt: skip
    if len(seen.matches.a):
        true = seen.matches.true_b[0] + np.array([LEFT, 0.0])
        at = (float(true[0] + p.off_x), float(true[1] + p.off_y))
        marks.append(Handle(panel="pair", name="match", thing="out", label="A match: drag its point in photo B",
                            role="third", at=at, parameters=("off_x", "off_y"), nudge=(2.0, 2.0),
                            move=lambda x, y: {"off_x": x - float(true[0]), "off_y": y - float(true[1])}))  # fmt: skip
    marks.append(Handle(panel="residuals", name="threshold", thing="agree", label="Threshold", role="first", freedom="x",
                        at=(p.threshold, 0.35 * height), parameters=("threshold",), nudge=(0.2, 0.0),
                        move=lambda x, _: {"threshold": x}))  # fmt: skip
    needed = seen.needed(seen.share)
    at_x = (
        min(needed, 0.97 * probability_range(seen)) if np.isfinite(needed) else 0.5 * probability_range(seen)
    )
    marks.append(Handle(panel="chance", name="confidence", thing="needed", label="Confidence", role="third", freedom="y",
                        at=(float(at_x), 100 * p.confidence), parameters=("confidence",), nudge=(0.0, -1.0),
                        move=lambda _, y: {"confidence": y / 100.0}, answer=True))  # fmt: skip
    return marks
