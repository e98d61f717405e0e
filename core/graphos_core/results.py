"""The result of each of the five steps, as the store keeps it and the window and the report show it."""

from __future__ import annotations

from typing import Any

from graphos_core.data import (
    Adjustment,
    Block,
    Cloud,
    DepthMap,
    Features,
    Georeference,
    PairMatches,
    Photo,
    Tracks,
    record,
)
from graphos_core.errors import ItemFailure
from graphos_core.roles import ComparisonResult


@record
class PreprocessingResult:
    """Undistorted and filtered photos.

    Attributes
    ----------
    files : tuple of str
        Paths of the result images in the order of the photos; empty when no filter is chosen and the photos are
        used as they are.
    failures : tuple of ItemFailure
    undistorted : tuple of Photo
        The undistorted photos in the order of the photos, their paths inside the result's folder; what they do not
        show is transparent. Empty when the photos stay as taken.
    """

    files: tuple[str, ...] = ()
    failures: tuple[ItemFailure, ...] = ()
    undistorted: tuple[Photo, ...] = ()


@record
class FeaturesResult:
    """Features of every photo, verified pairs and tracks.

    Attributes
    ----------
    features : tuple of Features
        In the order of the photos.
    pairs : tuple of PairMatches
        Every pair that was tried, with the reason where it is not used.
    tracks : Tracks
    """

    features: tuple[Features, ...]
    pairs: tuple[PairMatches, ...]
    tracks: Tracks


@record
class PlacedBlock:
    """The oriented block in the frame of what is known, before the adjustment."""

    block: Block
    georeference: Georeference


@record
class AdjustmentResult:
    """The adjusted block, and how it lies in the frame of what is known."""

    adjustment: Adjustment
    georeference: Georeference


@record
class DenseResult:
    """Depth maps and the cloud fused from them."""

    maps: tuple[DepthMap, ...]
    cloud: Cloud


@record
class QualityResult:
    """How good the model is.

    Attributes
    ----------
    figures : dict
        Internal figures by name, see `graphos_core.quality.internal`.
    advice : tuple of str
        What the figures mean and what would help.
    comparison : ComparisonResult or None
        Against the reference; None where there is none.
    """

    figures: dict[str, Any]
    advice: tuple[str, ...]
    comparison: ComparisonResult | None = None
