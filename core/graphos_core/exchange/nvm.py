"""VisualSFM's N-View Match files, ``NVM_V3`` (Wu, VisualSFM documentation, NVM; Wu et al. 2011).

Cameras: name, f, quaternion (w, x, y, z) of ``cam_from_world``, projection centre, radial distortion r, 0. The distortion
maps measured to ideal positions, ``x_ideal = x (1 + r |x|²)`` in units of f. Image points count from the image centre
(or the principal point of a ``FixedK`` header), y down. Blanks in names are written as quotation marks.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Parts, Read, Written
from graphos_core.exchange.bundler import centred, principal_point
from graphos_core.exchange.camera_fit import to_foreign
from graphos_core.exchange.formulas import ForeignCamera, Format
from graphos_core.exchange.photo_formats import centred_formats
from graphos_core.exchange.text_files import Lines, finite, not_such
from graphos_core.geometry.rotation import matrix_from_quaternion, quaternion_from_matrix
from graphos_core.store import write_text
from graphos_core.text import Text

BLANK = '"'
"""What stands for a blank in the name of a photo."""


def read_nvm(path: Path) -> Read:
    """Read the first model of a file.

    Raises
    ------
    UserError
        When the file cannot be read, with the line.
    """
    lines = Lines(path)
    head = lines.take("the header NVM_V3")
    if head[0] != "NVM_V3":
        raise not_such(
            path, "an NVM file", Text("It begins with “{word}”, expected NVM_V3.", word=head[0][:20])
        )
    parts = Parts()
    fixed = "FixedK" in head
    if fixed:
        parts.remarks.append("The file has a fixed calibration: image points count from its principal point.")
    photos = [_camera(lines) for _ in range(int(lines.numbers(1, "the number of cameras")[0]))]
    seen = _points(lines, parts, len(photos))
    table = np.array(seen, dtype=np.float64).reshape(-1, 4)
    names = [name for name, _ in photos]
    formats = centred_formats(names, path.parent, table[:, 1], table[:, 2:], parts.remarks)
    known: dict[tuple[float, float, int, int], int] = {}
    for (name, values), frame in zip(photos, formats, strict=True):
        f, r = values[0], values[8]
        key = (f, r, frame.width, frame.height)
        if key not in known:
            known[key] = _add_camera(parts, f, r, frame)
        parts.add_photo(
            name, known[key], matrix_from_quaternion(np.array(values[1:5])), np.array(values[5:8])
        )
    for point, photo, x, y in seen:
        cx, cy = formats[photo].centre
        parts.observations.append((point, photo, x + cx, y + cy))
    return parts.read()


def _camera(lines: Lines) -> tuple[str, list[float]]:
    words = lines.take("a camera")
    try:
        values = finite(words[-10:])
        if len(words) < 11 or values[0] <= 0 or np.linalg.norm(values[1:5]) < 1e-9:
            raise ValueError("no camera")
    except ValueError:
        raise lines.wrong("a camera: name, focal length, quaternion, centre, distortion, 0") from None
    return " ".join(words[:-10]).replace(BLANK, " "), values


def _points(lines: Lines, parts: Parts, count: int) -> list[tuple[int, int, float, float]]:
    seen = []
    for point in range(int(lines.numbers(1, "the number of points")[0])):
        values = lines.numbers(7, "a point")
        views = int(values[6])
        if len(values) < 7 + 4 * views:
            raise lines.wrong("a point with all its views")
        parts.points.append(values[:3])
        parts.colours.append([int(np.clip(v, 0, 255)) for v in values[3:6]])
        for k in range(views):
            photo, _, x, y = values[7 + 4 * k : 11 + 4 * k]
            if not 0 <= photo < count:
                raise lines.wrong("views of cameras that exist")
            seen.append((point, int(photo), x, y))
    return seen


def _add_camera(parts: Parts, f: float, r: float, frame: Format) -> int:
    if r == 0.0:
        parts.cameras.append(Camera(
            model="pinhole", width=frame.width, height=frame.height, values=np.array([f, *frame.centre]),
            label=f"NVM {len(parts.cameras) + 1}", focal_source="NVM",
        ))  # fmt: skip
        return len(parts.cameras) - 1
    return parts.add_camera(ForeignCamera("nvm", np.array([f, r]), frame, f"NVM {len(parts.cameras) + 1}"))


def write_nvm(block: Block, path: Path) -> Written:
    """Write the oriented photos of a block.

    Raises
    ------
    UserError
        When the file cannot be written, or a camera is a fish-eye.
    """
    photos = np.flatnonzero(block.oriented)
    interior, remarks, worst = _interior(block, photos)
    out = ["NVM_V3 ", "", str(len(photos))]
    for photo in photos.tolist():
        f, r = interior[int(block.camera_of_photo[photo])]
        numbers = [f, *quaternion_from_matrix(block.rotations[photo]), *block.centres[photo], r]
        name = block.names[photo].replace(" ", BLANK)
        out.append(f"{name}\t{' '.join(repr(float(v)) for v in numbers)} 0")
    keep = np.flatnonzero(np.asarray(block.oriented)[block.obs_photo])
    present, first = np.unique(block.obs_point[keep], return_index=True)
    bounds = [*first.tolist(), len(keep)]
    number = {int(photo): i for i, photo in enumerate(photos)}
    out += ["", str(len(present))]
    for i, point in enumerate(present.tolist()):
        views = []
        for k in keep[bounds[i] : bounds[i + 1]]:
            photo = int(block.obs_photo[k])
            x, y = block.obs_xy[k] - principal_point(block.cameras[block.camera_of_photo[photo]])
            views.append(f"{number[photo]} {k} {float(x)!r} {float(y)!r}")
        xyz = " ".join(repr(float(v)) for v in block.points[point])
        rgb = " ".join(str(int(v)) for v in block.colours[point])
        out.append(f"{xyz} {rgb} {len(views)} {' '.join(views)}")
    write_text(path, "\n".join([*out, "", "0", ""]))
    return Written((path,), remarks, worst)


def _interior(block: Block, photos: Array) -> tuple[dict[int, Array], tuple[str, ...], float]:
    """Return f and r of every used camera, what they cost in words, and the largest residual, px."""
    interior: dict[int, Array] = {}
    remarks: list[str] = []
    worst = 0.0
    for index in sorted({int(block.camera_of_photo[photo]) for photo in photos}):
        camera = block.cameras[index]
        if camera.model == "pinhole":
            interior[index] = np.array([camera.focal_px, 0.0])
        elif camera_model(camera.model).wide:
            raise UserError(
                Text("The camera model {model} cannot be written for VisualSFM.", model=camera.model),
                "VisualSFM only has perspective cameras.", "Choose a format with fish-eyes, such as COLMAP or MicMac.",
            )  # fmt: skip
        else:
            found = to_foreign(centred(camera), "nvm")
            interior[index] = found.camera.values
            worst = max(worst, found.max_px)
            if not found.exact:
                remarks.append(found.says(camera.label or camera.model, "NVM"))
    remarks.append("NVM has no principal point: image points are written relative to it.")
    return interior, tuple(remarks), worst
