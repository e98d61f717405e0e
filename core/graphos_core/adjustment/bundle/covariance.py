"""Cofactors of the unknowns from the reduced normal equations; never the full inverse.

With N the reduced matrix, G its null space and the inner constraints ``Cᵀx = 0`` with ``C = E G``, the cofactor
matrix is ``Q = (N + C Cᵀ)⁻¹ − G (CᵀG)⁻¹ (GᵀC)⁻¹ Gᵀ`` (Koch 1999, section 3.5; Förstner and Wrobel 2016, section 4.5).
Because the constraints concern reduced unknowns only, points follow from Q point by point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from graphos_core.adjustment.bundle import datum, result_kernels
from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.data import Array

SMALLEST_PIVOT = 1e-13
"""Relative pivot of the scaled reduced matrix below which an unknown counts as undetermined."""


@dataclass(frozen=True)
class Cofactors:
    """Cofactor matrices (covariances for sigma0 = 1 px) of one adjusted problem.

    Attributes
    ----------
    reduced : float64 (u, u)
        Of the reduced unknowns in the order of the problem's layout.
    points : float64 (p, 3, 3)
        Of the object points in the order of the solver; infinite where the rays do not fix a point.
    defect : int
        Datum defect d: conditions added.
    datum : str
        How the datum was defined.
    singular : bool
        Whether more than the datum was undetermined; a pseudo-inverse was then taken.
    """

    reduced: Array
    points: Array
    defect: int
    datum: str
    singular: bool


def cofactors(system: ReducedSystem, scene: Scene) -> Cofactors:
    """Return the cofactors of all unknowns at `scene`.

    Parameters
    ----------
    system : ReducedSystem
        Inside its working context.
    scene : Scene
        Adjusted.
    """
    problem = system.problem
    equations = system.build(scene, 0.0)
    null = datum.gauge(problem, scene)
    weights = datum.datum_weights(problem, scene)
    reduced, singular = _inverse(equations.matrix, null, weights)
    points = np.zeros((len(scene.points), 3, 3))

    def one(chunk: int) -> None:
        span = problem.chunks[chunk]
        result_kernels.point_covariances(scene, problem.layout, system.rules, span, reduced, points)

    system.each_chunk(one)
    defect = null.shape[1]
    return Cofactors(reduced, points, defect, datum.describe(problem, defect), singular)


def _inverse(matrix: Array, null: Array, weights: Array) -> tuple[Array, bool]:
    """Invert the reduced matrix (upper triangle) under inner constraints; scaled to unit diagonal first."""
    u = len(matrix)
    if u == 0:
        return np.zeros((0, 0)), False
    scale = np.sqrt(np.maximum(matrix.diagonal(), 0.0))
    scale[scale == 0.0] = 1.0
    scaled = np.triu(matrix) / scale[:, None] / scale
    constraints = np.linalg.qr(weights[:, None] * null / scale[:, None])[0]
    motion = null * scale[:, None]
    regular = scaled + np.triu(constraints @ constraints.T)
    factor, info = lapack.dpotrf(regular.T, lower=1, clean=0)
    singular = bool(info != 0 or np.any(factor.diagonal() ** 2 < SMALLEST_PIVOT))
    if singular:
        full = regular + np.triu(regular, 1).T
        inverse = np.linalg.pinv(full, rcond=SMALLEST_PIVOT, hermitian=True)
    else:
        half, _ = lapack.dpotri(factor, lower=1, overwrite_c=1)
        inverse = np.tril(half) + np.tril(half, -1).T
    if null.shape[1]:
        left = np.linalg.solve((constraints.T @ motion).T, motion.T).T
        inverse -= left @ left.T
    return inverse / scale[:, None] / scale, singular
