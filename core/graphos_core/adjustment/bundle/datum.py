"""The datum of a block: which motions of the whole block its observations leave free, and how they are fixed."""

from __future__ import annotations

from typing import Literal

import numpy as np

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.known.assembly import linearise
from graphos_core.adjustment.bundle.problem import Problem
from graphos_core.data import Array

MOTIONS = 7
"""Three shifts, three rotations and a scale: the similarity that photos alone leave free."""

NOTHING = 1e-8
"""A motion is free when it changes no observation by more than this share of what it could."""

DatumKind = Literal["inner", "minimal"]


def gauge(problem: Problem, scene: Scene) -> Array:
    """Return the null space of the normal equations: how the reduced unknowns move with the whole block.

    Returns
    -------
    float64 (u, d)
        One column per free motion, d the datum defect: 7 for a free block, fewer where fixed points, fixed photos or
        other observations hold it. Shifts and rotations are about the mean projection centre. Unknowns of other
        observations (a plane) move with the block as far as the observations allow.
    """
    motions = _motions(problem, scene)
    size = _size(problem, scene)
    unit = np.array([size] * 3 + [1.0] * 4)
    held = [_held(problem, scene, size)]
    others = linearise(problem, scene)
    extra = problem.unknowns - len(scene.extra) + np.arange(len(scene.extra))
    reach = np.ones(len(extra))
    if others is not None:
        moved = np.asarray(others.jacobian @ motions) * unit
        own = others.jacobian[:, extra].toarray()
        reach = np.maximum(np.linalg.norm(own, axis=0), 1e-300)
        could = np.asarray(abs(others.jacobian) @ np.abs(motions)) * unit  # rounding alone holds nothing
        rows = np.hstack([moved, own / reach])
        most = np.linalg.norm(np.hstack([could, own / reach]), axis=1)
        held.append(rows / np.maximum(most, 1e-300)[:, None])
    basis = _null_space(np.vstack(held))
    found = motions @ (unit[:, None] * basis[:MOTIONS])
    found[extra] += basis[MOTIONS:] / reach[:, None]
    return found


def defect(problem: Problem, scene: Scene) -> int:
    """Return the datum defect d alone; quick where nothing at all holds the block."""
    layout = problem.layout
    if not problem.groups and not problem.fixed.any():
        used = np.bincount(layout.photo, minlength=len(layout.pose)) > 0
        if not (used & (layout.pose == 0)).any():
            return MOTIONS
    return gauge(problem, scene).shape[1]


def _null_space(rows: Array) -> Array:
    """Return the null vectors (7 + e, d) of `rows` that move the block."""
    width = rows.shape[1]
    if not len(rows):
        return np.eye(width, MOTIONS)
    _, singular, vt = np.linalg.svd(rows, full_matrices=len(rows) < width)
    rank = int((singular > NOTHING * singular[0]).sum())
    null = vt[rank:].T
    if width > MOTIONS and null.shape[1]:  # an undetermined plane alone moves nothing
        _, share, turn = np.linalg.svd(null[:MOTIONS], full_matrices=True)
        null = null @ turn[: int((share > 1e-6).sum())].T
    return np.asarray(null)


def _motions(problem: Problem, scene: Scene) -> Array:
    """Return ∂(reduced unknowns)/∂(shift, rotation, scale) (u, 7) about the mean projection centre."""
    layout = problem.layout
    out = np.zeros((problem.unknowns, MOTIONS))
    middle = _middle(problem, scene)
    for n in np.flatnonzero(layout.pose > 0):
        column = layout.photo_column[n]
        out[column : column + 3, 3:6] = -scene.rotations[n]
        out[column + 3 : column + 6] = _motion(scene.centres[n] - middle)
    for i in np.flatnonzero(layout.point_column >= 0):
        column = layout.point_column[i]
        out[column : column + 3] = _motion(scene.points[i] - middle)
    return out


