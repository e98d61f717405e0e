"""Running the comparison: every variant over all photos and pairs, and over disturbed versions of the first photo."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import cv2
import numpy as np

from graphos_core.data import Array, Features, PairMatches, PhotoSet
from graphos_core.errors import UserError
from graphos_core.features.coverage import photo_coverage
from graphos_core.features.graph import components
from graphos_core.features_comparison.disturbances import DISTURBANCES, Disturbance, changed, small
from graphos_core.features_comparison.measures import AgainstTruth, against_truth
from graphos_core.features_comparison.records import Curve, FeatureComparison, Row
from graphos_core.features_comparison.truth import check_homography
from graphos_core.features_comparison.variants import Variant
from graphos_core.images import read_pixels
from graphos_core.params import unknown_name
from graphos_core.preprocessing.chain import apply_filters
from graphos_core.preprocessing.grey import eight_bit, luma
from graphos_core.run import Run
from graphos_core.text import Text

MOST_PAIRS = 300
"""Pairs that are matched; of more photos only pairs of neighbours in the order of the photos."""

WARM_SIDE = 96
"""Side of the part of the photo on which everything is run once before time is taken."""


def compare_features(
    photos: PhotoSet,
    variants: Sequence[Variant],
    *,
    run: Run,
    homography: Array | None = None,
    against: Sequence[str] = (),
) -> FeatureComparison:
    """Measure every variant on somebody's photos.

    Every finished row is offered as ``("row", Row)``, every curve as ``("curve", Curve)``. An algorithm that fails
    says why in its row, and the others go on.

    Parameters
    ----------
    photos : PhotoSet
    variants : sequence of Variant
        From `graphos_core.features_comparison.variants.variants`.
    run : Run
    homography : float64 (3, 3), optional
        From photo 1 to photo 2, px; only with exactly two photos.
    against : sequence of str
        Names of `DISTURBANCES` that are applied to the first photo.

    Raises
    ------
    UserError
        For one photo without disturbances, an unknown disturbance, or a homography that does not fit.
    Stopped
    """
    _check(photos, homography, against)
    seed = variants[0].recipe.seed
    run.seed = seed
    pairs, notes = _pairs(len(photos.photos))
    progress = _Progress(run, len(variants) * (len(photos.photos) + len(pairs) + sum(
        len(DISTURBANCES[name].levels) for name in against)))  # fmt: skip
    known: dict[Any, tuple[list[Features], float]] = {}
    rows, curves = [], []
    for variant in variants:
        _warm_up(photos, variant, run)
        row = _row(photos, variant, pairs, homography, known, run, progress)
        rows.append(row)
        run.show("row", row)
        for name in against if not row.failure else ():
            curves.append(_curve(photos, variant, DISTURBANCES[name], run, progress))
            run.show("curve", curves[-1])
    return FeatureComparison(
        photos=tuple(photo.name for photo in photos.photos), rows=tuple(rows), homography=homography,
        no_truth=_no_truth(homography, len(photos.photos)), curves=tuple(curves), notes=notes, seed=seed,
    )  # fmt: skip


def _check(photos: PhotoSet, homography: Array | None, against: Sequence[str]) -> None:
    for name in against:
        if name not in DISTURBANCES:
            raise UserError(unknown_name(name, list(DISTURBANCES), "disturbance"))
    count = len(photos.photos)
    if homography is not None and count != 2:
        raise UserError(
            Text("The homography cannot be used with {count} photos.", count=count),
            "It maps one photo to another: it belongs to exactly two.",
            "Name the two photos, in the order of the homography.",
        )
    if count < 2 and not against:
        raise UserError(
            "One photo cannot be matched.",
            "Matches need two photos of the same object.",
            "Name two photos or more, or compare on changed versions of the one with --against all.",
            "features/comparing",
        )
    if homography is not None:
        a, b = photos.photos
        check_homography(homography, (a.width, a.height), (b.width, b.height))


def _no_truth(homography: Array | None, count: int) -> str:
    if homography is not None:
        return ""
    if count == 2:
        return Text(
            "No homography between the two photos was given, so nobody knows which matches are right."
        )
    return Text("Truth for photos needs two photos and the homography between them.")


def _pairs(count: int) -> tuple[list[tuple[int, int]], tuple[str, ...]]:
    pairs = list(combinations(range(count), 2))
    if len(pairs) <= MOST_PAIRS:
        return pairs, ()
    reach = next(n for n in range(count, 0, -1) if n == 1 or n * count <= MOST_PAIRS)
    near = [(a, b) for a, b in pairs if b - a <= reach]
    note = Text(
        "Only the {near} pairs of photos that are at most {reach} apart in the list were matched, not all {all}.",
        near=len(near), reach=reach, all=len(pairs),
    )  # fmt: skip
    return near, (note,)


class _Progress:
    """Counts what is done over all variants."""

    def __init__(self, run: Run, total: int) -> None:
        self.run, self.total, self.done = run, total, 0

    def step(self) -> None:
        self.done += 1
        self.run.check()
        self.run.progress(self.done, self.total, "comparison")


def _images(photos: PhotoSet, variant: Variant, index: int, run: Run) -> tuple[Array, Array]:
    """Return grey as the detector sees it, uint8 (h, w), and colour."""
    pixels = read_pixels(photos.photos[index])
    colour = eight_bit(pixels)
    filters = variant.recipe.algorithms("preprocessing", "filter")
    grey = luma(apply_filters(pixels, filters, run) if filters else colour)
    return np.ascontiguousarray(eight_bit(grey)), colour


def _warm_up(photos: PhotoSet, variant: Variant, run: Run) -> None:
    """Run everything once on a small part, so that no compiler is in the times."""
    grey, _ = _images(photos, variant, 0, run)
    top, left = max(0, grey.shape[0] // 2 - WARM_SIDE), max(0, grey.shape[1] // 2 - WARM_SIDE)
    part = np.ascontiguousarray(grey[top : top + 2 * WARM_SIDE, left : left + 2 * WARM_SIDE])
    detector, params = variant.recipe.algorithm("features", "detector")
    matcher, matcher_params = variant.recipe.algorithm("features", "matcher")
    try:
        found = detector.function(part, part, params, run=run)
        matcher.function(found, found, matcher_params, run=run)
    except (UserError, cv2.error):  # it will fail again where it is reported
        return


def _row(
    photos: PhotoSet,
    variant: Variant,
    pairs: Sequence[tuple[int, int]],
    homography: Array | None,
    known: dict[Any, tuple[list[Features], float]],
    run: Run,
    progress: _Progress,
) -> Row:
    row = Row(variant.label, variant.detector, dict(variant.changes))
    try:
        features, seconds = _features(photos, variant, known, run, progress)
        row = replace(
            row, keypoints=sum(len(f.xy) for f in features),
            keypoints_per_photo=tuple(len(f.xy) for f in features), seconds={"detection": seconds}, time_s=seconds,
        )  # fmt: skip
        return _matched(photos, variant, features, pairs, homography, row, run, progress) if pairs else row
    except (UserError, cv2.error) as problem:
        run.warn(Text("{name} could not be compared: {why}", name=variant.label, why=problem))
        return replace(row, failure=str(problem))


def _features(
    photos: PhotoSet,
    variant: Variant,
    known: dict[Any, tuple[list[Features], float]],
    run: Run,
    progress: _Progress,
) -> tuple[list[Features], float]:
    """Return the features of all photos and the seconds of finding them; variants that share them, share both."""
    detector, params = variant.recipe.algorithm("features", "detector")
    filters = variant.recipe.algorithms("preprocessing", "filter")
    key = (detector.name, params, tuple((a.name, p) for a, p in filters))
    if key not in known:
        found, seconds = [], 0.0
        for index in range(len(photos.photos)):
            grey, colour = _images(photos, variant, index, run)
            started = time.perf_counter()
            found.append(detector.function(grey, colour, params, run=run))
            seconds += time.perf_counter() - started
            progress.step()
        known.clear()  # only neighbours in the list share: the memory of one set
        known[key] = (found, seconds)
    else:
        for _ in photos.photos:
            progress.step()
    return known[key]


def _matched(
    photos: PhotoSet,
    variant: Variant,
    features: list[Features],
    pairs: Sequence[tuple[int, int]],
    homography: Array | None,
    row: Row,
    run: Run,
    progress: _Progress,
) -> Row:
    matcher, matcher_params = variant.recipe.algorithm("features", "matcher")
    verification, verification_params = variant.recipe.algorithm("features", "verification")
    builder, builder_params = variant.recipe.algorithm("features", "tracks")
    cameras = [photos.cameras[photo.camera] for photo in photos.photos]
    seconds = {**row.seconds, "matching": 0.0, "verification": 0.0}
    verified: list[PairMatches] = []
    truth: AgainstTruth | None = None
    for a, b in pairs:
        started = time.perf_counter()
        candidates = matcher.function(features[a], features[b], matcher_params, run=run)
        matched = time.perf_counter()
        verified.append(verification.function(
            (a, b), features[a], features[b], candidates, (cameras[a], cameras[b]), verification_params, run=run
        ))  # fmt: skip
        seconds["matching"] += matched - started
        seconds["verification"] += time.perf_counter() - matched
        if homography is not None:
            truth = against_truth(features[a], features[b], candidates.matches, homography)
        progress.step()
    tracks = builder.function(features, verified, builder_params, run=run)
    matches, kept = sum(p.candidates for p in verified), sum(len(p.matches) for p in verified)
    groups = components(len(features), verified)
    row = replace(
        row, time_s=sum(seconds.values()), seconds=seconds, matches=matches, verified=kept,
        inlier_share=kept / matches if matches else None,
        coverage=float(np.mean([photo_coverage(features, verified, i).occupied_share for i in range(len(features))])),
        mean_rays=len(tracks.photo) / tracks.count if tracks.count else None,
        photos_connected=len(groups[0]) if kept else 0,
    )  # fmt: skip
    return row if truth is None else _with_truth(row, truth)


def _with_truth(row: Row, truth: AgainstTruth) -> Row:
    return replace(
        row, correct_3px=truth.correct_3px, correct_cells_2px=truth.correct_cells_2px,
        repeatability=truth.repeatability, precision=truth.precision, matching_score=truth.matching_score,
    )  # fmt: skip


def _curve(
    photos: PhotoSet, variant: Variant, disturbance: Disturbance, run: Run, progress: _Progress
) -> Curve:
    """Match the first photo, reduced, with changed versions of itself."""
    detector, params = variant.recipe.algorithm("features", "detector")
    matcher, matcher_params = variant.recipe.algorithm("features", "matcher")
    grey = small(_images(photos, variant, 0, run)[0])
    original = detector.function(grey, grey, params, run=run)
    measured = []
    for level in disturbance.levels:
        image, homography = changed(grey, disturbance, level, run.seed)
        found = detector.function(image, image, params, run=run)
        candidates = matcher.function(original, found, matcher_params, run=run)
        measured.append(against_truth(original, found, candidates.matches, homography))
        progress.step()
    return Curve(
        algorithm=variant.label, disturbance=disturbance.name, levels=disturbance.levels,
        repeatability=tuple(m.repeatability or 0.0 for m in measured),
        matching_score=tuple(m.matching_score or 0.0 for m in measured),
        correct=tuple(m.correct_cells_2px for m in measured),
    )  # fmt: skip
