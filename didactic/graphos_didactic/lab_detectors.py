"""Detectors compared in a lab: on the photos of the student's own block, against its truth, kept beside it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Features, PairMatches
from graphos_core.errors import UserError
from graphos_core.features.coverage import photo_coverage
from graphos_core.features_comparison.measures import REPEATED_PX, RIGHT_PX
from graphos_core.images import read_photo_set, read_pixels
from graphos_core.pipeline import Pipeline
from graphos_core.preprocessing.grey import luma
from graphos_core.recipe import Recipe
from graphos_core.registry import algorithms
from graphos_core.run import Run
from graphos_core.simulation.truth import Truth
from graphos_core.store import write_text
from graphos_core.text import Text
from graphos_didactic.lab_figures import READING, Figure

WARM_SIDE = 128
"""Side of the part of a photo on which a detector is run before time is taken, px."""
SAME_DEPTH = 0.01
"""A surface point is seen if its depth agrees with the true one so well, as a share."""
NUMBERS = (
    "keypoints",
    "seconds",
    "matches",
    "verified",
    "inlier_share",
    "coverage",
    "repeatability",
    "right",
)
"""What is kept of each detector."""


Source = Callable[[Pipeline | None, Truth | None], Figure | None]


def place(simulation: Path, detector: str) -> Path:
    """Return the file in which the numbers of a detector are kept, in the folder of the student's block."""
    return simulation / "detectors" / f"{detector}.json"


def kept(simulation: Path, detector: str) -> dict[str, float] | None:
    """Return the kept numbers of a detector; None where it was not run or they cannot be read."""
    try:
        found = json.loads(place(simulation, detector).read_text("utf-8"))
        return {name: float(found[name]) for name in NUMBERS}
    except (OSError, ValueError, KeyError, TypeError):
        return None


def measured(truth: Truth, detector: str) -> dict[str, float] | None:
    """Return `kept` numbers of the block of a truth."""
    return kept(Path(truth.folder), detector)


def measure(truth: Truth, detector: str, run: Run) -> dict[str, float]:
    """Detect, match and verify on all photos of a block with the usual parameters, and keep the numbers.

    Raises
    ------
    UserError
        When the photos cannot be read.
    Stopped
    """
    recipe = Recipe.default(0).choose("features", "detector", detector)
    photos = read_photo_set(Path(truth.folder) / "photos", run=run)
    if len(photos.photos) < 2:
        raise UserError("The photos of the lab are missing.", todo="Start the lab anew in another folder.")
    function, params = recipe.algorithm("features", "detector")
    pairs = list(combinations(range(len(photos.photos)), 2))
    first = np.ascontiguousarray(read_pixels(photos.photos[0])[:WARM_SIDE, :WARM_SIDE])
    function.function(luma(first), first, params, run=run)  # so that no compiler is in the times
    features: list[Features] = []
    started = time.perf_counter()
    for i, photo in enumerate(photos.photos):
        run.check()
        run.progress(i, len(photos.photos) + len(pairs), "photos and pairs")
        pixels = read_pixels(photo)
        features.append(function.function(luma(pixels), pixels, params, run=run))
    seconds = time.perf_counter() - started
    matcher, matcher_params = recipe.algorithm("features", "matcher")
    verification, verification_params = recipe.algorithm("features", "verification")
    verified: list[PairMatches] = []
    counts = np.zeros(5)
    for k, (a, b) in enumerate(pairs):
        run.check()
        run.progress(len(photos.photos) + k, len(photos.photos) + len(pairs), "photos and pairs")
        candidates = matcher.function(features[a], features[b], matcher_params, run=run)
        cameras = (photos.cameras[photos.photos[a].camera], photos.cameras[photos.photos[b].camera])
        accepted = verification.function(
            (a, b), features[a], features[b], candidates, cameras, verification_params, run=run
        )
        verified.append(accepted)
        counts += (len(candidates), *_against_truth(truth, (a, b), features, accepted))
    coverage = np.mean([photo_coverage(features, verified, i).occupied_share for i in range(len(features))])
    matches, kept_matches, right, repeated, common = (float(c) for c in counts)
    found = {
        "keypoints": float(np.mean([len(f.xy) for f in features])), "seconds": seconds / len(features),
        "matches": matches, "verified": kept_matches, "inlier_share": kept_matches / max(matches, 1.0),
        "coverage": float(coverage), "repeatability": repeated / max(common, 1.0), "right": right,
    }  # fmt: skip
    file = place(Path(truth.folder), detector)
    file.parent.mkdir(exist_ok=True)
    write_text(file, json.dumps(found, indent=1))
    return found


