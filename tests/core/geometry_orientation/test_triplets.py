"""A synchronised triple against known photos."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.data import Array
from graphos_core.geometry.rays import Rays, direction_rays, tangents
from graphos_core.geometry.rotation import angle_between, matrix_from_vector
from graphos_core.geometry.triplet import orient_triplet

SCALE = 800.0
ROTATIONS = np.stack(
    [
        np.eye(3),
        matrix_from_vector(np.array([0.1, -0.3, 0.2])),
        matrix_from_vector(np.array([-0.2, 0.4, 1.0])),
    ]
)
CENTRES = np.array([[0.0, 0.0, 0.0], [1.0, 0.1, -0.2], [-0.7, 0.9, 0.4]])


def photos(noise_px: float, wrong: int = 0) -> list[Rays]:
    rng = np.random.default_rng(4)
    points: Array = rng.normal(size=(300, 3)) * [2.0, 2.0, 1.0] + [0.0, 0.0, 3.0]
    sides = []
    for rotation, centre in zip(ROTATIONS, CENTRES, strict=True):
        seen = (points - centre) @ rotation.T
        unit = seen / np.linalg.norm(seen, axis=1, keepdims=True)
        across, down = tangents(unit)
        shift = rng.normal(0, noise_px / SCALE, (2, 300, 1))
        sides.append(unit + shift[0] * across + shift[1] * down)
    sides[2][:wrong] = sides[2][:wrong][::-1]
    return [direction_rays(side, SCALE) for side in sides]


@pytest.mark.parametrize("noise_px", [0.0, 0.3])
def test_two_pairs_are_brought_to_one_scale(noise_px: float) -> None:
    found = orient_triplet(*photos(noise_px), max(4.0 * noise_px, 0.1), seed=0)
    base = np.linalg.norm(CENTRES[1])
    limit = 1e-7 if noise_px == 0.0 else 5e-3
    assert found and found.inliers.mean() > 0.95
    np.testing.assert_allclose(found.centres, CENTRES / base, atol=limit)
    assert max(angle_between(r, t) for r, t in zip(found.rotations, ROTATIONS, strict=True)) < limit


def test_a_wrong_match_in_the_third_photo_is_found() -> None:
    found = orient_triplet(*photos(0.3, wrong=60), 1.5, seed=0)
    assert found and found.inliers[:60].mean() < 0.05 and found.inliers[60:].mean() > 0.95


def test_too_few_points_are_said() -> None:
    few = [side[np.arange(5)] for side in photos(0.0)]
    found = orient_triplet(*few, 1.0, seed=0)
    assert not found and "5 corresponding points" in found.reason
