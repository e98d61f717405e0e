"""Levenberg–Marquardt–Powell: Gauss–Newton inside a region of trust, bent towards steepest descent at its edge.

The dogleg of Powell 1970, A hybrid method for nonlinear equations, in the metric of the diagonal of JᵀJ; the radius
follows the ratio of the real to the predicted decrease (Nocedal and Wright 2006, Numerical optimization, sections 4.1
and 4.2; "LMP" in Börlin and Grussenmeyer 2013).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.adjustment.bundle.gauss_newton import with_datum
from graphos_core.adjustment.bundle.levenberg_marquardt import LOST_SHARE, Solution
from graphos_core.adjustment.bundle.reduced_system import Equations, Moved, ReducedSystem
from graphos_core.data import Array, IterationRecord
from graphos_core.run import Run

SMALLEST_RADIUS = 1e-12
"""Radius, relative to the first, below which no step lowers the cost."""


@dataclass(frozen=True)
class _Model:
    """The quadratic model at one scene: full step n and steepest descent d, with what their blends promise.

    gd = gᵀD⁻¹g = −gᵀd, curvature = |J d|², gn = −gᵀn, length = √(nᵀ D n).
    """

    step: Array
    direction: Array
    gd: float
    curvature: float
    gn: float
    length: float

    def dogleg(self, radius: float) -> tuple[float, float]:
        """Return the shares (of n, of d) of the dogleg's end at a distance `radius`."""
        if self.length <= radius:
            return 1.0, 0.0
        cauchy = self.gd / max(self.curvature, 1e-300)  # dᵀ D d = gd
        if cauchy * np.sqrt(self.gd) >= radius:
            return 0.0, radius / np.sqrt(self.gd)
        # |cauchy d + t (n − cauchy d)| = radius, with dᵀ D n = gn
        a = self.length**2 - 2.0 * cauchy * self.gn + cauchy**2 * self.gd
        b = cauchy * self.gn - cauchy**2 * self.gd
        c = cauchy**2 * self.gd - radius**2
        t = (-b + np.sqrt(max(b * b - a * c, 0.0))) / a
        return float(t), float((1.0 - t) * cauchy)

    def predicted(self, n: float, d: float) -> float:
        """Return the decrease the model promises for the shares n and d."""
        slope = n * self.gn + d * self.gd
        return slope - 0.5 * (d * d * self.curvature + 2.0 * n * d * self.gd + n * n * self.gn)


def minimise(system: ReducedSystem, max_iterations: int, tolerance: float, *, run: Run) -> Solution:
    """Minimise the cost from the problem's scene; as `levenberg_marquardt.minimise`.

    `IterationRecord.damping` is the radius of the region of trust, relative to the length of the first full step.
    """
    scene = system.problem.scene
    equations = system.build(scene, 0.0)
    cost = equations.cost
    records = [IterationRecord(iteration=0, cost=cost, step=0.0, damping=1.0, gradient=equations.largest_gradient,
                               accepted=True, interior=scene.values.copy())]  # fmt: skip
    run.show("iteration", records[0])
    reason = f"stopped after the largest number of iterations, {max_iterations}"
    model: _Model | None = None
    radius = first = 0.0
    for iteration in range(1, max_iterations + 1):
        run.check()
        if equations.largest_gradient < 1e-10 or cost < 1e-20 * max(equations.visible, 1):
            return Solution(scene, cost, tuple(records), True, "converged: the gradient is zero")
        if model is None:
            model = quadratic_model(system, equations)
            if model is None:
                return Solution(scene, cost, tuple(records), False, "stopped: the normal matrix is singular")
        if first == 0.0:
            radius = first = max(model.length, 1e-300)
        shares = model.dogleg(radius)
        moved = blended(system, equations, model, shares)
        predicted = model.predicted(*shares)
        accepted = moved.cost < cost and moved.lost <= LOST_SHARE * equations.visible
        records.append(IterationRecord(
            iteration=iteration, cost=moved.cost if accepted else cost, step=moved.step / max(moved.size, 1e-300),
            damping=radius / first, gradient=equations.largest_gradient, accepted=accepted,
            interior=(moved.scene if accepted else scene).values.copy(),
        ))  # fmt: skip
        run.show("iteration", records[-1])
        if model.predicted(1.0, 0.0) <= tolerance * cost:
            scene, cost = (moved.scene, moved.cost) if accepted else (scene, cost)
            reason = f"converged: the cost can fall by less than {tolerance:g} of itself"
            return Solution(scene, cost, tuple(records), True, reason)
        ratio = (cost - moved.cost) / max(predicted, 1e-300) if accepted else 0.0
        if ratio < 0.25:
            radius = 0.25 * min(radius, moved.scaled)
        elif ratio > 0.75 and shares[0] < 1.0:
            radius *= 2.0
        if radius < SMALLEST_RADIUS * first:
            return Solution(scene, cost, tuple(records), False, "stopped: no step lowers the cost")
        if accepted:
            scene, cost, model = moved.scene, moved.cost, None
            if iteration < max_iterations:
                equations = system.build(scene, 0.0)
                cost = equations.cost
    return Solution(scene, cost, tuple(records), False, reason)


def quadratic_model(system: ReducedSystem, equations: Equations) -> _Model | None:
    """Return the model at the scene of `equations`, None where the normal matrix is singular."""
    direction, gd, curvature = system.steepest(equations.scene, equations)
    step = system.solve(with_datum(system, equations), 0.0)
    if step is None:
        return None
    full = system.move(equations.scene, equations, 0.0, step)
    return _Model(step, direction, gd, curvature, 2.0 * full.predicted, full.scaled)


def blended(system: ReducedSystem, equations: Equations, model: _Model, shares: tuple[float, float]) -> Moved:
    """Return the scene moved by shares of the full step and of steepest descent."""
    n, d = shares
    if d == 0.0:
        return system.move(equations.scene, equations, 0.0, n * model.step, (n, 0.0))
    return system.move(equations.scene, equations, 0.0, n * model.step, shares, d * model.direction)
