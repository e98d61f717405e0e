"""Calibrations as text: PhotoModeler, Australis and iWitness, OpenCV YAML, Bundler, one line of COLMAP.

Each program has a reader that returns a `ForeignCamera` and a writer that returns the text.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from graphos_core.errors import UserError
from graphos_core.exchange.colmap_lines import parameter_count
from graphos_core.exchange.formulas import ForeignCamera, Format, formula
from graphos_core.exchange.formulas_other import AUSTRALIS, PHOTOMODELER
from graphos_core.exchange.text_files import bad_line, finite, not_such, read_lines
from graphos_core.text import Text

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

PHOTOMODELER_TITLES = {
    "focal": "Focal Length", "xp": "Xp - principal point x", "yp": "Yp - principal point y",
    "fw": "Fw - format width", "fh": "Fh - format height",
    "K1": "K1 - radial distortion 1", "K2": "K2 - radial distortion 2", "K3": "K3 - radial distortion 3",
    "P1": "P1 - decentering distortion 1", "P2": "P2 - decentering distortion 2",
    "width": "Image width", "height": "Image height",
}  # fmt: skip
"""Titles of PhotoModeler's calibration report; the last two are ours: it does not tell the format in pixels."""


def read_photomodeler_camera(path: Path, frame: Format | None = None) -> ForeignCamera:
    """Read a calibration report, or the camera of a text export (``…-pmexport.txt``).

    Raises
    ------
    UserError
        When the file cannot be read, or does not tell the format in pixels and none is given.
    """
    lines = read_lines(path)
    if is_photomodeler_export(lines):
        return _photomodeler_export(path, lines)
    text = "\n".join(lines)
    found: dict[str, float] = {}
    for key, title in PHOTOMODELER_TITLES.items():
        match = re.search(
            rf"^\s*{re.escape(title)}\s*:?\s*\n?\s*Value:\s*({NUMBER})", text, re.MULTILINE | re.IGNORECASE
        )
        if match:
            found[key] = float(match[1])
    missing = [PHOTOMODELER_TITLES[key] for key in ("focal", "xp", "yp", "fw", "fh") if key not in found]
    if missing:
        raise not_such(
            path, "a calibration of PhotoModeler", Text("It does not tell {what}.", what=missing[0])
        )
    if "width" in found and "height" in found:
        frame = Format(int(found["width"]), int(found["height"]))
    if frame is None:
        raise no_format(path)
    frame = Format(frame.width, frame.height, found["fw"] / frame.width)
    return ForeignCamera(
        "photomodeler", np.array([found.get(key, 0.0) for key in PHOTOMODELER]), frame, path.stem
    )


def is_photomodeler_export(lines: list[str]) -> bool:
    """Return whether lines begin like a text export: σ, version, width and height in px on the second."""
    words = lines[1].split() if len(lines) > 3 else []
    return len(words) == 4 and words[2].isdigit() and words[3].isdigit()


def _photomodeler_export(path: Path, lines: list[str]) -> ForeignCamera:
    try:
        width, height = (int(word) for word in lines[1].split()[2:4])
        c, xp, yp, fw, _, k1, k2, k3, p1, p2 = finite(lines[3].split())
    except ValueError:
        raise bad_line(path, 4, lines[3], "ten numbers of the interior orientation") from None
    return ForeignCamera("photomodeler", np.array([c, xp, yp, k1, k2, k3, p1, p2]),
                         Format(width, height, fw / width), path.stem)  # fmt: skip


def photomodeler_text(camera: ForeignCamera) -> str:
    """Return a calibration in the layout of PhotoModeler's report."""
    frame = camera.frame
    pitch = frame.pitch_mm or 1.0
    values = dict(zip(PHOTOMODELER, camera.values, strict=True))
    values |= {
        "fw": frame.width * pitch,
        "fh": frame.height * pitch,
        "width": frame.width,
        "height": frame.height,
    }
    units = {
        "focal": " mm",
        "xp": " mm",
        "yp": " mm",
        "fw": " mm",
        "fh": " mm",
        "width": " px",
        "height": " px",
    }
    out = ["Camera Calibration", f"   Camera1: {camera.label or 'Camera'}"]
    for key, title in PHOTOMODELER_TITLES.items():
        out += [f"      {title}", f"         Value: {float(values[key])!r}{units.get(key, '')}"]
    return "\n".join(out) + "\n"


def no_format(path: Path) -> UserError:
    """Say that a file does not tell the format."""
    return UserError(
        Text("{name} does not tell the format of the photos in pixels.", name=path.name),
        "Millimetres cannot be turned into pixels without it.",
        "Give the format: --size WIDTH,HEIGHT.",
    )


