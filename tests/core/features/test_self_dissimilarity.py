"""Self-dissimilarity: the kernel against its definition, the points against the authors' implementation."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from graphos_core.features.detectors.msd_kernels import nearest_distance_sums
from graphos_core.features.detectors.self_dissimilarity import (
    circle_directions,
    maxima,
    nearest_patches,
    possible_levels,
    pyramid,
    refined,
    saliency,
)


def by_definition(image: np.ndarray, patch: int, search: int, neighbours: int) -> np.ndarray:
    values = image.astype(np.int64)
    distances = []
    for dy in range(-search, search + 1):
        for dx in range(-search, search + 1):
            if dx or dy:
                square = (values - np.roll(values, (-dy, -dx), (0, 1))) ** 2
                reach = range(-patch, patch + 1)
                distances.append(sum(np.roll(square, (-v, -u), (0, 1)) for v in reach for u in reach))
    sums = np.sort(np.array(distances), axis=0)[:neighbours].sum(axis=0)
    border = patch + search
    inner = np.zeros_like(sums)
    inner[border:-border, border:-border] = sums[border:-border, border:-border]
    return inner


def textured(height: int, width: int) -> np.ndarray:
    noise = np.random.default_rng(3).normal(0, 1, (height, width))
    smooth = cv2.GaussianBlur(noise, (0, 0), 2.5)
    return np.clip(np.rint(128 + 45 * smooth / smooth.std()), 0, 255).astype(np.uint8)


@pytest.mark.parametrize(
    ("shape", "patch", "search", "neighbours"),
    [
        ((70, 301), 3, 5, 4),
        ((40, 41), 2, 3, 1),
        ((45, 290), 4, 2, 6),
        ((31, 30), 7, 4, 5),
        ((16, 60), 3, 5, 4),
    ],
)
def test_the_kernel_gives_the_sums_of_the_definition(
    shape: tuple[int, int], patch: int, search: int, neighbours: int
) -> None:
    image = np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)
    found = nearest_distance_sums(image.astype(np.float32), patch, search, neighbours)
    if min(shape) <= 2 * (patch + search):
        assert not found.any()
    else:
        np.testing.assert_array_equal(found, by_definition(image, patch, search, neighbours))


def test_points_are_those_of_the_reference_implementation() -> None:
    grey = textured(260, 330)
    reference = cv2.xfeatures2d.MSDDetector_create(3, 5, 5, 0, 250.0, 4, 1.25, -1, False).detect(grey)
    assert len(reference) > 100
    images = pyramid(grey, 1.25, possible_levels(grey.shape, 3, 5, 1.25))
    levels = [saliency(image, 3, 5, 4) for image in images]
    expected = {level: [p for p in reference if p.octave == level] for level in range(len(images))}
    for level, own in enumerate(levels):
        pixels = maxima(levels, level, 250.0, 5, 0, 1.25)
        xy, good = refined(own, pixels)
        pixels, xy = pixels[good], xy[good]
        assert len(xy) == len(expected[level])
        if len(xy) == 0:
            continue
        np.testing.assert_array_equal(
            own[pixels[:, 1], pixels[:, 0]], np.float32([p.response for p in expected[level]])
        )
        # the reference adds half a pixel to the points of the photo itself, which we do not follow
        offset = 0.5 if level == 0 else 0.0
        outer = (xy + 0.5) * 1.25**level - 0.5 + offset
        np.testing.assert_allclose(outer, [p.pt for p in expected[level]], atol=2e-2)


def test_a_maximum_exceeds_the_same_place_on_the_neighbouring_levels() -> None:
    """The reference reads neighbouring levels with the row length of its own, hence at other places."""
    grey = textured(150, 190)
    levels = [saliency(image, 3, 5, 4) for image in pyramid(grey, 1.25, 5)]
    alone = {tuple(p) for p in maxima(levels, 2, 250.0, 5, 0, 1.25)}
    kept = {tuple(p) for p in maxima(levels, 2, 250.0, 5, 1, 1.25)}
    expected = set()
    for column, row in alone:
        others = [
            levels[other][round(row * scale), round(column * scale)]
            for other, scale in ((1, 1.25), (3, 1 / 1.25))
        ]
        if levels[2][row, column] >= max(others):
            expected.add((column, row))
    assert kept == expected
    assert 0 < len(kept) < len(alone)


def test_nearest_patches_are_those_behind_the_saliency() -> None:
    image = textured(60, 80)
    field = saliency(image, 3, 5, 4)
    shift, distance = nearest_patches(image, 33, 25, 3, 5, 4)
    assert field[25, 33] == pytest.approx(distance.mean(), rel=1e-6)
    for (dx, dy), expected in zip(shift, distance, strict=True):
        a = image[22:29, 30:37].astype(float)
        b = image[22 + dy : 29 + dy, 30 + dx : 37 + dx].astype(float)
        assert ((a - b) ** 2).mean() == pytest.approx(expected)
    assert (np.diff(distance) >= 0).all()


def test_a_paraboloid_is_refined_to_its_peak() -> None:
    columns, rows = np.meshgrid(np.arange(20.0), np.arange(16.0))
    u, v = columns - 9.3, rows - 7.8
    field = (1000 - 3 * u**2 - 2 * v**2 + 1.5 * u * v).astype(np.float32)
    xy, good = refined(field, np.array([[9, 8]]))
    assert good.all()
    np.testing.assert_allclose(xy, [[9.3, 7.8]], atol=1e-3)


def test_a_flat_neighbourhood_keeps_its_pixel() -> None:
    xy, good = refined(np.full((9, 9), 5.0, np.float32), np.array([[4, 4]]))
    assert good.all()
    np.testing.assert_array_equal(xy, [[4.0, 4.0]])


def test_the_direction_turns_with_the_image() -> None:
    image = textured(101, 101)
    centre = np.array([[50, 50]])
    first = circle_directions(image, centre, 3, 5)
    for quarter in (1, 2, 3):
        turned = circle_directions(np.ascontiguousarray(np.rot90(image, -quarter)), centre, 3, 5)
        difference = (turned - first - quarter * np.pi / 2 + np.pi) % (2 * np.pi) - np.pi
        np.testing.assert_allclose(difference, 0.0, atol=1e-6)


def test_an_image_smaller_than_the_search_area_has_no_level() -> None:
    assert possible_levels((16, 400), 3, 5, 1.25) == 0
    assert possible_levels((22, 400), 3, 5, 1.25) == 1
