"""Four photos of nine points: the block that several simulators of the adjustment share."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from graphos_core.data import Camera
from graphos_core.geometry.rotation import look_at
from graphos_core.simulation.model import NoiseParams, TheoreticalModel, theoretical_model
from graphos_core.simulation.objects import imported
from graphos_core.simulation.templates import Stations

WIDTH, HEIGHT, FOCAL_PX = 1200, 900, 1000.0
CAMERA = Camera(
    model="pinhole",
    width=WIDTH,
    height=HEIGHT,
    values=np.array([FOCAL_PX, (WIDTH - 1) / 2, (HEIGHT - 1) / 2]),
)
POINTS_XYZ = np.array([
    [-3.0, 2.2, 0.3], [0.2, 2.5, -0.4], [3.1, 2.0, 0.6], [-3.2, -0.2, -0.5], [0.0, 0.1, 0.8], [2.9, 0.3, -0.3],
    [-2.8, -2.3, 0.5], [0.3, -2.1, -0.2], [3.0, -2.4, 0.4],
])  # fmt: skip
"""The object points, float64 (9, 3), m."""
CENTRES = np.array([[-3.0, -1.2, 9.0], [3.2, -0.8, 9.4], [0.4, 2.6, 8.8], [0.2, -3.4, 9.2]])
ROTATIONS = np.stack([look_at(c, 0.15 * c * [1, 1, 0], np.array([0.0, 1.0, 0.0])) for c in CENTRES])


@lru_cache(maxsize=32)
def four_photos(photos: int, sigma_px: float, seed: int) -> TheoreticalModel:
    """Return truth and measurements of the first `photos` photos."""
    stations = Stations(names=tuple("1234"[:photos]), rotations=ROTATIONS[:photos], centres=CENTRES[:photos])
    noise = NoiseParams(sigma_px=sigma_px, max_incidence=90.0)
    return theoretical_model(stations, CAMERA, imported(POINTS_XYZ), noise, seed=seed)