def read_australis_camera(path: Path, frame: Format | None = None) -> ForeignCamera:
    """Read the camera parameters of an Australis or iWitness text: rows C, XP, YP, K1 … B2; of five columns the third.

    Raises
    ------
    UserError
        When the file cannot be read, or does not tell the format and pixel size and none is given.
    """
    values: dict[str, float] = {}
    sides: dict[str, tuple[float, float]] = {}
    for n, line in enumerate(read_lines(path), 1):
        words = re.split(r"[\s=:,]+", line.strip())
        key = words[0].upper().replace("XO", "XP").replace("YO", "YP")
        if key in ("H", "V") and len(words) >= 3 and key not in sides:
            sides[key] = _pair(path, n, line, words[1:3])
        names = {name.upper(): name for name in AUSTRALIS}
        if key in names and names[key] not in values and len(words) > 1:
            try:
                numbers = finite([w for w in words[1:] if re.fullmatch(NUMBER, w)])
            except ValueError:
                raise bad_line(path, n, line, "numbers") from None
            if not numbers:
                raise bad_line(path, n, line, "a number")
            values[names[key]] = numbers[2] if len(numbers) >= 5 else numbers[0]
    if "c" not in values or "xp" not in values:
        raise not_such(path, "a calibration of Australis or iWitness", "It has no rows C and XP.")
    if len(sides) == 2:
        frame = Format(int(sides["H"][0]), int(sides["V"][0]), sides["H"][1])
    if frame is None or frame.pitch_mm is None:
        raise no_format(path)
    return ForeignCamera(
        "australis", np.array([values.get(name, 0.0) for name in AUSTRALIS]), frame, path.stem
    )


def _pair(path: Path, n: int, line: str, words: list[str]) -> tuple[float, float]:
    try:
        a, b = finite(words)
    except ValueError:
        raise bad_line(path, n, line, "the pixels of a side and their size in mm") from None
    return a, b


def australis_text(camera: ForeignCamera) -> str:
    """Return a calibration in the layout of Australis's camera report, final values only."""
    frame = camera.frame
    out = ["Australis Bundle Adjustment Results: Camera Parameters", "", f"Results for Camera 1  {camera.label or 'Camera'}",
           "", "Sensor Size   Pixel Size (mm)", f"H  {frame.width}   {frame.pitch_mm!r}", f"V  {frame.height}   {frame.pitch_mm!r}",
           "", "Variable      Value"]  # fmt: skip
    out += [f"{name.upper():<4}{float(v)!r}{' (mm)' if name in ('c', 'xp', 'yp') else ''}"
            for name, v in zip(AUSTRALIS, camera.values, strict=True)]  # fmt: skip
    return "\n".join(out) + "\n"


