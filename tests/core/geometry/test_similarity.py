"""Similarities are found again, and what cannot be found is refused."""

import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.geometry.similarity import Similarity, estimate_similarity

TRUE = Similarity(2.5, matrix_from_vector([0.4, -1.2, 2.0]), np.array([10.0, -20.0, 30.0]))


@pytest.mark.parametrize("flat", [1.0, 0.0])
def test_a_similarity_is_found_again_from_points_in_space_and_in_a_plane(flat):
    a = np.random.default_rng(0).normal(size=(10, 3)) * [1.0, 1.0, flat]
    found = estimate_similarity(a, TRUE.apply(a))
    assert found.scale == pytest.approx(2.5)
    assert np.allclose(found.rotation, TRUE.rotation, atol=1e-12)
    assert np.allclose(found.translation, TRUE.translation, atol=1e-10)
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)


def test_residuals_have_the_size_of_the_noise():
    rng = np.random.default_rng(1)
    a = rng.normal(size=(2000, 3))
    b = TRUE.apply(a) + rng.normal(0.0, 0.01, a.shape)
    left = estimate_similarity(a, b).apply(a) - b
    assert np.sqrt((left**2).sum() / (3 * 2000 - 7)) == pytest.approx(0.01, rel=0.05)


def test_a_rigid_motion_keeps_the_scale():
    a = np.random.default_rng(2).normal(size=(20, 3))
    assert estimate_similarity(a, 3.0 * a, with_scale=False).scale == 1.0


def test_a_mirror_image_is_not_answered_by_a_reflection():
    a = np.random.default_rng(3).normal(size=(20, 3))
    assert np.linalg.det(estimate_similarity(a, a * [1, 1, -1]).rotation) == pytest.approx(1.0)


def test_inverse_and_cameras_follow():
    rng = np.random.default_rng(4)
    points, centre = rng.normal(size=(5, 3)), rng.normal(size=3)
    rotation = matrix_from_vector([0.1, 0.2, 0.3])
    assert np.allclose(TRUE.inverse().apply(TRUE.apply(points)), points)
    before = (points - centre) @ rotation.T
    after = (TRUE.apply(points) - TRUE.apply(centre)) @ TRUE.rotate_camera(rotation).T
    assert np.allclose(after, TRUE.scale * before)


@pytest.mark.parametrize("points", [np.zeros((2, 3)), np.outer(np.arange(5.0), [1, 2, 3]), np.ones((4, 3))])
def test_too_few_points_and_points_on_a_line_are_refused(points):
    with pytest.raises(UserError):
        estimate_similarity(points, points)
