"""Terrain for strips from the air, and a statue-like body for stations all round."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.simulation.patches import Finish, box, curved, plane
from graphos_core.simulation.scene import Design
from graphos_core.simulation.texture_kernels import ASHLAR, BRICK, GROUND, PAVING, PLASTER, STATUE, octaves


def relief(x: Array, y: Array, seed: int, *, scale: float, height: float) -> Array:
    """Return multi-octave heights, m, at (x, y): hills of size `scale` m, about ± `height` m."""
    flat = np.stack([np.ravel(x), np.ravel(y)], axis=1) / scale
    values = np.array([octaves(a, b, 4000 + seed, 6, 0.5) for a, b in flat])
    result: Array = height * values.reshape(np.shape(x))
    return result


def terrain(seed: int) -> Design:
    """Return 60 m × 45 m of hilly ground with paths, walls and low houses; z up, middle at the origin."""
    x, y = np.linspace(-30.0, 30.0, 121), np.linspace(-22.5, 22.5, 91)
    xx, yy = np.meshgrid(x, y)
    z = relief(xx, yy, seed, scale=16.0, height=1.6)
    patches = [curved(np.stack([xx, yy, z], axis=2), x - x[0], y - y[0], Finish(GROUND, 1, 0.0, 3.0))]
    rng = np.random.default_rng(seed)
    for k in range(14):
        cx, cy = rng.uniform(-24, 24), rng.uniform(-18, 18)
        w, d, h = rng.uniform(1.5, 4.0), rng.uniform(1.5, 4.0), rng.uniform(0.8, 3.0)
        material = (BRICK, ASHLAR)[k % 2]
        patches += box((cx, cy, -3.0), (cx + w, cy + d, h), Finish(material, k, 0.5, 2.0), "fblr")
        patches += box(
            (cx - 0.2, cy - 0.2, h),
            (cx + w + 0.2, cy + d + 0.2, h + 0.1),
            Finish(PLASTER, k, 0.9, 2.0),
            "fblru",
        )
    return Design(patches, np.zeros(3))


def statue(seed: int) -> Design:
    """Return a boulder of 1 m radius on a pedestal on paved ground; middle of the boulder at the origin.

    The boulder is a sphere as six cube faces, pushed out by multi-octave noise.
    """
    patches = box((-0.6, -0.6, -2.0), (0.6, 0.6, -0.9), Finish(ASHLAR, 1, 0.7, 1.5), "fblru")
    ground = np.array([-7.0, -7.0, -2.0]), np.array([14.0, 0.0, 0.0]), np.array([0.0, 14.0, 0.0])
    patches.append(plane(*ground, Finish(PAVING, 2, 0.6, 3.0)))
    step = np.linspace(-1.0, 1.0, 65)
    a, b = np.meshgrid(np.tan(step * np.pi / 4), np.tan(step * np.pi / 4))
    one = np.ones_like(a)
    faces = [(a, -one, b), (one, a, b), (-a, one, b), (-one, -a, b), (a, b, one), (a, -b, -one)]
    knots = (step + 1.0) * np.pi / 4
    for index, face in enumerate(faces):
        unit = np.stack(face, axis=2) / np.sqrt(a**2 + b**2 + 1.0)[..., None]
        bumps = sum(
            relief(unit[..., i] + 3.1 * k, unit[..., j] - 1.7 * k, seed + k, scale=0.55, height=0.05)
            for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 0)))
        )
        radius = 1.0 + np.asarray(bumps)
        patches.append(curved(unit * radius[..., None], knots, knots, Finish(STATUE, 200 * index)))
    return Design(patches, np.zeros(3))
