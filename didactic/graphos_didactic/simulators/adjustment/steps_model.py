"""The engine's iteration from a wrong start, with every scene it tried; Jacobian and normal matrix of each."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from graphos_core.adjustment.bundle.adjust import METHODS, Method
from graphos_core.adjustment.bundle.kernels import Rules, Scene
from graphos_core.adjustment.bundle.levenberg_marquardt import Solution
from graphos_core.adjustment.bundle.problem import Freedom, Problem, make_problem
from graphos_core.adjustment.bundle.reduced_system import Equations, Moved, ReducedSystem
from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Block
from graphos_core.data.record import Array
from graphos_core.geometry.intersection_precision import image_derivatives
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.run import Run
from graphos_didactic.simulators.adjustment.four_photos import CAMERA, CENTRES, POINTS_XYZ, four_photos
from graphos_didactic.simulators.adjustment.steps_params import HIGHEST, LOWEST, MOST, StepsParams

KNOWN = (0, 2, 6)
"""Points that are known: they give the datum."""
POWERS = np.linspace(LOWEST, HIGHEST, 23)
"""Powers of ten of the damping along the curve."""


class Recorded(ReducedSystem):
    """The engine's system of equations, which remembers where each step would have led."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem, Rules(ROBUST["none"].code, 1.0, True), 1)
        self.tried: list[Moved | None] = []

    def solve(self, equations: Equations, damping: float) -> Array | None:
        """Solve; a matrix that cannot be factorised is remembered as a step to nowhere."""
        step = super().solve(equations, damping)
        if step is None:
            self.tried.append(None)
        return step

    def move(
        self,
        scene: Scene,
        equations: Equations,
        damping: float,
        step: Array,
        shares: tuple[float, float] = (1.0, 0.0),
        down: Array | None = None,
    ) -> Moved:
        """Move, and remember where to."""
        moved = super().move(scene, equations, damping, step, shares, down)
        self.tried.append(moved)
        return moved


