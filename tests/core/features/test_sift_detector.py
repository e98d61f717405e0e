import cv2
import numpy as np
import pytest

from graphos_core.features.detectors.selection import choose
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.run import Run

RUN = Run()


def blobs(centres: np.ndarray, sigma: float, size: tuple[int, int] = (400, 300)) -> np.ndarray:
    """Grey photo with Gaussian blobs at exactly known places."""
    x, y = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    image = np.full((size[1], size[0]), 60.0)
    for cx, cy in centres:
        image += 150.0 * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * sigma**2))
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def texture(height: int = 300, width: int = 400, seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).uniform(0, 255, (height, width)).astype(np.float32)
    soft = cv2.GaussianBlur(noise, (0, 0), 2.0)
    return cv2.normalize(soft, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


@pytest.mark.parametrize(("reduction", "tolerance"), [(1.0, 0.05), (1.6, 0.1), (2.0, 0.1), (3.0, 0.15)])
def test_points_lie_where_the_blobs_are_at_every_reduction(reduction: float, tolerance: float) -> None:
    sigma = 7.0
    grid = np.stack(np.meshgrid([60.3, 150.0, 240.7, 330.5], [60.0, 150.4, 239.6]), axis=-1).reshape(-1, 2)
    image = blobs(grid, sigma)
    found = sift(image, image, SiftParams(reduction=reduction), run=RUN)
    errors = []
    for centre in grid:
        distance = np.linalg.norm(found.xy - centre, axis=1)
        nearest = int(distance.argmin())
        errors.append(found.xy[nearest] - centre)
        assert found.scale[nearest] == pytest.approx(2 * sigma, rel=0.3)
    assert np.abs(np.mean(errors, axis=0)).max() < tolerance / 2  # no shift of the whole photo
    assert np.linalg.norm(errors, axis=1).max() < tolerance * 1.5


def test_points_turn_with_the_photo() -> None:
    image = texture()
    turned = np.ascontiguousarray(np.rot90(image, -1))  # clockwise on the screen
    a, b = (sift(i, i, SiftParams(hellinger=False), run=RUN) for i in (image, turned))
    moved = np.stack([image.shape[0] - 1 - a.xy[:, 1], a.xy[:, 0]], axis=1)
    distance = np.linalg.norm(moved[:, None] - b.xy[None], axis=2)
    partner = distance.argmin(axis=1)
    close = distance.min(axis=1) < 0.5
    assert close.mean() > 0.8
    turn = np.angle(np.exp(1j * (b.angle[partner[close]] - a.angle[close])))
    assert np.median(turn) == pytest.approx(np.pi / 2, abs=0.05)
    assert np.abs(a.angle).max() <= np.pi


def test_the_same_points_come_with_one_and_two_threads() -> None:
    image = texture(600, 800)
    before = cv2.getNumThreads()
    try:
        results = []
        for threads in (1, 2):
            cv2.setNumThreads(threads)
            results.append(sift(image, image, SiftParams(), run=RUN))
    finally:
        cv2.setNumThreads(before)
    for name in ("xy", "scale", "angle", "response", "descriptors"):
        assert np.array_equal(getattr(results[0], name), getattr(results[1], name))


def test_choosing_by_scale_keeps_the_largest_and_tells_how_many_were_found() -> None:
    image = texture()
    everything = sift(image, image, SiftParams(maximum=100_000), run=RUN)
    few = sift(image, image, SiftParams(maximum=100), run=RUN)
    assert len(few.xy) == 100 and few.found == len(everything.xy) > 300
    assert few.scale.min() >= np.sort(everything.scale)[-100]


def test_choosing_evenly_reaches_weakly_occupied_parts() -> None:
    rng = np.random.default_rng(0)
    crowded = rng.uniform((0, 0), (500, 1000), (5000, 2))
    sparse = rng.uniform((500, 0), (1000, 1000), (200, 2))
    xy = np.concatenate([crowded, sparse])
    scale = np.concatenate([rng.uniform(5, 10, 5000), rng.uniform(1, 4, 200)])
    even, largest = (choose(how, xy, scale, scale, 400, (1000, 1000)) for how in ("grid", "scale"))
    assert (xy[largest, 0] >= 500).sum() == 0
    assert (xy[even, 0] >= 500).sum() > 120
    assert len(even) == len(np.unique(even)) == 400
    assert np.array_equal(
        choose("grid", xy, scale, scale, 10_000, (1000, 1000)),
        choose("scale", xy, scale, scale, 10_000, (1000, 1000)),
    )


def test_octaves_hold_blobs_of_their_sizes_and_together_are_all() -> None:
    image = texture(500, 600)
    everything = sift(image, image, SiftParams(), run=RUN)
    parts = [sift(image, image, SiftParams(first_octave=o, octaves=1), run=RUN) for o in (-1, 0, 1)]
    rest = sift(image, image, SiftParams(first_octave=2), run=RUN)
    assert sum(part.found for part in parts) + rest.found == everything.found
    for octave, part in zip((-1, 0, 1), parts, strict=True):
        sizes = part.scale / 2.0**octave  # 2 σ, σ = 1.6 · 2^(i/3) with i from ½ to 3½ in an octave
        assert part.found > 20
        assert sizes.min() > 3.2 * 2 ** (0.4 / 3) and sizes.max() < 3.2 * 2 ** (3.6 / 3)
    first = sift(image, image, SiftParams(octaves=2), run=RUN)
    assert first.found == parts[0].found + parts[1].found


def test_root_descriptors_are_square_roots_of_length_one() -> None:
    image = texture()
    plain = sift(image, image, SiftParams(hellinger=False), run=RUN).descriptors.astype(float)
    root = sift(image, image, SiftParams(), run=RUN).descriptors.astype(float) / 512.0
    assert np.linalg.norm(root, axis=1) == pytest.approx(np.ones(len(root)), abs=0.02)
    expected = np.sqrt(plain / plain.sum(axis=1, keepdims=True))
    assert np.abs(root - np.minimum(expected, 255 / 512)).max() < 0.002


def test_a_photo_without_structure_has_no_points_and_colour_comes_from_the_photo() -> None:
    empty = sift(np.full((80, 90), 120, np.uint8), np.zeros((80, 90, 3), np.uint8), SiftParams(), run=RUN)
    assert empty.xy.shape == (0, 2) and empty.descriptors.shape == (0, 128) and empty.found == 0
    image = blobs(np.array([[100.0, 80.0]]), 8.0, (200, 160))
    colour = np.zeros((160, 200, 3), np.uint8)
    colour[70:90, 90:110] = (10, 200, 30)
    found = sift(image, colour, SiftParams(), run=RUN)
    assert found.colour[np.linalg.norm(found.xy - [100, 80], axis=1).argmin()].tolist() == [10, 200, 30]
