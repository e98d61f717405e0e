"""Figures per object point against what they are by definition."""

import numpy as np

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.statistics.point_figures import point_figure
from graphos_core.data import Camera
from graphos_core.simulation.model import NoiseParams, theoretical_model
from graphos_core.simulation.objects import ObjectParams, cube
from graphos_core.simulation.templates import OrbitalParams, place

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]))


def test_figures_are_those_of_the_definition() -> None:
    stations = place("orbital", OrbitalParams(axis_x=9, axis_y=9, axis_z=6, equators=1, per_equator=6))
    model = theoretical_model(
        stations, CAMERA, cube(ObjectParams(count=60)), NoiseParams(sigma_px=0.3), seed=2
    )
    adjustment = adjust_block(model.as_block())
    block = adjustment.block
    figures = {kind: point_figure(adjustment, kind) for kind in ("precision", "rays", "angle", "residual")}
    for point in (0, len(block.points) // 2, len(block.points) - 1):
        mine = np.flatnonzero(np.asarray(block.obs_point) == point)
        assert figures["rays"][point] == len(mine)
        assert np.isclose(
            figures["residual"][point], np.sqrt((np.asarray(adjustment.residuals)[mine] ** 2).mean())
        )
        rays = block.points[point] - np.asarray(block.centres)[np.asarray(block.obs_photo)[mine]]
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        assert np.isclose(figures["angle"][point], np.degrees(np.arccos((rays @ rays.T).min())), atol=1e-6)
        assert figures["precision"][point] == adjustment.sigma_points[point].max()
