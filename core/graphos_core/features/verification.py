r"""Robust epipolar geometry of a pair: which candidate matches agree with one relative orientation."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import cv2
import numpy as np

from graphos_core.data import Array, Camera, Candidates, Features, PairMatches
from graphos_core.features.pair_verdict import (
    LESSON,
    VerificationParams,
    epipolar_kind,
    ideal_pixels,
    matched_positions,
    pair_seed,
    rejected,
)
from graphos_core.features.robust.scene import pair_scene
from graphos_core.geometry.epipolar import (
    essential_from_relative,
    fundamental_from_essential,
    interior_matrix,
    line_distances,
)
from graphos_core.geometry.rays import rays_of
from graphos_core.geometry.relative_orientation import RayPairs, relative_orientation
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

SMALLEST_SAMPLE = {"essential": 5, "fundamental": 7}


class UsacParams(VerificationParams):
    """Parameters of the robust estimation."""

    model: Annotated[
        Literal["auto", "essential", "fundamental"],
        About(
            label="Matrix",
            help="Essential: principal distances are trusted (5 unknowns). Fundamental: they are not needed (7).",
            effect="Automatic: essential unless a principal distance is only estimated.",
            choices={
                "auto": "automatic",
                "essential": "essential matrix",
                "fundamental": "fundamental matrix",
            },
            learn=LESSON,
            level="student",
        ),
    ] = "auto"


@algorithm(
    stage="features",
    role="verification",
    name="usac",
    label="Robust epipolar geometry (MAGSAC++)",
    source="Raguram et al. 2013 (USAC); Barath et al. 2020 (MAGSAC++); Nistér 2004 (five-point solver)",
    version=2,
    learn=LESSON,
)
def usac(
    index: tuple[int, int],
    a: Features,
    b: Features,
    candidates: Candidates,
    cameras: tuple[Camera, Camera],
    params: UsacParams,
    *,
    run: Run,
) -> PairMatches:
    """Estimate the essential or fundamental matrix of a pair and keep the matches that fulfil it.

    For an essential matrix the positions are freed from distortion by the camera models first. A match is verified
    when its distance from the epipolar line is at most `UsacParams.threshold` in both photos. Fish-eye and panorama
    cameras always take the essential matrix: rays that do not lie before an image plane have no fundamental matrix.
    The random samples depend on ``run.seed`` and the pair only.

    Parameters
    ----------
    index : (int, int)
        Indices of the photos.
    a, b : Features
    candidates : Candidates
    cameras : (Camera, Camera)
    params : UsacParams
    run : Run

    Returns
    -------
    PairMatches
        With a reason and no matches where the pair cannot be used.
    """
    kind, wide = epipolar_kind(params.model, cameras)
    if len(candidates) < max(params.minimum, SMALLEST_SAMPLE[kind] + 1):
        return rejected(index, candidates, params, "candidate", len(candidates))
    xy_a, xy_b = matched_positions(a, b, candidates)
    if wide:
        matrix, verified = _by_rays(index, xy_a, xy_b, cameras, params, run.seed)
    else:
        matrix, verified = _in_plane(kind, index, xy_a, xy_b, cameras, params, run.seed)
    if matrix is None:
        return rejected(index, candidates, params, "verified", 0)
    if len(verified) < params.minimum:
        return rejected(index, candidates, params, "verified", len(verified))
    return PairMatches(
        a=index[0],
        b=index[1],
        matches=np.ascontiguousarray(candidates.matches[verified], dtype=np.int32),
        candidates=len(candidates),
        kind=kind,
        matrix=matrix,
        threshold_px=params.threshold,
        ratio=candidates.ratio[verified],
        scene=pair_scene(kind, matrix, xy_a[verified], xy_b[verified], cameras, pair_seed(run.seed, index)),
    )


def _in_plane(
    kind: str,
    index: tuple[int, int],
    xy_a: Array,
    xy_b: Array,
    cameras: tuple[Camera, Camera],
    params: UsacParams,
    seed: int,
) -> tuple[Array | None, Array]:
    """Return the matrix of two central cameras, and the indices of the matches that fulfil it."""
    if kind == "essential":
        xy_a, xy_b = ideal_pixels(cameras[0], xy_a), ideal_pixels(cameras[1], xy_b)
    usable = np.flatnonzero(np.isfinite(xy_a).all(axis=1) & np.isfinite(xy_b).all(axis=1))
    matrix = _estimate(kind, xy_a[usable], xy_b[usable], cameras, _settings(index, params, seed))
    if matrix is None:
        return None, usable
    fundamental = fundamental_from_essential(matrix, *cameras) if kind == "essential" else matrix
    distance_a, distance_b = line_distances(fundamental, xy_a[usable], xy_b[usable])
    return matrix, usable[(distance_a <= params.threshold) & (distance_b <= params.threshold)]


def _by_rays(
    index: tuple[int, int],
    xy_a: Array,
    xy_b: Array,
    cameras: tuple[Camera, Camera],
    params: UsacParams,
    seed: int,
) -> tuple[Array | None, Array]:
    """Return the essential matrix of rays of any field angle, and the indices of the matches that fulfil it."""
    a, b = rays_of(cameras[0], xy_a), rays_of(cameras[1], xy_b)
    usable = np.flatnonzero(a.valid & b.valid)
    pairs = RayPairs(a[usable], b[usable])
    found = relative_orientation(pairs.a, pairs.b, params.threshold, seed=pair_seed(seed, index))
    if not found:
        return None, usable
    essential = essential_from_relative(found.rotation, found.translation)
    distance = pairs.line_distances(essential)
    return essential / np.linalg.norm(essential), usable[distance <= params.threshold]


def _settings(index: tuple[int, int], params: UsacParams, seed: int) -> Any:
    settings: Any = cv2.UsacParams()
    settings.confidence = params.confidence
    settings.maxIterations = params.iterations
    settings.threshold = params.threshold
    settings.isParallel = False
    settings.sampler = cv2.SAMPLING_UNIFORM
    settings.score = cv2.SCORE_METHOD_MAGSAC
    settings.loMethod = cv2.LOCAL_OPTIM_SIGMA
    settings.loIterations = 5
    settings.loSampleSize = 50
    settings.final_polisher = cv2.MAGSAC
    settings.final_polisher_iterations = 3
    settings.randomGeneratorState = pair_seed(seed, index)
    return settings


def _estimate(
    kind: str, xy_a: Array, xy_b: Array, cameras: tuple[Camera, Camera], settings: Any
) -> Array | None:
    """Return the matrix (3, 3) of Frobenius norm 1, or None where no sample had a solution."""
    if len(xy_a) <= SMALLEST_SAMPLE[kind]:
        return None
    try:
        if kind == "essential":
            inner_a, inner_b = interior_matrix(cameras[0]), interior_matrix(cameras[1])
            found, _ = cv2.findEssentialMat(xy_a, xy_b, inner_a, inner_b, None, None, settings)
        else:
            found, _ = cv2.findFundamentalMat(xy_a, xy_b, settings)
    except cv2.error:  # degenerate samples only: all points in one place or on a line
        return None
    if found is None or found.shape != (3, 3) or not np.isfinite(found).all() or not found.any():
        return None
    return np.asarray(found, dtype=np.float64) / np.linalg.norm(found)
