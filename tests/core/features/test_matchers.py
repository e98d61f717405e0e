"""Robust, approximate and guided matching against definitions written out, OpenCV and simulated truth."""

import dataclasses

import cv2
import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera, Features
from graphos_core.features.given_pair import GivenPair
from graphos_core.features.matchers.flann import FlannParams, approximate_neighbours, flann
from graphos_core.features.matchers.guided import GuidedParams, guided
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.features.matchers.robust import RobustParams, robust, unit_roots
from graphos_core.geometry.rotation import look_at
from graphos_core.run import Run

RUN = Run()


def histograms(count: int, seed: int) -> np.ndarray:
    values = np.abs(np.random.default_rng(seed).normal(size=(count, 128))) ** 2
    return np.minimum(np.rint(512 * values / np.linalg.norm(values, axis=1, keepdims=True)), 255).astype(
        np.uint8
    )


def features(descriptors: np.ndarray, xy: np.ndarray | None = None, metric: str = "l2") -> Features:
    n = len(descriptors)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=np.arange(2 * n, dtype=np.float32).reshape(n, 2) if xy is None else xy.astype(np.float32), scale=zero, angle=zero, response=zero,
        descriptors=descriptors, colour=np.zeros((n, 3), np.uint8), width=1600, height=1200, metric=metric,
    )  # fmt: skip


def alike(seed: int = 0, noise: float = 14.0) -> tuple[np.ndarray, np.ndarray]:
    a, b = histograms(400, seed), histograms(350, seed + 1)
    rng = np.random.default_rng(seed + 2)
    b[:200] = np.clip(a[100:300] + rng.normal(0, noise * rng.uniform(0.3, 1.5, (200, 1)), (200, 128)), 0, 255)
    b[330:] = b[:20]  # twins: ambiguous
    return a, b


def distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.linalg.norm(a[:, None].astype(float) - b[None].astype(float), axis=2)


def written_out(table: np.ndarray, q: float, k: float) -> tuple[list[tuple[int, int]], tuple[int, ...]]:
    """Ratio test, then discrepancy, then both directions, in plain loops."""
    best = table.argmin(axis=1)
    two = np.sort(table, axis=1)[:, :2]
    distinct = [i for i in range(len(table)) if two[i, 0] < q * two[i, 1]]
    largest = max(two[i, 0] for i in distinct)
    near = [i for i in distinct if two[i, 0] <= k * largest]
    back = np.sort(table, axis=0)[:2]
    found = [
        (i, int(best[i])) for i in near
        if table[:, best[i]].argmin() == i and back[0, best[i]] < q * back[1, best[i]]
    ]  # fmt: skip
    return found, (len(table), len(distinct), len(near), len(found))


@pytest.mark.parametrize(("q", "k"), [(0.8, 1.0), (0.8, 0.6), (0.9, 0.4)])
def test_robust_matching_is_its_three_steps(q: float, k: float) -> None:
    a, b = alike()
    expected, counts = written_out(distances(a, b), q, k)
    found = robust(features(a), features(b), RobustParams(ratio=q, discrepancy=k), run=RUN)
    assert [tuple(pair) for pair in found.matches.tolist()] == expected
    assert found.steps == tuple(zip(("nearest", "ratio", "discrepancy", "mutual"), counts, strict=True))
    assert 20 < len(expected) < 200


def test_without_a_limit_robust_matching_is_mutual_matching() -> None:
    a, b = (features(d) for d in alike(3))
    plain, loose = mutual(a, b, MutualParams(), run=RUN), robust(a, b, RobustParams(discrepancy=1.0), run=RUN)
    assert np.array_equal(plain.matches, loose.matches)
    assert np.allclose(plain.ratio, loose.ratio, atol=1e-6)


@pytest.mark.parametrize("name", ["hellinger", "bhattacharyya"])
def test_distances_of_histograms_are_those_of_their_formulas(name: str) -> None:
    a, b = alike(5)
    p, q = (d / d.sum(axis=1, keepdims=True, dtype=float) for d in (a, b))
    coefficient = np.sqrt(p)[:, None] * np.sqrt(q)[None]
    table = (
        np.sqrt(np.maximum(1 - coefficient.sum(axis=2), 0))
        if name == "hellinger"
        else -np.log(coefficient.sum(axis=2))
    )
    expected, _ = written_out(table, 0.8, 1.0)
    found = robust(
        features(a), features(b), RobustParams(discrepancy=1.0, distance=name, rooted=False), run=RUN
    )
    assert [tuple(pair) for pair in found.matches.tolist()] == expected
    assert found.distance == pytest.approx(table[found.matches[:, 0], found.matches[:, 1]], abs=2e-3)


def test_hellinger_of_opencvs_histogram_comparison() -> None:
    a, b = alike(6)
    found = robust(features(a), features(b), RobustParams(distance="hellinger", rooted=False), run=RUN)
    for (i, j), distance in zip(found.matches[:20], found.distance[:20], strict=True):
        assert cv2.compareHist(a[i].astype(np.float32), b[j].astype(np.float32), cv2.HISTCMP_BHATTACHARYYA) == pytest.approx(distance, abs=2e-3)  # fmt: skip


