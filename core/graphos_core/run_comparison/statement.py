"""What a comparison of two adjustments comes to, in a few sentences; check points outrank every criterion."""

from __future__ import annotations

import math
from collections.abc import Sequence

from scipy.special import fdtri

from graphos_core.number_format import format_number, format_value
from graphos_core.run_comparison.records import (
    CameraParameterDifference,
    CheckDifference,
    FrameDifference,
    NumberDifference,
    PointsDifference,
)
from graphos_core.text import Text

ALPHA = 0.05
"""Error probability of the test whether one of two adjustments misses its check points by more (F test)."""


def statement(
    numbers: Sequence[NumberDifference],
    cameras: Sequence[CameraParameterDifference],
    frame: FrameDifference,
    points: PointsDifference,
    check: CheckDifference,
) -> tuple[str, ...]:
    """Return the sentences: fit, cameras, object points, accuracy."""
    found = [_fit({n.key: n for n in numbers})]
    changed = [row.label.lower() for row in cameras if row.significant]
    if changed:
        found.append(
            Text("Significant differences of the camera: {names}.", names=", ".join(dict.fromkeys(changed)))
        )
    if points.common:
        found.append(_points(points, frame.unit))
    found.append(_accuracy(check))
    return tuple(found)


def _fit(n: dict[str, NumberDifference]) -> str:
    a, b = n["sigma0_px"].a, n["sigma0_px"].b
    fit = Text("sigma0 of an image coordinate: {a} in A, {b} in B.", a=format_value(a, unit="px", digits=3),
               b=format_value(b, unit="px", digits=3))  # fmt: skip
    aic, bic = n["aic"].better.upper(), n["bic"].better.upper()
    if not (aic and bic):
        return fit
    if aic == bic:
        return Text("{fit} AIC and BIC both prefer {best}.", fit=fit, best=aic)
    return Text("{fit} AIC prefers {aic}, BIC prefers {bic}: what the additional unknowns describe is small.", fit=fit,
                aic=aic, bic=bic)  # fmt: skip


def _points(points: PointsDifference, unit: str) -> str:
    text = Text(
        "Object points: the median distance between A and B is {d}",
        d=format_value(points.median, unit=unit, digits=2),
    )
    sigma = math.hypot(points.sigma_a, points.sigma_b)
    if not sigma > 0:
        return Text("{text}.", text=text)
    return Text("{text}, against a standard deviation of {s} per coordinate.", text=text,
                s=format_value(sigma / math.sqrt(2.0), unit=unit, digits=2))  # fmt: skip


def _accuracy(check: CheckDifference) -> str:
    if check.rms_a is None or check.rms_b is None:
        return Text(
            "Without check points in both nothing independent says which of the two is nearer to the truth."
        )
    a, b = (math.sqrt(sum(v * v for v in rms) / 3.0) for rms in (check.rms_a, check.rms_b))
    words = {
        "a": format_value(1000.0 * a, unit="mm", digits=2), "b": format_value(1000.0 * b, unit="mm", digits=2),
    }  # fmt: skip
    text = Text("Check points are missed by {a} per coordinate in A and by {b} in B", **words)
    worse, better = ((a, 3 * check.count_a), (b, 3 * check.count_b)) if a > b else (
        (b, 3 * check.count_b), (a, 3 * check.count_a))  # fmt: skip
    if better[0] > 0 and (worse[0] / better[0]) ** 2 < fdtri(worse[1], better[1], 1.0 - ALPHA / 2.0):
        return Text("{text}: no more than chance makes of so few points.", text=text)
    if not worse[0] > 0:
        return Text("{text}.", text=text)
    best = "B" if a > b else "A"
    factor = format_number(worse[0] / better[0], digits=2) if better[0] > 0 else "∞"
    return Text("{text}: {best} is nearer to the truth by a factor of {f}.", text=text, best=best, f=factor)
