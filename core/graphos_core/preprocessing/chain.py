"""Filters one after the other."""

from __future__ import annotations

from collections.abc import Sequence

from graphos_core.data import Array
from graphos_core.params import Params
from graphos_core.registry import Algorithm
from graphos_core.run import Run


def apply_filters(image: Array, filters: Sequence[tuple[Algorithm, Params]], run: Run) -> Array:
    """Apply filters in order, each to the result of the one before.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    filters : sequence of (Algorithm, Params)
        Of the role ``filter``.
    run : Run

    Returns
    -------
    uint8 (h, w) or (h, w, 3)
        `image` itself when there are no filters.

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    for algorithm, params in filters:
        run.check()
        image = algorithm.function(image, params, run=run)
    return image
