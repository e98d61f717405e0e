"""The reduced normal equations: built by chunks in threads, solved by Cholesky, points by back-substitution."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.linalg import lapack
from threadpoolctl import ThreadpoolController

from graphos_core.adjustment.bundle import kernels, reduction_kernels, step_kernels
from graphos_core.adjustment.bundle.kernels import Layout, Rules, Scene
from graphos_core.adjustment.bundle.known import assembly
from graphos_core.adjustment.bundle.problem import Problem
from graphos_core.data import Array

SMALLEST_DIAGONAL = 1e-9
"""Floor of the damped diagonal, so that an unknown nobody observes keeps its value."""


@dataclass(frozen=True)
class Equations:
    """Normal equations at one scene, points eliminated.

    Attributes
    ----------
    scene : Scene
    matrix : float64 (u, u)
        Reduced matrix, upper triangle.
    gradient, reduced_gradient, diagonal : float64 (u,)
        ``Jᵀv`` of the reduced unknowns before and after the elimination, diagonal of JᵀJ before it.
    cost : float
        ½ Σ ρ, px².
    largest_gradient : float
        Largest element of the gradient, points included, absolute.
    visible : int
        Observations in front of their cameras.
    """

    scene: Scene
    matrix: Array
    gradient: Array
    reduced_gradient: Array
    diagonal: Array
    cost: float
    largest_gradient: float
    visible: int


@dataclass(frozen=True)
class Moved:
    """A scene after a step.

    Attributes
    ----------
    scene : Scene
    cost : float
        ½ Σ ρ over the observations that were in front of their cameras before the step.
    predicted : float
        Decrease of the cost predicted by the linear model.
    lost : int
        Observations that the step carried behind a camera.
    step, size : float
        Norms of the step and of the unknowns.
    scaled : float
        Norm of the step in the metric of the diagonal of JᵀJ: what a trust region is measured in.
    """

    scene: Scene
    cost: float
    predicted: float
    lost: int
    step: float
    size: float
    scaled: float


class ReducedSystem:
    """Builds and solves the reduced normal equations of one problem.

    Results do not depend on `threads`: chunks are fixed by the problem and summed in order.
    """

    def __init__(self, problem: Problem, rules: Rules, threads: int) -> None:
        self.problem = problem
        self.rules = rules
        self._threads = min(threads, len(problem.chunks))
        self._pool: ThreadPoolExecutor | None = None
        u = problem.unknowns
        self._matrices = [np.empty((u, u)) for _ in problem.chunks]
        layout = problem.layout
        first = [int(layout.photo_column[layout.photo[layout.start[span[0]]]]) for span in problem.chunks]
        self._first_rows = [0, *first[1:]]  # points are sorted by photo: a chunk leaves earlier rows alone

    @contextmanager
    def working(self) -> Iterator[ReducedSystem]:
        """Hold the threads, and BLAS to one thread, as long as the context lasts."""
        with _blas().limit(limits=1, user_api="blas"):
            if self._threads == 1:
                yield self
                return
            with ThreadPoolExecutor(self._threads) as pool:
                self._pool = pool
                try:
                    yield self
                finally:
                    self._pool = None

    def each_chunk(self, function: Callable[[int], Any]) -> list[Any]:
        """Call ``function(chunk)`` for every chunk and return the results in order."""
        count = range(len(self.problem.chunks))
        return [function(c) for c in count] if self._pool is None else list(self._pool.map(function, count))

    def build(self, scene: Scene, damping: float) -> Equations:
        """Return the reduced normal equations at `scene` with points damped by `damping`."""
        layout, u = self.problem.layout, self.problem.unknowns

        def one(chunk: int) -> tuple[Array, Array]:
            matrix = self._matrices[chunk]
            matrix[self._first_rows[chunk] :] = 0.0
            vectors, totals = np.zeros((3, u)), np.zeros(7)
            span = self.problem.chunks[chunk]
            reduction_kernels.build(scene, layout, self.rules, damping, span, matrix, vectors, totals)
            return vectors, totals

        parts = self.each_chunk(one)
        matrix = self._matrices[0]
        for row, other in zip(self._first_rows[1:], self._matrices[1:], strict=True):
            matrix[row:] += other[row:]
        vectors = sum(part[0] for part in parts)
        totals = [part[1] for part in parts]
        cost = float(sum(t[kernels.COST] for t in totals))
        if self.problem.groups:
            cost += self._add_others(scene, matrix, vectors)
        gradient = vectors[0]
        largest = max(
            [float(np.abs(gradient).max(initial=0.0)), *(float(t[kernels.GRADIENT]) for t in totals)]
        )
        return Equations(
            scene, matrix, gradient, vectors[0] + vectors[1], vectors[2], cost, largest,
            int(sum(t[kernels.VISIBLE] for t in totals)),
        )  # fmt: skip

    def _add_others(self, scene: Scene, matrix: Array, vectors: Array) -> float:
        """Add the other observations to the upper triangle, the gradient and the diagonal; return their cost."""
        found = assembly.linearise(self.problem, scene)
        if found is None:
            return 0.0
        residuals, jacobian = found.weighted
        normal = (jacobian.T @ jacobian).tocoo()
        upper = normal.row <= normal.col
        matrix[normal.row[upper], normal.col[upper]] += normal.data[upper]
        vectors[0] += jacobian.T @ residuals
        vectors[2] += normal.diagonal()
        return found.cost

    def solve(self, equations: Equations, damping: float) -> Array | None:
        """Return the step of the reduced unknowns, or None where the damped matrix is not positive definite.

        Overwrites ``equations.matrix``.
        """
        u = self.problem.unknowns
        if u == 0:
            return np.empty(0)
        matrix = equations.matrix
        matrix.flat[:: u + 1] += damping * equations.diagonal + SMALLEST_DIAGONAL * (
            equations.diagonal == 0.0
        )
        factor, info = lapack.dpotrf(matrix.T, lower=1, clean=0, overwrite_a=1)
        if info != 0:
            return None
        step, _ = lapack.dpotrs(factor, -equations.reduced_gradient, lower=1)
        return step if np.isfinite(step).all() else None

    def move(
        self,
        scene: Scene,
        equations: Equations,
        damping: float,
        step: Array,
        shares: tuple[float, float] = (1.0, 0.0),
        down: Array | None = None,
    ) -> Moved:
        """Return the scene moved by `step`, its points by back-substitution.

        Parameters
        ----------
        scene, equations, damping
            What `step` was computed from.
        step : float64 (u,)
            Share of the full step of the reduced unknowns.
        shares : (float, float)
            Of the full step and of steepest descent, for the points; `Moved.predicted` holds for (1, 0) only.
        down : float64 (u,), optional
            Share of steepest descent of the reduced unknowns.
        """
        layout = self.problem.layout
        moved = Scene(*(np.empty_like(part) for part in scene))
        shift = np.zeros((len(layout.pose), 3))
        whole = step if down is None else step + down
        step_kernels.move_photos(scene, layout, whole, moved, shift)
        if down is not None:
            shift = _shifts(scene, layout, step)
        moved.extra[:] = scene.extra + whole[len(whole) - len(scene.extra) :]
        rest = np.zeros(len(step)) if down is None else down

        def one(chunk: int) -> Array:
            totals = np.zeros(8)
            span = self.problem.chunks[chunk]
            step_kernels.substitute(
                scene, layout, self.rules, damping, span, step, rest, shift, shares, moved, totals
            )
            return totals

        totals = sum(self.each_chunk(one))
        cost = float(totals[kernels.COST]) + assembly.cost(self.problem, moved)
        predicted = 0.5 * float(step @ (damping * equations.diagonal * step - equations.gradient))
        size = float(totals[kernels.SIZE2]) + float((scene.centres**2).sum()) + float((scene.values**2).sum())
        return Moved(
            moved, cost, predicted + float(totals[kernels.PREDICTED]),
            int(totals[kernels.LOST]), float(np.sqrt(totals[kernels.STEP2] + whole @ whole)), float(np.sqrt(size)),
            float(np.sqrt(totals[kernels.SCALED2] + whole @ (equations.diagonal * whole))),
        )  # fmt: skip

    def steepest(self, scene: Scene, equations: Equations) -> tuple[Array, float, float]:
        """Return the direction of steepest descent −D⁻¹ g (u,) of the reduced unknowns, gᵀD⁻¹g and |J d|² of all.

        D is the diagonal of JᵀJ.
        """
        direction = -equations.gradient / np.where(equations.diagonal > 0, equations.diagonal, 1.0)

        def one(chunk: int) -> Array:
            totals = np.zeros(2)
            span = self.problem.chunks[chunk]
            step_kernels.steepest(scene, self.problem.layout, self.rules, span, direction, totals)
            return totals

        descent, curvature = sum(self.each_chunk(one))
        others = assembly.linearise(self.problem, scene)
        if others is not None:
            curvature += float(((others.weighted[1] @ direction) ** 2).sum())
        return direction, float(descent - equations.gradient @ direction), float(curvature)


def _shifts(scene: Scene, layout: Layout, step: Array) -> Array:
    """Return R δC (n, 3) of each photo."""
    out = np.zeros((len(layout.pose), 3))
    free = np.flatnonzero(layout.pose > 0)
    moved = step[layout.photo_column[free][:, None] + np.arange(3, 6)]
    out[free] = np.einsum("nij,nj->ni", scene.rotations[free], moved)
    return out


@cache
def _blas() -> ThreadpoolController:
    """Return the controller of the BLAS libraries; made once, because looking for them takes milliseconds."""
    return ThreadpoolController()
