"""Cofactors of the unknowns from the reduced normal equations; never the full inverse.

With N the reduced matrix, G its null space and the conditions ``Cᵀx = 0`` that fix the datum, the cofactor
matrix is ``Q = (N + C Cᵀ)⁻¹ − G (CᵀG)⁻¹ (GᵀC)⁻¹ Gᵀ`` (Koch 1999, section 3.5; Förstner and Wrobel 2016, section 4.5).
Because the constraints concern reduced unknowns only, points follow from Q point by point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from graphos_core.adjustment.bundle import datum, statistics_kernels
from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.rank import datum_findings, defects
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.data import Array, Finding

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
        Whether more than the datum was undetermined; the unknowns concerned have enormous cofactors then.
    null : float64 (u, d)
        The free motions, see `graphos_core.adjustment.bundle.datum.gauge`.
    findings : tuple of Finding
        What is undetermined, in words.
    redundancy, effect : float64 (m, 2) or None
        Of the observations in the order of the solver, see `graphos_core.adjustment.bundle.statistics_kernels`.
    """

    reduced: Array
    points: Array
    defect: int
    datum: str
    singular: bool
    null: Array
    findings: tuple[Finding, ...] = ()
    redundancy: Array | None = None
    effect: Array | None = None


def cofactors(
    system: ReducedSystem, scene: Scene, kind: datum.DatumKind = "inner", delta0: float = -1.0
) -> Cofactors:
    """Return the cofactors of all unknowns at `scene`.

    Parameters
    ----------
    system : ReducedSystem
        Inside its working context.
    scene : Scene
        Adjusted.
    kind : {"inner", "minimal"}
        How free motions of the block are fixed.
    delta0 : float
        Non-centrality of the minimal detectable bias; negative leaves out redundancy numbers and effects.
    """
    problem = system.problem
    equations = system.build(scene, 0.0)
    null = datum.gauge(problem, scene)
    held = datum.constraints(problem, scene, null, kind)
    reduced, free = _inverse(equations.matrix, null, held)
    points = np.zeros((len(scene.points), 3, 3))
    m = len(problem.layout.photo) if delta0 >= 0.0 else 0
    redundancy, effect = np.zeros((m, 2)), np.zeros((m, 2))

    def one(chunk: int) -> None:
        statistics_kernels.statistics(
            scene,
            problem.layout,
            system.rules,
            problem.chunks[chunk],
            reduced,
            delta0,
            points,
            redundancy,
            effect,
        )

    system.each_chunk(one)
    defect = null.shape[1]
    return Cofactors(
        reduced, points, defect, datum.describe(problem, defect, kind), free.shape[1] > 0, null,
        (*defects(problem, free), *datum_findings(null, scene, problem)),
        redundancy if m else None, effect if m else None,
    )  # fmt: skip


def _inverse(matrix: Array, null: Array, held: Array) -> tuple[Array, Array]:
    """Invert the reduced matrix (upper triangle) under the conditions ``heldᵀ x = 0``; scaled to unit diagonal first.

    Where the matrix is singular all the same, its eigenvalues are raised to `SMALLEST_PIVOT`: what nothing determines
    gets a standard deviation millions of times that of a determined unknown, and all that depends on it too.

    Returns
    -------
    float64 (u, u)
        The inverse.
    float64 (u, k)
        Null vectors of the scaled matrix with its conditions, none where it is regular.
    """
    u = len(matrix)
    free = np.zeros((u, 0))
    if u == 0:
        return np.zeros((0, 0)), free
    scale = np.sqrt(np.maximum(matrix.diagonal(), 0.0))
    scale[scale == 0.0] = 1.0
    scaled = np.triu(matrix) / scale[:, None] / scale
    constraints = np.linalg.qr(held / scale[:, None])[0]
    motion = null * scale[:, None]
    regular = scaled + np.triu(constraints @ constraints.T)
    factor, info = lapack.dpotrf(regular.T, lower=1, clean=0)
    if info != 0 or np.any(factor.diagonal() ** 2 < SMALLEST_PIVOT):
        values, vectors = np.linalg.eigh(regular, UPLO="U")
        inverse = (vectors / np.maximum(values, SMALLEST_PIVOT)) @ vectors.T
        free = vectors[:, : max(int((values < SMALLEST_PIVOT).sum()), 1)]
    else:
        half, _ = lapack.dpotri(factor, lower=1, overwrite_c=1)
        inverse = np.tril(half) + np.tril(half, -1).T
    if null.shape[1]:
        left = np.linalg.solve((constraints.T @ motion).T, motion.T).T
        inverse -= left @ left.T
    return inverse / scale[:, None] / scale, free
