"""What the internal figures mean for the person, and what would help: one sentence per weakness."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from graphos_core.data import Adjustment
from graphos_core.quality.internal import image_coverage
from graphos_core.text import Text


def advice(
    figures: Mapping[str, Mapping[str, Any]], adjustment: Adjustment, check_rms_m: float = math.nan
) -> tuple[Text, ...]:
    """Return sentences about what is weak, the weightiest first; a single confirming one when nothing is.

    Parameters
    ----------
    figures : mapping
        From `graphos_core.quality.internal.internal_figures`.
    adjustment : Adjustment
    check_rms_m : float
        RMS per coordinate over the check points, m; NaN where there are none.
    """
    found = [
        *_about_orientation(figures, adjustment),
        *_about_geometry(figures, adjustment),
        *_about_scale(figures, adjustment),
    ]
    if not found:
        found.append(Text("Residuals, rays, intersection angles and coverage are all in the usual range."))
    return (*found, _about_accuracy(check_rms_m))


def _about_accuracy(check_rms_m: float) -> Text:
    if math.isfinite(check_rms_m):
        return Text(
            "Check points took no part and show the accuracy: {rms:.2f} mm RMS per coordinate.",
            rms=1000.0 * check_rms_m,
        )
    return Text("These figures show only the precision; independent check points would show the accuracy.")


def _value(figures: Mapping[str, Mapping[str, Any]], name: str) -> float:
    value = figures.get(name, {}).get("value")
    return float("nan") if value is None else float(value)


def _about_orientation(figures: Mapping[str, Mapping[str, Any]], adjustment: Adjustment) -> list[Text]:
    found = []
    block = adjustment.block
    if not block.oriented.all():
        names = [name for name, good in zip(block.names, block.oriented, strict=True) if not good]
        shown = ", ".join(names[:5]) + (" …" if len(names) > 5 else "")
        found.append(
            Text(
                "{count} photos are not oriented ({names}). Photos in between, with 60 % overlap or more, would tie "
                "them in.",
                count=len(names), names=shown,
            )
        )  # fmt: skip
    rms = _value(figures, "reprojection_rms")
    if rms > 1.0:
        found.append(
            Text(
                "The reprojection RMS of {rms:.2f} px is large. Self-calibration with more lens parameters, or a "
                "stricter matching threshold, usually brings it below 1 px.",
                rms=rms,
            )
        )
    if not adjustment.converged:
        found.append(Text("The adjustment did not converge: {reason}", reason=adjustment.stop_reason))
    return found


def _about_geometry(figures: Mapping[str, Mapping[str, Any]], adjustment: Adjustment) -> list[Text]:
    found = []
    rays, angle = _value(figures, "mean_rays"), _value(figures, "intersection_angle")
    if rays < 3.0:
        found.append(
            Text(
                "Object points have {rays:.1f} rays on average: a wrong match in two rays cannot be noticed. More "
                "overlap gives three rays or more.",
                rays=rays,
            )
        )
    if angle < 8.0:
        found.append(
            Text(
                "The rays intersect under {angle:.1f}° (median): depth is much less precise than position. Take "
                "the photos with longer bases.",
                angle=angle,
            )
        )
    covers = image_coverage(adjustment.block)
    weak = [
        f"{name} ({100 * share:.0f} %)"
        for name, share, good in zip(adjustment.block.names, covers, adjustment.block.oriented, strict=True)
        if good and share < 0.35
    ]
    if weak:
        found.append(
            Text(
                "Tie points cover only a small part of {names}. Outside that part the orientation and the lens "
                "parameters are extrapolated.",
                names=", ".join(weak[:4]) + (" …" if len(weak) > 4 else ""),
            )
        )
    return found


def _about_scale(figures: Mapping[str, Mapping[str, Any]], adjustment: Adjustment) -> list[Text]:
    found = []
    if adjustment.block.unit != "m":
        found.append(
            Text(
                "The model has no scale yet. Three control points, or one known distance, give lengths in metres."
            )
        )
    precision, gsd = _value(figures, "point_precision"), _value(figures, "gsd")
    if np.isfinite(precision) and np.isfinite(gsd) and precision > 1.5 * gsd:
        found.append(
            Text(
                "Object points are {ratio:.1f} times less precise than a pixel on the object is large. Longer bases "
                "or more rays per point would help.",
                ratio=precision / gsd,
            )
        )
    return found
