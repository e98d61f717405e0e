"""Small blocks for simulators: adjusted by the engine, with everything its equations say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphos_core.adjustment.bundle.covariance import Cofactors, cofactors
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.known.group import Group
from graphos_core.adjustment.bundle.problem import Freedom, Problem, make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_core.cameras import camera_model
from graphos_core.data import Block
from graphos_core.data.record import Array

POSE = ("ω", "φ", "κ", "X", "Y", "Z")
PLAIN = Rules(ROBUST["none"].code, 1.0, True)


@dataclass(frozen=True, eq=False)
class Equations:
    """The normal equations of a block at its present values: problem and cofactors.

    Attributes
    ----------
    problem : Problem
    cofactors : Cofactors
    """

    problem: Problem
    cofactors: Cofactors

    def of_photo(self, photo: int) -> slice:
        """Columns of the rotation and the projection centre of a photo."""
        first = int(self.problem.layout.photo_column[photo])
        return slice(first, first + int(self.problem.layout.pose[photo]))

    @cached_property
    def of_camera(self) -> dict[str, int]:
        """Column of every free parameter of the first camera, by name."""
        layout = self.problem.layout
        names = camera_model(self.problem.block.cameras[0].model).names
        first, count = int(layout.camera_column[0]), int(layout.free_count[0])
        return {names[layout.free_index[0, i]]: first + i for i in range(count)}

    @property
    def determined(self) -> bool:
        """Whether nothing but the datum is open."""
        return not self.cofactors.singular

    @cached_property
    def correlations(self) -> Array:
        """Correlations of all reduced unknowns, float64 (u, u); NaN where not determined."""
        q = self.cofactors.reduced
        if not self.determined:
            return np.full_like(q, np.nan)
        sigma = np.sqrt(np.maximum(q.diagonal(), 1e-300))
        return np.asarray(np.clip(q / sigma[:, None] / sigma, -1.0, 1.0))


def equations(
    block: Block, freedom: Freedom, groups: Sequence[Group] = (), datum: str = "inner"
) -> Equations:
    """Return the equations of a block at its present values, without moving anything."""
    problem = make_problem(block, freedom, groups)
    system = ReducedSystem(problem, PLAIN, 1)
    with system.working():
        found = cofactors(system, problem.scene, "minimal" if datum == "minimal" else "inner")
    return Equations(problem, found)
