"""What holds a block: control, the free motions that are left, and the precision in the chosen datum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from graphos_core.adjustment.bundle import datum
from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.known.group import Group
from graphos_core.adjustment.bundle.known.points import Coordinates, Distances
from graphos_core.adjustment.bundle.problem import Freedom, make_problem
from graphos_core.adjustment.bundle.rank import datum_findings
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_core.data import Adjustment, Block
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_didactic.simulators.adjustment.datum_params import CORNERS, DatumParams
from graphos_didactic.simulators.adjustment.four_photos import POINTS_XYZ, four_photos
from graphos_didactic.simulators.adjustment.small_block import Equations, equations

AXES: dict[str, tuple[int, ...]] = {"none": (), "height": (2,), "position": (0, 1), "full": (0, 1, 2)}
NAMES = (
    "shift along X",
    "shift along Y",
    "shift along Z",
    "turn about X",
    "turn about Y",
    "turn about Z",
    "scale",
)
REACH = 1.3
"""A free motion of full amount moves the farthest point by so much, m."""


@dataclass(frozen=True)
class Motion:
    """A motion of the whole block that no observation notices.

    Attributes
    ----------
    name : str
    pivot : float64 (3,)
        Turns and scale are about this place, m.
    shift, turn : float64 (3,)
        m and radians at full amount.
    scale : float
        Change of scale at full amount.
    """

    name: str
    pivot: Array
    shift: Array
    turn: Array
    scale: float

    def of(self, amount: float) -> Similarity:
        """Return the finite motion of part `amount`."""
        rotation, scale = matrix_from_vector(amount * self.turn), 1.0 + amount * self.scale
        return Similarity(scale, rotation, self.pivot + amount * self.shift - scale * rotation @ self.pivot)


@dataclass(frozen=True, eq=False)
class Held:
    """The block of a parameter sheet."""

    params: DatumParams

    @cached_property
    def block(self) -> Block:
        """Measured, from true values."""
        block = four_photos(4, self.params.sigma_px, self.params.seed).as_block()
        return replace(block, obs_sigma_px=np.full(len(block.obs_xy), self.params.sigma_px))

    @property
    def roles(self) -> dict[int, str]:
        """What is known of each corner, by its number."""
        return {n: str(getattr(self.params, f"p{n}")) for n in CORNERS}

    @cached_property
    def known(self) -> tuple[tuple[int, int], ...]:
        """Point (from 0) and axis of every known coordinate."""
        return tuple((n - 1, axis) for n, role in self.roles.items() for axis in AXES[role])

    @property
    def count(self) -> int:
        """Known numbers: coordinates and the distance."""
        return len(self.known) + int(self.params.distance)

    @property
    def given(self) -> Array:
        """Coordinates as they are given, with the error of point 1, float64 (9, 3), m."""
        out = POINTS_XYZ.copy()
        out[0, :2] += np.array([self.params.wrong_x, self.params.wrong_y]) * 1e-3
        return out

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """What is known, as observations."""
        sigma, made = self.params.control_mm * 1e-3, []
        if self.known:
            point, axis = np.array(self.known, dtype=np.int64).T
            labels = tuple(f"{p + 1} {'XYZ'[a]}" for p, a in self.known)
            made.append(Coordinates(point, axis, self.given[point, axis], np.full(len(point), sigma), labels))
        if self.params.distance:
            a, b = np.array([0]), np.array([2])
            length = np.array([float(np.linalg.norm(POINTS_XYZ[2] - POINTS_XYZ[0]))])
            made.append(Distances(a, b, length, np.array([sigma]), ("1–3",)))  # type: ignore[arg-type]
        return tuple(made)

    @cached_property
    def adjustment(self) -> Adjustment:
        """The adjusted block, without statistics."""
        return adjust_block(self.block, Freedom(), Options(statistics=False), self.groups)

    @cached_property
    def free(self) -> Adjustment:
        """The block adjusted without anything known."""
        return adjust_block(self.block, Freedom(), Options(statistics=False))

    @cached_property
    def equations(self) -> Equations:
        """The normal equations in the chosen datum."""
        return equations(self.adjustment.block, Freedom(), self.groups, self.params.kind)

    @property
    def defect(self) -> int:
        """Number of free motions."""
        return self.equations.cofactors.defect

    @cached_property
    def covariances(self) -> Array:
        """Covariance of every point with the a priori σ, float64 (9, 3, 3), m²."""
        found = self.equations
        out = np.empty((len(POINTS_XYZ), 3, 3))
        out[found.problem.order] = found.cofactors.points
        return out

    @property
    def sigmas(self) -> Array:
        """Standard deviation of every point in space, √(σ_X² + σ_Y² + σ_Z²), float64 (9,), m."""
        return np.sqrt(np.maximum(np.einsum("pii->p", self.covariances), 0.0))

    @cached_property
    def bending(self) -> float:
        """How far the shape is from that of the free network, RMS per coordinate after the best similarity, m."""
        points, free = (np.asarray(a.block.points) for a in (self.adjustment, self.free))
        return float(np.sqrt(((estimate_similarity(points, free).apply(points) - free) ** 2).mean()))

    @cached_property
    def spectrum(self) -> Array:
        """Eigenvalues of the reduced normal matrix with unit diagonal, largest first, relative to the largest."""
        system = ReducedSystem(self.equations.problem, Rules(ROBUST["none"].code, 1.0, True), 1)
        with system.working():
            upper = np.triu(system.build(self.equations.problem.scene, 0.0).matrix)
        scale = np.sqrt(np.maximum(upper.diagonal(), 1e-300))
        values = np.linalg.eigvalsh((upper + np.triu(upper, 1).T) / scale[:, None] / scale)[::-1]
        return np.asarray(np.maximum(values / values[0], 1e-17))

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """The free motions in words: the engine's null space, sorted out into turns, shifts and scale."""
        if self.defect == 0:
            return ()
        block = self.adjustment.block
        problem = self.equations.problem
        columns = 6 * len(block.names)  # photos stand first
        free = make_problem(block, Freedom())
        elementary = datum.gauge(free, free.scene)[:columns]
        parts = np.linalg.lstsq(elementary, self.equations.cofactors.null[:columns], rcond=None)[0].T
        centres = problem.scene.centres
        size = float(np.abs(centres - centres.mean(axis=0)).max())
        parts = parts * np.array(
            [size] * 3 + [1.0] * 4
        )  # the engine counts shifts in units of the block's size
        return tuple(self._motion(row) for row in _sparse(_about(parts, self._pivot - centres.mean(axis=0))))

    @property
    def advice(self) -> str:
        """What the engine says about the free motions, and what would fix them; empty where nothing is free."""
        found, problem = self.equations.cofactors, self.equations.problem
        return " ".join(f"{f.what} {f.todo}" for f in datum_findings(found.null, problem.scene, problem))

    @property
    def _pivot(self) -> Array:
        full = [n - 1 for n, role in self.roles.items() if role == "full"]
        known = full or [n - 1 for n, role in self.roles.items() if role != "none"]
        place = np.asarray(self.adjustment.block.points)[known[0]] if known else np.zeros(3)
        return np.asarray(place)

    def _motion(self, row: Array) -> Motion:
        shift, turn, scale = row[:3], row[3:6], float(row[6])
        arms = np.asarray(self.adjustment.block.points) - self._pivot
        moved = shift + np.cross(turn, arms) + scale * arms
        size = REACH / max(float(np.linalg.norm(moved, axis=1).max()), 1e-12)
        return Motion(_name(row), self._pivot, shift * size, turn * size, scale * size)

    @property
    def shown(self) -> Motion | None:
        """The free motion that is shown; None when nothing is free."""
        return self.motions[min(self.params.motion, self.defect) - 1] if self.motions else None


