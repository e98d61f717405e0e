"""A small block with known truth: convergent and rolled photos round a scene with depth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Block, Camera
from graphos_core.geometry.rotation import look_at, matrix_from_vector

WIDTH, HEIGHT = 1600, 1200


class Made(NamedTuple):
    """The block as it is, and as it is given to the adjustment: noisy observations, disturbed start."""

    truth: Block
    start: Block


def make(
    seed: int = 0,
    noise_px: float = 0.3,
    photos: int = 8,
    points: int = 150,
    cameras: int = 1,
    shake: float = 0.01,
) -> Made:
    rng = np.random.default_rng(seed)
    camera = Camera(
        model="basic", width=WIDTH, height=HEIGHT, values=np.array([1500.0, 805.0, 592.0, -0.12, 0.05])
    )
    ground = rng.uniform([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0], (points, 3))
    azimuth = 2.0 * np.pi * np.arange(photos) / photos
    centres = np.stack([5.0 * np.cos(azimuth), 5.0 * np.sin(azimuth), 5.0 + np.sin(3 * azimuth)], axis=1)
    rotations = np.stack([
        matrix_from_vector([0.0, 0.0, (i % 4) * np.pi / 2]) @ look_at(c, rng.normal(0.0, 0.2, 3))
        for i, c in enumerate(centres)
    ])  # fmt: skip
    rows = []
    for i in range(photos):
        pixel = pixel_from_ray(camera, (ground - centres[i]) @ rotations[i].T)
        inside = (pixel > 0).all(axis=1) & (pixel < [WIDTH - 1, HEIGHT - 1]).all(axis=1)
        rows += [(p, i, *pixel[p]) for p in np.flatnonzero(inside)]
    table = np.array(sorted(rows))
    block = Block(
        cameras=(camera,) * cameras,
        names=tuple(f"photo {i}" for i in range(photos)),
        camera_of_photo=(np.arange(photos) % cameras).astype(np.int32),
        oriented=np.ones(photos, dtype=bool),
        rotations=rotations,
        centres=centres,
        points=ground,
        colours=np.zeros((points, 3), dtype=np.uint8),
        point_track=np.arange(points, dtype=np.int32),
        obs_photo=table[:, 1].astype(np.int32),
        obs_point=table[:, 0].astype(np.int32),
        obs_xy=table[:, 2:],
    )
    start = replace(
        block,
        cameras=(replace(camera, values=camera.values * [1.0 + shake, 1.0, 1.0, 0.5, 0.5]),) * cameras,
        rotations=np.stack([matrix_from_vector(rng.normal(0.0, shake, 3)) @ r for r in rotations]),
        centres=centres + rng.normal(0.0, 5.0 * shake, centres.shape),
        points=ground + rng.normal(0.0, 5.0 * shake, ground.shape),
        obs_xy=block.obs_xy + rng.normal(0.0, noise_px, block.obs_xy.shape),
    )
    return Made(block, start)


@pytest.fixture(scope="session")
def make_block() -> Callable[..., Made]:
    """Make a block; see `make`."""
    return make
