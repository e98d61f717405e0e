"""Orientation and descriptor of a keypoint: OpenCV's SIFT is the oracle for every keypoint of a photo."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from graphos_core.data import Array
from graphos_core.features.descriptor import (
    CELLS,
    bin_shares,
    describe,
    descriptor_histogram,
    gradients,
    normalised,
    orientation_histogram,
    orientation_peaks,
)


@pytest.fixture(scope="module")
def photo() -> Array:
    """Blobs of every size on a slope, with a little noise, uint8 (301, 397): odd sizes on purpose."""
    draw = np.random.default_rng(3)
    grey = np.zeros((301, 397), np.float32)
    for _ in range(260):
        x, y, radius = draw.uniform(0, 397), draw.uniform(0, 301), 2.0 ** draw.uniform(0.7, 5)
        cv2.ellipse(
            grey, ((x, y), (radius, 1.6 * radius), draw.uniform(0, 180)), float(draw.uniform(30, 220)), -1
        )
    grey = cv2.GaussianBlur(grey, (0, 0), 0.8) + np.linspace(0, 30, 397, dtype=np.float32)
    return np.clip(grey + draw.normal(size=grey.shape), 0, 255).astype(np.uint8)


def test_descriptor_and_direction_are_those_of_opencv(photo: Array) -> None:
    sift = cv2.SIFT_create(0, 3, 0.04, 10, 1.6, cv2.CV_32F, True)  # type: ignore[attr-defined]
    points, descriptors = sift.detectAndCompute(photo, None)
    assert len(points) > 300
    worst, turned = [], []
    for point, descriptor in zip(points[::3], descriptors[::3], strict=True):
        made = describe(photo, *point.pt, point.size, np.radians(point.angle))
        worst.append(np.abs(made.descriptor.astype(float) - descriptor).max())
        off = np.angle(np.exp(1j * (made.peaks - np.radians(point.angle))))
        turned.append(np.abs(off).min())
        octave = (point.octave & 255) + 1 if (point.octave & 255) < 128 else 0
        assert (made.octave, made.layer) == (octave, point.octave >> 8 & 255)
    assert np.percentile(worst, 98) <= 1.0  # bytes; OpenCV's arctangent is good to 0.3 degrees
    assert np.percentile(turned, 95) < np.radians(0.5)


def test_other_layers_and_first_blur_are_followed(photo: Array) -> None:
    sift = cv2.SIFT_create(0, 4, 0.04, 10, 2.0, cv2.CV_32F, True)  # type: ignore[attr-defined]
    points, descriptors = sift.detectAndCompute(photo, None)
    for point, descriptor in zip(points[::12], descriptors[::12], strict=True):
        made = describe(photo, *point.pt, point.size, np.radians(point.angle), layers=4, sigma=2.0)
        assert np.linalg.norm(made.descriptor - descriptor) < 15.0


def test_a_turned_photo_has_the_same_descriptor(photo: Array) -> None:
    before = describe(photo, 200.0, 152.0, 20.0, 0.3)
    turned = np.ascontiguousarray(np.rot90(photo, -1))  # clockwise: (x, y) → (h − 1 − y, x)
    after = describe(turned, photo.shape[0] - 1 - 152.0, 200.0, 20.0, 0.3 + np.pi / 2)
    assert np.linalg.norm(before.final - after.final) < 0.12
    assert np.linalg.norm(before.final - describe(turned, 148.0, 200.0, 20.0, 0.3).final) > 0.4
    assert np.corrcoef(before.patch.ravel(), after.patch.ravel())[0, 1] > 0.99


def test_brightness_and_contrast_leave_the_descriptor(photo: Array) -> None:
    before = describe(photo, 120.0, 90.0, 16.0, 1.0)
    after = describe(0.4 * photo.astype(np.float32) + 60.0, 120.0, 90.0, 16.0, 1.0)
    np.testing.assert_allclose(after.raw, 0.4 * before.raw, rtol=1e-4, atol=1e-2)
    np.testing.assert_allclose(after.final, before.final, atol=1e-5)


@pytest.mark.parametrize("towards", [0.0, 0.7, 2.5, -1.2, np.pi])
def test_a_slope_has_one_direction(towards: float) -> None:
    rows, columns = np.mgrid[0:81, 0:81].astype(np.float32)
    slope = np.cos(towards) * columns + np.sin(towards) * rows
    histogram = orientation_histogram(slope, (40.0, 40.0), 4.0)
    peaks = orientation_peaks(histogram)
    assert len(peaks) == 1
    assert abs(np.angle(np.exp(1j * (peaks[0] - towards)))) < np.radians(5.0)  # half a bin
    along = descriptor_histogram(slope, (40.0, 40.0), 3.0, towards)
    assert along[..., 0].sum() > 0.99 * along.sum()
    # the same slope seen by a keypoint that points 90 degrees clockwise of it: bin 2, counter-clockwise
    beside = descriptor_histogram(slope, (40.0, 40.0), 3.0, towards + np.pi / 2)
    assert beside[..., 2].sum() > 0.99 * beside.sum()


def test_cells_are_counted_from_the_upper_left_of_the_upright_patch() -> None:
    image = np.zeros((121, 121), np.float32)
    image[30:38, 30:38] = np.arange(8, dtype=np.float32) * 10  # upper left of (60, 60)
    cells = descriptor_histogram(image, (60.0, 60.0), 6.0, 0.0).sum(axis=2)
    assert np.unravel_index(cells.argmax(), cells.shape) == (0, 0)
    # the patch shows it on the same side, and turned by 90 degrees on the lower left
    down = descriptor_histogram(image, (60.0, 60.0), 6.0, np.pi / 2).sum(axis=2)
    assert np.unravel_index(down.argmax(), down.shape) == (CELLS - 1, 0)


def test_two_peaks_of_similar_height_are_both_reported() -> None:
    histogram = np.full(36, 1.0)
    histogram[[4, 5, 6]] = 5.0, 10.0, 5.0
    histogram[[20, 21, 22]] = 4.0, 8.1, 6.0
    histogram[30] = 7.0
    peaks = np.degrees(orientation_peaks(histogram))
    assert len(peaks) == 2
    assert peaks[0] == pytest.approx(50.0)
    assert -150.0 < peaks[1] < -145.0  # 210 degrees, pulled towards the higher neighbour
    assert len(orientation_peaks(histogram, 0.5)) == 3


def test_the_histogram_is_cut_at_a_fifth_and_has_length_one() -> None:
    raw = np.zeros((4, 4, 8))
    raw[0, 0, 0], raw[1, 1, 1] = 100.0, 1.0
    unit, final = normalised(raw)
    assert np.linalg.norm(unit) == pytest.approx(1.0)
    assert np.linalg.norm(final) == pytest.approx(1.0)
    assert final[1, 1, 1] / final[0, 0, 0] == pytest.approx(0.2**-1 * unit[1, 1, 1])
    assert not normalised(np.zeros((4, 4, 8)))[1].any()


def test_shares_of_bins_add_up_except_outside() -> None:
    assert bin_shares(1.25, 4) == {1: 0.75, 2: 0.25}
    assert bin_shares(-0.5, 4) == {0: 0.5}
    assert bin_shares(7.5, 8, circular=True) == {7: 0.5, 0: 0.5}


def test_the_patch_and_its_gradients_agree() -> None:
    _, columns = np.mgrid[0:101, 0:101].astype(np.float32)
    made = describe(2.0 * columns, 50.0, 50.0, 8.0, np.pi / 2)  # slope to the right, keypoint points down
    middle = made.patch[16:48, 16:48]
    size, direction = gradients(middle)
    assert np.allclose(direction, -np.pi / 2, atol=0.02)  # up, in the upright patch
    per_pixel = 2.0 * 4 * 3 * 4.0 / 64  # grey levels per px times 12 σ over 64 px
    assert np.allclose(size, per_pixel, rtol=0.02)


@pytest.mark.parametrize("grey", [np.full((40, 60), 90, np.uint8), np.zeros((1, 50), np.uint8)])
def test_without_texture_everything_is_zero(grey: Array) -> None:
    made = describe(grey, 20.0, 0.0, 12.0, 0.0)
    assert not made.descriptor.any()
    assert len(made.peaks) == 0


def test_a_keypoint_outside_is_refused(photo: Array) -> None:
    with pytest.raises(ValueError, match="keypoint at"):
        describe(photo, -1.0, 5.0, 8.0, 0.0)