def read_opencv_camera(path: Path, frame: Format | None = None) -> ForeignCamera:
    """Read an OpenCV or ROS calibration (YAML): camera matrix, distortion coefficients, format.

    Raises
    ------
    UserError
        When the file cannot be read, or has a model that is not supported.
    """
    text = "\n".join(read_lines(path))
    k = _matrix(path, text, ("camera_matrix", "cameraMatrix", "Camera_Matrix", "intrinsic_matrix", "K", "M1"))
    d = _matrix(
        path,
        text,
        ("distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "dist_coeffs", "D", "D1"),
    )
    if len(k) != 9 or k[1] or k[0] <= 0 or k[4] <= 0:
        raise not_such(path, "a calibration of OpenCV", "Its camera matrix is not 3 × 3 without skew.")
    sides = [_scalar(text, (f"image_{s}", f"image_{s.capitalize()}", s)) for s in ("width", "height")]
    if all(s is not None for s in sides):
        frame = Format(int(sides[0] or 0), int(sides[1] or 0), frame.pitch_mm if frame else None)
    if frame is None or frame.width <= 0 or frame.height <= 0:
        raise no_format(path)
    fisheye = bool(re.search(r"(distortion_model|camera_model)\s*:\s*['\"]?(equidistant|fisheye|kannala)", text, re.IGNORECASE)
                   or re.search(r"fisheye_model\s*:\s*1", text))  # fmt: skip
    if len(d) > 12 and any(d[12:]):
        raise not_such(path, "a calibration of OpenCV", "It has a tilted sensor (tau), which is not read.")
    d = d[:12]
    count = next(c for c in (4, 5, 8, 12) if c >= len(d))
    name = "opencv fisheye" if fisheye else f"opencv {count}"
    if fisheye and len(d) != 4:
        raise not_such(path, "a fish-eye calibration of OpenCV", "It does not have four coefficients.")
    values = [k[0], k[4], k[2], k[5], *d, *[0.0] * (0 if fisheye else count - len(d))]
    return ForeignCamera(name, np.array(values), frame, path.stem)


def _matrix(path: Path, text: str, names: tuple[str, ...]) -> list[float]:
    for name in names:
        match = re.search(rf"^\s*{name}\s*:.*?data\s*:\s*\[([^\]]*)\]", text, re.MULTILINE | re.DOTALL)
        match = match or re.search(rf"^\s*{name}\s*:\s*\[([^\]]*)\]", text, re.MULTILINE)
        if match:
            try:
                return finite([word for word in re.split(r"[,\s]+", match[1]) if word])
            except ValueError:
                raise not_such(
                    path,
                    "a calibration of OpenCV",
                    Text("{name} has something that is no number.", name=name),
                ) from None
    raise not_such(path, "a calibration of OpenCV", Text("It has no {name}.", name=names[0]))


def _scalar(text: str, names: tuple[str, ...]) -> float | None:
    for name in names:
        match = re.search(rf"^\s*{name}\s*:\s*({NUMBER})\s*$", text, re.MULTILINE)
        if match:
            return float(match[1])
    return None


def opencv_text(camera: ForeignCamera) -> str:
    """Return a calibration as OpenCV's FileStorage reads it."""
    fx, fy, cx, cy, *d = (float(v) for v in camera.values)
    fisheye = camera.formula == "opencv fisheye"
    return "\n".join([
        "%YAML:1.0", "---", f"image_width: {camera.frame.width}", f"image_height: {camera.frame.height}",
        f"distortion_model: {'fisheye' if fisheye else 'brown'}",
        *_opencv_matrix("camera_matrix", 3, 3, [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]),
        *_opencv_matrix("distortion_coefficients", len(d), 1, d), "",
    ])  # fmt: skip


def _opencv_matrix(name: str, rows: int, columns: int, values: list[float]) -> list[str]:
    return [f"{name}: !!opencv-matrix", f"   rows: {rows}", f"   cols: {columns}", "   dt: d",
            f"   data: [ {', '.join(repr(v) for v in values)} ]"]  # fmt: skip


def read_colmap_camera(path: Path, _frame: Format | None = None) -> ForeignCamera:
    """Read the first camera of a ``cameras.txt``.

    Raises
    ------
    UserError
        When the file cannot be read, with the line.
    """
    for n, line in enumerate(read_lines(path), 1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        count = parameter_count(words[1]) if len(words) > 1 else 0
        try:
            width, height = int(words[2]), int(words[3])
            values = finite(words[4:])
            if len(values) != count or width <= 0 or height <= 0:
                raise ValueError("not a camera")
        except (ValueError, IndexError):
            raise bad_line(path, n, line, "CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]") from None
        return ForeignCamera(
            f"colmap {words[1]}", np.array(values), Format(width, height), f"COLMAP {words[1]}"
        )
    raise not_such(path, "a list of cameras of COLMAP", "It has no line with a camera.")


def colmap_text(camera: ForeignCamera) -> str:
    """Return a ``cameras.txt`` with one camera."""
    numbers = " ".join(repr(float(v)) for v in camera.values)
    frame = camera.frame
    head = "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
    return f"{head}1 {camera.formula.split()[1]} {frame.width} {frame.height} {numbers}\n"


def read_bundler_camera(path: Path, frame: Format | None = None) -> ForeignCamera:
    """Read f, k1, k2 of the first camera of a bundle file, or a line with these three numbers.

    Raises
    ------
    UserError
        When the file cannot be read, or no format is given.
    """
    lines = [line.split() for line in read_lines(path) if line.strip() and not line.startswith("#")]
    row = next((words for words in lines if len(words) == 3), [])
    try:
        values = finite(row)
        if len(values) != 3 or values[0] <= 0:
            raise ValueError("no camera")
    except ValueError:
        raise not_such(path, "a camera of Bundler", "It has no line with f, k1, k2.") from None
    if frame is None:
        raise no_format(path)
    return ForeignCamera("bundler", np.array(values), frame, path.stem)


def bundler_text(camera: ForeignCamera) -> str:
    """Return f, k1, k2 as in a bundle file."""
    names = " ".join(formula(camera.formula).parameters)
    return f"# Bundler camera: {names}\n{' '.join(repr(float(v)) for v in camera.values)}\n"
