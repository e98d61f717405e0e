"""All other observations of a problem together: residuals, Jacobian and their part of the normal equations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.known.group import Entries
from graphos_core.adjustment.bundle.problem import Problem
from graphos_core.data.record import Array


@dataclass(frozen=True)
class Linear:
    """Other observations, linearised.

    Attributes
    ----------
    residuals : float64 (k,)
        Computed − observed.
    jacobian : csr_array (k, u)
        Of the reduced unknowns.
    sigma : float64 (k,)
        A priori standard deviations.
    group : int64 (k,)
        Group of each observation.
    """

    residuals: Array
    jacobian: csr_array
    sigma: Array
    group: Array

    @property
    def cost(self) -> float:
        """½ Σ v²/σ²."""
        return 0.5 * float(((self.residuals / self.sigma) ** 2).sum())

    @property
    def weighted(self) -> tuple[Array, csr_array]:
        """Residuals and Jacobian, each divided by σ."""
        return self.residuals / self.sigma, self.jacobian.multiply(1.0 / self.sigma[:, None]).tocsr()


def linearise(problem: Problem, scene: Scene) -> Linear | None:
    """Return the other observations at `scene`, or None where there are none."""
    if not problem.groups:
        return None
    residuals, sigma, group, parts = [], [], [], []
    first = 0
    for g, (observations, at) in enumerate(zip(problem.groups, problem.columns, strict=True)):
        entries = Entries()
        residuals.append(observations.evaluate(scene, at, entries) - observations.observed)
        rows, columns, values = entries.arrays()
        parts.append((rows + first, columns, values))
        sigma.append(observations.sigma)
        group.append(np.full(len(observations.sigma), g))
        first += len(observations.sigma)
    rows, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    jacobian = csr_array((values, (rows, columns)), shape=(first, problem.unknowns))
    return Linear(np.concatenate(residuals), jacobian, np.concatenate(sigma), np.concatenate(group))


def cost(problem: Problem, scene: Scene) -> float:
    """Return ½ Σ v²/σ² of the other observations."""
    total = 0.0
    for observations, at in zip(problem.groups, problem.columns, strict=True):
        v = (observations.evaluate(scene, at, Entries()) - observations.observed) / observations.sigma
        total += 0.5 * float(v @ v)
    return total
