"""What every detector promises: points found again under known changes, masks, bad photos, threads."""

import cv2
import numpy as np
import pytest

from graphos_core.data import Features
from graphos_core.features.detectors.fast import fast_corners
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.registry import find
from graphos_core.run import Run

RUN = Run()
NAMES = ("akaze", "brisk", "fast", "foerstner", "harris", "moravec", "orb", "sift")


def texture(height: int = 360, width: int = 480, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    layers = [cv2.GaussianBlur(rng.uniform(-1, 1, (height, width)).astype(np.float32), (0, 0), s) * s
              for s in (1.5, 4.0, 9.0)]  # fmt: skip
    return cv2.normalize(np.sum(layers, axis=0), None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


def detect(name: str, image: np.ndarray, mask: np.ndarray | None = None, **changes: object) -> Features:
    algorithm = find("features", name)
    return algorithm.function(image, image, algorithm.params(**changes), run=RUN, mask=mask)


def right_matches(a: Features, b: Features, b_from_a: np.ndarray) -> tuple[int, int]:
    """Number of matches, and of those within 2.5 px of the truth."""
    matches = mutual(a, b, MutualParams(), run=RUN).matches
    mapped = cv2.perspectiveTransform(a.xy[None].astype(np.float64), b_from_a)[0]
    error = np.linalg.norm(mapped[matches[:, 0]] - b.xy[matches[:, 1]], axis=1)
    return len(matches), int((error < 2.5).sum())


def turned_and_smaller(image: np.ndarray, degrees: float, factor: float) -> tuple[np.ndarray, np.ndarray]:
    h, w = image.shape
    warp = np.vstack([cv2.getRotationMatrix2D((w / 2, h / 2), degrees, factor), [0, 0, 1]])
    smooth = cv2.GaussianBlur(image, (0, 0), 0.5 / factor) if factor < 1 else image
    return cv2.warpPerspective(smooth, warp, (w, h), borderMode=cv2.BORDER_REFLECT), warp


@pytest.mark.parametrize("name", NAMES)
def test_points_are_found_again_in_a_turned_and_smaller_photo(name: str) -> None:
    image = texture()
    other, warp = turned_and_smaller(image, 33.0, 0.75)
    matches, right = right_matches(detect(name, image), detect(name, other), warp)
    assert right >= 60
    assert right > 0.7 * matches


@pytest.mark.parametrize(("name", "changes"), [
    ("fast", {"descriptor": "sift"}), ("akaze", {"diffusivity": "weickert"}), ("orb", {"rank": "fast"}),
])  # fmt: skip
def test_other_choices_match_too(name: str, changes: dict[str, str]) -> None:
    image = texture()
    other, warp = turned_and_smaller(image, 20.0, 0.9)
    matches, right = right_matches(detect(name, image, **changes), detect(name, other, **changes), warp)
    assert right >= 60 and right > 0.7 * matches


@pytest.mark.parametrize(("name", "changes"), [
    ("akaze", {"upright": True}), ("harris", {"upright": True}), ("fast", {"descriptor": "brief"}),
])  # fmt: skip
def test_upright_descriptors_match_upright_photos_only(name: str, changes: dict[str, object]) -> None:
    image = texture()
    moved, shift = turned_and_smaller(image, 0.0, 0.9)
    turned, warp = turned_and_smaller(image, 90.0, 0.7)
    a = detect(name, image, **changes)
    upright = right_matches(a, detect(name, moved, **changes), shift)[1]
    lying = right_matches(a, detect(name, turned, **changes), warp)[1]
    assert upright >= 60
    assert lying < 0.1 * upright


@pytest.mark.parametrize("name", [n for n in NAMES if n not in ("sift", "akaze")])
def test_levels_let_corners_survive_half_the_size(name: str) -> None:
    image = texture()
    half, warp = turned_and_smaller(image, 0.0, 0.5)
    one = {"octaves": 0} if name == "brisk" else {"levels": 1}
    several = right_matches(detect(name, image), detect(name, half), warp)[1]
    single = right_matches(detect(name, image, **one), detect(name, half, **one), warp)[1]
    assert several >= 2 * max(10, single)


def test_the_number_of_points_answers_to_thresholds_octaves_and_layers() -> None:
    image = texture()
    for name, loose, strict in (
        ("akaze", {"threshold": 0.0001}, {"threshold": 0.01}), ("orb", {"threshold": 8}, {"threshold": 40}),
        ("brisk", {"threshold": 15}, {"threshold": 60}), ("fast", {"threshold": 8}, {"threshold": 40}),
        ("akaze", {"layers": 6}, {"layers": 1}), ("akaze", {"octaves": 4}, {"octaves": 1}),
        ("brisk", {"octaves": 4}, {"octaves": 0}), ("fast", {"suppression": False}, {"suppression": True}),
        ("orb", {"scale_factor": 1.1, "levels": 16}, {"scale_factor": 2.0, "levels": 16}),
    ):  # fmt: skip
        many, few = (detect(name, image, **changes).found for changes in (loose, strict))
        assert many > few, (name, loose)
    assert len(np.unique(detect("orb", image, levels=3).scale)) == 3
    assert detect("orb", image, levels=1, patch=41).scale[0] == pytest.approx(41)
    small, large = (detect("brisk", image, pattern=p) for p in (0.7, 1.5))
    assert len(small.xy) > len(large.xy)  # a larger pattern does not fit near the border


def test_fast_is_the_segment_test_of_nine_pixels() -> None:
    image = cv2.GaussianBlur(np.random.default_rng(0).integers(0, 256, (40, 50), dtype=np.uint8), (0, 0), 1.0)
    ring = [(0, 3), (1, 3), (2, 2), (3, 1), (3, 0), (3, -1), (2, -2), (1, -3), (0, -3), (-1, -3), (-2, -2),
            (-3, -1), (-3, 0), (-3, 1), (-2, 2), (-1, 3)]  # fmt: skip
    expected = set()
    for y in range(3, 37):
        for x in range(3, 47):
            difference = [int(image[y + v, x + u]) - int(image[y, x]) for u, v in ring] * 2
            if any(all(sign * d > 12 for d in difference[i : i + 9]) for i in range(16) for sign in (1, -1)):
                expected.add((x, y))
    xy, _ = fast_corners(image, 12, suppression=False)
    assert len(expected) > 50
    assert set(map(tuple, xy.astype(int).tolist())) == expected


@pytest.mark.parametrize("name", NAMES)
def test_points_lie_only_where_the_mask_allows(name: str) -> None:
    image = texture()
    mask = np.zeros(image.shape, dtype=bool)
    mask[100:250, 150:400] = True
    found, everywhere = detect(name, image, mask), detect(name, image)
    column, row = np.rint(found.xy).astype(int).T
    assert 0 < found.found == len(found.xy) < len(everywhere.xy)
    assert mask[row, column].all()
    assert detect(name, image, np.zeros(image.shape, dtype=bool)).xy.shape == (0, 2)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("shape", [(1, 60), (60, 1), (1, 1), (9, 200), (64, 64)])
def test_photos_without_structure_or_size_have_no_points(name: str, shape: tuple[int, int]) -> None:
    found = detect(name, np.full(shape, 128, np.uint8))
    assert found.xy.shape == (0, 2)
    assert found.descriptors.ndim == 2 and found.descriptors.dtype == np.uint8
    assert found.descriptors.shape[1] in (32, 61, 64, 128)


def test_more_levels_and_octaves_than_the_photo_has_are_no_fault() -> None:
    image = texture(60, 80)
    for name, changes in (("orb", {"levels": 16, "scale_factor": 2.0}), ("brisk", {"octaves": 8}),
                          ("akaze", {"octaves": 8}), ("harris", {"levels": 12}), ("fast", {"levels": 16})):  # fmt: skip
        detect(name, image, **changes)


@pytest.mark.parametrize("name", NAMES)
def test_the_number_of_threads_changes_nothing(name: str) -> None:
    import numba

    image = texture()
    results = []
    before = cv2.getNumThreads(), numba.get_num_threads()
    try:
        for threads in (1, 2):
            cv2.setNumThreads(threads)
            numba.set_num_threads(min(threads, numba.config.NUMBA_NUM_THREADS))
            results.append(detect(name, image, maximum=500, selection="anms"))
    finally:
        cv2.setNumThreads(before[0])
        numba.set_num_threads(before[1])
    for field in ("xy", "scale", "angle", "response", "descriptors"):
        assert np.array_equal(getattr(results[0], field), getattr(results[1], field)), field
