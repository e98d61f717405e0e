"""Camera files of every program by name: reading, writing, and conversion with its residual."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Camera
from graphos_core.errors import UserError
from graphos_core.exchange import camera_texts as texts
from graphos_core.exchange.bundler import centred
from graphos_core.exchange.camera_fit import (
    EXACT_PX,
    Conversion,
    foreign_pixels,
    foreign_rays,
    from_foreign,
    pixel_grid,
    to_foreign,
)
from graphos_core.exchange.colmap_model import CENTRAL, FISHEYE
from graphos_core.exchange.dbat_camera import read_dbat_camera
from graphos_core.exchange.formulas import ForeignCamera, Format
from graphos_core.exchange.graphos_camera import camera_text, read_camera
from graphos_core.exchange.metashape import metashape_calibration_xml, metashape_camera, read_metashape_camera
from graphos_core.exchange.micmac_camera import micmac_camera, micmac_xml, read_micmac_camera
from graphos_core.exchange.text_files import read_lines
from graphos_core.params import unknown_name
from graphos_core.store import write_text
from graphos_core.text import Text

Reader = Callable[[Path, Format | None], ForeignCamera]
Chooser = Callable[[Camera], Conversion[ForeignCamera]]


@dataclass(frozen=True)
class CameraFormat:
    """A kind of camera file.

    Attributes
    ----------
    name, label : str
        ``"metashape"``, ``"Agisoft Metashape (XML)"``.
    suffix : str
        Usual ending of the file.
    read : callable
        ``(path, format or None) -> ForeignCamera``; the format is for files that do not tell it.
    choose : callable or None
        ``camera -> conversion`` to the program's formula; None for a format that is only read.
    text : callable or None
        ``ForeignCamera -> text`` of the file.
    """

    name: str
    label: str
    suffix: str
    read: Reader
    choose: Chooser | None = None
    text: Callable[[ForeignCamera], str] | None = None


def _first_exact(*names: str) -> Chooser:
    """Return the chooser of the first formula that expresses a camera, else of the one with the smallest residual."""

    def choose(camera: Camera) -> Conversion[ForeignCamera]:
        found = []
        for name in names:
            found.append(to_foreign(camera, name))
            if found[-1].exact:
                return found[-1]
        return min(found, key=lambda c: (c.without_image, c.rms_px))

    return choose


def _by_kind(central: Chooser, wide: Chooser | None, program: str) -> Chooser:
    """Return a chooser that takes another formula for fish-eyes, or refuses them."""

    def choose(camera: Camera) -> Conversion[ForeignCamera]:
        model = camera_model(camera.model)
        chosen = wide if model.wide else central
        if chosen is None or model.projection == "spherical":
            raise UserError(
                Text("The camera model {model} cannot be written for {program}.", model=model.label, program=program),
                "The program has no such camera.", "Choose a format with fish-eyes, such as COLMAP, MicMac or Metashape.",
            )  # fmt: skip
        return chosen(camera)

    return choose


def _without_format(read: Callable[[Path], ForeignCamera]) -> Reader:
    return lambda path, frame: _with_pitch(read(path), frame)


def _with_pitch(camera: ForeignCamera, frame: Format | None) -> ForeignCamera:
    """Return the camera with the pixel size that the person gave, where the file tells none."""
    if frame is None or frame.pitch_mm is None or camera.frame.pitch_mm is not None:
        return camera
    return replace(camera, frame=replace(camera.frame, pitch_mm=frame.pitch_mm))


def _colmap(*names: str) -> tuple[str, ...]:
    return tuple(f"colmap {name}" for name in names)


CAMERA_FORMATS: dict[str, CameraFormat] = {f.name: f for f in (
    CameraFormat("metashape", "Agisoft Metashape (XML)", ".xml", _without_format(read_metashape_camera),
                 metashape_camera, metashape_calibration_xml),
    CameraFormat("photomodeler", "PhotoModeler (text)", ".txt", texts.read_photomodeler_camera,
                 _by_kind(_first_exact("photomodeler"), None, "PhotoModeler"), texts.photomodeler_text),
    CameraFormat("opencv", "OpenCV (YAML)", ".yaml", texts.read_opencv_camera,
                 _by_kind(_first_exact("opencv 4", "opencv 5", "opencv 8", "opencv 12"), _first_exact("opencv fisheye"),
                          "OpenCV"), texts.opencv_text),
    CameraFormat("colmap", "COLMAP (cameras.txt)", ".txt", texts.read_colmap_camera,
                 _by_kind(_first_exact(*_colmap(*CENTRAL)), _first_exact(*_colmap(*FISHEYE)), "COLMAP"),
                 texts.colmap_text),
    CameraFormat("micmac", "MicMac (AutoCal XML)", ".xml", _without_format(read_micmac_camera), micmac_camera, micmac_xml),
    CameraFormat("bundler", "Bundler (f, k1, k2)", ".txt", texts.read_bundler_camera,
                 _by_kind(_first_exact("bundler"), None, "Bundler"), texts.bundler_text),
    CameraFormat("australis", "Australis, iWitness (text)", ".txt", texts.read_australis_camera,
                 _by_kind(_first_exact("australis"), None, "Australis"), texts.australis_text),
    CameraFormat("dbat", "Damped Bundle Adjustment Toolbox (XML)", ".xml", _without_format(read_dbat_camera)),
)}  # fmt: skip
"""Other programs' formats by name; ``graphos`` itself is not among them."""

