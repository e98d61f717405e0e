"""Bundler's ``bundle.out`` (v0.3) with its list of photos (Snavely, Bundler manual, sections 4 and 5).

Its camera looks along −z with y up, p = −P / P_z; image points count from the image centre, y up. There is no principal
point: image points are written relative to it, as COLMAP's exporter does, and read relative to the image centre.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Parts, Read, Written
from graphos_core.exchange.camera_fit import format_of, to_foreign
from graphos_core.exchange.formulas import Format
from graphos_core.exchange.photo_formats import centred_formats
from graphos_core.exchange.text_files import Lines, not_such, read_lines
from graphos_core.geometry.rotation import FLIP
from graphos_core.store import write_text
from graphos_core.text import Text

LIST = "list.txt"
"""Name of the list of photos beside the bundle file."""


def read_bundler(path: Path, names: Path | None = None) -> Read:
    """Read a bundle file.

    Parameters
    ----------
    path : Path
        ``bundle.out``.
    names : Path or None
        List of photos; None for ``list.txt`` beside it, or numbers where there is none.

    Raises
    ------
    UserError
        When a file cannot be read, with the line.
    """
    lines = Lines(path)
    count, points = (int(v) for v in lines.numbers(2, "the numbers of cameras and points"))
    parts = Parts()
    photos = _photo_names(path, names, count, parts.remarks)
    poses = [[lines.numbers(3, "a camera") for _ in range(5)] for _ in range(count)]
    seen: list[tuple[int, int, float, float]] = []
    for point in range(points):
        parts.points.append(lines.numbers(3, "the coordinates of a point")[:3])
        parts.colours.append([int(np.clip(v, 0, 255)) for v in lines.numbers(3, "the colour of a point")[:3]])
        views = lines.numbers(1, "the views of a point")
        if len(views) < 1 + 4 * int(views[0]):
            raise lines.wrong("the views of a point")
        for k in range(int(views[0])):
            photo, _, x, y = views[1 + 4 * k : 5 + 4 * k]
            if not 0 <= photo < count:
                raise lines.wrong("views of cameras that exist")
            seen.append((point, int(photo), x, -y))
    table = np.array(seen, dtype=np.float64).reshape(-1, 4)
    formats = centred_formats(photos, path.parent, table[:, 1], table[:, 2:], parts.remarks)
    _add_photos(path, parts, photos, poses, formats)
    for point, photo, x, y in seen:
        cx, cy = formats[photo].centre
        parts.observations.append((point, photo, x + cx, y + cy))
    return parts.read()


def _photo_names(path: Path, names: Path | None, count: int, remarks: list[str]) -> list[str]:
    """Read the list: a name per line, perhaps followed by 0 and a focal length."""
    beside = path.with_name(LIST) if names is None else names
    if names is None and not beside.is_file():
        remarks.append(
            Text("There is no {name} beside the file: photos are called by their number.", name=LIST)
        )
        return [f"{i:08d}" for i in range(count)]
    found = [
        re.sub(r"\s+\d+\s+[\d.eE+-]+\s*$", "", line).strip() for line in read_lines(beside) if line.strip()
    ]
    if len(found) != count:
        raise not_such(beside, "the list of this bundle file",
                       Text("It names {names} photos, the bundle file has {count} cameras.", names=len(found), count=count))  # fmt: skip
    return found


def _add_photos(
    path: Path, parts: Parts, photos: list[str], poses: list[list[list[float]]], formats: list[Format]
) -> None:
    known: dict[tuple[float, float, float, int, int], int] = {}
    for name, pose, frame in zip(photos, poses, formats, strict=True):
        f, k1, k2 = pose[0][:3]
        key = (f, k1, k2, frame.width, frame.height)
        if key not in known:
            known[key] = len(parts.cameras)
            parts.cameras.append(Camera(
                model="basic", width=frame.width, height=frame.height, label=f"Bundler {len(known)}",
                values=np.array([f or float(max(frame.width, frame.height)), *frame.centre, k1, k2]),
                focal_source="Bundler", focal_estimated=f <= 0,
            ))  # fmt: skip
        rotation = FLIP @ np.array([row[:3] for row in pose[1:4]])
        try:
            if f <= 0:
                parts.add_photo(name, known[key], None, None)
            else:
                parts.add_photo(name, known[key], rotation, -rotation.T @ (FLIP @ np.array(pose[4][:3])))
        except ValueError:
            raise not_such(
                path, "a bundle file", Text("The rotation of {name} is no rotation matrix.", name=name)
            ) from None


def write_bundler(block: Block, path: Path) -> Written:
    """Write the oriented photos of a block as ``bundle.out`` and its ``list.txt``.

    Raises
    ------
    UserError
        When a file cannot be written.
    """
    photos = np.flatnonzero(block.oriented)
    remarks: list[str] = []
    worst = 0.0
    interior: dict[int, Array] = {}
    for index in sorted({int(block.camera_of_photo[photo]) for photo in photos}):
        interior[index], cost, say = bundler_camera(block.cameras[index])
        worst = max(worst, cost)
        remarks += [say] if say else []
    if any(
        np.abs(principal_point(block.cameras[i]) - _centre(block.cameras[i])).max() > 1e-9 for i in interior
    ):
        remarks.append("Bundler has no principal point: image points are written relative to it.")
    keep = np.asarray(block.oriented)[block.obs_photo]
    present = np.unique(block.obs_point[keep])
    out = ["# Bundle file v0.3", f"{len(photos)} {len(present)}"]
    for photo in photos.tolist():
        rotation = FLIP @ block.rotations[photo]
        out.append(" ".join(repr(float(v)) for v in interior[int(block.camera_of_photo[photo])]))
        out += [
            " ".join(repr(float(v)) for v in row) for row in [*rotation, -rotation @ block.centres[photo]]
        ]
    out += _points(block, photos, keep, present)
    write_text(path, "\n".join(out) + "\n")
    listed = path.with_name(LIST)
    write_text(listed, "\n".join(block.names[photo] for photo in photos) + "\n")
    return Written((path, listed), tuple(remarks), worst)


def _points(block: Block, photos: Array, keep: Array, present: Array) -> list[str]:
    number = {int(photo): i for i, photo in enumerate(photos)}
    out = []
    key = np.zeros(len(block.obs_photo), dtype=np.int64)
    for photo in photos:
        mine = np.flatnonzero(block.obs_photo == photo)
        key[mine] = np.arange(len(mine))
    order = np.flatnonzero(keep)
    bounds = np.searchsorted(block.obs_point[order], [present, present + 1])
    for point, first, last in zip(present.tolist(), *bounds.tolist(), strict=True):
        out.append(" ".join(repr(float(v)) for v in block.points[point]))
        out.append(" ".join(str(int(v)) for v in block.colours[point]))
        views = [str(last - first)]
        for k in order[first:last]:
            photo = int(block.obs_photo[k])
            x, y = block.obs_xy[k] - principal_point(block.cameras[block.camera_of_photo[photo]])
            views.append(f"{number[photo]} {key[k]} {float(x)!r} {float(-y)!r}")
        out.append(" ".join(views))
    return out


def principal_point(camera: Camera) -> Array:
    """Return x0, y0 (2,), px."""
    names = camera_model(camera.model).names
    return np.array([camera.values[names.index("x0")], camera.values[names.index("y0")]])


def _centre(camera: Camera) -> Array:
    return np.array([(camera.width - 1) / 2.0, (camera.height - 1) / 2.0])


def centred(camera: Camera) -> Camera:
    """Return the same camera with its principal point in the image centre, for formats that have none."""
    names = camera_model(camera.model).names
    values = np.array(camera.values)
    values[[names.index("x0"), names.index("y0")]] = _centre(camera)
    return replace(camera, values=values)


def bundler_camera(camera: Camera) -> tuple[Array, float, str]:
    """Return f, k1, k2, the largest residual, px, and what it costs in words; empty where nothing.

    Raises
    ------
    UserError
        When the camera is a fish-eye, which Bundler does not have, or its format is unknown.
    """
    if camera.model in ("pinhole", "basic"):
        return np.array([camera.focal_px, *([*camera.values[3:], 0.0, 0.0][:2])]), 0.0, ""
    if camera_model(camera.model).wide:
        raise UserError(
            Text("The camera model {model} cannot be written for Bundler.", model=camera.model),
            "Bundler only has perspective cameras.", "Choose a format with fish-eyes, such as COLMAP or MicMac.",
        )  # fmt: skip
    format_of(camera)
    found = to_foreign(centred(camera), "bundler")
    say = "" if found.exact else found.says(camera.label or camera.model, "Bundler")
    return found.camera.values, found.max_px, say