def test_roots_already_taken_make_hellinger_the_euclidean_distance() -> None:
    a, b = (np.rint(512 * unit_roots(d, False)).astype(np.uint8) for d in alike(7))
    plain = robust(features(a), features(b), RobustParams(), run=RUN)
    rooted = robust(features(a), features(b), RobustParams(distance="hellinger"), run=RUN)
    same = {tuple(m) for m in plain.matches.tolist()} & {tuple(m) for m in rooted.matches.tolist()}
    assert len(same) > 0.98 * len(plain)  # up to the rounding of the lengths
    assert rooted.distance.mean() == pytest.approx(plain.distance.mean() / 512 / np.sqrt(2), rel=0.01)


def test_bhattacharyya_lets_more_pass_the_same_ratio() -> None:
    a, b = (features(d) for d in alike(8, noise=30.0))
    counts = [dict(robust(a, b, RobustParams(distance=d, rooted=False, discrepancy=1.0), run=RUN).steps)["ratio"]
              for d in ("hellinger", "bhattacharyya")]  # fmt: skip
    assert counts[1] > counts[0]


def test_approximate_neighbours_are_nearly_all_exact_and_repeatable() -> None:
    a, b = (features(d) for d in alike(9))
    exact = {tuple(m) for m in mutual(a, b, MutualParams(), run=RUN).matches.tolist()}
    found = flann(a, b, FlannParams(checks=128), run=RUN)
    near = {tuple(m) for m in found.matches.tolist()}
    assert len(near & exact) >= 0.95 * len(exact)
    assert np.array_equal(found.matches, flann(a, b, FlannParams(checks=128), run=RUN).matches)
    least = distances(a.descriptors, b.descriptors).min(axis=1)
    rough = approximate_neighbours(a.descriptors, b.descriptors, FlannParams(checks=1, trees=1), 0)
    assert (rough.first >= least - 1e-3).all() and (rough.first > least + 1).any()


CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.05, 0.01]))


def facade(metric: str = "l2") -> tuple[Features, Features, GivenPair]:
    """A wall with the same three windows again and again: descriptors repeat, only geometry tells them apart."""
    rng = np.random.default_rng(0)
    points = rng.uniform((-3, -0.6, -2), (3, 0.6, 2), (240, 3))
    kinds = histograms(3, 1) if metric == "l2" else rng.integers(0, 256, (3, 32), dtype=np.uint8)
    kind = rng.integers(0, 3, 240)
    centres = (np.array([0.0, -9.0, 0.0]), np.array([1.2, -9.0, 0.4]))
    rotations = tuple(look_at(c, np.zeros(3)) for c in centres)
    photos = []
    for centre, rotation in zip(centres, rotations, strict=True):
        xy = pixel_from_ray(CAMERA, (points - centre) @ rotation.T) + rng.normal(0, 0.2, (240, 2))
        noise = rng.normal(0, 6, (240, 128)) if metric == "l2" else np.zeros((240, 32))
        photos.append(features(np.clip(kinds[kind] + noise, 0, 255).astype(np.uint8), xy, metric))
    return photos[0], photos[1], GivenPair((CAMERA, CAMERA), rotations, centres)


def right(matches: np.ndarray) -> int:
    return int((matches[:, 0] == matches[:, 1]).sum())


def test_with_the_orientation_repeated_structure_is_matched() -> None:
    a, b, given = facade()
    plain = mutual(a, b, MutualParams(), run=RUN)
    found = guided(a, b, GuidedParams(band=1.5), run=RUN, given=given)
    assert right(found.matches) > 5 * max(right(plain.matches), 5)
    assert right(found.matches) > 0.8 * len(found)
    assert np.array_equal(
        guided(a, b, GuidedParams(), run=RUN).matches, plain.matches
    )  # nothing given: as mutual


@pytest.mark.parametrize("metric", ["l2", "hamming"])
def test_every_guided_match_lies_near_its_line_in_both_photos(metric: str) -> None:
    a, b, given = facade(metric)
    found = guided(a, b, GuidedParams(band=1.0, ratio=1.0, mutual=False), run=RUN, given=given)
    matrix, p, q, length_b, length_a = given.epipolar(a.xy, b.xy)
    misfit = np.abs(np.einsum("ni,ij,nj->n", q[found.matches[:, 1]], matrix, p[found.matches[:, 0]]))
    assert (misfit <= 1.01 * np.minimum(length_b[found.matches[:, 0]], length_a[found.matches[:, 1]])).all()
    assert len(found) > 0


def test_a_point_with_nothing_near_its_line_has_no_match() -> None:
    a, b, given = facade()
    far = dataclasses.replace(b, xy=b.xy + np.float32([0, 900]))
    found = guided(a, far, GuidedParams(band=0.5, ratio=1.0, mutual=False), run=RUN, given=given)
    assert dict(found.steps)["nearest"] == len(found) < 60


@pytest.mark.parametrize(
    "matcher", [(robust, RobustParams()), (flann, FlannParams()), (guided, GuidedParams())]
)
def test_photos_with_hardly_any_points_or_of_other_kinds_have_no_matches(matcher: tuple) -> None:
    function, params = matcher
    some, few, binary = (
        features(histograms(40, 1)),
        features(histograms(1, 2)),
        features(histograms(40, 3), metric="hamming"),
    )
    for one, two in ((some, few), (few, some), (some, binary)):
        assert len(function(one, two, params, run=RUN)) == 0