OWN = "graphos"
"""Name of our own format."""


@dataclass(frozen=True)
class ConvertedCamera:
    """What a conversion from file to file cost.

    Attributes
    ----------
    file : Path
    camera : Camera
        The camera as one of our models, between the two.
    source, target : str
        Formula or model of the two files.
    pixels, residuals : float64 (n, 2)
        Grid over the format, and position in the target − in the source of the same direction, px.
    without_image : int
        Pixels of the grid whose direction in the source has no image in the target.
    remarks : tuple of str
    """

    file: Path
    camera: Camera
    source: str
    target: str
    pixels: Array
    residuals: Array
    without_image: int
    remarks: tuple[str, ...]

    @property
    def max_px(self) -> float:
        """Largest distance over the format, px."""
        return float(np.hypot(*self.residuals.T).max(initial=0.0))

    @property
    def rms_px(self) -> float:
        """Root mean square per coordinate, px."""
        return float(np.sqrt((self.residuals**2).mean())) if self.residuals.size else 0.0


def camera_format(name: str) -> CameraFormat:
    """Return a format by name.

    Raises
    ------
    UserError
        When there is none of that name.
    """
    if name not in CAMERA_FORMATS:
        raise UserError(unknown_name(name, [*CAMERA_FORMATS, OWN], "camera format"))
    return CAMERA_FORMATS[name]


def guess_camera_format(path: Path) -> str:
    """Return the format of a file from its content.

    Raises
    ------
    UserError
        When it is none of the known ones.
    """
    head = "\n".join(read_lines(path)[:400])
    low = head.casefold()
    marks = {
        OWN: "[camera.values]" in low, "micmac": "calibrationinternconique" in low, "dbat": "dbat_camera_version" in low,
        "metashape": "<calibration" in low and "calibrationinternconique" not in low,
        "opencv": "opencv-matrix" in low or "camera_matrix" in low, "photomodeler": "principal point x" in low or "bundle soln" in low,
        "australis": "australis" in low or "iwitness" in low, "bundler": "bundle" in low,
        "colmap": any(f" {name} " in head for name in (*CENTRAL, *FISHEYE, "FOV")),
    }  # fmt: skip
    for name, fits in marks.items():
        if fits:
            return name
    raise UserError(
        Text("The format of {name} was not recognised.", name=path.name),
        Text("Known are {names}.", names=", ".join([*CAMERA_FORMATS, OWN])), "Say which it is with --from.",
    )  # fmt: skip


