"""Every way to grey on one photo: what each keeps of the colour contrast, and how many keypoints it gives."""

from __future__ import annotations

import time
from collections.abc import Callable

from graphos_core import registry
from graphos_core.data import Array, record
from graphos_core.preprocessing.decolorization_quality import decolorization_quality
from graphos_core.preprocessing.grey import GreyParams
from graphos_core.run import Run, each

OTHERS = ("decolor", "lightness", "principal")
"""Decolourisations beside the choices of plain grey."""


@record
class GreyVariant:
    """One way to grey, judged on one photo.

    Attributes
    ----------
    algorithm : str
        Name of the filter.
    choice : str
        Of plain grey its weights; empty for others.
    label : str
        Name for people.
    ccpr, ccfr, e_score : float
        Means over τ = 1 … 15; NaN for a photo without contrast.
    keypoints : int or None
        None when they were not counted.
    seconds : float
        Time of the conversion.
    """

    algorithm: str
    choice: str
    label: str
    ccpr: float
    ccfr: float
    e_score: float
    keypoints: int | None
    seconds: float


def compare_grey_variants(
    image: Array, count: Callable[[Array], int] | None, *, run: Run
) -> tuple[GreyVariant, ...]:
    """Judge every decolourisation with its default parameters on one photo.

    Parameters
    ----------
    image : uint8 or uint16 (h, w, 3) RGB
    count : callable or None
        Counts the keypoints of a grey photo uint8 (h, w); the caller's, because detectors live in the next room.
    run : Run
        Its seed draws the pixel pairs.

    Raises
    ------
    ValueError
        For a photo without colour.
    Stopped
        When the person asked to stop.
    """
    if image.ndim != 3 or image.shape[2] != 3:
        raise ValueError("a photo without colour has one way to grey only")
    plain = registry.find("preprocessing", "grey")
    labels = GreyParams.declarations()["weights"].about.choices
    todo = [
        (registry.find("preprocessing", n), "", registry.find("preprocessing", n).params()) for n in OTHERS
    ]
    todo += [(plain, choice, GreyParams(weights=choice)) for choice in labels]  # type: ignore[arg-type]
    rows = []
    for algorithm, choice, params in each(run, todo, "grey versions"):
        begun = time.perf_counter()
        grey = algorithm.function(image, params, run=run)
        seconds = time.perf_counter() - begun
        ccpr, ccfr, e_score = decolorization_quality(image, grey, run.seed).means()
        rows.append(
            GreyVariant(
                algorithm=algorithm.name,
                choice=choice,
                label=labels[choice] if choice else algorithm.label,
                ccpr=ccpr,
                ccfr=ccfr,
                e_score=e_score,
                keypoints=None if count is None else count(grey),
                seconds=seconds,
            )
        )
    return tuple(rows)
