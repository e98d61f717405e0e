"""The datum of a block: which motions of the whole block its observations leave free, and how they are fixed."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.problem import Problem
from graphos_core.data import Array

MOTIONS = 7
"""Three shifts, three rotations and a scale: the similarity that photos alone leave free."""


def gauge(problem: Problem, scene: Scene) -> Array:
    """Return the null space of the normal equations: how the reduced unknowns move with the whole block.

    Returns
    -------
    float64 (u, d)
        One column per free motion, d the datum defect: 7 for a free block, fewer where fixed points or photos hold
        it. Shifts and rotations are about the mean projection centre.
    """
    allowed = free_motions(problem, scene)
    layout = problem.layout
    out = np.zeros((problem.unknowns, MOTIONS))
    middle = _middle(problem, scene)
    for n in np.flatnonzero(layout.pose > 0):
        column = layout.photo_column[n]
        out[column : column + 3, 3:6] = -scene.rotations[n]
        out[column + 3 : column + 6] = _motion(scene.centres[n] - middle)
    return out @ allowed


def datum_weights(problem: Problem, scene: Scene) -> Array:
    """Return the weight (u,) of each reduced unknown in the inner constraints.

    1 for a projection centre, the squared mean distance of photos and points for a rotation (so that both are
    lengths), 0 for interior orientation.
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


def describe(problem: Problem, defect: int) -> str:
    """Say in words how the datum was defined."""
    fixed_points = len(problem.order) - problem.free_points
    fixed_photos = int(((problem.layout.pose == 0) & (np.bincount(
        problem.layout.photo, minlength=len(problem.layout.pose)) > 0)).sum())  # fmt: skip
    held = [f"{fixed_points} fixed points"] if fixed_points else []
    held += [f"{fixed_photos} fixed photos"] if fixed_photos else []
    if defect == 0:
        return " and ".join(held)
    inner = f"inner constraints on the exterior orientations ({defect} conditions)"
    return f"{' and '.join(held)}, {inner}" if held else f"free network: {inner}"


def _middle(problem: Problem, scene: Scene) -> Array:
    used = np.unique(problem.layout.photo)
    return scene.centres[used].mean(axis=0)


def _motion(x: Array) -> Array:
    """Return ∂x/∂(shift, rotation, scale) (3, 7) of a place x."""
    return np.hstack([np.eye(3), [[0, x[2], -x[1]], [-x[2], 0, x[0]], [x[1], -x[0], 0]], x[:, None]])


def free_motions(problem: Problem, scene: Scene) -> Array:
    """Return a basis (7, d) of the motions that leave fixed points and fixed photos where they are."""
    layout = problem.layout
    middle = _middle(problem, scene)
    used = np.bincount(layout.photo, minlength=len(layout.pose)) > 0
    photos = np.flatnonzero(used & (layout.pose == 0))
    points = scene.points[~layout.free_point]
    if len(photos) == 0 and len(points) == 0:
        return np.eye(MOTIONS)
    size = float(np.abs(scene.centres[used] - middle).max()) or 1.0
    size = max(size, float(np.abs(points - middle).max(initial=0.0)))
    held = [_motion((x - middle) / size) for x in (*points[:200], *scene.centres[photos])]
    if len(photos):
        held.append(np.hstack([np.zeros((3, 3)), np.eye(3), np.zeros((3, 1))]))
    _, singular, vt = np.linalg.svd(np.vstack(held))
    rank = int((singular > 1e-9 * singular[0]).sum())
    basis = vt[rank:].T
    basis[:3] *= size
    return basis
