"""Rank defects beyond the datum, in words: which unknowns the observations leave free, and what would fix them."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.problem import Problem
from graphos_core.cameras import camera_model
from graphos_core.data import Array, Finding
from graphos_core.text import Text

PART = 0.1
"""An unknown belongs to a defect when its share of the null vector is this part of the largest."""

MOST = 8
"""Defects that are described at most; the rest are of the same kind."""

LARGEST = 4000
"""Beyond this number of reduced unknowns null vectors are not computed."""


def defects(problem: Problem, matrix: Array, relative: float) -> tuple[Finding, ...]:
    """Describe the null vectors of a reduced matrix whose datum is fixed.

    Parameters
    ----------
    problem : Problem
    matrix : float64 (u, u)
        Symmetric, scaled to unit diagonal, datum conditions added.
    relative : float
        Eigenvalues below this are zero.
    """
    u = len(matrix)
    if u > LARGEST:
        return (Finding(severity="error", what="Some unknowns cannot be determined.",
                        todo="Look for photos and cameras with few points.", learn="adjustment/rank-defects"),)  # fmt: skip
    values, vectors = np.linalg.eigh(matrix)
    names = names_of(problem)
    found = []
    for k in np.flatnonzero(values < relative)[:MOST]:
        share = np.abs(vectors[:, k])
        parts = np.flatnonzero(share > PART * share.max())
        found.append(_finding([names[i] for i in parts[np.argsort(-share[parts])]]))
    return tuple(found)


def names_of(problem: Problem) -> list[tuple[str, str, str]]:
    """Return (kind, owner, unknown) of every reduced unknown, such as ``("photo", "a.jpg", "rotation about x")``."""
    layout, block = problem.layout, problem.block
    out: list[tuple[str, str, str]] = [("", "", "")] * problem.unknowns
    for n in np.flatnonzero(layout.width > 0).tolist():
        column, pose, c = layout.photo_column[n], layout.pose[n], layout.camera[n]
        for i in range(int(pose)):
            what = f"rotation about {'xyz'[i]}" if i < 3 else f"centre {'XYZ'[i - 3]}"
            out[column + i] = ("photo", block.names[n], what)
        _camera(problem, c, column + pose, layout.width[n] - pose, out)
    for c in np.flatnonzero(layout.camera_column >= 0).tolist():
        _camera(problem, c, layout.camera_column[c], layout.free_count[c], out)
    for i in np.flatnonzero(layout.point_column >= 0).tolist():
        for axis in range(3):
            out[layout.point_column[i] + axis] = ("point", str(problem.order[i]), "XYZ"[axis])
    first = problem.unknowns - sum(len(group.extras) for group in problem.groups)
    for k, extra in enumerate(extra for group in problem.groups for extra in group.extras):
        out[first + k] = ("extra", extra.name, "")
    return out


def _camera(problem: Problem, c: int, column: int, count: int, out: list[tuple[str, str, str]]) -> None:
    camera = problem.block.cameras[c]
    parameters = camera_model(camera.model).parameters
    for i in range(count):
        label = parameters[problem.layout.free_index[c, i]].label
        out[column + i] = ("camera", camera.label or f"Camera {c + 1}", label)


def _finding(parts: list[tuple[str, str, str]]) -> Finding:
    kinds = {kind for kind, _, _ in parts}
    owners = list(dict.fromkeys(owner for _, owner, _ in parts))
    listed = ", ".join(f"{owner}: {what}" if what else owner for _, owner, what in parts[:6])
    why = Text("Free are, the most first: {listed}.", listed=listed)
    if kinds == {"photo"} and len(owners) == 1:
        todo = "Add tie points to that photo, not all on one line or close together, or leave it out."
    elif kinds == {"photo"}:
        todo = (
            "These photos hang together with the rest by too few points: add tie points, or photos between."
        )
    elif "camera" in kinds:
        todo = "Hold one of these camera parameters fixed, or take convergent photos rolled by 90° of a scene with depth."
    elif "point" in kinds:
        todo = "Measure the point in another photo, or give its coordinates."
    else:
        todo = "Give this unknown a value, or observations that depend on it."
    return Finding(severity="error", what="An unknown cannot be determined by these observations.", why=why, todo=todo,
                   learn="adjustment/rank-defects", items=tuple(owners))  # fmt: skip


def datum_findings(null: Array, scene: Scene, problem: Problem) -> tuple[Finding, ...]:
    """Say which motions of the whole block nothing known fixes, and what would.

    Parameters
    ----------
    null : float64 (u, d)
        Free motions, see `graphos_core.adjustment.bundle.datum.gauge`.
    """
    if not null.shape[1]:
        return ()
    free = _free_kinds(null, scene, problem)
    if not free:
        return ()
    todo = {
        "scale": "give one distance", "position": "give three coordinates of a point or photo",
        "rotation": "give control points, or a horizontal plane and an axis",
    }  # fmt: skip
    return (Finding(
        severity="info", what=Text("{kinds} of the whole block: nothing known fixes it.", kinds=" and ".join(
            kind.capitalize() if i == 0 else kind for i, kind in enumerate(free))),
        why="Photos alone know neither; the shape of the block does not suffer.",
        todo=Text("To fix it: {todo}.", todo="; ".join(todo[kind] for kind in free)), learn="adjustment/datum",
    ),)  # fmt: skip


def _free_kinds(null: Array, scene: Scene, problem: Problem) -> list[str]:
    """Return which of scale, position and rotation occur among the free motions."""
    layout = problem.layout
    photos = np.flatnonzero(layout.pose > 0)
    if len(photos) < 2:
        return []
    centres = np.stack([null[layout.photo_column[n] + 3 : layout.photo_column[n] + 6] for n in photos])
    turns = np.stack([null[layout.photo_column[n] : layout.photo_column[n] + 3] for n in photos])
    relative = scene.centres[photos] - scene.centres[photos].mean(axis=0)
    moved = centres - centres.mean(axis=0)
    size = float((relative**2).sum()) or 1.0
    growth = np.einsum("na,nad->d", relative, moved) / size
    shift = np.linalg.norm(centres.mean(axis=0), axis=0) / np.sqrt(size)
    turned = np.linalg.norm(turns, axis=1).max(axis=0)
    largest = max(float(np.abs(growth).max()), float(shift.max()), float(turned.max()), 1e-300)
    found = []
    for kind, value in (
        ("scale", np.abs(growth).max()),
        ("position", shift.max()),
        ("rotation", turned.max()),
    ):
        if value > 1e-6 * largest:
            found.append(kind)
    return found