def true_places(truth: Truth, a: int, b: int, xy: Array) -> Array:
    """Return where photo b shows the surface points that photo a shows at xy (n, 2), px; NaN where it does not.

    By the true depth, orientation and camera of both photos; hidden points and those outside the format are NaN.
    """
    camera_a, camera_b = (truth.cameras[int(truth.camera_of_photo[i])] for i in (a, b))
    xy = np.asarray(xy, dtype=np.float64)
    depth = _depth_at(truth.depth(a), xy)
    rays = ray_from_pixel(camera_a, xy)
    points = (rays / rays[:, 2:] * depth[:, None]) @ truth.rotations[a] + truth.centres[a]
    local = (points - truth.centres[b]) @ truth.rotations[b].T
    there = pixel_from_ray(camera_b, local)
    seen = _depth_at(truth.depth(b), there)
    hidden = ~(np.abs(seen - local[:, 2]) <= SAME_DEPTH * local[:, 2])
    return np.where(hidden[:, None], np.nan, there)


def _depth_at(depth: Array, xy: Array) -> Array:
    """Return the depth at the nearest pixel, float64 (n,); NaN outside."""
    whole = np.rint(np.nan_to_num(xy, nan=-1e6)).astype(np.int64)
    height, width = depth.shape
    inside = np.all((whole >= 0) & (whole < (width, height)), axis=1)
    x, y = np.where(inside[:, None], whole, 0).T
    return np.where(inside, depth[y, x].astype(np.float64), np.nan)


def _against_truth(
    truth: Truth, pair: tuple[int, int], features: list[Features], accepted: PairMatches
) -> tuple[float, float, float, float]:
    """Return verified matches, right ones of them, keypoints found again, and keypoints of a that b shows."""
    a, b = pair
    there = true_places(truth, a, b, features[a].xy)
    matches = accepted.matches
    miss = np.hypot(*(features[b].xy[matches[:, 1]] - there[matches[:, 0]]).T)
    common = np.unique(np.round(there[np.isfinite(there).all(axis=1)], 2), axis=0)
    again = 0.0
    if len(common) and len(features[b].xy):
        again = float((cKDTree(features[b].xy).query(common)[0] <= REPEATED_PX).sum())
    return float(len(matches)), float((miss <= RIGHT_PX).sum()), again, float(len(common))


def detector_line(detector: str, found: dict[str, float]) -> Text:
    """Say in a line what a detector gave."""
    return Text(
        "{name}: {keypoints:.0f} keypoints per photo in {seconds:.2f} s, {matches:.0f} matches, {verified:.0f} of them "
        "verified ({share:.0f} %), coverage {coverage:.0f} %.",
        name=label(detector), keypoints=found["keypoints"], seconds=found["seconds"], matches=found["matches"],
        verified=found["verified"], share=100 * found["inlier_share"], coverage=100 * found["coverage"],
    )  # fmt: skip


def label(detector: str) -> str:
    """Return the name of a detector for people."""
    return next(a.label for a in algorithms("features", "detector") if a.name == detector)


def detectors() -> list[str]:
    """Return the names of all detectors."""
    return [algorithm.name for algorithm in algorithms("features", "detector")]


def _figure(detector: str, what: str, words: str, unit: str, factor: float = 1.0) -> Source:
    def figure(pipeline: Pipeline | None, truth: Truth | None) -> Figure | None:
        found = measured(truth, detector) if truth is not None else None
        if found is None:
            return None
        return Figure(f"{words}, {label(detector)}", factor * found[what], 0.0, unit)

    return figure


def _right_of_verified(detector: str) -> Source:
    def figure(pipeline: Pipeline | None, truth: Truth | None) -> Figure | None:
        found = measured(truth, detector) if truth is not None else None
        if found is None or not found["verified"]:
            return None
        value = 100.0 * found["right"] / found["verified"]
        return Figure(f"right of the verified matches, {label(detector)}", value, READING * value, "%")

    return figure


def _verified_per_keypoint(detector: str) -> Source:
    def figure(pipeline: Pipeline | None, truth: Truth | None) -> Figure | None:
        found = measured(truth, detector) if truth is not None else None
        if found is None or not found["keypoints"]:
            return None
        value = found["verified"] / found["keypoints"]
        return Figure(f"verified matches per keypoint, {label(detector)}", value, READING * value, "")

    return figure


def _figures() -> dict[str, Source]:
    shown: tuple[tuple[str, str, str, float], ...] = (
        ("keypoints", "keypoints per photo", "points", 1.0),
        ("matches", "matches", "matches", 1.0),
        ("verified", "verified matches", "matches", 1.0),
        ("coverage", "coverage", "%", 100.0),
        ("repeatability", "repeatability", "%", 100.0),
    )
    found: dict[str, Source] = {}
    for detector in detectors():
        for what, words, unit, factor in shown:
            found[f"{detector}_{what}"] = _figure(detector, what, words, unit, factor)
        found[f"{detector}_right"] = _right_of_verified(detector)
        found[f"{detector}_yield"] = _verified_per_keypoint(detector)
    return found


DETECTOR_FIGURES: dict[str, Source] = _figures()
"""Every figure of a detector by the name that labs use: ``sift_verified``."""
