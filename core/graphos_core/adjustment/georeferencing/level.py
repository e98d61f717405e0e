"""Scene-based orientation: a horizontal plane, a vertical line or axes turn the block the right way up."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.georeferencing.measured_points import MeasuredPoints
from graphos_core.data import Array, Block, Known, KnownShape
from graphos_core.geometry.similarity import Similarity
from graphos_core.run import Run
from graphos_core.text import Text

AXES = {"x axis": 0, "y axis": 1, "z axis": 2, "vertical line": 2}

SAME = 1e-3
"""Sine of the angle below which two directions are the same, and share of the extent below which points are one line."""


def levelled(block: Block, known: Known, points: MeasuredPoints, run: Run) -> Similarity | None:
    """Return the rotation that makes planes horizontal and axes point along X, Y, Z; None where nothing says so.

    A horizontal plane, else a vertical line or Z axis, gives the vertical; an X or Y axis gives the azimuth. What is
    measured above a horizontal plane is on the side of the cameras. The first point of the first shape becomes the
    origin. After Deseilligny and Clery 2011, APERO, section 4.4 (scene-based orientation).

    Parameters
    ----------
    block : Block
    known : Known
    points : MeasuredPoints
        Of ``known.measured``.
    run : Run
        Is told which shapes have too few points.
    """
    up: Array | None = None
    azimuth: tuple[int, Array] | None = None
    origin: Array | None = None
    for shape in known.shapes:
        xyz = _places(shape, known, points)
        need = 3 if shape.kind == "horizontal plane" else 2
        if shape.kind not in AXES and shape.kind != "horizontal plane":
            continue
        if len(xyz) < need:
            run.warn(Text("The {kind} does not turn the block: {count} of its points are measured in two oriented "
                          "photos, {need} are needed.", kind=shape.kind, count=len(xyz), need=need))  # fmt: skip
            continue
        extent = np.linalg.svd(xyz - xyz.mean(axis=0), compute_uv=False)
        if extent[need - 2] <= SAME * extent[0]:
            run.warn(Text("The {kind} does not turn the block: its points are {what}.", kind=shape.kind,
                          what="on one line" if need == 3 and extent[0] > 0 else "one and the same"))  # fmt: skip
            continue
        origin = xyz[0] if origin is None else origin
        if shape.kind == "horizontal plane":
            up = _normal(xyz, np.asarray(block.centres[np.asarray(block.oriented)]))
        elif AXES[shape.kind] == 2:
            up = (xyz[-1] - xyz[0]) if up is None else up
        else:
            azimuth = (AXES[shape.kind], xyz[-1] - xyz[0])
    if up is not None and azimuth is not None and _parallel(up, azimuth[1]):
        run.warn(Text("The {axis} axis does not turn the block: its points stand above each other.",
                      axis="XYZ"[azimuth[0]]))  # fmt: skip
        azimuth = None
    if up is None and azimuth is None:
        return None
    turn = _frame(up, azimuth)
    return Similarity(1.0, turn, -turn @ (np.zeros(3) if origin is None else origin))


def _places(shape: KnownShape, known: Known, points: MeasuredPoints) -> Array:
    names = () if known.control is None else known.control.names
    index = [names.index(name) for name in shape.points if name in names]
    return np.asarray(points.xyz[[i for i in index if points.found[i]]])


def _normal(xyz: Array, centres: Array) -> Array:
    """Return the normal of a plane through points, on the side of the cameras."""
    middle = xyz.mean(axis=0)
    normal = np.linalg.svd(xyz - middle)[2][2]
    return np.asarray(normal if (centres - middle).mean(axis=0) @ normal > 0 else -normal)


def _parallel(a: Array, b: Array) -> bool:
    """Say whether two directions hardly differ, or one of them has no length."""
    return bool(np.linalg.norm(np.cross(a, b)) <= SAME * np.linalg.norm(a) * np.linalg.norm(b))


def _frame(up: Array | None, azimuth: tuple[int, Array] | None) -> Array:
    """Return ``world_from_model`` (3, 3) with `up` along Z and the azimuth's direction, seen from above, along its axis."""
    if up is None:
        axis, along = azimuth if azimuth is not None else (0, np.array([1.0, 0.0, 0.0]))
        helper = np.eye(3)[int(np.argmin(np.abs(along)))]
        up = np.cross(along, helper)
    z = up / np.linalg.norm(up)
    axis, along = azimuth if azimuth is not None else (0, np.eye(3)[int(np.argmin(np.abs(z)))])
    flat = along - (along @ z) * z
    flat /= np.linalg.norm(flat)
    x = flat if axis == 0 else np.cross(flat, z)
    return np.stack([x, np.cross(z, x), z])
