"""What the image graph is drawn from: its edges, and where its nodes may lie."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from graphos_core.data import Array, PairMatches, Photo
from graphos_core.features.graph import match_counts
from graphos_core.rendering.graph_layout import flat_layout, force_layout
from graphos_py.views.graph_marks import Edge

STRENGTH, GNSS, ORIENTATION = "strength", "gnss", "orientation"
EARTH_M = 6_371_000.0


def edges_of(pairs: Sequence[PairMatches]) -> list[Edge]:
    """Return the edges of all pairs that are used."""
    return [
        Edge(i, pair.a, pair.b, len(pair.matches))
        for i, pair in enumerate(pairs)
        if not pair.reason and len(pair.matches)
    ]


def positions_by_gnss(photos: Sequence[Photo]) -> Array | None:
    """Return east and north (n, 2), m, of the photos, north up on the screen; None unless all say where they were."""
    places = [(photo.exif.longitude_deg, photo.exif.latitude_deg) for photo in photos]
    if not places or any(x is None or y is None for x, y in places):
        return None
    degrees = np.array(places, np.float64)
    shift = np.radians(degrees - degrees.mean(axis=0)) * EARTH_M
    shift[:, 0] *= np.cos(np.radians(degrees[:, 1].mean()))
    return np.asarray(shift * [1.0, -1.0])


def positions_by_orientation(adjusted: Any, names: Sequence[str]) -> Array | None:
    """Return the projection centres (n, 2) seen where they spread most; None without a block of these photos.

    Photos that are not oriented stand in a row below.
    """
    block = getattr(getattr(adjusted, "adjustment", None), "block", None)
    if block is None or tuple(block.names) != tuple(names) or np.sum(block.oriented) < 3:
        return None
    centres = np.where(np.asarray(block.oriented)[:, None], np.asarray(block.centres, np.float64), np.nan)
    flat = flat_layout(centres)
    missing = np.flatnonzero(~np.isfinite(flat).all(axis=1))
    low, high = np.nanmin(flat, axis=0), np.nanmax(flat, axis=0)
    for place, photo in enumerate(missing):
        flat[photo] = [
            low[0] + (place + 0.5) * (high[0] - low[0]) / len(missing),
            high[1] + 0.25 * (high - low).max(),
        ]
    return flat


def positions_by_strength(count: int, pairs: Sequence[PairMatches]) -> Array:
    """Return places (n, 2) at which photos with many common points lie together."""
    return force_layout(match_counts(count, pairs).astype(np.float64))
