"""Where the first value of the principal distance comes from: given, the camera table, EXIF, or a flagged guess."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from graphos_core.data import Exif
from graphos_core.text import Text

FILM_DIAGONAL_MM = math.hypot(36.0, 24.0)
"""Diagonal of the 35 mm film frame; the 35 mm equivalent compares diagonals (CIPA DCG-001, EXIF 2.32)."""

GUESS_FACTOR = 1.2
"""Principal distance over the longer side of the photo where nothing is known: about 43 mm on 35 mm film."""


@dataclass(frozen=True)
class PrincipalDistance:
    """A first principal distance.

    Attributes
    ----------
    focal_px : float
    pixel_pitch_mm : float or None
        Size of a pixel on the sensor, where known.
    estimated : bool
        True for a guess.
    source : str
        Where it came from, in words.
    """

    focal_px: float
    pixel_pitch_mm: float | None
    estimated: bool
    source: str


@cache
def camera_table() -> dict[tuple[str, str], tuple[float, float, str]]:
    """Return sensor width, height (mm, longer side first) and source by (make, model), in small letters."""
    text = (files("graphos_resources") / "cameras.csv").read_text(encoding="utf-8")
    rows = csv.DictReader(line for line in text.splitlines() if line and not line.startswith("#"))
    return {
        (row["make"].strip().lower(), row["model"].strip().lower()): (
            float(row["sensor_width_mm"]),
            float(row["sensor_height_mm"]),
            row["source"],
        )
        for row in rows
    }


def principal_distance(
    exif: Exif, width: int, height: int, given_px: float | None = None
) -> PrincipalDistance:
    """Choose the first principal distance of a camera.

    In this order: the given value; focal length over the pixel pitch of the camera table; the 35 mm equivalent,
    ``f_px = f_35 · √(w² + h²) / 43.27 mm`` (the equivalent compares diagonals of the field of view; it is written
    in whole millimetres, so it is the rougher of the two); ``1.2 · max(w, h)`` as a guess, flagged.

    Parameters
    ----------
    exif : Exif
    width, height : int
        Size of the photo, px. A photo may be a crop of the sensor along one side only: the pitch is the smaller
        of longer side over longer side and shorter over shorter.
    given_px : float, optional
    """
    long, short = max(width, height), min(width, height)
    sensor = camera_table().get((exif.make.lower(), exif.model.lower()))
    pitch = min(sensor[0] / long, sensor[1] / short) if sensor else None
    if given_px is not None:
        return PrincipalDistance(float(given_px), pitch, False, Text("given"))
    if exif.focal_mm and pitch:
        source = Text(
            "EXIF focal length {focal:g} mm and sensor {wide:g} × {high:g} mm of the camera table",
            focal=exif.focal_mm,
            wide=sensor[0] if sensor else 0.0,
            high=sensor[1] if sensor else 0.0,
        )
        return PrincipalDistance(exif.focal_mm / pitch, pitch, False, source)
    if exif.focal_35mm:
        focal = exif.focal_35mm * math.hypot(width, height) / FILM_DIAGONAL_MM
        source = Text("EXIF 35 mm equivalent {focal:g} mm", focal=exif.focal_35mm)
        return PrincipalDistance(focal, exif.focal_mm / focal if exif.focal_mm else None, False, source)
    why = (
        Text(
            "the sensor size of {make} {model} is not in the camera table",
            make=exif.make or Text("this unknown"),
            model=exif.model or Text("camera"),
        )
        if exif.focal_mm
        else Text("the photo has no EXIF focal length")
    )
    source = Text("estimated as {factor:g} × the longer side, because {why}", factor=GUESS_FACTOR, why=why)
    return PrincipalDistance(GUESS_FACTOR * long, None, True, source)
