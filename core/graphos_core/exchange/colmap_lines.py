"""The lines of a COLMAP text model, read and checked."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.exchange.formulas import formulas
from graphos_core.text import Text


@dataclass(frozen=True)
class Image:
    """One photo of the model, in COLMAP's conventions."""

    number: int
    quaternion: Array
    translation: Array
    camera: int
    name: str
    xy: Array
    point_ids: Array


@dataclass(frozen=True)
class Model:
    """Cameras (model, width, height, parameters), images, and points (coordinates, colour) by their numbers."""

    cameras: dict[int, tuple[str, int, int, tuple[float, ...]]]
    images: list[Image]
    points: dict[int, tuple[tuple[float, ...], tuple[int, ...]]]


def parse_model(folder: Path) -> Model:
    """Read the three files.

    Raises
    ------
    UserError
        When a file is missing, or a line is not as the format says.
    """
    cameras = dict(_each(folder / "cameras.txt", _camera))
    lines = _lines(folder / "images.txt", keep_empty=True)
    images = []
    for (number, head), (_, points) in zip(lines[::2], [*lines[1::2], (0, "")], strict=False):
        try:
            images.append(_image(head, points))
        except (ValueError, IndexError, OverflowError):
            raise _bad_line("images.txt", number, head) from None
        if images[-1].camera not in cameras:
            raise _bad_line("images.txt", number, head)
    return Model(cameras, images, dict(_each(folder / "points3D.txt", _point)))


def _each(path: Path, parse):  # type: ignore[no-untyped-def]
    """Parse every line of a file; a line that cannot be parsed is named."""
    for number, line in _lines(path):
        try:
            yield parse(line.split())
        except (ValueError, IndexError, OverflowError):
            raise _bad_line(path.name, number, line) from None


def _lines(path: Path, *, keep_empty: bool = False) -> list[tuple[int, str]]:
    try:
        text = path.read_text("utf-8", errors="replace")
    except OSError as problem:
        raise UserError(
            Text("The COLMAP model in {folder} could not be read.", folder=path.parent.name),
            Text("{name}: {why}.", name=path.name, why=problem.strerror or str(problem)),
            "A text model has the files cameras.txt, images.txt and points3D.txt in one folder.",
        ) from problem
    lines = [(n, line) for n, line in enumerate(text.split("\n"), start=1) if not line.startswith("#")]
    if not keep_empty:
        return [(n, line) for n, line in lines if line.strip()]
    while lines and not lines[0][1].strip():
        del lines[0]
    while len(lines) > 1 and not lines[-1][1].strip() and not lines[-2][1].strip():
        del lines[-1]
    if len(lines) % 2 and lines and not lines[-1][1].strip():
        del lines[-1]
    return lines


def _camera(words: list[str]) -> tuple[int, tuple[str, int, int, tuple[float, ...]]]:
    model = words[1]
    count = parameter_count(model)
    values = _numbers(words[4 : 4 + count])
    width, height = int(words[2]), int(words[3])
    if len(values) != count or width <= 0 or height <= 0 or values[0] <= 0:
        raise ValueError(words)
    return int(words[0]), (model, width, height, values)


def parameter_count(model: str) -> int:
    """Return the number of parameters of one of COLMAP's camera models.

    Raises
    ------
    UserError
        When it is not supported.
    """
    known = {name.split()[1]: f for name, f in formulas().items() if name.startswith("colmap ")}
    if model not in known:
        raise UserError(
            Text("The COLMAP camera model {model} is not supported.", model=model[:40]),
            Text("Supported are {names}.", names=", ".join(known)),
            "Reconstruct again with one of these models.",
        )
    return len(known[model].parameters)


def _image(head: str, points: str) -> Image:
    words = head.split(maxsplit=9)
    pose = np.array(_numbers(words[1:8]))
    if len(words) != 10 or np.linalg.norm(pose[:4]) < 1e-9:
        raise ValueError(head)
    table = np.array(points.split(), dtype=np.float64).reshape(-1, 3)
    return Image(
        int(words[0]),
        pose[:4],
        pose[4:],
        int(words[8]),
        words[9].strip(),
        table[:, :2],
        table[:, 2].astype(np.int64),
    )


def _point(words: list[str]) -> tuple[int, tuple[tuple[float, ...], tuple[int, ...]]]:
    xyz, colour = _numbers(words[1:4]), tuple(int(word) for word in words[4:7])
    if len(xyz) != 3 or len(colour) != 3 or not all(0 <= c <= 255 for c in colour):
        raise ValueError(words)
    return int(words[0]), (xyz, colour)


def _numbers(words: list[str]) -> tuple[float, ...]:
    values = tuple(float(word) for word in words)
    if not np.isfinite(values).all():
        raise ValueError(words)
    return values


def _bad_line(name: str, number: int, line: str) -> UserError:
    return UserError(
        Text("{name} could not be read.", name=name),
        Text("Line {number} is not as COLMAP writes it: “{line}”.", number=number, line=line[:60]),
        "Export the model again as text.",
    )
