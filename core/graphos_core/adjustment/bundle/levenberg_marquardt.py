"""Levenberg–Marquardt: damped Gauss–Newton steps on the reduced normal equations.

Damping λ multiplies the diagonal of JᵀJ (Marquardt 1963); it shrinks and grows with the ratio of the real to the
predicted decrease of the cost (Nielsen 1999). Robust functions enter as weights renewed in each iteration.
"""

from __future__ import annotations

from dataclasses import dataclass

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.data import IterationRecord
from graphos_core.run import Run

FIRST_DAMPING, LARGEST_DAMPING, SMALLEST_DAMPING = 1e-4, 1e12, 1e-14
LOST_SHARE = 0.02
"""A step that carries more than this share of the observations behind their cameras is refused."""


@dataclass(frozen=True)
class Solution:
    """Where the iteration ended.

    Attributes
    ----------
    scene : Scene
    cost : float
    iterations : tuple of IterationRecord
    converged : bool
    reason : str
        Why it stopped, in words.
    """

    scene: Scene
    cost: float
    iterations: tuple[IterationRecord, ...]
    converged: bool
    reason: str


def minimise(system: ReducedSystem, max_iterations: int, tolerance: float, *, run: Run) -> Solution:
    """Minimise the cost from the problem's scene.

    Parameters
    ----------
    system : ReducedSystem
        Inside its `ReducedSystem.working` context.
    max_iterations : int
        Steps tried, refused ones included.
    tolerance : float
        Converged when an accepted step lowers the cost by less than this share of it, and the linear model
        promised no more.
    run : Run
        Is shown an `IterationRecord` per step under ``"iteration"``.

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    scene, damping, growth = system.problem.scene, FIRST_DAMPING, 2.0
    equations = system.build(scene, damping)
    cost = equations.cost
    records = [IterationRecord(
        iteration=0, cost=cost, step=0.0, damping=damping, gradient=equations.largest_gradient, accepted=True,
        interior=scene.values.copy(),
    )]  # fmt: skip
    run.show("iteration", records[0])
    reason = f"stopped after the largest number of iterations, {max_iterations}"
    for iteration in range(1, max_iterations + 1):
        run.check()
        if equations.largest_gradient < 1e-10 or cost < 1e-20 * max(equations.visible, 1):
            return Solution(scene, cost, tuple(records), True, "converged: the gradient is zero")
        step = system.solve(equations, damping)
        moved = None if step is None else system.move(scene, equations, damping, step)
        accepted, relative = False, 0.0
        if moved is not None:
            relative = moved.step / max(moved.size, 1e-300)
            accepted = moved.cost < cost and moved.lost <= LOST_SHARE * equations.visible
        records.append(IterationRecord(
            iteration=iteration, cost=moved.cost if moved is not None and accepted else cost, step=relative,
            damping=damping, gradient=equations.largest_gradient, accepted=accepted,
            interior=(moved.scene if moved is not None and accepted else scene).values.copy(),
        ))  # fmt: skip
        run.show("iteration", records[-1])
        if moved is not None and moved.predicted <= tolerance * cost and moved.lost == 0:
            scene, cost = (moved.scene, moved.cost) if accepted else (scene, cost)
            reason = f"converged: the cost can fall by less than {tolerance:g} of itself"
            return Solution(scene, cost, tuple(records), True, reason)
        if moved is not None and accepted:
            gain = (cost - moved.cost) / max(moved.predicted, 1e-300)
            damping = max(damping * max(1.0 / 3.0, 1.0 - (2.0 * gain - 1.0) ** 3), SMALLEST_DAMPING)
            growth = 2.0
            scene, cost = moved.scene, moved.cost
        else:
            damping *= growth
            growth *= 2.0
            if damping > LARGEST_DAMPING:
                return Solution(scene, cost, tuple(records), False, "stopped: no step lowers the cost")
        if iteration < max_iterations:
            equations = system.build(scene, damping)
            cost = equations.cost
    return Solution(scene, cost, tuple(records), False, reason)
