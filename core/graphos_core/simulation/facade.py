"""The façade of the demo: steps, plinth, columns, niches, door, windows, entablature and cornice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.data.record import Array
from graphos_core.simulation.patches import Finish, Patch, box, curved, extrude, pierced, plane, revolve
from graphos_core.simulation.scene import Design
from graphos_core.simulation.texture_kernels import ASHLAR, BRICK, GLASS, GROUND, PAVING, PLASTER, STONE, WOOD

FLOOR, PLINTH, EAVES = 0.48, 1.25, 6.1
"""Heights of the top step, of the plinth and of the wall, m."""
COLUMNS = (-4.45, -1.75, 1.75, 4.45)
NICHES = (-3.1, 3.1)
COLUMN_Y = -0.42
TARGET_DIAMETER = 0.20


def design(seed: int) -> Design:
    """Return the façade: 12 m wide, 8 m high, front wall in the plane y = 0, z up from the ground, x to the right."""
    patches = [_wall()]
    patches += _base() + _door() + _window() + _corners() + _entablature() + _ground()
    for index, x in enumerate(COLUMNS):
        patches += _column(x, 10 * index)
    for index, x in enumerate(NICHES):
        patches += _niche(x, 10 * index)
    numbered = [
        replace(patch, seed=patch.seed + 37 * index) if patch.material not in (BRICK, ASHLAR) else patch
        for index, patch in enumerate(patches)
    ]
    return Design(_with_targets(numbered), np.array([0.0, -0.2, 3.75]))


def _wall() -> Patch:
    openings = [
        (6.0 - 1.05, 6.0 + 1.05, 0.0, 3.15, False),
        (6.0 - 0.75, 6.0 + 0.75, 4.05, 5.25, False),
        *((6.0 + x - 0.62, 6.0 + x + 0.62, 1.35, 3.45, True) for x in NICHES),
    ]
    return pierced(np.array([-6.0, 0.0, FLOOR]), 12.0, EAVES - FLOOR, openings, Finish(BRICK, weather=0.8))


def _base() -> list[Patch]:
    stone = Finish(STONE, weather=0.9)
    patches = []
    for step in range(3):  # steps over the whole width
        z = 0.16 * step
        reach = 1.75 - 0.33 * step
        slabs = Finish(ASHLAR, 40 + step, 1.0)
        patches += box((-6.6 + 0.2 * step, -reach, z), (6.6 - 0.2 * step, 0.0, z + 0.16), slabs, "fulr")
    ashlar = Finish(ASHLAR, weather=0.9)
    for x0, x1 in ((-6.12, -1.3), (1.3, 6.12)):
        patches += box((x0, -0.14, FLOOR), (x1, 0.0, PLINTH - 0.1), ashlar, "flr")
        profile = np.array([[-0.14, 0.0], [-0.20, 0.02], [-0.20, 0.08], [-0.17, 0.10], [0.0, 0.115]])
        patches.append(extrude(profile + np.array([0.0, PLINTH - 0.1]), x0, x1, stone))
    for x in COLUMNS:  # pedestals
        patches += box((x - 0.42, -0.84, FLOOR), (x + 0.42, -0.14, PLINTH - 0.1), ashlar, "flr")
        patches += box((x - 0.48, -0.90, PLINTH - 0.1), (x + 0.48, -0.10, PLINTH), stone, "fudlr")
    return patches


def _column(x: float, seed: int) -> list[Patch]:
    base, top = PLINTH, EAVES
    stone = Finish(STONE, seed, 0.7)
    patches = box((x - 0.38, COLUMN_Y - 0.38, base), (x + 0.38, COLUMN_Y + 0.38, base + 0.12), stone, "fulr")
    angle = np.linspace(-np.pi / 2, np.pi / 2, 9)
    torus = np.stack([0.31 + 0.07 * np.cos(angle), base + 0.19 + 0.07 * np.sin(angle)], axis=1)
    upper = np.stack([0.285 + 0.04 * np.cos(angle), base + 0.33 + 0.04 * np.sin(angle)], axis=1)
    low, high = base + 0.40, top - 0.52
    share = np.linspace(0.0, 1.0, 14)
    shaft = np.stack([0.275 - 0.045 * share**1.6, low + share * (high - low)], axis=1)
    ring = np.stack([0.235 + 0.03 * np.cos(angle), high + 0.04 + 0.03 * np.sin(angle)], axis=1)
    swell = np.linspace(0.0, 1.0, 12)
    echinus = np.stack([0.235 + 0.16 * swell**2.2, high + 0.08 + 0.28 * swell], axis=1)
    profile = np.concatenate([torus, upper, shaft, ring, echinus])
    patches.append(revolve(profile, (x, COLUMN_Y), stone, sides=44))
    leaf = np.linspace(0.0, 1.0, 7)
    for k in range(10):  # leaves of the capital
        turn = 2 * np.pi * k / 10 + 0.31
        centre = (x + 0.235 * np.sin(turn), COLUMN_Y - 0.235 * np.cos(turn))
        outline = np.stack(
            [0.055 * np.sin(np.pi * (0.15 + 0.83 * leaf)) + 0.012, high + 0.06 + 0.26 * leaf], axis=1
        )
        patches.append(revolve(outline, centre, replace(stone, seed=seed + k), sides=12))
    patches += box((x - 0.42, COLUMN_Y - 0.42, top - 0.16), (x + 0.42, COLUMN_Y + 0.42, top), stone, "fdlr")
    return patches


def _niche(x: float, seed: int) -> list[Patch]:
    z0, spring, radius = FLOOR + 1.35, FLOOR + 3.45, 0.62
    plaster = Finish(PLASTER, seed, 0.6)
    rise = np.linspace(0.0, np.pi / 2 - 0.02, 14)
    dome = np.stack([radius * np.cos(rise), spring + radius * np.sin(rise)], axis=1)
    profile = np.concatenate([[[radius, z0]], dome])
    patches = [revolve(profile, (x, 0.0), plaster, sides=32, span=np.pi, hollow=True)]
    patches.append(
        plane(np.array([x - radius, 0.0, z0]), np.array([2 * radius, 0, 0]), np.array([0, radius, 0]),
              Finish(STONE, seed, 0.8))
    )  # fmt: skip
    patches += box((x - 0.85, -0.12, z0 - 0.16), (x + 0.85, 0.0, z0), Finish(STONE, seed, 0.8), "fudlr")
    patches += _archivolt(x, spring, radius, seed)
    urn = np.array([
        [0.20, 0.0], [0.20, 0.06], [0.10, 0.10], [0.08, 0.18], [0.12, 0.24], [0.24, 0.38], [0.31, 0.56], [0.33, 0.74],
        [0.29, 0.90], [0.19, 1.02], [0.15, 1.10], [0.17, 1.18], [0.25, 1.24], [0.25, 1.28], [0.12, 1.33], [0.03, 1.42],
        [0.002, 1.50],
    ])  # fmt: skip
    dense = np.stack([np.interp(np.linspace(0, 16, 65), np.arange(17), urn[:, k]) for k in range(2)], axis=1)
    dense[:, 1] += z0 + 0.22
    patches.append(revolve(dense, (x, 0.10), Finish(STONE, seed + 3, 0.7), sides=40))
    patches += box((x - 0.28, -0.16, z0), (x + 0.28, 0.36, z0 + 0.22), Finish(ASHLAR, seed, 0.7), "fulr")
    return patches


def _archivolt(x: float, spring: float, radius: float, seed: int) -> list[Patch]:
    """Stone ring round the niche's arch, standing 5 cm proud of the wall, and its two jambs."""
    stone = Finish(STONE, seed + 7, 0.5)
    section = np.array([[0.0, -0.05], [0.17, -0.05], [0.17, 0.0]])  # outwards from the arch, and y
    angle = np.linspace(np.pi, 0.0, 33)
    reach = radius + section[:, :1]
    grid = np.empty((3, 33, 3))
    grid[:, :, 0] = x + reach * np.cos(angle)
    grid[:, :, 1] = section[:, 1:]
    grid[:, :, 2] = spring + reach * np.sin(angle)
    t = np.array([0.0, 0.17, 0.22])
    patches = [curved(grid, np.linspace(0.0, np.pi * (radius + 0.1), 33), t, stone)]
    inner = grid[:2].copy()
    inner[0], inner[1] = grid[0], grid[0]
    inner[0, :, 1] = 0.0
    patches.append(curved(inner, np.linspace(0.0, np.pi * radius, 33), np.array([0.0, 0.05]), stone))
    low = FLOOR + 1.35
    for x0, x1 in ((x - radius - 0.17, x - radius), (x + radius, x + radius + 0.17)):
        patches += box((x0, -0.05, low), (x1, 0.0, spring), stone, "flr")
    return patches


