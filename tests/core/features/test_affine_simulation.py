"""Simulated views: their number, their geometry and the way back."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from graphos_core.features.detectors.affine_simulation import (
    fully_inside,
    keypoints_in_photo,
    mapped,
    simulate,
    views,
)


def blob_photo(x: float, y: float, width: int = 160, height: int = 120, sigma: float = 3.0) -> np.ndarray:
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    spot = np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / (2 * sigma**2))
    return np.rint(20 + 200 * spot).astype(np.uint8)


def centroid(image: np.ndarray) -> np.ndarray:
    weight = image.astype(float) - 20.0
    columns, rows = np.meshgrid(np.arange(image.shape[1]), np.arange(image.shape[0]))
    return np.array([(weight * columns).sum(), (weight * rows).sum()]) / weight.sum()


def test_there_are_as_many_views_as_opencv_s_affine_feature_has() -> None:
    noise = np.random.default_rng(1).integers(0, 256, (90, 120), dtype=np.uint8)
    backend = cv2.SIFT_create(contrastThreshold=0.005)
    points = cv2.AffineFeature_create(backend, 5, 0, math.sqrt(2.0), 72.0).detect(noise)
    assert {p.class_id for p in points} == set(range(len(views(5, math.radians(72.0)))))


def test_longitudes_cover_half_a_turn_in_steps_that_shrink_with_the_tilt() -> None:
    for tilt, longitude in views(4, math.radians(72.0))[1:]:
        steps = longitude * tilt / math.radians(72.0)
        assert steps == pytest.approx(round(steps), abs=1e-9)
        assert 0.0 <= longitude < math.pi


@pytest.mark.parametrize(("tilt", "longitude"), [(1.0, 0.0), (math.sqrt(2.0), 0.7), (2.0, 2.1), (4.0, 1.2)])
def test_a_blob_is_where_the_affine_map_says(tilt: float, longitude: float) -> None:
    view = simulate(blob_photo(71.3, 52.8), tilt, longitude)
    expected = mapped(view.simulated_from_photo, np.array([[71.3, 52.8]]))[0]
    np.testing.assert_allclose(centroid(view.image), expected, atol=0.02)
    np.testing.assert_allclose(mapped(view.photo_from_simulated, expected[None])[0], (71.3, 52.8), atol=1e-9)


def test_a_circular_blob_becomes_an_ellipse_of_the_tilt() -> None:
    view = simulate(blob_photo(80, 60, sigma=8.0), 2.0, 0.0)
    weight = view.image.astype(float) - 20.0
    columns, rows = np.meshgrid(np.arange(view.image.shape[1]), np.arange(view.image.shape[0]))
    x, y = centroid(view.image)
    variance_x = (weight * (columns - x) ** 2).sum() / weight.sum()
    variance_y = (weight * (rows - y) ** 2).sum() / weight.sum()
    blur = 0.8**2 * (2.0**2 - 1)
    np.testing.assert_allclose([variance_x, variance_y], [(64 + blur) / 4, 64], rtol=0.02)


def test_fine_stripes_do_not_alias() -> None:
    columns = np.arange(400)
    stripes = np.tile(np.rint(127 + 120 * np.cos(2 * np.pi * columns / 4.3)), (60, 1)).astype(np.uint8)
    assert simulate(stripes, 4.0, 0.0).image[:, 10:-10].std() < 1.5


def test_scale_and_angle_come_back_by_the_affine_map() -> None:
    view = simulate(blob_photo(80, 60), 2.0, math.pi / 2)
    xy = mapped(view.simulated_from_photo, np.array([[40.0, 30.0]]))
    back, scale, angle = keypoints_in_photo(view, xy, np.array([5.0]), np.array([0.0]))
    np.testing.assert_allclose(back, [[40.0, 30.0]], atol=1e-9)
    np.testing.assert_allclose(scale, 5.0 * math.sqrt(2.0))
    np.testing.assert_allclose(angle, -math.pi / 2, atol=1e-12)


def test_circles_that_reach_over_the_border_of_the_photo_are_told() -> None:
    view = simulate(blob_photo(80, 60), 2.0, 0.9)
    photo = np.array([[80.0, 60.0], [3.0, 3.0], [-4.0, 60.0], [2.0, 60.0], [2.0, 60.0]])
    inside = fully_inside(
        view, mapped(view.simulated_from_photo, photo), np.array([10.0, 10.0, 0.0, 0.5, 9.0])
    )
    assert inside.tolist() == [True, False, False, True, False]
