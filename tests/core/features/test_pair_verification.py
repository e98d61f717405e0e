import dataclasses

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera, Candidates, Features
from graphos_core.features.verification import UsacParams, usac
from graphos_core.geometry.epipolar import (
    essential_from_relative,
    fundamental_from_cameras,
    relative_orientation,
)
from graphos_core.geometry.rotation import look_at
from graphos_core.run import Run

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.08, 0.01]))
CENTRES = np.array([[0.0, -10.0, 1.0], [2.5, -9.5, 1.5]])
ROTATIONS = [look_at(centre, np.zeros(3)) for centre in CENTRES]
NOISE_PX = 0.3


def photo(xy: np.ndarray) -> Features:
    n = len(xy)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=xy.astype(np.float32), scale=zero, angle=zero, response=zero, descriptors=np.zeros((n, 128), np.uint8),
        colour=np.zeros((n, 3), np.uint8), width=1600, height=1200,
    )  # fmt: skip


def pair(right: int = 300, wrong: int = 100, seed: int = 0) -> tuple[Features, Features, np.ndarray]:
    """Two photos of points in a box, with Gaussian noise, and candidate matches of which the last `wrong` are false."""
    rng = np.random.default_rng(seed)
    points = rng.uniform((-3, -2, -2), (3, 2, 2), (right, 3))
    seen = []
    for rotation, centre in zip(ROTATIONS, CENTRES, strict=True):
        xy = pixel_from_ray(CAMERA, (points - centre) @ rotation.T) + rng.normal(0, NOISE_PX, (right, 2))
        seen.append(photo(np.concatenate([xy, rng.uniform((0, 0), (1600, 1200), (wrong, 2))])))
    index = np.arange(right + wrong, dtype=np.int32)
    return seen[0], seen[1], np.stack([index, index], axis=1)


def verify(right: int = 300, wrong: int = 100, camera: Camera = CAMERA, seed: int = 0, **params: object):
    a, b, candidates = pair(right, wrong)
    sheet = UsacParams(**{"threshold": 1.5, **params})
    return usac((0, 1), a, b, Candidates.of(candidates), (camera, camera), sheet, run=Run(seed=seed))


@pytest.mark.parametrize("model", ["essential", "fundamental"])
def test_right_matches_stay_and_wrong_ones_go(model: str) -> None:
    camera = CAMERA if model == "essential" else dataclasses.replace(CAMERA, focal_estimated=True)
    found = verify(camera=camera, threshold=1.5 if model == "essential" else 4.0)
    assert found.kind == model and found.reason == ""
    kept = found.matches[:, 0]
    assert (kept < 300).sum() >= 294  # 1.5 px are five standard deviations
    assert (kept >= 300).sum() <= 4  # wrong, but by chance on the line
    assert found.candidates == 400


def test_the_essential_matrix_is_that_of_the_true_orientation() -> None:
    found = verify(wrong=0)
    truth = essential_from_relative(*relative_orientation(ROTATIONS[0], CENTRES[0], ROTATIONS[1], CENTRES[1]))
    truth /= np.linalg.norm(truth)
    sign = np.sign((truth * found.matrix).sum())
    assert np.abs(sign * found.matrix - truth).max() < 5e-3


def test_distances_from_the_true_lines_agree_with_the_injected_noise() -> None:
    a, b, candidates = pair(wrong=0)
    found = verify(wrong=0)
    straight = dataclasses.replace(CAMERA, values=np.array([*CAMERA.values[:3], 0.0, 0.0]))
    assert len(found.matches) == 300
    fundamental = fundamental_from_cameras(
        straight, ROTATIONS[0], CENTRES[0], straight, ROTATIONS[1], CENTRES[1]
    )
    from graphos_core.cameras import ray_from_pixel
    from graphos_core.geometry.epipolar import sampson_distances

    ideal = [
        ray_from_pixel(CAMERA, f.xy[m].astype(float))[:, :2] * CAMERA.focal_px + CAMERA.values[1:3]
        for f, m in ((a, candidates[:, 0]), (b, candidates[:, 1]))
    ]
    distances = sampson_distances(fundamental, *ideal)
    assert np.sqrt((distances**2).mean()) == pytest.approx(NOISE_PX, rel=0.12)


def test_pairs_with_too_few_matches_are_rejected_with_the_numbers() -> None:
    few = verify(right=9, wrong=0)
    assert few.reason == "only 9 candidate matches, 15 needed"
    assert few.kind == "none" and few.matches.shape == (0, 2) and not few.matrix.any()
    unrelated = verify(right=0, wrong=60)
    assert unrelated.reason.startswith("only ") and unrelated.reason.endswith(
        "verified matches of 60, 15 needed"
    )


def test_points_in_one_place_are_rejected_and_do_not_stop_the_work() -> None:
    same = photo(np.full((40, 2), 500.0))
    index = np.stack([np.arange(40, dtype=np.int32)] * 2, axis=1)
    for model in ("essential", "fundamental"):
        found = usac(
            (0, 1), same, same, Candidates.of(index), (CAMERA, CAMERA), UsacParams(model=model), run=Run()
        )
        assert found.a == 0 and (found.reason or len(found.matches) == 40)


def test_the_same_seed_gives_the_same_bits() -> None:
    one, two = verify(seed=3), verify(seed=3)
    assert np.array_equal(one.matrix, two.matrix) and np.array_equal(one.matches, two.matches)