def _door() -> list[Patch]:
    stone, wood = Finish(STONE, 60, 0.7), Finish(WOOD, 61)
    low, top, depth = FLOOR, FLOOR + 3.15, 0.45
    patches = _reveal(-1.05, 1.05, low, top, depth, stone)
    patches.append(plane(np.array([-1.05, depth, low]), np.array([2.1, 0, 0]), np.array([0, 0, 3.15]), wood))
    for x0 in (-0.95, 0.08):
        for z0, z1 in ((0.15, 0.85), (0.97, 1.85), (1.97, 3.0)):
            panel = (x0, depth - 0.06, low + z0), (x0 + 0.87, depth, low + z1)
            patches += box(*panel, wood, "fudlr")
            inner = (x0 + 0.14, depth - 0.10, low + z0 + 0.14), (x0 + 0.73, depth - 0.06, low + z1 - 0.14)
            patches += box(*inner, wood, "fudlr")
    for x0, x1 in ((-1.30, -1.05), (1.05, 1.30)):
        patches += box((x0, -0.10, low), (x1, 0.0, top), stone, "flr")
    patches += box((-1.30, -0.10, top), (1.30, 0.0, top + 0.25), stone, "fdlr")
    profile = np.array([[0.0, 0.0], [-0.12, 0.0], [-0.16, 0.05], [-0.28, 0.12], [-0.30, 0.20], [0.0, 0.24]])
    patches.append(extrude(profile + np.array([0.0, top + 0.25]), -1.45, 1.45, stone))
    return patches


