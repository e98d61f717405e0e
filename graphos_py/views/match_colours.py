"""What the colour of a match says: its distance from the geometry of the pair, or how distinctive it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.matches import PairMatches
from graphos_core.data.record import Array
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_py.translation import tr

RESIDUAL, RATIO = "residual", "ratio"
TABLE = "bright viridis"
DROPPED = (150, 150, 150)
"""Matches that a thinning would leave out."""


@dataclass(frozen=True)
class MatchColours:
    """Figures of the matches of one pair and their range on the colour bar.

    Attributes
    ----------
    values : float (n,) or None
        None where the figure is not known: colour then only tells neighbours apart.
    low, high : float
        Ends of the colour bar.
    title, unit : str
    """

    values: Array | None
    low: float
    high: float
    title: str
    unit: str

    def rgb(self, xy: Array, width: int, kept: Array | None) -> Array:
        """Return uint8 (n, 3) of the matches at `xy` (n, 2) in a photo of `width`; not kept ones are grey."""
        if self.values is None:
            colours = colours_of_values(xy[:, 0], 0.0, float(max(width, 1)), TABLE)
        else:
            colours = colours_of_values(self.values, self.low, self.high, TABLE)
        if kept is not None:
            colours[~kept] = DROPPED
        return colours


def colours_by(kind: str, pair: PairMatches | None, residuals: Array | None) -> MatchColours:
    """Return the colouring of a pair by residual or by ratio."""
    if kind == RATIO:
        ratio = np.asarray(pair.ratio) if pair is not None else np.zeros(0)
        known = ratio if pair is not None and len(ratio) == len(pair.matches) > 0 else None
        low = 0.0 if known is None else float(np.floor(10 * np.quantile(known, 0.02)) / 10)
        high = 1.0 if known is None else float(max(np.ceil(20 * known.max()) / 20, low + 0.05))
        return MatchColours(known, low, high, tr("nearest / second nearest distance"), "")
    return MatchColours(residuals, 0.0, residual_range(pair, residuals), residual_title(pair), "px")


def residual_title(pair: PairMatches | None) -> str:
    """Return what the residual of a match is measured from."""
    planar = pair is not None and pair.kind == "homography"
    return tr("distance from the mapped point") if planar else tr("distance from the epipolar line")


def residual_range(pair: PairMatches | None, residuals: Array | None) -> float:
    """Return the distance that gets the last colour, px: few matches lie beyond it."""
    if residuals is None or not len(residuals):
        return 1.0
    high = float(np.quantile(residuals, 0.98))
    threshold = pair.threshold_px if pair is not None else 0.0
    return max(min(high, threshold) if threshold > 0 else high, 1e-3)
