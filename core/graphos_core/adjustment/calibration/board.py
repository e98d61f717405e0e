"""Is the board flat? Its points as unknowns, and how far they are from where the drawing has them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import f as fisher

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.data import Adjustment, Array
from graphos_core.data.record import record
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.run import Run

LEAST_RAYS = 3
"""Rays every point of the board needs to be free."""
ALPHA = 0.001
"""Error probability of the test for a board that is not flat."""


@record
class BoardShape:
    """How the board differs from its drawing, from an adjustment with its points free.

    Attributes
    ----------
    points : float64 (n, 3)
        Adjusted points of the board laid over the drawing by a similarity, m.
    deviations : float64 (n, 3)
        Adjusted − drawn, m; z is out of the plane.
    sigmas : float64 (n, 3)
        Their standard deviations, m.
    flatness_m : float
        Root mean square of the deviations out of the plane, m.
    in_plane_m : float
        Root mean square per coordinate of the deviations in the plane, m.
    statistic, limit : float
        F statistic of the hypothesis that board and drawing agree, and its limit.
    sigma0_px : float
        Standard deviation of unit weight of the adjustment with free points, px.
    """

    points: Array
    deviations: Array
    sigmas: Array
    flatness_m: float
    in_plane_m: float
    statistic: float
    limit: float
    sigma0_px: float

    @property
    def agrees(self) -> bool:
        """Whether the drawing is good enough for these photos."""
        return self.statistic <= self.limit


def free_board(
    result: Adjustment, interior: tuple[tuple[str, ...], ...], run: Run
) -> tuple[Adjustment, BoardShape] | None:
    """Adjust once more with the board's points free, and lay them over the drawing.

    The datum is that of a free network; a similarity onto the drawing gives position and scale back. Whether the
    drawing agrees is tested by ``F = ((Ω₁ − Ω₂) / (r₁ − r₂)) / (Ω₂ / r₂)`` (Koch 1999, section 4.2).

    Parameters
    ----------
    result : Adjustment
        With the board's points fixed.
    interior : tuple of tuple of str
        Free parameters of each camera.
    run : Run

    Returns
    -------
    (Adjustment, BoardShape) or None
        None where a point has too few rays or the free network has no redundancy of its own.
    """
    block = result.block
    rays = np.bincount(block.obs_point, minlength=len(block.points))
    if rays.min() < LEAST_RAYS or block.oriented.sum() < LEAST_RAYS:
        return None
    quiet = Run(threads=run.threads, seed=run.seed)
    freed = adjust_block(
        block, Freedom(interior=interior), Options(max_iterations=200, tolerance=1e-12), run=quiet
    )
    run.check()
    if len(freed.block.points) != len(block.points) or freed.redundancy <= 0 or quiet.warnings:
        return None
    placed = estimate_similarity(freed.block.points, block.points)
    points = placed.apply(freed.block.points)
    turned = replace(
        freed.block, points=points, centres=placed.apply(freed.block.centres),
        rotations=freed.block.rotations @ placed.rotation.T,
    )  # fmt: skip
    omega = [float((a.residuals**2).sum()) for a in (result, freed)]
    freedom = result.redundancy - freed.redundancy
    statistic = max(omega[0] - omega[1], 0.0) / freedom / (omega[1] / freed.redundancy)
    deviations = points - block.points
    shape = BoardShape(
        points=points, deviations=deviations, sigmas=placed.scale * freed.sigma_points,
        flatness_m=float(np.sqrt((deviations[:, 2] ** 2).mean())),
        in_plane_m=float(np.sqrt((deviations[:, :2] ** 2).mean())), statistic=statistic,
        limit=float(fisher.ppf(1.0 - ALPHA, freedom, freed.redundancy)), sigma0_px=freed.sigma0_px,
    )  # fmt: skip
    scaled = replace(
        freed, block=turned, sigma_points=shape.sigmas, sigma_centres=placed.scale * freed.sigma_centres
    )
    return scaled, shape