def read_any_camera(path: Path, name: str = "", frame: Format | None = None) -> Camera | ForeignCamera:
    """Read a camera file; `name` empty to recognise the format.

    Raises
    ------
    UserError
        When it cannot be read.
    """
    name = name or guess_camera_format(path)
    if name == OWN:
        return read_camera(path)
    return camera_format(name).read(path, frame)


def convert_camera(
    source: Path, target: Path, to: str, *, of: str = "", frame: Format | None = None, model: str = ""
) -> ConvertedCamera:
    """Convert a camera file.

    Parameters
    ----------
    source, target : Path
    to, of : str
        Formats; `of` empty to recognise it.
    frame : Format or None
        Format and pixel size for files that do not tell them.
    model : str
        Our model between the two; empty for the simplest that expresses the source.

    Raises
    ------
    UserError
        When a file cannot be read or written, or the target cannot hold the camera.
    """
    if to != OWN:
        camera_format(to)
    found = read_any_camera(source, of, frame)
    remarks: list[str] = []
    if isinstance(found, Camera):
        camera, from_name = found, found.model
        if frame is not None and camera.pixel_pitch_mm is None:
            camera = replace(camera, pixel_pitch_mm=frame.pitch_mm)
    else:
        step = from_foreign(found, model)
        camera, from_name = step.camera, found.formula
        remarks.append(step.says(found.formula, camera.model))
    made = camera
    target_name = camera.model
    if to == OWN:
        write_text(target, camera_text(camera))
        made_foreign = None
    else:
        made_foreign, say = write_camera(camera, target, to)
        target_name = made_foreign.formula
        remarks.append(say)
    pixels, residuals, lost = end_to_end(found, made_foreign if made_foreign is not None else made)
    return ConvertedCamera(target, camera, from_name, target_name, pixels, residuals, lost, tuple(remarks))


def write_camera(camera: Camera, path: Path, to: str) -> tuple[ForeignCamera, str]:
    """Write a camera of ours in a program's format; the camera as written, and what it cost in a sentence.

    Raises
    ------
    UserError
        When the file cannot be written, or the format cannot hold the camera.
    """
    chosen = camera_format(to)
    if chosen.choose is None or chosen.text is None:
        raise UserError(
            Text("{label} is only read here.", label=chosen.label),
            "Its files hold settings of a project besides the camera.", "Choose another format.",
        )  # fmt: skip
    step = chosen.choose(camera)
    write_text(path, chosen.text(step.camera))
    say = step.says(camera.model, step.camera.formula)
    if to == "bundler" and not step.exact and to_foreign(centred(camera), "bundler").exact:
        say = Text("{say} Only the principal point is lost: Bundler has none.", say=say)
    return step.camera, say


def end_to_end(source: Camera | ForeignCamera, target: Camera | ForeignCamera) -> tuple[Array, Array, int]:
    """Return a grid of pixels (n, 2), how much further each direction lies in the target (n, 2), px, and how many are lost."""
    from graphos_core.cameras import pixel_from_ray, ray_from_pixel

    frame = source.frame if isinstance(source, ForeignCamera) else Format(source.width, source.height)
    pixels = pixel_grid(frame)
    rays = (
        foreign_rays(source, pixels) if isinstance(source, ForeignCamera) else ray_from_pixel(source, pixels)
    )
    seen = np.isfinite(rays).all(axis=1)
    pixels, rays = pixels[seen], rays[seen]
    there = (
        foreign_pixels(target, rays) if isinstance(target, ForeignCamera) else pixel_from_ray(target, rays)
    )
    good = np.isfinite(there).all(axis=1)
    return pixels[good], (there - pixels)[good], int((~good).sum())


def exact(converted: ConvertedCamera) -> bool:
    """Return whether nothing was lost: the largest difference over the whole format is at most 1e-6 px."""
    return converted.max_px <= EXACT_PX and not converted.without_image
