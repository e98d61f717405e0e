"""Patches: rectangles of texture laid over planes, extrusions and bodies of revolution, as triangles."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from graphos_core.data.record import Array

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Patch:
    """A surface with coordinates (s, t) in metres over which one texture tile is laid.

    Attributes
    ----------
    grid : float64 (m, n, 3)
        Positions on the lattice of `t_knots` × `s_knots`, m; the outside is where ∂P/∂s × ∂P/∂t points.
    s_knots, t_knots : float64 (n,), (m,)
        Increasing, starting at 0, metres along the surface.
    material : int
        See `graphos_core.simulation.texture_kernels`.
    st : float64 (v, 2)
        (s, t) of the mesh vertices; their positions are bilinear in the lattice.
    triangles : int32 (f, 3)
        Counter-clockwise seen from outside.
    s0, t0 : float
        Added to (s, t) before the material is asked, so that masonry runs on over neighbouring patches.
    seed : int
        Variant of the material.
    coarse : float
        Texels of this patch are so many times larger than the scene's.
    weather : float
        Strength of stains and streaks, 0 to 1.
    """

    grid: Array
    s_knots: Array
    t_knots: Array
    material: int
    st: Array
    triangles: Array
    s0: float = 0.0
    t0: float = 0.0
    seed: int = 0
    coarse: float = 1.0
    weather: float = 0.0
    targets: tuple[tuple[int, float, float, float], ...] = field(default=())
    """Painted targets: number, s, t of the centre, and diameter, metres."""

    def at(self, st: Array) -> Array:
        """Return positions (n, 3) of (s, t) (n, 2), bilinear in the lattice, m."""
        st = np.asarray(st, dtype=np.float64)
        j = np.clip(np.searchsorted(self.s_knots, st[:, 0], side="right") - 1, 0, len(self.s_knots) - 2)
        i = np.clip(np.searchsorted(self.t_knots, st[:, 1], side="right") - 1, 0, len(self.t_knots) - 2)
        u = ((st[:, 0] - self.s_knots[j]) / (self.s_knots[j + 1] - self.s_knots[j]))[:, None]
        v = ((st[:, 1] - self.t_knots[i]) / (self.t_knots[i + 1] - self.t_knots[i]))[:, None]
        low = self.grid[i, j] * (1 - u) + self.grid[i, j + 1] * u
        high = self.grid[i + 1, j] * (1 - u) + self.grid[i + 1, j + 1] * u
        result: Array = low * (1 - v) + high * v
        return result

    @property
    def size(self) -> tuple[float, float]:
        """Extent in s and t, m."""
        return float(self.s_knots[-1]), float(self.t_knots[-1])


@dataclass(frozen=True)
class Finish:
    """What a patch is made of: material, variant, weathering, texel factor."""

    material: int
    seed: int = 0
    weather: float = 0.0
    coarse: float = 1.0


def lattice_mesh(s_knots: Array, t_knots: Array) -> tuple[Array, Array]:
    """Return vertices (s, t) (v, 2) and triangles (f, 3) of a full lattice."""
    n, m = len(s_knots), len(t_knots)
    st = np.stack(np.meshgrid(s_knots, t_knots), axis=-1).reshape(-1, 2)
    corner = (np.arange(m - 1)[:, None] * n + np.arange(n - 1)[None, :]).reshape(-1)
    lower = np.stack([corner, corner + 1, corner + n + 1], axis=1)
    upper = np.stack([corner, corner + n + 1, corner + n], axis=1)
    return st, np.concatenate([lower, upper]).astype(np.int32)


def curved(grid: Array, s_knots: Array, t_knots: Array, finish: Finish) -> Patch:
    """Return a patch whose mesh is its lattice."""
    st, triangles = lattice_mesh(s_knots, t_knots)
    return Patch(np.asarray(grid, dtype=np.float64), s_knots, t_knots, finish.material, st, triangles,
                 seed=finish.seed, weather=finish.weather, coarse=finish.coarse)  # fmt: skip


def plane(
    origin: Array,
    along: Array,
    up: Array,
    finish: Finish,
    *,
    offset: tuple[float, float] = (0.0, 0.0),
    cell: float = 1.0,
) -> Patch:
    """Return a parallelogram from `origin` along the vectors `along` and `up` (m); outside is ``along × up``."""
    origin, along, up = (np.asarray(v, dtype=np.float64) for v in (origin, along, up))
    width, height = float(np.linalg.norm(along)), float(np.linalg.norm(up))
    corners = np.array([[origin, origin + along], [origin + up, origin + along + up]])
    s = np.linspace(0.0, width, max(2, int(np.ceil(width / cell)) + 1))
    t = np.linspace(0.0, height, max(2, int(np.ceil(height / cell)) + 1))
    st, triangles = lattice_mesh(s, t)
    return Patch(corners, np.array([0.0, width]), np.array([0.0, height]), finish.material, st, triangles,
                 s0=offset[0], t0=offset[1], seed=finish.seed, weather=finish.weather,
                 coarse=finish.coarse)  # fmt: skip


def box(low: Point, high: Point, finish: Finish, faces: str = "fudlr") -> list[Patch]:
    """Return faces of a box from `low` to `high`: f(ront, −y), b(ack), u(p), d(own), l(eft, −x), r(ight)."""
    (x0, y0, z0), (x1, y1, z1) = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    x, y, z = np.diag([x1 - x0, y1 - y0, z1 - z0])
    made = {
        "f": ((x0, y0, z0), x, z, (x0, z0)),
        "b": ((x1, y1, z0), -x, z, (-x1, z0)),
        "l": ((x0, y1, z0), -y, z, (-y1, z0)),
        "r": ((x1, y0, z0), y, z, (y0, z0)),
        "u": ((x0, y0, z1), x, y, (x0, y0)),
        "d": ((x0, y1, z0), x, -y, (x0, -y1)),
    }
    return [
        plane(np.array(made[face][0]), made[face][1], made[face][2], finish, offset=made[face][3])
        for face in faces
    ]


def revolve(
    profile: Array,
    axis: tuple[float, float],
    finish: Finish,
    *,
    sides: int = 40,
    span: float = 2 * np.pi,
    hollow: bool = False,
) -> Patch:
    """Return a body of revolution about a vertical axis.

    Parameters
    ----------
    profile : float64 (m, 2)
        Radius and height, m, from bottom to top.
    axis : (x, y)
        Where the axis stands, m.
    finish : Finish
    sides : int
        Facets round the axis.
    span : float
        Angle covered, radians, centred on −y (the front).
    hollow : bool
        The inside of a niche instead: centred on +y, with the normal towards the axis.
    """
    profile = np.asarray(profile, dtype=np.float64)
    angle = np.linspace(-span / 2, span / 2, sides + 1)
    direction = np.stack([np.sin(angle), np.cos(angle) if hollow else -np.cos(angle)], axis=1)
    grid = np.empty((len(profile), sides + 1, 3))
    grid[:, :, 0] = axis[0] + profile[:, :1] * direction[:, 0]
    grid[:, :, 1] = axis[1] + profile[:, :1] * direction[:, 1]
    grid[:, :, 2] = profile[:, 1:]
    steps = np.maximum(np.linalg.norm(np.diff(profile, axis=0), axis=1), 1e-4)
    t_knots = np.concatenate([[0.0], np.cumsum(steps)])
    s_knots = np.linspace(0.0, span * float(profile[:, 0].max()), sides + 1)
    return curved(grid, s_knots, t_knots, finish)


def extrude(profile: Array, x0: float, x1: float, finish: Finish, *, cell: float = 1.0) -> Patch:
    """Return a moulding: a profile (m, 2) of (y, z) from bottom to top, drawn along x from `x0` to `x1`, m."""
    profile = np.asarray(profile, dtype=np.float64)
    x = np.linspace(x0, x1, max(2, int(np.ceil((x1 - x0) / cell)) + 1))
    grid = np.empty((len(profile), len(x), 3))
    grid[:, :, 0] = x
    grid[:, :, 1] = profile[:, :1]
    grid[:, :, 2] = profile[:, 1:]
    steps = np.maximum(np.linalg.norm(np.diff(profile, axis=0), axis=1), 1e-4)
    return curved(grid, x - x0, np.concatenate([[0.0], np.cumsum(steps)]), finish)


def pierced(
    origin: Array,
    width: float,
    height: float,
    openings: list[tuple[float, float, float, float, bool]],
    finish: Finish,
) -> Patch:
    """Return an upright wall towards −y with openings.

    Parameters
    ----------
    origin : (3,)
        Lower left corner, m.
    width, height : float
        Extent, m.
    openings : list of (s0, s1, t0, t1, arched)
        Openings in wall coordinates, m; an arched one ends in a half circle of diameter s1 − s0 above t1.
    finish : Finish
    """
    s_cuts, t_cuts = [0.0, width], [0.0, height]
    for s0, s1, t0, t1, arched in openings:
        s_cuts += [s0, s1]
        t_cuts += [t0, t1] + ([t1 + (s1 - s0) / 2] if arched else [])
        if arched:
            s_cuts += list(arch_stations(s0, s1))
    s_knots, t_knots = _refine(s_cuts), _refine(t_cuts)
    st, triangles = lattice_mesh(s_knots, t_knots)
    centre = st[triangles].mean(axis=1)
    keep = np.ones(len(triangles), dtype=bool)
    for s0, s1, t0, t1, arched in openings:
        top = t1 + (s1 - s0) / 2 if arched else t1
        inside = (centre > [s0, t0]).all(axis=1) & (centre < [s1, top]).all(axis=1)
        keep &= ~inside
    vertices, faces = [st], [triangles[keep]]
    for s0, s1, _, t1, arched in openings:
        if arched:
            more, these = _spandrels(s0, s1, t1, sum(len(v) for v in vertices))
            vertices.append(more)
            faces.append(these)
    x, z = np.array([width, 0.0, 0.0]), np.array([0.0, 0.0, height])
    flat = plane(origin, x, z, finish, offset=(float(origin[0]), float(origin[2])))
    return Patch(flat.grid, flat.s_knots, flat.t_knots, finish.material, np.concatenate(vertices),
                 np.concatenate(faces).astype(np.int32), s0=flat.s0, t0=flat.t0, seed=finish.seed,
                 weather=finish.weather, coarse=finish.coarse)  # fmt: skip


def arch_stations(s0: float, s1: float, pieces: int = 24) -> Array:
    """Return where along s a half circle over [s0, s1] is cut into facets."""
    result: Array = 0.5 * (s0 + s1) - 0.5 * (s1 - s0) * np.cos(np.linspace(0.0, np.pi, pieces + 1))
    return result


def _spandrels(s0: float, s1: float, spring: float, first: int) -> tuple[Array, Array]:
    s = arch_stations(s0, s1)
    radius = (s1 - s0) / 2
    arc = spring + np.sqrt(np.maximum(radius**2 - (s - (s0 + s1) / 2) ** 2, 0.0))
    st = np.concatenate([np.stack([s, arc], axis=1), np.stack([s, np.full_like(s, spring + radius)], axis=1)])
    n = len(s)
    corner = np.arange(n - 1) + first
    lower = np.stack([corner, corner + 1, corner + n + 1], axis=1)
    upper = np.stack([corner, corner + n + 1, corner + n], axis=1)
    return st, np.concatenate([lower, upper])


def _refine(cuts: list[float], cell: float = 0.8) -> Array:
    edges = np.unique(np.round(cuts, 9))
    parts = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / cell))), endpoint=False) for a, b in pairwise(edges)
    ]
    return np.append(np.concatenate(parts), edges[-1])