def _window() -> list[Patch]:
    stone, glass = Finish(STONE, 70, 0.7), Finish(GLASS, 71)
    low, top, depth = FLOOR + 4.05, FLOOR + 5.25, 0.30
    patches = _reveal(-0.75, 0.75, low, top, depth, stone)
    patches.append(plane(np.array([-0.75, depth, low]), np.array([1.5, 0, 0]), np.array([0, 0, 1.2]), glass))
    for x in (-0.25, 0.25):
        patches += box((x - 0.04, depth - 0.08, low), (x + 0.04, depth, top), stone, "flr")
    patches += box((-0.75, depth - 0.08, low + 0.56), (0.75, depth, low + 0.64), stone, "fud")
    patches += box((-0.95, -0.07, low - 0.14), (0.95, 0.0, low), stone, "fudlr")
    for x0, x1 in ((-0.92, -0.75), (0.75, 0.92)):
        patches += box((x0, -0.06, low), (x1, 0.0, top), stone, "flr")
    patches += box((-0.92, -0.06, top), (0.92, 0.0, top + 0.16), stone, "fudlr")
    return patches


def _reveal(x0: float, x1: float, z0: float, z1: float, depth: float, finish: Finish) -> list[Patch]:
    """Sides, sill and lintel of a rectangular recess, seen from inside it."""
    into, up, across = (
        np.array([0.0, depth, 0.0]),
        np.array([0.0, 0.0, z1 - z0]),
        np.array([x1 - x0, 0.0, 0.0]),
    )
    return [
        plane(np.array([x0, 0.0, z0]), into, up, finish),
        plane(np.array([x1, depth, z0]), -into, up, finish),
        plane(np.array([x0, 0.0, z0]), across, into, finish),
        plane(np.array([x0, depth, z1]), across, -into, finish),
    ]


def _corners() -> list[Patch]:
    """Rusticated corner blocks, alternately long and short, and the side walls of the building."""
    patches = []
    for side in (-1.0, 1.0):
        for k in range(14):
            z = PLINTH + 0.03 + k * 0.345
            reach = 0.70 if k % 2 == 0 else 0.46
            x0, x1 = sorted((side * 6.05, side * (6.05 - reach)))
            patches += box(
                (x0, -0.07, z), (x1, 0.0, min(z + 0.32, EAVES)), Finish(STONE, 5 * k, 0.9), "fudlr"
            )
    brick = Finish(BRICK, 3, 0.8, 2.0)
    patches.append(plane(np.array([-6.0, 6.0, 0.0]), np.array([0, -6.0, 0]), np.array([0, 0, 7.0]), brick))
    patches.append(plane(np.array([6.0, 0.0, 0.0]), np.array([0, 6.0, 0]), np.array([0, 0, 7.0]), brick))
    return patches


