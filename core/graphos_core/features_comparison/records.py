"""What a comparison of algorithms consists of."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from graphos_core.data import Array

DEFINITIONS = {
    "keypoints": "Key points kept, all photos together.",
    "time_s": "Seconds of finding, matching and verifying, all photos and pairs, one after the other; without reading.",
    "matches": "Candidate matches of the matcher, all pairs together.",
    "verified": "Matches that fulfil the geometry of their pair, all pairs together.",
    "inlier_share": "Verified matches through candidate matches.",
    "coverage": "Share of the format's cells with a verified match, mean of the photos.",
    "mean_rays": "Photos per tie point, mean of all tie points.",
    "correct_3px": "Candidate matches (before verification) nearer than 3 px to where the homography maps them.",
    "correct_cells_2px": "The same, counted once per 2 px cell of photo 1.",
    "repeatability": "Points in the common part of both photos with a partner within 1.5 px, one to one, through the smaller "
    "number of points there (Mikolajczyk et al. 2005, by position).",
    "precision": "Correct matches through candidate matches.",
    "matching_score": "Correct matches, once per cell, through the smaller number of points in the common part.",
}
"""What every figure of a row means."""


@dataclass(frozen=True)
class Row:
    """The figures of one algorithm with one set of parameters; see `DEFINITIONS`.

    Attributes
    ----------
    algorithm : str
        Name of the detector, with what was varied.
    detector : str
    parameters : dict
        What was set: ``{"sift.contrast": "0.02"}``.
    keypoints_per_photo : tuple of int
    seconds : dict
        ``detection, matching, verification``.
    photos_connected : int
        Photos in the largest group that hangs together by verified pairs.
    failure : str
        Why the algorithm could not be run; then every figure is zero or None.
    """

    algorithm: str
    detector: str
    parameters: dict[str, str]
    keypoints: int = 0
    time_s: float = 0.0
    matches: int = 0
    verified: int = 0
    inlier_share: float | None = None
    coverage: float = 0.0
    correct_3px: int | None = None
    correct_cells_2px: int | None = None
    repeatability: float | None = None
    mean_rays: float | None = None
    precision: float | None = None
    matching_score: float | None = None
    keypoints_per_photo: tuple[int, ...] = ()
    seconds: dict[str, float] = field(default_factory=dict)
    photos_connected: int = 0
    failure: str = ""


@dataclass(frozen=True)
class Curve:
    """One algorithm against one disturbance: a value per level.

    Attributes
    ----------
    algorithm, disturbance : str
    levels : tuple of float
    repeatability, matching_score : tuple of float
        0 where the changed photo has no points at all.
    correct : tuple of int
        Right matches, once per cell.
    """

    algorithm: str
    disturbance: str
    levels: tuple[float, ...]
    repeatability: tuple[float, ...]
    matching_score: tuple[float, ...]
    correct: tuple[int, ...]


@dataclass(frozen=True)
class FeatureComparison:
    """Everything that was measured.

    Attributes
    ----------
    photos : tuple of str
    rows : tuple of Row
    homography : float64 (3, 3) or None
        From photo 1 to photo 2, where known.
    no_truth : str
        Why figures against truth are missing; empty where they are not.
    curves : tuple of Curve
        Against disturbances of the first photo.
    notes : tuple of str
    seed : int
    """

    photos: tuple[str, ...]
    rows: tuple[Row, ...]
    homography: Array | None
    no_truth: str
    curves: tuple[Curve, ...] = ()
    notes: tuple[str, ...] = ()
    seed: int = 0

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data, as ``comparison.json`` holds it."""
        from graphos_core import __version__
        from graphos_core.report import plain

        truth = {"known": self.homography is not None, "reason": self.no_truth}
        if self.homography is not None:
            truth["homography"] = self.homography.tolist()
        found: dict[str, Any] = plain({
            "schema": 1, "version": __version__, "seed": self.seed, "photos": self.photos, "truth": truth,
            "definitions": DEFINITIONS, "rows": [asdict(row) for row in self.rows],
            "curves": [asdict(curve) for curve in self.curves], "notes": self.notes,
        })  # fmt: skip
        return found
