"""Observations that ended behind their cameras leave the adjusted problem."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.known.group import Columns, Group
from graphos_core.adjustment.bundle.levenberg_marquardt import Solution
from graphos_core.adjustment.bundle.problem import Freedom, Problem, chunks_of, make_problem
from graphos_core.adjustment.bundle.selection import select, usable
from graphos_core.data import Array


def without_hidden(
    problem: Problem, freedom: Freedom, solution: Solution, residuals: Array
) -> tuple[Problem, Solution, Array]:
    """Drop the observations that ended behind their cameras; they had no weight, so the solution stays.

    Returns the smaller problem, the solution, and which observations of the block (bool) are left.
    """
    seen: Array = np.asarray(np.isfinite(residuals).all(axis=1))
    quick = trimmed(problem, solution.scene, seen)
    if quick is not None:
        return quick[0], replace(solution, scene=quick[1]), quick[2]
    block, fixed = problem.to_block(solution.scene), problem.fixed_points
    kept = np.zeros(len(block.points), dtype=bool)
    kept[problem.order] = problem.layout.point_column >= 0
    keep = seen.copy()
    sigma = None if block.obs_sigma_px is None else block.obs_sigma_px[keep]
    keep[keep] = usable(replace(block, obs_photo=block.obs_photo[keep], obs_point=block.obs_point[keep],
                                obs_xy=block.obs_xy[keep], obs_sigma_px=sigma), fixed | kept)  # fmt: skip
    smaller, points = select(block, keep)
    place = np.full(len(block.points), -1)
    place[points] = np.arange(len(points))
    groups = [
        moved
        for group, at in zip(problem.groups, problem.columns, strict=True)
        if (moved := _renumber(group, at, problem.order, place, solution.scene)) is not None
    ]
    left = make_problem(smaller, replace(freedom, fixed_points=fixed[points]), groups)
    return left, replace(solution, scene=left.scene), keep


def _renumber(group: Group, at: Columns, order: Array, place: Array, scene: Scene) -> Group | None:
    """Return a group whose points are those of the smaller block and whose own unknowns start as adjusted."""
    now = np.full(len(at.point), -1)
    there = at.point >= 0
    now[there] = place[order[at.point[there]]]
    rest = group.restrict(now >= 0, np.ones(len(scene.centres), dtype=bool))
    if rest is None:
        return None
    fields: dict[str, Any] = {}
    if len(rest.points):
        fields = {name: now[getattr(rest, name)] for name in ("point", "a", "b") if hasattr(rest, name)}
    if rest.extras:
        found = scene.extra[at.extra_value : at.extra_value + len(rest.extras)]
        fields["extras"] = tuple(replace(e, value=float(v)) for e, v in zip(rest.extras, found, strict=True))
    return replace(rest, **fields)  # type: ignore[type-var]


def trimmed(problem: Problem, scene: Scene, keep: Array) -> tuple[Problem, Scene, Array] | None:
    """Leave observations out of a problem without other observations; None where more would change than its points.

    Parameters
    ----------
    problem : Problem
    scene : Scene
        Where its unknowns are.
    keep : bool (m,)
        Observations of the block that stay, as far as their points keep two rays.

    Returns
    -------
    Problem, Scene, bool (m,)
        The smaller problem and scene, and which observations of the old block are left.
    """
    layout = problem.layout
    if problem.groups or problem.fixed.any():
        return None
    seen = keep[problem.observation]
    rays = np.add.reduceat(seen.astype(np.int64), layout.start[:-1])
    stays = rays >= 2
    seen &= np.repeat(stays, np.diff(layout.start))
    photo = layout.photo[seen]
    if np.any(
        (np.bincount(photo, minlength=len(layout.pose)) > 0)
        != (np.bincount(layout.photo, minlength=len(layout.pose)) > 0)
    ):
        return None
    left = np.zeros(len(keep), dtype=bool)
    left[problem.observation[seen]] = True
    block, points = select(problem.block, left)
    place = np.full(len(problem.order), -1)
    place[points] = np.arange(len(points))
    start = np.concatenate([[0], np.cumsum(rays[stays])])
    smaller = layout._replace(
        start=start, photo=photo, xy=layout.xy[seen], weight=layout.weight[seen],
        free_point=layout.free_point[stays], point_column=layout.point_column[stays],
    )  # fmt: skip
    observation = (np.cumsum(left) - 1)[problem.observation[seen]]
    moved = scene._replace(points=np.ascontiguousarray(scene.points[stays]))
    chunks = chunks_of(start, problem.unknowns)
    return (
        Problem(block, smaller, moved, place[problem.order[stays]], observation, problem.unknowns, chunks), moved, left
    )  # fmt: skip