def _entablature() -> list[Patch]:
    stone = Finish(STONE, 80, 1.0)
    z = EAVES
    patches = box((-6.2, -0.80, z), (6.2, 0.0, z + 0.22), stone, "fdlr")
    patches += box((-6.24, -0.84, z + 0.22), (6.24, 0.0, z + 0.46), stone, "fdlr")
    patches += box((-6.2, -0.78, z + 0.46), (6.2, 0.0, z + 0.92), Finish(ASHLAR, 81, 1.0), "flr")
    for k in range(7):  # medallions on the frieze
        x = -5.4 + 1.8 * k
        patches += box(
            (x - 0.30, -0.83, z + 0.54), (x + 0.30, -0.78, z + 0.84), Finish(STONE, 82 + k, 0.6), "fudlr"
        )
        for dx in (-0.15, 0.0, 0.15):
            low, high = (x + dx - 0.045, -0.87, z + 0.57), (x + dx + 0.045, -0.83, z + 0.81)
            patches += box(low, high, Finish(STONE, 90 + k, 0.6), "fudlr")
    for k in range(44):  # dentils
        x = -6.1 + 12.2 * k / 43
        patches += box(
            (x - 0.08, -0.95, z + 0.94), (x + 0.08, -0.78, z + 1.08), Finish(STONE, 3 * k, 0.6), "fdlr"
        )
    profile = np.array([
        [-0.78, 0.92], [-0.80, 0.93], [-0.80, 1.08], [-1.02, 1.09], [-1.12, 1.14], [-1.12, 1.26], [-1.16, 1.28],
        [-1.22, 1.34], [-1.30, 1.38], [-1.30, 1.43], [-0.55, 1.50],
    ])  # fmt: skip
    patches.append(extrude(profile + np.array([0.0, z]), -6.45, 6.45, stone))
    patches += box((-6.0, -0.55, z + 1.44), (6.0, 0.3, z + 2.0), Finish(ASHLAR, 83, 1.0), "fulr")
    for x in (-5.7, -1.9, 1.9, 5.7):
        patches += box((x - 0.3, -0.62, z + 1.44), (x + 0.3, 0.37, z + 2.12), Finish(STONE, 84, 1.0), "fulr")
    return patches


def _ground() -> list[Patch]:
    patches = [
        plane(np.array([-9.0, -6.0, 0.0]), np.array([18.0, 0, 0]), np.array([0, 6.0, 0]), Finish(PAVING, 95, 0.6, 1.5)),
        plane(np.array([-45.0, -30.0, -0.02]), np.array([60.0, 0, 0]), np.array([0, 54.0, 0]),
              Finish(GROUND, 96, 0.0, 8.0), cell=2.0),
    ]  # fmt: skip
    brick = Finish(BRICK, 97, 0.9, 2.0)
    for x0, x1 in ((-14.0, -6.0), (6.0, 14.0)):  # garden walls
        patches += box((x0, 1.2, 0.0), (x1, 1.5, 2.3), brick, "flr")
        patches += box((x0 - 0.05, 1.12, 2.3), (x1 + 0.05, 1.58, 2.42), Finish(STONE, 98, 0.9, 2.0), "fulr")
    return patches


TARGETS: tuple[tuple[float, float, float], ...] = (
    (-5.0, 0.0, 1.75), (-5.0, 0.0, 5.1), (-2.52, 0.0, 1.46), (-2.25, 0.0, 5.3), (-1.18, 0.0, 4.55), (1.18, 0.0, 4.55),
    (2.52, 0.0, 1.46), (2.25, 0.0, 5.3), (5.0, 0.0, 1.75), (5.0, 0.0, 5.1), (-3.1, -0.14, 0.85), (3.1, -0.14, 0.85),
    (-4.45, -0.84, 0.86), (-1.75, -0.84, 0.86), (1.75, -0.84, 0.86), (4.45, -0.84, 0.86), (-3.75, -0.55, 7.82),
    (0.0, -0.55, 7.82), (3.75, -0.55, 7.82), (-4.5, -0.78, 6.80), (4.5, -0.78, 6.80),
)  # fmt: skip
"""Centres of the control targets, m; each lies on a face towards −y."""


def _with_targets(patches: list[Patch]) -> list[Patch]:
    placed: dict[int, list[tuple[int, float, float, float]]] = {}
    for number, centre in enumerate(TARGETS, start=1):
        index, s, t = _face_at(patches, np.array(centre))
        placed.setdefault(index, []).append((number, s, t, TARGET_DIAMETER))
    return [
        replace(patch, targets=tuple(placed[index])) if index in placed else patch
        for index, patch in enumerate(patches)
    ]


def _face_at(patches: list[Patch], centre: Array) -> tuple[int, float, float]:
    for index, patch in enumerate(patches):
        low, high = patch.grid.reshape(-1, 3).min(axis=0), patch.grid.reshape(-1, 3).max(axis=0)
        flat = high[1] - low[1] < 1e-9 and patch.grid.shape[:2] == (2, 2)
        if flat and (centre >= low - 1e-9).all() and (centre <= high + 1e-9).all():
            return index, float(centre[0] - low[0]), float(centre[2] - low[2])
    raise ValueError(f"no face towards the viewer at {centre}")
