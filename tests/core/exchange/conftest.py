"""Small exact blocks for the tests of formats."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Block, Camera
from graphos_core.geometry.rotation import look_at

CENTRED = Camera(model="basic", width=801, height=601, values=np.array([900.0, 400.0, 300.0, -0.08, 0.03]))
OFFSET = Camera(model="basic", width=801, height=601, values=np.array([910.0, 404.5, 297.25, -0.05, 0.01]), pixel_pitch_mm=0.005)  # fmt: skip


def make_block(cameras: tuple[Camera, ...] = (CENTRED, OFFSET), seed: int = 5) -> Block:
    """Four photos by the cameras in turn, the third not oriented; observations are exact projections."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (30, 3))
    centres = np.array([[-2.0, -6, 0.3], [0, -6.5, 0.5], [0, 0, 0], [2, -6, -0.4]])
    ups = np.array([[0, 0, 1.0], [0.3, 0, 1], [0, 0, 1], [1, 0, 0.2]])
    rotations = np.stack(
        [
            look_at(c, np.zeros(3), u) if i != 2 else np.eye(3)
            for i, (c, u) in enumerate(zip(centres, ups, strict=True))
        ]
    )
    camera_of_photo = np.arange(4, dtype=np.int32) % len(cameras)
    rows = []
    for p in range(30):
        for i in (0, 1, 3):
            exact = pixel_from_ray(cameras[camera_of_photo[i]], (points[p] - centres[i]) @ rotations[i].T)[0]
            rows.append([i, p, *exact])
    table = np.array(rows)
    return Block(
        cameras=cameras, names=("a.jpg", "b b.jpg", "c.jpg", "d.jpg"), camera_of_photo=camera_of_photo,
        oriented=np.array([True, True, False, True]), rotations=rotations, centres=centres, points=points,
        colours=rng.integers(0, 256, (30, 3)).astype(np.uint8), point_track=np.arange(30, dtype=np.int32),
        obs_photo=table[:, 0].astype(np.int32), obs_point=table[:, 1].astype(np.int32), obs_xy=table[:, 2:],
    )  # fmt: skip


@pytest.fixture
def block_of() -> Callable[..., Block]:
    """Return the maker of small exact blocks."""
    return make_block