@dataclass(frozen=True, eq=False)
class Iteration:
    """The adjustment of a parameter sheet."""

    params: StepsParams

    @cached_property
    def start(self) -> Block:
        """The measured block with wrong start values; known points are right."""
        p = self.params
        block = four_photos(4, p.sigma_px, p.seed).as_block(
            perturb_centre=p.rough, perturb_points=p.rough, perturb_rotation=0.05 * p.rough, seed=p.seed
        )
        points, centres, rotations = (np.array(a) for a in (block.points, block.centres, block.rotations))
        points[list(KNOWN)] = POINTS_XYZ[list(KNOWN)]
        centres[0] = CENTRES[0] + (p.start_x, p.start_y, 0.0)
        rotations[0] = matrix_from_vector(np.array([0.0, 0.0, np.radians(p.turn)])) @ rotations[0]
        sigma = np.full(len(block.obs_xy), p.sigma_px)
        return replace(block, points=points, centres=centres, rotations=rotations, obs_sigma_px=sigma)

    @cached_property
    def problem(self) -> Problem:
        """The engine's problem."""
        fixed = np.isin(np.arange(len(POINTS_XYZ)), KNOWN)
        return make_problem(self.start, Freedom(fixed_points=fixed))

    def run(self, method: Method) -> tuple[Solution, Recorded]:
        """Return trace and end of the engine's iteration by one of its methods, and what it tried."""
        system = Recorded(self.problem)
        with system.working():
            return METHODS[method](system, MOST, 1e-8, run=Run()), system

    @cached_property
    def _chosen(self) -> tuple[Solution, Recorded]:
        return self.run(self.params.method)

    @cached_property
    def solutions(self) -> dict[Method, Solution]:
        """Trace and end of every method from the same start."""
        methods: tuple[Method, ...] = ("levenberg-marquardt", "gauss-newton", "powell")
        return {m: self.solution if m == self.params.method else self.run(m)[0] for m in methods}

    @property
    def longest(self) -> int:
        """Iterations of the slowest method, the start included."""
        return max(len(solution.iterations) for solution in self.solutions.values())

    @property
    def solution(self) -> Solution:
        """Trace and end of the iteration by the chosen method."""
        return self._chosen[0]

    @cached_property
    def scenes(self) -> tuple[Scene, ...]:
        """The scene after each iteration; a refused step changes nothing."""
        solution, system = self._chosen
        scenes, tried = [self.problem.scene], iter(system.tried)
        for record in solution.iterations[1:]:
            found = None
            if (
                record.accepted
            ):  # a line search or a bent step tries several places, the accepted one has this cost
                found = next((m for m in tried if m is not None and m.cost == record.cost), None)
            scenes.append(scenes[-1] if found is None else found.scene)
        return tuple(scenes)

    @property
    def number(self) -> int:
        """The iteration that is shown."""
        return min(max(self.params.iteration, 0), len(self.scenes) - 1)

    @property
    def scene(self) -> Scene:
        """The scene that is shown."""
        return self.scenes[self.number]

    def trial(self, powers: Array) -> list[Moved | None]:
        """Return where steps of different damping, as powers of ten, lead from the scene that is shown."""
        system = Recorded(self.problem)
        with system.working():
            for power in powers:
                damping = 10.0 ** float(power)
                equations = system.build(self.scene, damping)
                step = system.solve(equations, damping)
                if step is not None:
                    system.move(self.scene, equations, damping, step)
        return system.tried

    @cached_property
    def mine(self) -> Moved | None:
        """Where the step with the chosen damping leads."""
        return self.trial(np.array([self.params.damping]))[0]

    @cached_property
    def curve(self) -> Array:
        """Cost after a step of each damping of `POWERS`; infinite where it leads behind a camera or nowhere."""
        return np.array([m.cost if m is not None and m.lost == 0 else np.inf for m in self.trial(POWERS)])

    @property
    def cost(self) -> float:
        """Cost of the scene that is shown."""
        system = Recorded(self.problem)
        with system.working():
            return system.build(self.scene, 0.0).cost

    @cached_property
    def jacobian(self) -> Array:
        """∂v/∂(photos, free points), divided by σ, at the scene that is shown, float64 (72, 42).

        Columns: small rotation and projection centre of each photo, then X, Y, Z of each free point; rows: x and y of
        each observation, in the order of the solver. By the engine's ∂(x, y)/∂X: ``∂v/∂C = −∂v/∂X`` and
        ``∂v/∂ω = −∂v/∂X Rᵀ [p]×`` with ``p = R (X − C)``.
        """
        layout, scene = self.problem.layout, self.scene
        free = np.flatnonzero(layout.free_point)
        u = self.problem.unknowns
        out = np.zeros((2 * len(layout.photo), u + 3 * len(free)))
        for i in range(len(scene.points)):
            for o in range(layout.start[i], layout.start[i + 1]):
                n = int(layout.photo[o])
                ground = image_derivatives(CAMERA, scene.rotations[n], scene.centres[n], scene.points[i])
                if ground is None:
                    continue
                ground = ground / self.params.sigma_px
                p = scene.rotations[n] @ (scene.points[i] - scene.centres[n])
                cross = np.array([[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]])
                column = int(layout.photo_column[n])
                out[2 * o : 2 * o + 2, column : column + 3] = -ground @ scene.rotations[n].T @ cross
                out[2 * o : 2 * o + 2, column + 3 : column + 6] = -ground
                if layout.free_point[i]:
                    place = u + 3 * int(np.searchsorted(free, i))
                    out[2 * o : 2 * o + 2, place : place + 3] = ground
        return out

    @cached_property
    def normal(self) -> Array:
        """Normal matrix JᵀJ, float64 (42, 42)."""
        return np.asarray(self.jacobian.T @ self.jacobian)

    @cached_property
    def reduced(self) -> Array:
        """The engine's reduced matrix without damping (Schur complement of the photos), float64 (24, 24)."""
        system = Recorded(self.problem)
        with system.working():
            upper = np.triu(system.build(self.scene, 0.0).matrix)
        return np.asarray(upper + np.triu(upper, 1).T)

    def images(self, scene: Scene, photo: int) -> Array:
        """Return where the points of the solver appear in a photo, float64 (9, 2), px."""
        return pixel_from_ray(CAMERA, (scene.points - scene.centres[photo]) @ scene.rotations[photo].T)

    def measured(self, photo: int) -> Array:
        """Return where the points of the solver were measured in a photo, float64 (9, 2), px; NaN where not."""
        layout = self.problem.layout
        out = np.full((len(self.scene.points), 2), np.nan)
        point = np.repeat(np.arange(len(out)), np.diff(layout.start))
        mine = layout.photo == photo
        out[point[mine]] = layout.xy[mine]
        return out

    def error(self, scene: Scene) -> float:
        """Distance of photo 1 from its true place, m."""
        return float(np.linalg.norm(scene.centres[0] - CENTRES[0]))
