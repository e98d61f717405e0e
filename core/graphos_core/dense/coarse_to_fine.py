"""The depth of every pixel of one photo, from a coarse picture with all depths to a fine one with few.

The coarsest level of the pyramid tries the whole range of depths; every finer level tries a narrow range around
the surface found before, for each pixel its own (Rothermel et al. 2012 narrow the range in the same spirit).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.dense.cost import Sweep, matching_cost, parallax_per_inverse_depth
from graphos_core.dense.kernels import smooth_surface, winners
from graphos_core.dense.sgm import aggregate
from graphos_core.dense.undistort import OUTSIDE, View
from graphos_core.run import Run

COARSEST_SIDE = 48
"""A picture is not halved further when its shorter side would get smaller than this, px."""

FINE_STEP, FINE_DEPTHS = 0.4, 8
"""The last pass on the finest level: its step relative to the others, and how many hypotheses."""


@dataclass(frozen=True)
class Matching:
    """How one photo is matched; see `graphos_core.dense.depth_maps.MultiViewParams` for what the values mean.

    Attributes
    ----------
    window : int
        px.
    census : bool
    noise : float
        Grey levels.
    p1, p2 : float
        In units of the stored cost.
    edge_grey : float
    levels : int
    step_px : float
        Step between hypotheses as parallax in the neighbour with the longest base, px.
    most_depths : int
        Largest number of hypotheses on the coarsest level.
    local_depths : int
        Number of hypotheses on the finer levels, odd.
    """

    window: int
    census: bool
    noise: float
    p1: float
    p2: float
    edge_grey: float
    levels: int
    step_px: float
    most_depths: int
    local_depths: int


@dataclass(frozen=True)
class Surface:
    """What was found for one photo.

    Attributes
    ----------
    inverse_depth : float32 (h, w)
        1 / block unit.
    score : float32 (h, w)
        Matching score of the winner, 0 to 1.
    edge : bool (h, w)
        The winner lies at an end of its range.
    """

    inverse_depth: Array
    score: Array
    edge: Array


def pyramid(view: View, levels: int) -> list[View]:
    """Return the view and its reductions, finest first; fewer levels where the picture gets too small."""
    out = [view]
    while len(out) < levels and min(out[-1].grey.shape) >= 2 * COARSEST_SIDE:
        out.append(out[-1].halved())
    return out


def estimate(
    reference: View, others: Sequence[View], near: float, far: float, how: Matching, *, run: Run
) -> Surface:
    """Return the inverse depth of every pixel of `reference`.

    Parameters
    ----------
    reference : View
    others : sequence of View
        Its neighbours.
    near, far : float
        Range of depths, in the block's unit.
    how : Matching
    run : Run

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    views = pyramid(reference, how.levels)
    others_by_level = list(zip(*(_matched(o, len(views)) for o in others), strict=True))
    found: Surface | None = None
    for level in range(len(views) - 1, -1, -1):
        run.check()
        view, neighbours = views[level], others_by_level[level]
        step = step_of_inverse_depth(view, neighbours, near, far, how.step_px)
        if found is None:
            sweep = full_sweep(view.grey.shape, near, far, step, how.most_depths)
        else:
            sweep = local_sweep(found.inverse_depth, view.grey.shape, step, how.local_depths)
        found = match_once(view, neighbours, sweep, how, run)
    assert found is not None
    step = step_of_inverse_depth(views[0], others_by_level[0], near, far, how.step_px)
    sweep = local_sweep(found.inverse_depth, views[0].grey.shape, FINE_STEP * step, FINE_DEPTHS)
    finest = match_once(views[0], others_by_level[0], sweep, how, run)
    return replace(finest, edge=found.edge)  # the end of the last, tiny range does not mean much


def _matched(view: View, levels: int) -> list[View]:
    """Return exactly `levels` reductions of a view."""
    out = [view]
    while len(out) < levels:
        out.append(out[-1].halved())
    return out


def step_of_inverse_depth(
    view: View, others: Sequence[View], near: float, far: float, step_px: float
) -> float:
    """Return the step of inverse depth that moves a point by `step_px` in the neighbour with the longest base."""
    middle = 0.5 * (1.0 / near + 1.0 / far)
    return step_px / max(max(parallax_per_inverse_depth(view, other, middle) for other in others), 1e-12)


def full_sweep(shape: tuple[int, ...], near: float, far: float, step: float, most: int) -> Sweep:
    """Return the sweep of the whole range of depths by planes; the step grows where it needs too many."""
    low, high = 1.0 / far, 1.0 / near
    count = int(np.clip(np.ceil((high - low) / step) + 1, 3, most))
    return Sweep(np.full(shape, low, np.float32), 0, count, (high - low) / (count - 1))


def local_sweep(before: Array, shape: tuple[int, ...], step: float, count: int) -> Sweep:
    """Return the sweep of a narrow range around a surface found before, which is smoothed and enlarged."""
    smooth = np.empty_like(before)
    smooth_surface(cv2.medianBlur(before, 3), 2.0 * step, 2, smooth)
    if smooth.shape != shape:
        smooth = enlarged(smooth, shape, 3.0 * step)
    return Sweep(smooth, -(count // 2), count, step)


def enlarged(surface: Array, shape: tuple[int, ...], jump: float) -> Array:
    """Return a surface of twice the size: linear between pixels, but not over jumps of inverse depth.

    Pixel (x, y) of the large picture lies at ((x + 0.5)/2 − 0.5, …) of the small one.
    """
    h, w = shape
    x = ((np.arange(w) + 0.5) / 2.0 - 0.5).astype(np.float32)
    y = ((np.arange(h) + 0.5) / 2.0 - 0.5).astype(np.float32)
    at_x, at_y = np.meshgrid(x, y)
    linear = cv2.remap(surface, at_x, at_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    nearest = cv2.remap(surface, at_x, at_y, cv2.INTER_NEAREST, borderMode=cv2.BORDER_REPLICATE)
    return np.where(np.abs(linear - nearest) > jump, nearest, linear).astype(np.float32)


def match_once(view: View, others: Sequence[View], sweep: Sweep, how: Matching, run: Run) -> Surface:
    """Cost, aggregation and choice of the best hypothesis, once."""
    cost = matching_cost(view, others, sweep, window=how.window, noise=how.noise, census=how.census, run=run)
    grey = np.ascontiguousarray(view.grey)
    total = aggregate(cost, sweep.starts, grey, p1=how.p1, p2=how.p2, edge_grey=how.edge_grey, run=run)
    run.check()
    depth, score = np.empty(grey.shape, np.float32), np.empty(grey.shape, np.float32)
    edge = np.empty(grey.shape, np.bool_)
    winners(total, cost, sweep.surface, sweep.first, sweep.step, depth, score, edge)
    edge |= grey == OUTSIDE
    return Surface(depth, score, edge)
