"""The program's own calibration file: one or more cameras with values and standard deviations, as TOML.

::

    schema = 1
    [[camera]]
    label = "Nikon D60, 29 mm"
    model = "basic"
    width = 3872
    height = 2592
    [camera.values]            # principal distance and point in px, distortion in normalised units
    focal_px = 4870.3
    x0 = 1935.5
    y0 = 1295.5
    k1 = -0.08
    k2 = 0.03
    [camera.sigmas]            # optional
    focal_px = 0.4

A camera may have ``[[camera.before]]`` cameras, whose distortion is taken away first (`Camera.before`). The centre of the
top-left pixel is (0, 0). A single ``[camera]``, as ``graphos convert camera`` writes it, is read too.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from graphos_core import __version__
from graphos_core.cameras import camera_model
from graphos_core.data import Camera, PhotoSet
from graphos_core.errors import GraphosError, UserError
from graphos_core.params import unknown_name
from graphos_core.store import write_text
from graphos_core.text import Text

SCHEMA = 1
HEAD = """# Calibration by GRAPHOS-Py. The centre of the top-left pixel is (0, 0), x to the right, y down; principal distance
# and principal point in px, distortion in normalised units, by the formula of the model.
"""


def write_calibration(path: Path, cameras: Sequence[Camera]) -> None:
    """Write calibrated cameras.

    Raises
    ------
    UserError
        When the file cannot be written.
    """
    entries = [_entry(camera) for camera in cameras]
    write_text(path, HEAD + tomli_w.dumps({"schema": SCHEMA, "version": __version__, "camera": entries}))


def _entry(camera: Camera) -> dict[str, Any]:
    model = camera_model(camera.model)
    entry: dict[str, Any] = {
        "label": str(camera.label), "model": camera.model, "direction": model.direction, "width": camera.width,
        "height": camera.height,
    }  # fmt: skip
    if camera.pixel_pitch_mm is not None:
        entry["pixel_pitch_mm"] = float(camera.pixel_pitch_mm)
    entry["values"] = {n: float(v) for n, v in zip(model.names, camera.values, strict=True)}
    if camera.sigmas is not None:
        known = zip(model.names, camera.sigmas, strict=True)
        entry["sigmas"] = {n: float(s) if math.isfinite(s) else 0.0 for n, s in known}
    if camera.before:
        entry["before"] = [_entry(earlier) for earlier in camera.before]
    return entry


def read_calibration(path: Path) -> tuple[Camera, ...]:
    """Read calibrated cameras.

    Raises
    ------
    UserError
        When the file cannot be read, or is not one of `write_calibration`, naming what is wrong.
    """
    try:
        document = tomllib.loads(path.read_text("utf-8"))
        if document.get("schema", SCHEMA) != SCHEMA:
            raise ValueError(f"it has schema {document.get('schema', 'none')}, this version reads {SCHEMA}")
        entries = document["camera"]
        entries = [entries] if isinstance(entries, dict) else entries
        if not entries:
            raise ValueError("it has no camera")
        return tuple(_camera(entry, path) for entry in entries)
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        AttributeError,
        RecursionError,
        GraphosError,
    ) as problem:
        why = Text("“{name}” is missing", name=problem.args[0]) if isinstance(problem, KeyError) else problem
        if isinstance(problem, OSError):
            why = Text("{why}", why=problem.strerror or problem)
        raise UserError(
            Text("The calibration {name} cannot be read.", name=path.name), Text("{why}.", why=str(why).rstrip(".")),
            "Give a calibration.toml as “graphos calibrate” writes it; other formats are converted by “graphos convert”.",
        ) from problem  # fmt: skip


def _camera(entry: dict[str, Any], path: Path) -> Camera:
    model = camera_model(str(entry["model"]))
    given, sigmas = dict(entry["values"]), dict(entry.get("sigmas", {}))
    for name in (*given, *sigmas):
        if name not in model.names:
            raise ValueError(
                str(unknown_name(name, list(model.names), f"parameter of the model {model.name}"))
            )
    values = np.array([_number(name, given[name]) for name in model.names])
    width, height = entry["width"], entry["height"]
    if not (type(width) is int and type(height) is int and 0 < width < 1e6 and 0 < height < 1e6):
        raise ValueError(f"width and height are {width} and {height}, two whole numbers of pixels are needed")
    if not 1.0 <= values[0] <= 1e7:
        raise ValueError(f"the principal distance is {values[0]:g} px, needs 1 to 10000000")
    pitch = entry.get("pixel_pitch_mm")
    return Camera(
        model=model.name, width=width, height=height, values=values,
        sigmas=np.array([_number(n, sigmas.get(n, 0.0)) for n in model.names]) if sigmas else None,
        label=str(entry.get("label", "")), pixel_pitch_mm=None if pitch is None else _number("pixel_pitch_mm", pitch),
        focal_estimated=False, focal_source=Text("given calibration {name}", name=path.name),
        before=tuple(_camera(earlier, path) for earlier in entry.get("before", [])),
    )  # fmt: skip


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError(f"“{name}” is {value}, a number is needed")
    return float(value)


def with_calibration(photos: PhotoSet, given: Sequence[Camera]) -> PhotoSet:
    """Return the photos with calibrated cameras in place of the guessed ones of the same format.

    Of several of one format that with the same label is taken, else the first.

    Raises
    ------
    UserError
        When a camera of the photos has no calibration of its format.
    """
    cameras = []
    for camera in photos.cameras:
        alike = [g for g in given if (g.width, g.height) == (camera.width, camera.height)]
        alike = [g for g in alike if g.label == camera.label] or alike
        if not alike:
            sizes = ", ".join(f"{g.width} × {g.height}" for g in given)
            raise UserError(
                "The given calibration does not belong to these photos.",
                Text("It is for photos of {sizes} px; {label} has {w} × {h} px.", sizes=sizes,
                     label=camera.label or Text("the camera"), w=camera.width, h=camera.height),
                "Calibrate with photos of the same size and zoom, or leave the calibration out.",
            )  # fmt: skip
        known = alike[0]
        cameras.append(replace(
            known, label=camera.label or known.label, pixel_pitch_mm=known.pixel_pitch_mm or camera.pixel_pitch_mm
        ))  # fmt: skip
    return replace(photos, cameras=tuple(cameras))
