"""Gauss–Newton with step control: the full step, halved until the cost falls enough.

The rule of Armijo 1966 is used as in Börlin and Grussenmeyer 2013, Bundle adjustment with and without damping, "GNA".
A free network is fixed by inner constraints, so the normal matrix is regular without damping.
"""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle import datum
from graphos_core.adjustment.bundle.levenberg_marquardt import LOST_SHARE, Solution
from graphos_core.adjustment.bundle.reduced_system import Equations, Moved, ReducedSystem
from graphos_core.data import Array, IterationRecord
from graphos_core.run import Run

ENOUGH = 0.1
"""Share of the decrease along the tangent that a step must reach."""

SHORTEST = 1e-3
"""Step share below which the line search gives up."""


def minimise(system: ReducedSystem, max_iterations: int, tolerance: float, *, run: Run) -> Solution:
    """Minimise the cost from the problem's scene; as `levenberg_marquardt.minimise`.

    `IterationRecord.damping` is the share of the full step that was taken.
    """
    scene = system.problem.scene
    equations = system.build(scene, 0.0)
    cost = equations.cost
    records = [IterationRecord(iteration=0, cost=cost, step=0.0, damping=1.0, gradient=equations.largest_gradient,
                               accepted=True, interior=scene.values.copy())]  # fmt: skip
    run.show("iteration", records[0])
    reason = f"stopped after the largest number of iterations, {max_iterations}"
    for iteration in range(1, max_iterations + 1):
        run.check()
        if equations.largest_gradient < 1e-10 or cost < 1e-20 * max(equations.visible, 1):
            return Solution(scene, cost, tuple(records), True, "converged: the gradient is zero")
        step = system.solve(with_datum(system, equations), 0.0)
        if step is None:
            return Solution(scene, cost, tuple(records), False, "stopped: the normal matrix is singular")
        taken = _line_search(system, equations, step)
        moved, share, predicted = taken
        relative = 0.0 if moved is None else moved.step / max(moved.size, 1e-300)
        records.append(IterationRecord(
            iteration=iteration, cost=cost if moved is None else moved.cost, step=relative, damping=share,
            gradient=equations.largest_gradient, accepted=moved is not None,
            interior=(scene if moved is None else moved.scene).values.copy(),
        ))  # fmt: skip
        run.show("iteration", records[-1])
        if predicted <= tolerance * cost:
            scene, cost = (scene, cost) if moved is None else (moved.scene, moved.cost)
            reason = f"converged: the cost can fall by less than {tolerance:g} of itself"
            return Solution(scene, cost, tuple(records), True, reason)
        if moved is None:
            return Solution(scene, cost, tuple(records), False, "stopped: no step lowers the cost")
        scene = moved.scene
        if iteration < max_iterations:
            equations = system.build(scene, 0.0)
            cost = equations.cost
        else:
            cost = moved.cost
    return Solution(scene, cost, tuple(records), False, reason)


def with_datum(system: ReducedSystem, equations: Equations) -> Equations:
    """Add the conditions of free motions to the normal matrix, in its own size."""
    null = datum.gauge(system.problem, equations.scene)
    if null.shape[1]:
        held = np.linalg.qr(datum.constraints(system.problem, equations.scene, null))[0]
        size = float(np.median(equations.diagonal[equations.diagonal > 0]))
        equations.matrix[:] += np.triu(size * held @ held.T)
    return equations


def _line_search(
    system: ReducedSystem, equations: Equations, step: Array
) -> tuple[Moved | None, float, float]:
    """Return the accepted step or None, its share of the full one, and the decrease that the full one promised."""
    share, predicted = 1.0, 0.0
    while share >= SHORTEST:
        moved = system.move(equations.scene, equations, 0.0, share * step, (share, 0.0))
        if share == 1.0:
            predicted = moved.predicted
        enough = moved.cost <= equations.cost - 2.0 * ENOUGH * share * predicted
        if enough and moved.lost <= LOST_SHARE * equations.visible:
            return moved, share, predicted
        share *= 0.5
    return None, share, predicted
