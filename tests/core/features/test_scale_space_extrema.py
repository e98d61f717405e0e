"""Extrema of the difference of Gaussians: OpenCV's keypoints, known blobs, edges and corners."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.spatial import cKDTree

from graphos_core.data import Array
from graphos_core.features.detectors.scale_space import scale_space
from graphos_core.features.detectors.scale_space_extrema import (
    EDGE,
    KEPT,
    UNSTABLE,
    WEAK,
    curvature_ratio,
    extreme_samples,
    find_extrema,
    quadratic,
)


def scene(seed: int) -> Array:
    """Ellipses of all sizes with noise, uint8 (241, 323)."""
    draw = np.random.default_rng(seed)
    grey = np.zeros((241, 323), np.float32)
    for _ in range(150):
        box = (
            (draw.uniform(0, 323), draw.uniform(0, 241)),
            tuple(2.0 ** draw.uniform(1, 5, 2)),
            360 * draw.random(),
        )
        cv2.ellipse(grey, box, float(draw.uniform(20, 220)), -1)
    grey = cv2.GaussianBlur(grey, (0, 0), 0.7) + draw.normal(size=grey.shape) * 2
    return np.clip(grey, 0, 255).astype(np.uint8)


@pytest.mark.parametrize(
    ("layers", "contrast", "edge", "sigma"), [(3, 0.04, 10.0, 1.6), (3, 0.09, 4.0, 1.6), (5, 0.03, 12.0, 1.9)]
)
def test_the_keypoints_are_those_of_opencv(layers: int, contrast: float, edge: float, sigma: float) -> None:
    grey = scene(5)
    sift = cv2.SIFT_create(0, layers, contrast, edge, sigma, cv2.CV_32F, True)  # type: ignore[attr-defined]
    theirs = np.array([(*point.pt, point.size) for point in sift.detect(grey, None)])
    found = find_extrema(scale_space(grey, layers=layers, sigma=sigma), contrast=contrast, edge=edge)
    kept = found.verdict == KEPT
    ours = np.column_stack([found.xy, found.diameter])[kept]
    assert len(ours) > 100
    to_ours, _ = cKDTree(ours).query(theirs)
    to_theirs, _ = cKDTree(theirs).query(ours)
    assert np.mean(to_ours < 0.01) > 0.99
    assert np.mean(to_theirs < 0.01) > 0.99
    assert len(np.unique(ours.round(6), axis=0)) == len(ours)
    assert {KEPT, UNSTABLE, WEAK, EDGE} == set(found.verdict.tolist())


@pytest.mark.parametrize("size", [3.0, 5.0, 9.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_blob_is_found_at_its_place_and_size(size: float, sign: float) -> None:
    x, y = 70.3, 64.8
    rows, columns = np.mgrid[0:128, 0:128]
    grey = 128.0 + sign * 100.0 * np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / (2 * size**2))
    found = find_extrema(scale_space(grey.astype(np.float32)))
    kept = np.flatnonzero(found.verdict == KEPT)
    best = kept[np.abs(found.value[kept]).argmax()]
    np.testing.assert_allclose(found.xy[best], (x, y), atol=0.02 * size)
    assert (
        np.sign(found.value[best]) == -sign
    )  # wider minus narrower blur: dark in the middle of a bright blob
    # L(kσ) − L(σ) of a Gaussian blob of variance s² is extreme where σ² k = s² (both blurs add to s²)
    assert found.diameter[best] / 2 == pytest.approx(size / 2 ** (1 / 6), rel=0.05)
    assert found.ratio[best] < 1.1


def test_edges_and_weak_blobs_are_rejected_for_what_they_are() -> None:
    draw = np.random.default_rng(0)
    grey = np.full((160, 160), 60.0) + draw.normal(size=(160, 160)) * 3.0
    grey[:, 80:] += 120
    found = find_extrema(scale_space(grey.astype(np.float32)), least=0.0002)
    inside = (found.diameter < 10) & (np.abs(found.xy[:, 1] - 80) < 60)
    on_edge = inside & (np.abs(found.xy[:, 0] - 79.5) < 6) & (np.abs(found.value) > 0.02)
    assert on_edge.sum() > 5
    assert not (found.verdict[on_edge] == KEPT).any()  # the others slide away along the edge
    assert (found.verdict[on_edge] == EDGE).mean() > 0.5
    flat = inside & (np.abs(found.xy[:, 0] - 40) < 25)
    assert flat.sum() > 5
    assert set(found.verdict[flat].tolist()) == {WEAK, UNSTABLE}


def test_thresholds_work_in_the_direction_they_say() -> None:
    space = scale_space(scene(2))

    def count(**values: float) -> int:
        return int((find_extrema(space, **values).verdict == KEPT).sum())

    assert count(contrast=0.02) > count(contrast=0.04) > count(contrast=0.1)
    assert count(edge=20.0) > count(edge=10.0) > count(edge=3.0)


def test_the_curvature_ratio_is_that_of_the_eigenvalues() -> None:
    draw = np.random.default_rng(1)
    hessian = draw.normal(size=(200, 3, 3))
    hessian += hessian.transpose(0, 2, 1)
    low, high = np.sort(np.linalg.eigvalsh(hessian[:, :2, :2]), axis=1).T
    ratio = np.where(low * high > 0, np.maximum(high / low, low / high), np.inf)
    np.testing.assert_allclose(curvature_ratio(hessian), ratio, rtol=1e-6)


def test_derivatives_are_those_of_a_quadratic() -> None:
    draw = np.random.default_rng(2)
    h = draw.normal(size=(3, 3))
    h, g = h + h.T, draw.normal(size=3)
    z, y, x = np.mgrid[-1:2, -1:2, -1:2].astype(float)
    place = np.stack([x, y, z], axis=-1)
    values = 255 * (7.0 + place @ g + 0.5 * np.einsum("...i,ij,...j", place, h, place))
    value, gradient, hessian = quadratic(values, *np.array([[1], [1], [1]]))
    np.testing.assert_allclose(value, 7.0)
    np.testing.assert_allclose(gradient[0], g)
    np.testing.assert_allclose(hessian[0], h)


def test_an_extremum_is_larger_than_all_its_neighbours() -> None:
    stack = np.random.default_rng(3).normal(size=(5, 40, 50)).astype(np.float32) * 30
    for layer in (1, 2, 3):
        at = {tuple(place) for place in extreme_samples(stack, layer, 0.0)}
        for row in range(5, 35):
            for column in range(5, 45):
                near = stack[layer - 1 : layer + 2, row - 1 : row + 2, column - 1 : column + 2]
                here = stack[layer, row, column]
                extreme = (here == near.max() and here > 0) or (here == near.min() and here < 0)
                assert ((row, column) in at) == extreme


@pytest.mark.parametrize("shape", [(1, 40), (8, 8), (30, 30)])
def test_a_photo_without_structure_has_no_extrema(shape: tuple[int, int]) -> None:
    assert len(find_extrema(scale_space(np.full(shape, 77, np.uint8)))) == 0
