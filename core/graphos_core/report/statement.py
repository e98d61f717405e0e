"""The closing statement: precision from the covariance against accuracy from check points, and what follows."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import chdtri

from graphos_core.number_format import format_number
from graphos_core.report.values import rms_per_axis
from graphos_core.text import Text

ALPHA = 0.01
"""Error probability of the test whether check points keep what the covariance promises."""


def statement(report: dict[str, Any]) -> dict[str, Any] | None:
    """Return ``verdict, precision, accuracy, text, factor`` from the finished parts; None without adjustment.

    `verdict` is ``"confirmed"``, ``"optimistic"``, ``"cautious"`` or ``"not checked"``: whether the normalised
    residuals of the check points, ``d / √(σ² + σ_given²)``, have the sum of squares that a χ² distribution with as
    many degrees of freedom allows. `factor` is the root mean square of the normalised residuals: 1 when the standard
    deviations are right.
    """
    points, found = report["object_points"], report["check"]
    if points is None:
        return None
    precision = _precision(points)
    if found is None:
        if report["orientation"]["unit"] != "m":
            accuracy = Text("The model has no scale: nothing can be said about accuracy in metres.")
        else:
            accuracy = Text(
                "There are no check points: accuracy is not known. Standard deviations cannot show what bends the block "
                "as a whole, such as a wrong calibration or wrong control."
            )
        return _made("not checked", precision, accuracy, math.nan)
    independent = [p for p in found["points"] if p["role"] == "check"]
    if not independent:
        return _made("not checked", precision, Text(
            "All points that are compared also placed the block: accuracy is not known, for a similarity takes up part of "
            "every error."), math.nan)  # fmt: skip
    d = np.array([p["residual_m"] for p in independent], dtype=np.float64)
    accuracy = Text(
        "Accuracy: {count} check points that took no part are missed by {x} mm in X, {y} mm in Y and {z} mm in Z (root "
        "mean square).", count=len(independent), **dict(zip("xyz", _millimetres(rms_per_axis(d)), strict=True)),
    )  # fmt: skip
    normalised = np.array([p["normalised"] for p in independent], dtype=np.float64).ravel()
    normalised = normalised[np.isfinite(normalised)]
    if not len(normalised):
        text = Text("{accuracy} Their own standard deviations are not known, so the two cannot be set against each "
                    "other.", accuracy=accuracy)  # fmt: skip
        return _made("not checked", precision, text, math.nan)
    squares, n = float((normalised**2).sum()), len(normalised)
    factor = math.sqrt(squares / n)
    low, high = chdtri(n, 1 - ALPHA / 2), chdtri(n, ALPHA / 2)  # χ² quantiles by upper tail
    verdict = "optimistic" if squares > high else "cautious" if squares < low else "confirmed"
    return _made(verdict, precision, Text(
        "{accuracy} {conclusion}", accuracy=accuracy, conclusion=_conclusion(verdict, factor)), factor)  # fmt: skip


def _precision(points: dict[str, Any]) -> str:
    if points["sigma"] is None:
        return Text("Precision: the adjustment computed no standard deviations of the object points.")
    scale, unit = (1000.0, "mm") if points["unit"] == "m" else (1.0, points["unit"])
    x, y, z = (format_number(scale * points["sigma"][axis]["median"], digits=2) for axis in "xyz")
    return Text(
        "Precision: the median standard deviation of an object point is {x} {unit} in X, {y} {unit} in Y and {z} {unit} "
        "in Z, from the covariance.", x=x, y=y, z=z, unit=unit,
    )  # fmt: skip


def _conclusion(verdict: str, factor: float) -> str:
    times = format_number(factor, digits=2)
    if verdict == "confirmed":
        return Text("That is {times} times what their standard deviations let one expect, as close to 1 as so few points "
                    "can tell: the stated precision is confirmed.", times=times)  # fmt: skip
    if verdict == "optimistic":
        return Text("That is {times} times what their standard deviations let one expect: the stated precision is too "
                    "good to be true by about this factor. Look for systematic errors: calibration, control, "
                    "measurements.", times=times)  # fmt: skip
    return Text("That is only {times} times what their standard deviations let one expect: the a priori standard "
                "deviations are too cautious.", times=times)  # fmt: skip


def _made(verdict: str, precision: str, accuracy: str, factor: float) -> dict[str, Any]:
    return {
        "verdict": verdict, "precision": precision, "accuracy": accuracy, "text": f"{precision} {accuracy}",
        "factor": factor,
    }  # fmt: skip


def _millimetres(metres: list[float] | None) -> list[str]:
    return [format_number(1000.0 * v, digits=2) for v in metres or [math.nan] * 3]
