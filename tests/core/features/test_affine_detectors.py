"""MSD, ASIFT and affine MSD: places, one position per point, and what simulation is good for."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from graphos_core.data import Features
from graphos_core.features.detectors.affine_kernels import leaders, most_different
from graphos_core.features.detectors.amsd import AmsdParams, amsd
from graphos_core.features.detectors.asift import AsiftParams, asift
from graphos_core.features.detectors.msd import MsdParams, msd
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.run import Run

RUN = Run()


def texture(height: int = 180, width: int = 240, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    layers = [cv2.GaussianBlur(rng.uniform(-1, 1, (height, width)).astype(np.float32), (0, 0), s) * s
              for s in (2.0, 5.0)]  # fmt: skip
    return cv2.normalize(np.sum(layers, axis=0), None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


def tilted(image: np.ndarray, tilt: float, degrees: float) -> tuple[np.ndarray, np.ndarray]:
    """View from aside made independently of the engine's simulation: area averages of an enlarged photo."""
    h, w = image.shape
    turn = np.vstack([cv2.getRotationMatrix2D((w / 2 - 0.5, h / 2 - 0.5), degrees, 1.0), [0, 0, 1]])
    squeeze = np.array([[1 / tilt, 0, (w - w / tilt) / 2], [0, 1, 0], [0, 0, 1]])
    fine = 4.0
    enlarge = np.array([[fine, 0, (fine - 1) / 2], [0, fine, (fine - 1) / 2], [0, 0, 1]])
    large = cv2.warpPerspective(
        image, enlarge @ squeeze @ turn, (int(w * fine), int(h * fine)), flags=cv2.INTER_CUBIC,
        borderMode=cv2.BORDER_CONSTANT, borderValue=128,
    )  # fmt: skip
    large = cv2.GaussianBlur(large, (0, 0), 1.6)
    return cv2.resize(large, (w, h), interpolation=cv2.INTER_AREA), squeeze @ turn


def right_points(a: Features, b: Features, b_from_a: np.ndarray) -> tuple[int, int]:
    """Number of matches, and of cells of 2 px with one within 3 px of the truth."""
    matches = mutual(a, b, MutualParams(), run=RUN).matches
    mapped = cv2.perspectiveTransform(a.xy[None].astype(np.float64), b_from_a)[0]
    right = np.linalg.norm(mapped[matches[:, 0]] - b.xy[matches[:, 1]], axis=1) < 3.0
    return len(matches), len(np.unique(np.floor(a.xy[matches[right, 0]] / 2), axis=0))


@pytest.mark.parametrize(
    ("plain", "plain_params", "affine", "affine_params"),
    [(sift, SiftParams(), asift, AsiftParams()), (msd, MsdParams(threshold=50.0), amsd, AmsdParams(tilts=2))],
)
def test_simulated_views_match_a_photo_from_aside(plain, plain_params, affine, affine_params) -> None:  # type: ignore[no-untyped-def]
    image = texture(240, 320)
    other, truth = tilted(image, 2.6, 40.0)
    _, by_plain = right_points(*(plain(i, i, plain_params, run=RUN) for i in (image, other)), truth)
    matches, by_affine = right_points(*(affine(i, i, affine_params, run=RUN) for i in (image, other)), truth)
    assert by_affine >= 3 * max(by_plain, 10)
    assert by_affine > 0.7 * matches


@pytest.mark.parametrize("name", ["asift", "amsd"])
def test_without_tilts_the_plain_points_remain(name: str) -> None:
    image = texture()
    common = {"merge": 0.0, "maximum": 100_000}
    plain, affine = {
        "asift": (sift(image, image, SiftParams(maximum=100_000), run=RUN),
                  asift(image, image, AsiftParams(tilts=0, **common), run=RUN)),
        "amsd": (msd(image, image, MsdParams(maximum=100_000), run=RUN),
                 amsd(image, image, AmsdParams(tilts=0, nms_radius=5, threshold=20.0, selection="scale", **common), run=RUN)),
    }[name]  # fmt: skip
    np.testing.assert_allclose(affine.xy, plain.xy, atol=1e-4)
    np.testing.assert_array_equal(affine.descriptors, plain.descriptors)


def test_points_of_several_views_share_one_position_and_few_descriptors() -> None:
    image = texture()
    found = asift(image, image, AsiftParams(descriptors=3), run=RUN)
    _, count = np.unique(found.xy, axis=0, return_counts=True)
    assert count.max() <= 3
    assert (count > 1).mean() > 0.3
    assert (found.xy > -0.5).all() and (found.xy < (239.5, 179.5)).all()


def test_the_first_near_point_without_a_leader_leads() -> None:
    pairs = np.array([[0, 2], [1, 2], [1, 3], [2, 4], [3, 4]])
    np.testing.assert_array_equal(leaders(pairs, 6), [0, 1, 0, 1, 4, 5])


def test_the_most_different_descriptors_stay() -> None:
    descriptors = np.array([[10, 10], [12, 10], [200, 10], [10, 90], [7, 7]], np.uint8)
    order, begins = np.arange(5), np.array([0, 4, 5])
    np.testing.assert_array_equal(
        most_different(descriptors, order, begins, 2), [True, False, True, False, True]
    )
    np.testing.assert_array_equal(
        most_different(descriptors, order, begins, 3), [True, False, True, True, True]
    )


@pytest.mark.parametrize("orientation", ["gradients", "dissimilarity"])
def test_msd_points_are_found_again_in_a_turned_photo(orientation: str) -> None:
    image = texture()
    warp = np.vstack([cv2.getRotationMatrix2D((119.5, 89.5), 30.0, 0.9), [0, 0, 1]])
    turned = cv2.warpPerspective(image, warp, (240, 180), borderMode=cv2.BORDER_REFLECT)
    params = MsdParams(orientation=orientation, threshold=100.0)
    matches, right = right_points(*(msd(i, i, params, run=RUN) for i in (image, turned)), warp)
    assert right >= 30
    assert right > 0.7 * matches
