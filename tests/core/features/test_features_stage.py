import threading

import cv2
import numpy as np
import pytest

from graphos_core.data import Camera, Features, PairMatches
from graphos_core.errors import Stopped
from graphos_core.features.stage import detect_all, match_all
from graphos_core.registry import find
from graphos_core.run import Run

DETECTOR, MATCHER, CHECK = (find("features", name) for name in ("sift", "mutual", "usac"))
CAMERA = Camera(model="basic", width=320, height=240, values=np.array([400.0, 159.5, 119.5, 0.0, 0.0]),
                focal_estimated=True)  # fmt: skip


class Listener(Run):
    def __init__(self, threads: int = 2, stop_after: int | None = None) -> None:
        super().__init__(threads=threads)
        self.shown: list[tuple[str, object]] = []
        self.lock = threading.Lock()
        self.stop_after = stop_after

    def show(self, key: str, value: object) -> None:
        with self.lock:
            self.shown.append((key, value))
            if self.stop_after is not None and len(self.shown) >= self.stop_after:
                self.stop()


def view(index: int) -> tuple[np.ndarray, np.ndarray]:
    """A textured relief seen with a parallax that depends on its height."""
    rng = np.random.default_rng(0)
    base = cv2.GaussianBlur(rng.uniform(0, 255, (300, 500)).astype(np.float32), (0, 0), 1.6)
    base = cv2.normalize(base, None, 0, 255, cv2.NORM_MINMAX)
    y, x = np.mgrid[:240, :320].astype(np.float32)
    height = 8 * np.sin(x / 40) * np.cos(y / 30)
    photo = cv2.remap(base, x + 40 + index * (10 + height), y + 20, cv2.INTER_CUBIC)
    grey = np.clip(photo, 0, 255).astype(np.uint8)
    return grey, np.repeat(grey[:, :, None], 3, axis=2)


def work(run: Run, count: int = 3) -> tuple[list[Features], list[PairMatches]]:
    features = detect_all(count, view, DETECTOR, DETECTOR.params(), run)
    pairs = match_all(features, [CAMERA] * count, (MATCHER, MATCHER.params()), (CHECK, CHECK.params()), run)
    return features, pairs


def test_all_photos_and_pairs_are_done_in_order_and_shown() -> None:
    run = Listener()
    features, pairs = work(run)
    assert [(p.a, p.b) for p in pairs] == [(0, 1), (0, 2), (1, 2)]
    assert all(len(p.matches) > 100 and p.kind == "fundamental" for p in pairs)
    assert [key for key, _ in run.shown].count("pair") == 3
    assert [value[0] for key, value in run.shown if key == "features"] == [0, 1, 2]
    a, b = features[0], features[1]
    moved = b.xy[pairs[0].matches[:, 1]] - a.xy[pairs[0].matches[:, 0]]
    assert np.median(np.abs(moved[:, 1])) < 0.2


def test_one_and_two_threads_give_the_same_bits() -> None:
    (features_1, pairs_1), (features_2, pairs_2) = work(Run(threads=1)), work(Run(threads=2))
    for one, two in zip(features_1, features_2, strict=True):
        assert np.array_equal(one.xy, two.xy) and np.array_equal(one.descriptors, two.descriptors)
    for one, two in zip(pairs_1, pairs_2, strict=True):
        assert np.array_equal(one.matches, two.matches) and np.array_equal(one.matrix, two.matrix)


def test_the_number_of_opencv_threads_is_put_back() -> None:
    before = cv2.getNumThreads()
    detect_all(1, view, DETECTOR, DETECTOR.params(), Run(threads=1))
    assert cv2.getNumThreads() == before


@pytest.mark.parametrize("stop_after", [1, 4])
def test_stopping_ends_the_work_within_one_item(stop_after: int) -> None:
    run = Listener(threads=1, stop_after=stop_after)
    with pytest.raises(Stopped):
        work(run)
    assert len(run.shown) == stop_after
