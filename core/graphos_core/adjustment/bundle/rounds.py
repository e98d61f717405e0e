"""Rounds of adjustment and rejection, and the final adjustment with its weights."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.known.build import (
    Defaults,
    Observed,
    is_measured,
    join_measured,
    named_points,
    observe,
)
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.bundle.rank import with_names
from graphos_core.adjustment.bundle.rejection import normalised, robust_spread, without_long
from graphos_core.adjustment.bundle.schur import SCALE_SIGMAS, Named
from graphos_core.adjustment.bundle.self_calibration import (
    corner_effect_px,
    free_parameters,
    warn_of_weak_parameters,
)
from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.cameras import camera_model
from graphos_core.data import Adjustment, Array, Block, IterationRecord, Known
from graphos_core.run import Run
from graphos_core.text import Text

MOST_ROUNDS = 15

ROUGH_TOLERANCE = 1e-4
"""Convergence limit of the rounds that only serve to find what is rejected next; the last adjustment is exact."""

UNDETERMINED_SHARE = 0.2
"""A parameter is frozen when one standard deviation moves the edge of the photo by this share of the half diagonal."""

MOST_COMPONENTS = 10
CHANGED, FEWEST_REDUNDANT = 0.02, 2.0
"""Variance components have converged below this change; groups with less redundancy keep their σ."""


class Rounds:
    """One run of the stage.

    Attributes
    ----------
    block : Block
        As it is after the last round; `Block.obs_sigma_px` of tie points relative to each other.
    rejected : int
    trace : tuple of IterationRecord
    frozen : list of str
        Camera parameters that could not be determined, in words.
    """

    def __init__(self, block: Block, known: Known, params: BundleParams, run: Run) -> None:
        self.known, self.params, self.run = known, params, run
        self.calibrated = free_parameters(block, params, run)
        self.defaults = Defaults(
            control_m=params.control_sigma_m, measured_px=params.measured_sigma_px,
            use_control=params.control == "weighted",
        )  # fmt: skip
        ties = block if params.scale_weights else replace(block, obs_sigma_px=None)
        self.block = join_measured(ties, known, self.defaults)
        self.cameras = self.block.cameras
        self.rejected = 0
        self.trace: tuple[IterationRecord, ...] = ()
        self.frozen: list[str] = []
        self._factors: dict[str, float] = {}
        self._tie_sigma = params.tie_sigma_px or 1.0
        self._spread = self._tie_sigma
        self._told = False

    # ------------------------------------------------------------------------------------------------ rounds

    def reject(self) -> None:
        """Adjust and reject until nothing is too long and the weights stand still."""
        self._weigh(self._spread_of(self._adjust(Options(max_iterations=0, statistics=False))))
        steps = self._steps()
        for done in range(MOST_ROUNDS):
            self.run.progress(done, MOST_ROUNDS, Text("rounds of adjustment"))
            before = self._spread
            interior = steps[min(done, len(steps) - 1)]
            rough = max(self.params.tolerance, ROUGH_TOLERANCE)
            result = self._adjust(self._options(rough), interior, self.run)
            self.trace += result.iterations
            spread = self._spread_of(result)
            settled = (
                self.params.robust == "none" or spread > 0.8 * before
            )  # while it falls, good ones look bad
            self.block = self._relative(result.block)
            dropped = self._reject(result, spread) if settled else 0
            self._weigh(spread)
            if done >= len(steps) - 1 and dropped == 0 and settled and abs(spread - before) < 0.05 * before:
                break

    def _steps(self) -> list[tuple[tuple[str, ...], ...]]:
        """Return the free camera parameters of the first rounds; the last entry stands for all others."""
        everything = self.calibrated.interior
        nothing: tuple[tuple[str, ...], ...] = tuple(() for _ in everything)
        focal = tuple(tuple(name for name in names if name == "focal_px") for names in everything)
        return {
            "together": [everything],
            "interior later": [nothing, everything],
            "step by step": [nothing, focal, everything],
        }[self.params.strategy]

    def _reject(self, result: Adjustment, spread: float) -> int:
        """Take the too long observations out of the block, which is as adjusted."""
        if self.params.rejection is None:
            return 0
        measured = is_measured(result.block)[result.block.obs_point]
        limit = self.params.rejection * spread / self._tie_sigma
        self.block, dropped = without_long(self.block, np.hypot(*normalised(result).T), limit, measured)
        self.rejected += dropped
        return dropped

    # ------------------------------------------------------------------------------------------------- final

    def final(self) -> tuple[Adjustment, Named]:
        """Adjust exactly, with statistics; parameters that nothing determines are frozen and it is done again.

        The precision of tie points, so far from the median of their residuals, is first taken from their sum of squares
        and redundancy: points with two rays have small residuals in one direction, which the median takes for precision.
        """
        if self.params.tie_sigma_px is None:
            self._weigh_by_redundancy()
        exact = self._exact()
        result = self._adjust(exact, self.calibrated.interior, self.run)
        while (worst := self._undetermined(result)) is not None:
            self._freeze(*worst)
            result = self._adjust(exact, self.calibrated.interior, self.run)
        if self.params.variance_components:
            result = self._components(result, exact)
        warn_of_weak_parameters(result.block, self.run)
        named = Named(named_points(result.block, self.known))
        track = np.where(is_measured(result.block), -1, result.block.point_track).astype(np.int32)
        groups = tuple(replace(g, factor=self._factors.get(g.kind, 1.0)) for g in result.groups)
        prior = self._tie_sigma * self._factors.get("tie points", 1.0)
        result = replace(result, prior_px=prior, sigma0_px=result.sigma0 * prior,
                         findings=with_names(result.findings, named.place))  # fmt: skip
        if self.params.tie_sigma_px is None:  # the weights come from the residuals: their test says nothing
            result = replace(result, global_test=None)
        return replace(result, block=replace(result.block, point_track=track), groups=groups), named

    def _exact(self) -> Options:
        return replace(self._options(self.params.tolerance), statistics=True, reliability=True)

    def _weigh_by_redundancy(self) -> None:
        rough = replace(self._exact(), tolerance=max(self.params.tolerance, ROUGH_TOLERANCE))
        result = self._adjust(rough, self.calibrated.interior, self.run)
        self.trace += result.iterations
        self.block = self._relative(result.block)
        ties = next((group for group in result.groups if group.kind == "tie points"), None)
        if ties is not None and np.isfinite(ties.sigma0) and ties.sigma0 > 0:
            self._weigh(self._tie_sigma * ties.sigma0)

    def _undetermined(self, result: Adjustment) -> tuple[int, str] | None:
        worst, found = UNDETERMINED_SHARE, None
        for c, camera in enumerate(result.block.cameras):
            half = 0.5 * float(np.hypot(camera.width, camera.height)) or 1.0
            for name, effect in corner_effect_px(camera).items():
                share = effect / half if np.isfinite(effect) else np.inf
                if share > worst and name in self.calibrated.interior[c]:
                    worst, found = share, (c, name)
        return found

    def _freeze(self, c: int, name: str) -> None:
        self.calibrated = self.calibrated.without([(c, name)])
        camera = self.block.cameras[c]
        model = camera_model(camera.model)
        place = model.index(name)
        values = np.array(camera.values)
        values[place] = self.cameras[c].values[place]
        cameras = list(self.block.cameras)
        cameras[c] = replace(camera, values=values)
        self.block = replace(self.block, cameras=tuple(cameras))
        said = Text(
            "{camera}: {parameter} cannot be determined by these photos and is held at its start value.",
            camera=camera.label or f"Camera {c + 1}", parameter=model.parameters[place].label,
        )  # fmt: skip
        self.frozen.append(said)
        self.run.warn(said)

    def _components(self, result: Adjustment, options: Options) -> Adjustment:
        """Multiply the standard deviations of each group by the root of its variance component until they agree.

        Förstner 1979, Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten.
        """
        for _ in range(MOST_COMPONENTS):
            change = 0.0
            for kind, component in _components_of(result).items():
                self._factors[kind] = self._factors.get(kind, 1.0) * component
                change = max(change, abs(np.log(component)))
            if change < CHANGED:
                break
            self.block = self._relative(result.block)
            result = self._adjust(options, self.calibrated.interior, self.run)
        return result

    # --------------------------------------------------------------------------------------------- adjusting

    def _options(self, tolerance: float) -> Options:
        p = self.params
        scale = p.robust_scale_px or SCALE_SIGMAS * self._spread * (2.0 if p.robust == "tukey" else 1.0)
        return Options(
            robust=p.robust, method=p.method, scale_px=scale / self._tie_sigma, max_iterations=p.max_iterations, tolerance=tolerance,
            statistics=False, alpha=p.alpha, power=p.power, datum=p.datum,
        )  # fmt: skip

    def _adjust(
        self, options: Options, interior: tuple[tuple[str, ...], ...] = (), run: Run | None = None
    ) -> Adjustment:
        observed = self._observed()
        freedom = Freedom(interior=interior, fixed_points=observed.fixed_points)
        start = replace(self.block, cameras=self.cameras)  # priors hold the start values
        priors = self.calibrated.only(interior).prior_group(start)
        groups = [
            replace(g, sigma=g.sigma * self._factors.get(g.kind, 1.0))  # type: ignore[type-var]
            for g in (*observed.groups, *priors)
        ]
        return adjust_block(observed.block, freedom, options, groups, run=run)

    def _observed(self) -> Observed:
        observed = observe(self.block, self.known, self.defaults, Run() if self._told else self.run)
        self._told = True
        return replace(observed, block=replace(observed.block, obs_sigma_px=self._sigma(observed.block)))

    def _scales(self, block: Block) -> Array:
        """Return what the relative standard deviation of each observation is multiplied by."""
        measured = is_measured(block)[block.obs_point]
        ties = self._tie_sigma * self._factors.get("tie points", 1.0)
        return np.where(measured, self._factors.get("control image points", 1.0), ties)

    def _sigma(self, block: Block) -> Array:
        relative = np.ones(len(block.obs_xy)) if block.obs_sigma_px is None else block.obs_sigma_px
        return np.asarray(relative * self._scales(block))

    def _relative(self, block: Block) -> Block:
        if block.obs_sigma_px is None:
            return block
        return replace(block, obs_sigma_px=block.obs_sigma_px / self._scales(block))

    def _spread_of(self, result: Adjustment) -> float:
        ties = ~is_measured(result.block)[result.block.obs_point]
        return robust_spread(result, ties) * self._tie_sigma

    def _weigh(self, spread: float) -> None:
        """Take the spread of the tie points as their standard deviation, unless the person gave it."""
        self._spread = spread
        if self.params.tie_sigma_px is None:
            self._tie_sigma = spread


def _components_of(result: Adjustment) -> dict[str, float]:
    """Return the root of the variance component of each kind of observations; priors and conditions have none."""
    squares: dict[str, float] = {}
    redundancy: dict[str, float] = {}
    for group in result.groups:
        if group.kind not in ("camera", "datum"):
            squares[group.kind] = squares.get(group.kind, 0.0) + group.squares
            redundancy[group.kind] = redundancy.get(group.kind, 0.0) + group.redundancy
    return {
        kind: float(np.sqrt(squares[kind] / share))
        for kind, share in redundancy.items()
        if share > FEWEST_REDUNDANT and squares[kind] > 0.0
    }