def _about(parts: Array, pivot: Array) -> Array:
    """Return motions (d, 7) given about one place as motions about another, `pivot` away from it."""
    out = parts.copy()
    out[:, :3] += np.cross(parts[:, 3:6], pivot) + parts[:, 6:] * pivot
    return out


def _sparse(rows: Array) -> Array:
    """Return a basis (d, 7) of the same space with as few parts per row as elimination gives, scale first."""
    rows = rows.copy()
    done = 0
    for column in (6, 5, 4, 3, 0, 1, 2):
        if done == len(rows):
            break
        pivot = done + int(np.argmax(np.abs(rows[done:, column])))
        if abs(rows[pivot, column]) < 1e-7 * np.abs(rows).max():
            continue
        rows[[done, pivot]] = rows[[pivot, done]]
        rows[done] /= rows[done, column]
        others = np.arange(len(rows)) != done
        rows[others] -= rows[others, column, None] * rows[done]
        done += 1
    rows[np.abs(rows) < 1e-7] = 0.0
    return rows


def _name(row: Array) -> str:
    """Return a motion in words."""
    parts = np.flatnonzero(np.abs(row) > 1e-6)
    if len(parts) == 1:
        return NAMES[parts[0]]
    if not np.any(np.abs(row[[0, 1, 2, 6]]) > 1e-6):
        way = row[3:6] / np.linalg.norm(row[3:6])
        return "turn about the axis ({:.2f}, {:.2f}, {:.2f})".format(*way).replace("-", "−")
    return " with ".join(NAMES[i] for i in parts)
