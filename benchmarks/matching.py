"""Matching: exact mutual matching beside a bare matrix product and OpenCV; a pair of photos beside pycolmap.

usage: python benchmarks/matching.py product
       GRAPHOS_DATA=… python benchmarks/matching.py methods PHOTO PHOTO
       python benchmarks/matching.py pair PHOTO PHOTO [--set room.algorithm.parameter=value …]

Two threads each, in one run, alternating; the best of the repetitions counts. `pair` compares what is found with default
options: seconds from photos to verified matches (imports and kernels warm), and the verified matches, judged alike for
both programs by one fundamental matrix within 1 px and 4 px of the epipolar lines.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "2")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "2")

import cv2
import numpy as np

from graphos_core.data import Candidates, Features
from graphos_core.features.matchers.flann import FlannParams, flann
from graphos_core.features.matchers.guided import GuidedParams
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.features.matchers.robust import RobustParams, robust
from graphos_core.features.pair_verdict import epipolar_kind
from graphos_core.features.verification import UsacParams, usac
from graphos_core.images import read_photo_set
from graphos_core.recipe import Recipe
from graphos_core.run import Run

THREADS = 2


def best(actions: dict[str, Callable[[], object]], repetitions: int = 7) -> dict[str, float]:
    """Return the best seconds of each action, taken in turn."""
    seconds = dict.fromkeys(actions, np.inf)
    for _ in range(repetitions):
        for name, action in actions.items():
            started = time.perf_counter()
            action()
            seconds[name] = min(seconds[name], time.perf_counter() - started)
    return seconds


def sift_like(count: int, seed: int) -> Features:
    values = np.abs(np.random.default_rng(seed).normal(size=(count, 128))) ** 2
    values = np.minimum(np.rint(512 * values / np.linalg.norm(values, axis=1, keepdims=True)), 255)
    xy = np.random.default_rng(seed + 1000).uniform(
        0, 3000, (count, 2)
    )  # distinct: features at one place are one point
    return features(values.astype(np.uint8), xy)


def features(descriptors: np.ndarray, xy: np.ndarray) -> Features:
    n = len(descriptors)
    zero = np.zeros(n, np.float32)
    return Features(
        xy=xy.astype(np.float32), scale=zero, angle=zero, response=zero, descriptors=descriptors,
        colour=np.zeros((n, 3), np.uint8), width=1, height=1,
    )  # fmt: skip


def product() -> None:
    """8192 × 8192 descriptors of bytes."""
    a, b = sift_like(8192, 1), sift_like(8192, 2)
    left, right = a.descriptors.astype(np.float32), b.descriptors.astype(np.float32)
    matcher = cv2.BFMatcher(cv2.NORM_L2, crossCheck=False)
    cv2.setNumThreads(THREADS)

    def both_directions() -> None:
        matcher.knnMatch(left, right, 2)
        matcher.knnMatch(right, left, 2)

    seconds = best({
        "bare product": lambda: left @ right.T,
        "mutual": lambda: mutual(a, b, MutualParams(), run=Run()),
        "cv2.BFMatcher, one direction": lambda: matcher.knnMatch(left, right, 2),
        "cv2.BFMatcher, both directions": both_directions,
        "flann, 64 checks, both directions": lambda: flann(a, b, FlannParams(), run=Run()),
    })  # fmt: skip
    for name, value in seconds.items():
        print(f"{name:34} {value:.3f} s   {value / seconds['bare product']:.2f} of the product")
    print(f"mutual / BFMatcher one direction {seconds['mutual'] / seconds['cv2.BFMatcher, one direction']:.2f}, "
          f"both {seconds['mutual'] / seconds['cv2.BFMatcher, both directions']:.2f}")  # fmt: skip


def ours(paths: list[Path], settings: list[str]) -> tuple[float, list[Features], np.ndarray]:
    """Return seconds from the files to verified matches, the features and the matches."""
    from graphos_core.features.stage import detect_all, match_all
    from graphos_core.images import read_pixels
    from graphos_core.preprocessing.grey import eight_bit

    recipe = Recipe.default()
    for setting in settings:
        recipe = recipe.set(setting)
    detector, params = recipe.algorithm("features", "detector")
    photos = read_photo_set(paths, run=Run())

    def read(index: int) -> tuple[np.ndarray, np.ndarray]:
        colour = eight_bit(read_pixels(photos.photos[index]))
        return cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), colour

    started = time.perf_counter()
    run = Run(threads=THREADS)
    found = detect_all(2, read, detector, params, run)
    cameras = [photos.cameras[photo.camera] for photo in photos.photos]
    (pair,) = match_all(
        found,
        cameras,
        recipe.algorithm("features", "matcher"),
        recipe.algorithm("features", "verification"),
        run,
    )
    return time.perf_counter() - started, found, pair.matches


def colmap(paths: list[Path]) -> tuple[float, list[Features], np.ndarray]:
    import pycolmap

    from graphos_core.exchange.features_colmap import read_colmap_features

    extraction, matching = pycolmap.FeatureExtractionOptions(), pycolmap.FeatureMatchingOptions()
    extraction.num_threads = matching.num_threads = THREADS
    with tempfile.TemporaryDirectory() as folder:
        photos = Path(folder) / "photos"
        photos.mkdir()
        for path in paths:
            (photos / path.name).symlink_to(path.resolve())
        database = Path(folder) / "database.db"
        started = time.perf_counter()
        pycolmap.extract_features(database, photos, extraction_options=extraction)
        pycolmap.match_exhaustive(database, matching_options=matching)
        seconds = time.perf_counter() - started
        read = read_colmap_features(database)
    order = [read.photos.index(path.name) for path in paths]
    matches = read.pairs[0].matches if order == [0, 1] else read.pairs[0].matches[:, ::-1]
    return seconds, [features(read.features[i].descriptors, read.features[i].xy) for i in order], matches


def agreeing(found: list[Features], matches: np.ndarray, threshold: float) -> int:
    """Return how many matches lie within a threshold of the epipolar lines of one fundamental matrix fitted to them."""
    xy = [own.xy[matches[:, side]].astype(np.float64) for side, own in enumerate(found)]
    _, inlier = cv2.findFundamentalMat(*xy, cv2.USAC_MAGSAC, threshold, 0.9999, 10_000)
    return len(np.unique(np.hstack([np.rint(p[inlier.ravel() > 0]) for p in xy]), axis=0))


def pair(paths: list[Path], settings: list[str], repetitions: int) -> None:
    rows: dict[str, list[tuple[float, int, int, int]]] = {"ours": [], "pycolmap": []}
    ours(paths, settings)  # kernels
    for _ in range(repetitions):
        for name, program in (("ours", lambda: ours(paths, settings)), ("pycolmap", lambda: colmap(paths))):
            seconds, found, matches = program()
            rows[name].append(
                (seconds, len(matches), agreeing(found, matches, 1.0), agreeing(found, matches, 4.0))
            )
            print(f"{name:9} {seconds:6.2f} s  verified {rows[name][-1][1]}, at different places within 1 px "
                  f"{rows[name][-1][2]}, within 4 px {rows[name][-1][3]}", flush=True)  # fmt: skip
    mine, theirs = (min(rows[name]) for name in rows)
    print(f"time {mine[0] / theirs[0]:.2f}, verified {mine[1] / theirs[1]:.2f}, within 1 px {mine[2] / theirs[2]:.2f}, "
          f"within 4 px {mine[3] / theirs[3]:.2f} of pycolmap")  # fmt: skip


def methods(paths: list[Path]) -> None:
    """Matchers on the same keypoints of one pair: seconds, candidates, verified."""
    _, found, _ = ours(paths, [])
    photos = read_photo_set(paths, run=Run())
    cameras = (photos.cameras[photos.photos[0].camera], photos.cameras[photos.photos[1].camera])
    print(f"verification by {epipolar_kind('auto', cameras)[0]} matrix; guided matching needs an orientation "
          f"({GuidedParams().band} px) and is not compared here")  # fmt: skip
    ways: dict[str, Callable[[], Candidates]] = {
        "mutual": lambda: mutual(*found, MutualParams(), run=Run()),
        "robust": lambda: robust(*found, RobustParams(), run=Run()),
        "robust, Bhattacharyya": lambda: robust(*found, RobustParams(distance="bhattacharyya"), run=Run()),
        "flann": lambda: flann(*found, FlannParams(), run=Run()),
    }
    for name, way in ways.items():
        seconds = best({name: way}, 3)[name]
        candidates = way()
        verified = usac((0, 1), *found, candidates, cameras, UsacParams(), run=Run())
        print(f"{name:24} {seconds:.3f} s  {len(candidates)} candidates, {len(verified.matches)} verified")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("product", "methods", "pair"))
    parser.add_argument("photos", nargs="*", type=Path)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--repetitions", type=int, default=2)
    options = parser.parse_args()
    cv2.setNumThreads(THREADS)
    if options.what == "product":
        product()
    elif options.what == "methods":
        methods(options.photos)
    else:
        pair(options.photos, options.set, options.repetitions)


if __name__ == "__main__":
    main()
