"""What all verifications of a pair share: parameters, distortion-free positions, seeds, and how a pair is rejected."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from graphos_core.cameras import camera_model, ray_from_pixel
from graphos_core.data import Array, Camera, Candidates, Features, PairMatches
from graphos_core.params import About, Params
from graphos_core.text import Text

LESSON = "features/verification"


class VerificationParams(Params):
    """Parameters of every verification."""

    threshold: Annotated[
        float,
        About(
            label="Distance from the line",
            symbol="d",
            unit="px",
            low=0.1,
            high=50.0,
            step=0.5,
            help="Largest distance of a match from its epipolar line, in either photo, in pixels of the full photo. "
            "It must leave room for the distortion, which is not known yet.",
            effect="Higher: more matches, more wrong ones. Lower: with unknown distortion matches near the edges fail.",
            learn=LESSON,
            level="novice",
        ),
    ] = 4.0
    minimum: Annotated[
        int,
        About(
            label="Least matches",
            symbol="n",
            unit="matches",
            low=8,
            high=1000,
            step=1,
            help="A pair with fewer verified matches is not used.",
            effect="Higher: doubtful pairs fall away. Lower: weakly overlapping photos stay connected.",
            learn=LESSON,
            level="student",
        ),
    ] = 15
    confidence: Annotated[
        float,
        About(
            label="Confidence",
            symbol="p",
            low=0.5,
            high=1.0,
            high_open=True,
            step=0.001,
            help="Probability that at least one sample was free of wrong matches when the search ends.",
            effect="Higher: more samples, slower, safer. Lower: faster.",
            learn=LESSON,
            level="expert",
        ),
    ] = 0.999
    iterations: Annotated[
        int,
        About(
            label="Largest number of samples",
            unit="samples",
            low=100,
            high=1_000_000,
            step=1000,
            help="The search ends after so many samples in any case.",
            effect="Higher: pairs with very many wrong matches can be found, slower. Lower: faster.",
            learn=LESSON,
            level="expert",
        ),
    ] = 10_000


def epipolar_kind(wanted: str, cameras: tuple[Camera, Camera]) -> tuple[str, bool]:
    """Return ``"essential"`` or ``"fundamental"`` for ``"auto"``, and whether one of the cameras is wide.

    Essential unless a principal distance is only estimated; always for fish-eye and panorama cameras.
    """
    wide = any(camera_model(camera.model).wide for camera in cameras)
    reliable = not any(camera.focal_estimated for camera in cameras)
    if wide or wanted == "essential":
        return "essential", wide
    return ("essential" if wanted == "auto" and reliable else "fundamental"), wide


def matched_positions(a: Features, b: Features, candidates: Candidates) -> tuple[Array, Array]:
    """Return the measured pixels, float64 (n, 2), of both points of each candidate match."""
    matches = candidates.matches
    return a.xy[matches[:, 0]].astype(np.float64), b.xy[matches[:, 1]].astype(np.float64)


def ideal_pixels(camera: Camera, xy: Array) -> Array:
    """Return where points (n, 2) would be without distortion, px; NaN where the distortion cannot be inverted."""
    if not np.any(camera.values[3:]):
        return xy
    return np.asarray(ray_from_pixel(camera, xy)[:, :2] * camera.values[0] + camera.values[1:3])


def pair_seed(seed: int, index: tuple[int, int]) -> int:
    """Return the seed of a pair's random samples: of the recipe and the pair only."""
    return int(np.random.SeedSequence([seed, *index]).generate_state(1)[0] & 0x7FFFFFFF)


def rejected(
    index: tuple[int, int], candidates: Candidates, params: VerificationParams, what: str, n: int
) -> PairMatches:
    """Return a pair without matches, with the reason: too few candidate or too few verified matches."""
    template = (
        "only {count} candidate matches, {needed} needed"
        if what == "candidate"
        else "only {count} verified matches of {candidates}, {needed} needed"
    )
    return PairMatches(
        a=index[0],
        b=index[1],
        matches=np.zeros((0, 2), np.int32),
        candidates=len(candidates),
        kind="none",
        matrix=np.zeros((3, 3)),
        threshold_px=params.threshold,
        reason=Text(template, count=n, needed=params.minimum, candidates=len(candidates)),
    )
