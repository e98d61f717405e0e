"""Cameras of this program as a file of their own: TOML with the parameters by name."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Camera
from graphos_core.exchange.text_files import not_such, read_bytes
from graphos_core.text import Text

WHAT = "a camera of GRAPHOS"


def camera_text(camera: Camera) -> str:
    """Return a camera as TOML; standard deviations are kept where there are."""
    model = camera_model(camera.model)
    out = [
        "[camera]",
        f"model = {json.dumps(camera.model)}",
        f"width = {camera.width}",
        f"height = {camera.height}",
    ]
    if camera.label:
        out.append(f"label = {json.dumps(camera.label, ensure_ascii=False)}")
    if camera.pixel_pitch_mm is not None:
        out.append(f"pixel_pitch_mm = {camera.pixel_pitch_mm!r}")
    out += [
        "",
        "[camera.values]",
        *(f"{p.name} = {float(v)!r}" for p, v in zip(model.parameters, camera.values, strict=True)),
    ]
    if camera.sigmas is not None:
        out += [
            "",
            "[camera.sigmas]",
            *(f"{p.name} = {float(v)!r}" for p, v in zip(model.parameters, camera.sigmas, strict=True)),
        ]
    return "\n".join(out) + "\n"


def read_camera(path: Path) -> Camera:
    """Read a camera.

    Raises
    ------
    UserError
        When the file cannot be read, the model or a parameter is unknown, or a value is missing or not finite.
    """
    try:
        table = tomllib.loads(read_bytes(path).decode("utf-8-sig", errors="replace"))["camera"]
        table = table[0] if isinstance(table, list) else table  # the first of a calibration.toml
        model = camera_model(str(table["model"]))
        width, height = int(table["width"]), int(table["height"])
        values = _by_name(path, table["values"], model.names)
        sigmas = _by_name(path, table["sigmas"], model.names) if "sigmas" in table else None
        pitch = float(table["pixel_pitch_mm"]) if "pixel_pitch_mm" in table else None
        if width <= 0 or height <= 0 or values[0] <= 0 or (pitch is not None and not 0 < pitch < 1):
            raise ValueError("a format, principal distance or pixel size is not possible")
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError) as problem:
        raise not_such(path, WHAT, Text("The reader says: {why}.", why=problem)) from problem
    return Camera(
        model=model.name, width=width, height=height, values=values, sigmas=sigmas, pixel_pitch_mm=pitch,
        label=str(table.get("label", "")), focal_source=path.name,
    )  # fmt: skip


def _by_name(path: Path, table: object, names: tuple[str, ...]) -> Array:
    if not isinstance(table, dict):
        raise not_such(path, WHAT, "Its values are no table.")
    strange = [name for name in table if name not in names]
    missing = [name for name in names if name not in table]
    if strange or missing:
        raise not_such(path, WHAT, Text(
            "The parameter {name} is {what}; the model has {names}.", name=(strange or missing)[0],
            what="unknown" if strange else "missing", names=", ".join(names),
        ))  # fmt: skip
    values = [float(table[name]) for name in names]
    if not all(math.isfinite(v) for v in values):
        raise not_such(path, WHAT, "A value is not finite.")
    return np.array(values)
