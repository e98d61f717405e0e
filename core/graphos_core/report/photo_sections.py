"""The section on the photos."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data import Adjustment
from graphos_core.number_format import UNKNOWN, format_number, format_value
from graphos_core.report.page import Part, Pictures, Section, Table
from graphos_core.report.photo_pictures import photo_picture
from graphos_core.text import Text

DRAWN = 12
"""So many photos get a picture of their residual vectors: those with the largest RMS."""

LONG = 3.0
"""Residual vectors longer than this many times their root mean square are red."""


def photos_section(report: dict[str, Any], adjustment: Adjustment) -> Section:
    """Orientation ± σ, residuals and coverage of every photo, and the residual vectors of the worst."""
    o = report["orientation"]
    unit = o["unit"]
    position = ("Photo", "RMS px", "points", "coverage %", *(f"{axis} ± σ {unit}" for axis in "XYZ"))
    parts: list[Part] = [
        Table(position, [_position(p) for p in o["photos"]], note=Text(
            "X, Y, Z: projection centre. σ from the covariance, relative to the datum. RMS of the image residuals per "
            "coordinate. Coverage: share of a grid of about 10 × 13 cells with at least one point.")),
        Table(("Photo", "ω ± σ °", "φ ± σ °", "κ ± σ °"), [_angles(p) for p in o["photos"]], note=Text(
            "ω, φ, κ: image frame x right, y up, z backward; world from image = Rx(ω) Ry(φ) Rz(κ).")),
    ]  # fmt: skip
    if len(adjustment.residuals):
        parts.append(_vectors(adjustment))
    return Section("photos", Text("Photos"), "adjustment/orientation", parts)


def _position(p: dict[str, Any]) -> tuple[str, ...]:
    centre = [format_value(v, s) for v, s in zip(p["centre"], p["sigma_centre"], strict=True)]
    rms = UNKNOWN if p["rms_px"] is None else format_number(p["rms_px"], digits=3)
    coverage = format_number(round(100.0 * p["coverage"]))
    return (p["name"], rms, format_number(p["observations"]), coverage, *centre)


def _angles(p: dict[str, Any]) -> tuple[str, ...]:
    sigmas = p["sigma_omega_phi_kappa_deg"]
    return (p["name"], *(format_value(v, s) for v, s in zip(p["omega_phi_kappa_deg"], sigmas, strict=True)))


def _vectors(adjustment: Adjustment) -> Pictures:
    block = adjustment.block
    squares = (adjustment.residuals**2).sum(axis=1)
    n = len(block.names)
    mean = np.bincount(block.obs_photo, squares, n) / np.maximum(np.bincount(block.obs_photo, minlength=n), 1)
    worst = np.argsort(-mean, kind="stable")[: min(DRAWN, int((mean > 0).sum()))]
    length = 2.0 * float(np.sqrt(squares.mean()))
    longest = LONG * float(np.sqrt(squares.mean()))
    drawn = [photo_picture(adjustment, int(i), length, longest) for i in worst]
    which = (
        Text("All photos")
        if len(worst) == int((mean > 0).sum())
        else Text("The {n} photos with the largest RMS", n=DRAWN)
    )
    return Pictures(drawn, per_row=3, caption=Text(
        "{which}, the largest RMS first: residual vectors (projected − measured) of a selection of points. One twelfth of "
        "the longer side is {length} px; vectors longer than {longest} px ({times} times the root mean square length) "
        "are drawn in the second colour.", which=which, length=format_number(length, digits=2),
        longest=format_number(longest, digits=2), times=format_number(LONG, digits=2)))  # fmt: skip
