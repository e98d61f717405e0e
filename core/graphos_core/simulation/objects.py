"""Object points of theoretical models: cube, sphere, terrain, imported cloud."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from graphos_core.data.record import Array, record
from graphos_core.errors import UserError
from graphos_core.params import About, Params
from graphos_core.text import Text


@record
class ObjectPoints:
    """Points of an object.

    Attributes
    ----------
    xyz : float64 (n, 3)
        Object frame, m.
    normals : float64 (n, 3)
        Outward unit normals; rows of zeros where unknown.
    """

    xyz: Array
    normals: Array

    def moved(self, by: Array) -> ObjectPoints:
        """Return the points shifted by `by` (3,), m."""
        return ObjectPoints(xyz=self.xyz + np.asarray(by), normals=self.normals)


class ObjectParams(Params):
    """Size of an object and number of its points."""

    size: Annotated[
        float, About(label="Size", unit="m", low=0, low_open=True, high=1e6, step=1,
                     help="Side of the cube or of the terrain, diameter of the sphere.")
    ] = 4.0  # fmt: skip
    count: Annotated[
        int, About(label="Points", unit="", low=4, high=1_000_000, step=100, help="Number of object points.",
                   effect="Higher: more observations.")
    ] = 500  # fmt: skip
    relief: Annotated[
        float, About(label="Relief", unit="m", low=0, high=1e5, step=0.1,
                     help="Height of the terrain's hills; the other objects have none.")
    ] = 0.5  # fmt: skip


def cube(params: ObjectParams, seed: int = 0) -> ObjectPoints:
    """Return points spread evenly at random over the six faces of a cube about the origin."""
    rng = np.random.default_rng([seed, 1])
    face = np.arange(params.count) % 6
    axis, sign = face // 2, np.where(face % 2, 1.0, -1.0)
    xyz = rng.uniform(-0.5, 0.5, (params.count, 3)) * params.size
    rows = np.arange(params.count)
    xyz[rows, axis] = 0.5 * sign * params.size
    normals = np.zeros_like(xyz)
    normals[rows, axis] = sign
    return ObjectPoints(xyz=xyz, normals=normals)


def sphere(params: ObjectParams, seed: int = 0) -> ObjectPoints:
    """Return points spread evenly at random over a sphere about the origin."""
    rng = np.random.default_rng([seed, 2])
    normals = rng.standard_normal((params.count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return ObjectPoints(xyz=0.5 * params.size * normals, normals=normals)


def terrain(params: ObjectParams, seed: int = 0) -> ObjectPoints:
    """Return points spread evenly at random over hills of four octaves, z up, about the origin."""
    rng = np.random.default_rng([seed, 3])
    xy = rng.uniform(-0.5, 0.5, (params.count, 2)) * params.size
    z, slope = np.zeros(params.count), np.zeros((params.count, 2))
    for octave in range(4):
        wave = rng.standard_normal(2)
        wave *= 2 * np.pi * 1.5 * 2.0**octave / params.size / np.linalg.norm(wave)
        height = params.relief / 2.0 ** (octave + 1)
        phase = xy @ wave + rng.uniform(0, 2 * np.pi)
        z += height * np.sin(phase)
        slope += height * np.cos(phase)[:, None] * wave
    normals = np.column_stack([-slope, np.ones(params.count)])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return ObjectPoints(xyz=np.column_stack([xy, z]), normals=normals)


def imported(xyz: Array, normals: Array | None = None) -> ObjectPoints:
    """Return a cloud (n, 3) from elsewhere, m, with its outward unit normals where they are known.

    Raises
    ------
    UserError
        When the arrays are not (n, 3) or not finite.
    """
    xyz = np.asarray(xyz, dtype=np.float64)
    normals = np.zeros_like(xyz) if normals is None else np.asarray(normals, dtype=np.float64)
    if xyz.ndim != 2 or xyz.shape[1] != 3 or normals.shape != xyz.shape:
        raise UserError(
            Text(
                "A cloud needs three coordinates per point, this one has the shape {shape}.", shape=xyz.shape
            ),
            todo="Give an array with one row of x, y, z per point.",
        )
    if not np.isfinite(xyz).all():
        raise UserError("The cloud has points without finite coordinates.", todo="Remove them.")
    return ObjectPoints(xyz=xyz, normals=normals)


OBJECTS = {"cube": cube, "sphere": sphere, "terrain": terrain}
"""Every object that is made from `ObjectParams`, by name."""