def constraints(problem: Problem, scene: Scene, null: Array, kind: DatumKind = "inner") -> Array:
    """Return C (u, d) of the conditions ``Cᵀ x = 0`` that fix the free motions.

    Parameters
    ----------
    problem, scene : Problem, Scene
    null : float64 (u, d)
        Of `gauge`.
    kind : {"inner", "minimal"}
        Inner: the exterior orientations move as little as possible in the sense of least squares (free network).
        Minimal: as many coordinates as there are free motions are held at their values, those that hold the block
        best.
    """
    weights = datum_weights(problem, scene)
    if kind == "inner" or not null.shape[1]:
        return np.asarray(weights[:, None] * null)
    chosen: list[int] = []
    rest = np.sqrt(weights)[:, None] * null
    for _ in range(
        null.shape[1]
    ):  # pivoted elimination: the unknown that a free motion moves most is held next
        row = int(np.argmax((rest**2).sum(axis=1)))
        chosen.append(row)
        direction = rest[row] / np.linalg.norm(rest[row])
        rest = rest - np.outer(rest @ direction, direction)
    out = np.zeros_like(null)
    out[chosen, np.arange(len(chosen))] = 1.0
    return out


def datum_weights(problem: Problem, scene: Scene) -> Array:
    """Return the weight (u,) of each reduced unknown in the inner constraints.

    1 for a projection centre, the squared mean distance of photos and points for a rotation (so that both are
    lengths), 0 for everything else.
    """
    layout = problem.layout
    first = layout.photo[layout.start[:-1]]
    distance2 = float(((scene.points - scene.centres[first]) ** 2).sum(axis=1).mean())
    weights = np.zeros(problem.unknowns)
    for n in np.flatnonzero(layout.pose > 0):
        column = layout.photo_column[n]
        weights[column : column + 3] = distance2
        weights[column + 3 : column + 6] = 1.0
    return weights


def describe(problem: Problem, defect: int, kind: DatumKind = "inner") -> str:
    """Say in words how the datum was defined."""
    held = []
    fixed_points = int(problem.fixed.sum())
    used = np.bincount(problem.layout.photo, minlength=len(problem.layout.pose)) > 0
    fixed_photos = int((used & (problem.layout.pose == 0)).sum())
    if fixed_points:
        held.append(f"{fixed_points} fixed points")
    if fixed_photos:
        held.append(f"{fixed_photos} fixed photos")
    names = {"datum": "the scale at its start"}
    holding = [g for g in problem.groups if g.kind != "camera" and not (g.kind == "rig" and g.extras)]
    held += sorted({names.get(g.kind, g.kind) for g in holding})
    if defect == 0:
        return " and ".join(held)
    how = "inner constraints on" if kind == "inner" else "minimal constraints among"
    inner = f"{how} the exterior orientations ({defect} conditions)"
    return f"{' and '.join(held)}, {inner}" if held else f"free network: {inner}"


def _middle(problem: Problem, scene: Scene) -> Array:
    used = np.bincount(problem.layout.photo, minlength=len(scene.centres)) > 0
    return np.asarray(scene.centres[used].mean(axis=0))


def _motion(x: Array) -> Array:
    """Return ∂x/∂(shift, rotation, scale) (3, 7) of a place x."""
    return np.hstack([np.eye(3), [[0, x[2], -x[1]], [-x[2], 0, x[0]], [x[1], -x[0], 0]], x[:, None]])


def _size(problem: Problem, scene: Scene) -> float:
    used, middle = np.unique(problem.layout.photo), _middle(problem, scene)
    size = float(np.abs(scene.centres[used] - middle).max()) or 1.0
    kept = scene.points[~problem.layout.free_point]
    return max(size, float(np.abs(kept - middle).max(initial=0.0)))


def _held(problem: Problem, scene: Scene, size: float) -> Array:
    """Return what the motions, in units of the block's size, do to fixed points and fixed photos (rows, 7 + e)."""
    layout, middle = problem.layout, _middle(problem, scene)
    used = np.bincount(layout.photo, minlength=len(layout.pose)) > 0
    photos = np.flatnonzero(used & (layout.pose == 0))
    points = scene.points[problem.fixed][:200]
    rows = [_motion((x - middle) / size) for x in (*points, *scene.centres[photos])]
    if len(photos):
        rows.append(np.hstack([np.zeros((3, 3)), np.eye(3), np.zeros((3, 1))]))
    found = np.vstack(rows) if rows else np.empty((0, MOTIONS))
    return np.hstack([found, np.zeros((len(found), len(scene.extra)))])
