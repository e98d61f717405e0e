"""Rank defects beyond the datum, in words: which unknowns the observations leave free, and what would fix them."""

from __future__ import annotations

from dataclasses import replace

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


def defects(problem: Problem, free: Array) -> tuple[Finding, ...]:
    """Describe what the observations leave free beside the datum.

    Parameters
    ----------
    problem : Problem
    free : float64 (u, k)
        Null vectors of the reduced matrix, which is scaled to unit diagonal and whose datum is fixed.
    """
    names = names_of(problem) if free.shape[1] else []
    found = []
    for vector in free.T[:MOST]:
        share = np.abs(vector)
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
            out[layout.point_column[i] + axis] = ("point", point_name(problem.order[i]), "XYZ"[axis])
    first = problem.unknowns - sum(len(group.extras) for group in problem.groups)
    for k, extra in enumerate(extra for group in problem.groups for extra in group.extras):
        out[first + k] = ("extra", extra.name, "")
    return out


def point_name(index: int) -> str:
    """Return what a point of the adjusted block is called as long as nobody knows its name."""
    return f"point {index}"


def with_names(findings: tuple[Finding, ...], names: dict[str, int]) -> tuple[Finding, ...]:
    """Return the findings of `defects` with the names (name → index into the block's points) that points have."""
    name_of = {point_name(index): name for name, index in names.items()}
    out = []
    for finding in findings:
        known = {item: name_of[item] for item in finding.items if item in name_of}
        why = finding.why
        if known and isinstance(why, Text) and "listed" in why.arguments:
            listed = why.arguments["listed"]
            for old, new in known.items():
                listed = listed.replace(f"{old}: ", f"{new}: ")
            why = Text(why.template, **(why.arguments | {"listed": listed}))
        out.append(replace(finding, why=why, items=tuple(known.get(item, item) for item in finding.items)))
    return tuple(out)


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
            "These photos hang together with the rest by too few points: add tie points or photos between, and measure "
            "control points in several photos."
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
    size = float((relative**2).sum()) or 1.0
    growth = np.einsum("na,nad->d", relative, centres) / size
    spin = np.einsum("nai,nad->id", scene.rotations[photos], turns) / len(photos)
    shift = centres.mean(axis=0) / np.sqrt(size)
    about = np.vstack([growth, spin])
    limit = 1e-6 * max(float(np.abs(about).max()), float(np.abs(shift).max()), 1e-300)
    # turned about a held point the middle of the photos moves too: free is what moves without turn and growth
    moves = np.linalg.matrix_rank(np.vstack([about, shift]), tol=limit) > np.linalg.matrix_rank(
        about, tol=limit
    )
    free = {
        "scale": np.abs(growth).max() > limit,
        "position": moves,
        "rotation": np.abs(spin).max() > limit,
    }
    return [kind for kind, is_free in free.items() if is_free]
