"""MicMac's orientation folders: ``Ori-…/Orientation-PHOTO.xml`` and the calibrations they name.

``X = R P + C`` with the camera frame x right, y down, z forward: ``CodageMatr`` is ``world_from_cam`` by rows (MicMac,
``CPP_Bundler.cpp``, "Conventions in MicMac and Bundler"). There are no object points in it; tie points are in ``Homol``.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element
from xml.sax.saxutils import escape

import numpy as np

from graphos_core.data import Array, Block
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Parts, Read, Written
from graphos_core.exchange.micmac_camera import camera_of, micmac_camera, micmac_xml, read_micmac_camera
from graphos_core.exchange.text_files import not_such, parse_xml, xml_numbers, xml_text
from graphos_core.store import write_text
from graphos_core.text import Text

WHAT = "an orientation of MicMac"
PREFIX = "Orientation-"


def read_micmac(folder: Path) -> Read:
    """Read the orientations of a folder; calibrations are sought in it by name, wherever the files say they lie.

    Raises
    ------
    UserError
        When there are none, or a file is damaged.
    """
    files = sorted(folder.glob(f"{PREFIX}*.xml"))
    if not files:
        raise UserError(
            Text("{name} holds no orientation of MicMac.", name=folder.name),
            Text("There is no file {prefix}….xml in it.", prefix=PREFIX), "Choose the folder Ori-….",
        )  # fmt: skip
    parts = Parts()
    cameras: dict[str, int] = {}
    for path in files:
        root = parse_xml(path, WHAT)
        found = root if root.tag == "OrientationConique" else root.find(".//OrientationConique")
        if found is None:
            raise not_such(path, WHAT, "It has no OrientationConique.")
        rotation, centre = _pose(path, found)
        camera = _camera(path, found, parts, cameras)
        try:
            parts.add_photo(path.name.removeprefix(PREFIX).removesuffix(".xml"), camera, rotation.T, centre)
        except ValueError:
            raise not_such(path, WHAT, "Its matrix is no rotation.") from None
    parts.remarks.append(
        "MicMac keeps tie points apart (Homol): there are no object points in the orientation."
    )
    return parts.read()


def _pose(path: Path, element: Element) -> tuple[Array, Array]:
    outer = element.find("Externe")
    matrix = outer.find("ParamRotation/CodageMatr") if outer is not None else None
    if outer is None or matrix is None:
        raise not_such(path, WHAT, "It has no rotation matrix (CodageMatr).")
    convention = xml_text(element, "ConvOri/KnownConv") or xml_text(outer, "KnownConv")
    if convention not in ("", "eConvApero_DistM2C", "eConvApero_DistC2M"):
        raise not_such(path, WHAT, Text("Its convention {name} is not read.", name=convention[:40]))
    rows = [xml_numbers(path, matrix, tag, 3) for tag in ("L1", "L2", "L3")]
    return np.array(rows), xml_numbers(path, outer, "Centre", 3)


def _camera(path: Path, element: Element, parts: Parts, known: dict[str, int]) -> int:
    """Return the camera of an orientation: named in a file, or given inside."""
    named = xml_text(element, "FileInterne").replace("\\", "/").rsplit("/", 1)[-1]
    inside = element.find("Interne")
    if not named and inside is None:
        raise not_such(path, WHAT, "It names no calibration.")
    if not named or not (path.parent / named).is_file():
        if inside is None:
            raise not_such(path, WHAT, Text("Its calibration {name} is not in the folder.", name=named[:80]))
        return parts.add_camera(camera_of(path, inside))
    if named not in known:
        known[named] = parts.add_camera(read_micmac_camera(path.parent / named))
    return known[named]


def write_micmac(block: Block, folder: Path) -> Written:
    """Write the oriented photos of a block into a folder, which MicMac expects to be called ``Ori-…``.

    Raises
    ------
    UserError
        When a file cannot be written or a camera not be expressed.
    """
    photos = np.flatnonzero(block.oriented)
    files: list[Path] = []
    remarks = ["MicMac keeps tie points apart: export them as tie points (Homol)."]
    worst = 0.0
    names: dict[int, str] = {}
    for index in sorted({int(block.camera_of_photo[photo]) for photo in photos}):
        camera = block.cameras[index]
        found = micmac_camera(camera)
        names[index] = f"AutoCal_Camera-{index + 1}.xml"
        files.append(folder / names[index])
        write_text(files[-1], micmac_xml(found.camera))
        worst = max(worst, found.max_px)
        if not found.exact:
            remarks.append(found.says(camera.label or camera.model, found.camera.formula))
    for photo in photos.tolist():
        name = block.names[photo].replace("/", "_")
        files.append(folder / f"{PREFIX}{name}.xml")
        write_text(
            files[-1],
            _orientation_xml(block, photo, f"{folder.name}/{names[int(block.camera_of_photo[photo])]}"),
        )
    return Written(tuple(files), tuple(remarks), worst)


def _orientation_xml(block: Block, photo: int, calibration: str) -> str:
    rows = [" ".join(repr(float(v)) for v in row) for row in block.rotations[photo].T]
    centre = " ".join(repr(float(v)) for v in block.centres[photo])
    matrix = "".join(f"<L{i}>{row}</L{i}>\n" for i, row in enumerate(rows, 1))
    return (
        '<?xml version="1.0" ?>\n<ExportAPERO>\n<OrientationConique>\n'
        "<OrIntImaM2C><I00>0 0</I00><V10>1 0</V10><V01>0 1</V01></OrIntImaM2C>\n"
        f"<TypeProj>eProjStenope</TypeProj>\n<ZoneUtileInPixel>true</ZoneUtileInPixel>\n"
        f"<FileInterne>{escape(calibration)}</FileInterne>\n<RelativeNameFI>false</RelativeNameFI>\n"
        f"<Externe>\n<KnownConv>eConvApero_DistM2C</KnownConv>\n<Centre>{centre}</Centre>\n"
        f"<ParamRotation>\n<CodageMatr>\n{matrix}</CodageMatr>\n</ParamRotation>\n</Externe>\n"
        "<ConvOri><KnownConv>eConvApero_DistM2C</KnownConv></ConvOri>\n</OrientationConique>\n</ExportAPERO>\n"
    )
