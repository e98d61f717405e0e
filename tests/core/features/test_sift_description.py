"""Directions and SIFT descriptors at given points, against the one-point twin and against OpenCV."""

import cv2
import numpy as np
import pytest

from graphos_core.features.descriptor import describe
from graphos_core.features.detectors.description_kernels import centroid_directions
from graphos_core.features.detectors.sift_description import sift_descriptors, sift_directions


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    noise = np.random.default_rng(3).uniform(0, 255, (240, 320)).astype(np.float32)
    return cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2.5), None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


@pytest.mark.parametrize("sigma", [2.0, 3.0, 6.0])
def test_directions_and_descriptors_are_those_of_one_point_at_a_time(image: np.ndarray, sigma: float) -> None:
    xy = np.random.default_rng(4).uniform((60, 60), (260, 180), (25, 2))
    index, angle = sift_directions(image, xy, sigma)
    descriptors = sift_descriptors(image, xy[index], angle, sigma)
    alike = 0
    for i in range(len(xy)):
        own = angle[index == i]
        twin = describe(image, *xy[i], 2 * sigma, float(own[0]))
        assert 1 <= len(own) <= 4
        turned = np.abs(np.angle(np.exp(1j * (own[:, None] - twin.peaks[None]))))
        alike += turned[0].min() < np.radians(8)
        difference = descriptors[index == i][0].astype(float) - twin.descriptor
        assert np.linalg.norm(difference) < 0.06 * 512
    assert alike >= 23  # the twin blurs octave by octave and may see another peak as the highest


def test_a_point_without_texture_has_no_direction() -> None:
    index, angle = sift_directions(np.full((60, 60), 90, np.uint8), np.array([[30.0, 30.0]]), 2.0)
    assert len(index) == len(angle) == 0


def test_the_direction_to_the_centroid_is_that_of_orb(image: np.ndarray) -> None:
    points = cv2.ORB_create(5000, 1.2, 1, 31, 0, 2, cv2.ORB_FAST_SCORE, 31, 10).detect(image)
    xy = np.array([p.pt for p in points])
    expected = np.radians([p.angle for p in points])
    found = centroid_directions(image, xy, 15)
    assert len(points) > 30
    assert np.degrees(np.abs(np.angle(np.exp(1j * (found - expected))))).max() < 0.05
