"""A courtyard: four walls, paving, plinths, columns and a doorway, open to the sky; for cameras that see all round."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.simulation.patches import Finish, Patch, box, plane, revolve
from graphos_core.simulation.scene import Design
from graphos_core.simulation.texture_kernels import ASHLAR, BRICK, PAVING, PLASTER, STONE, WOOD

HALF_X, HALF_Y, HEIGHT = 4.6, 3.8, 4.4
"""Half length and half width of the court and height of its walls, m."""


def design(seed: int) -> Design:
    """Return the courtyard about the z axis, ground in the plane z = 0; every surface faces inwards."""
    patches = [*_walls(), *_furniture()]
    numbered = [replace(patch, seed=patch.seed + 37 * index) for index, patch in enumerate(patches)]
    return Design(numbered, np.array([0.0, 0.0, 1.7]))


def _walls() -> list[Patch]:
    x, y, z = np.diag([2 * HALF_X, 2 * HALF_Y, HEIGHT])
    low, high = np.array([-HALF_X, -HALF_Y, 0.0]), np.array([HALF_X, HALF_Y, 0.0])
    return [
        plane(low, x, y, Finish(PAVING, 3, 0.8)),
        plane(low + y, x, z, Finish(BRICK, 1, 0.9)),
        plane(high - y, -x, z, Finish(ASHLAR, 2, 1.0)),
        plane(low, y, z, Finish(PLASTER, 5, 1.0)),
        plane(high, -y, z, Finish(STONE, 7, 1.0)),
    ]


def _furniture() -> list[Patch]:
    patches = []
    for index, (sx, sy) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
        cx, cy = sx * (HALF_X - 0.75), sy * (HALF_Y - 0.75)
        patches += box((cx - 0.35, cy - 0.35, 0.0), (cx + 0.35, cy + 0.35, 0.7), Finish(ASHLAR, index, 0.8))
        share = np.linspace(0.0, 1.0, 12)
        shaft = np.stack([0.27 - 0.05 * share**1.6, 0.7 + 2.4 * share], axis=1)
        patches.append(revolve(shaft, (cx, cy), Finish(STONE, 10 + index, 0.8), sides=36))
        patches += box(
            (cx - 0.32, cy - 0.32, 3.1), (cx + 0.32, cy + 0.32, 3.35), Finish(STONE, 20 + index, 0.7)
        )
    patches += box((-0.9, HALF_Y - 0.15, 0.0), (0.9, HALF_Y, 2.4), Finish(WOOD, 4, 0.9), "fulr")
    patches += box((-HALF_X, -1.2, 0.0), (-HALF_X + 0.5, 1.2, 0.5), Finish(WOOD, 6, 0.7), "fburd")
    patches += box((1.1, -HALF_Y, 0.0), (2.3, -HALF_Y + 0.6, 0.9), Finish(BRICK, 8, 0.9), "bulr")
    return patches
