"""Agisoft Metashape: camera files (XML) and calibration files (XML), versions 1.3 and later.

A camera's ``<transform>`` is ``chunk_from_cam`` (4, 4) by rows, camera frame x right, y down, z forward; the chunk's
``<transform>`` is the similarity to the world, which for geographic coordinate systems is geocentric. Lens formulas:
`graphos_core.exchange.formulas_other`. The files hold no tie points.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element
from xml.sax.saxutils import quoteattr

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Parts, Read, Written
from graphos_core.exchange.camera_fit import Conversion, to_foreign
from graphos_core.exchange.formulas import ForeignCamera, Format
from graphos_core.exchange.formulas_other import METASHAPE
from graphos_core.exchange.text_files import not_such, parse_xml, xml_numbers, xml_text
from graphos_core.geometry.similarity import Similarity
from graphos_core.store import write_text
from graphos_core.text import Text

WHAT = "a camera file of Metashape"
PROJECTIONS = {"frame": "frame", "fisheye": "equidistant_fisheye", "equidistant_fisheye": "equidistant_fisheye",
               "equisolid_fisheye": "equisolid_fisheye"}  # fmt: skip
"""Sensor types that are read; plain ``fisheye`` is the equidistant one."""


def read_metashape_camera(path: Path) -> ForeignCamera:
    """Read the first calibration of a file: of a camera file, or of a calibration file.

    Raises
    ------
    UserError
        When the file cannot be read, or its projection is not supported.
    """
    root = parse_xml(path, WHAT)
    if root.tag == "calibration":
        return _calibration(path, root, xml_text(root, "projection") or "frame", path.stem, None)
    for sensor in root.iter("sensor"):
        found = _sensor(path, sensor)
        if found is not None:
            return found
    raise not_such(path, "a calibration of Metashape", "It has no calibrated sensor.")


def read_metashape(path: Path) -> Read:
    """Read the cameras of the first chunk of a camera file.

    Raises
    ------
    UserError
        When the file cannot be read.
    """
    root = parse_xml(path, WHAT)
    chunk = next(root.iter("chunk"), None)
    if chunk is None:
        raise not_such(path, WHAT, "It has no chunk.")
    parts = Parts()
    sensors: dict[str, int] = {}
    for sensor in chunk.iter("sensor"):
        found = _sensor(path, sensor)
        if found is not None:
            sensors[sensor.attrib.get("id", "")] = parts.add_camera(found)
    world = _similarity(path, chunk, parts)
    for camera in chunk.iter("camera"):
        _add_camera(path, camera, parts, sensors, world)
    parts.remarks.append(
        "A camera file of Metashape holds no tie points: export them as Bundler, for example."
    )
    return parts.read()


def _sensor(path: Path, sensor: Element) -> ForeignCamera | None:
    calibrations = sensor.findall("calibration")
    if not calibrations:
        return None
    best = next((c for c in calibrations if c.attrib.get("class") == "adjusted"), calibrations[0])
    kind = best.attrib.get("type", sensor.attrib.get("type", "frame"))
    pitch = next(
        (p.attrib.get("value") for p in sensor.findall("property") if p.attrib.get("name") == "pixel_width"),
        None,
    )
    try:
        pitch_mm = float(pitch) if pitch else None
    except ValueError:
        pitch_mm = None
    return _calibration(path, best, kind, sensor.attrib.get("label", ""), pitch_mm)


def _calibration(path: Path, element: Element, kind: str, label: str, pitch: float | None) -> ForeignCamera:
    if kind not in PROJECTIONS:
        raise not_such(path, WHAT, Text("Its camera type {name} is not read.", name=kind[:40]))
    size = element.find("resolution")
    try:
        width = int(size.attrib["width"] if size is not None else xml_text(element, "width"))
        height = int(size.attrib["height"] if size is not None else xml_text(element, "height"))
    except (KeyError, ValueError):
        raise not_such(path, WHAT, "A calibration has no format.") from None
    if element.find("f") is None:
        raise not_such(path, WHAT, "A calibration has no <f>: it is of a version before 1.3.")
    if any(element.find(tag) is not None and xml_numbers(path, element, tag, 1)[0] for tag in ("p3", "p4")):
        raise not_such(path, WHAT, "It has the decentring terms p3, p4, which are not read.")
    values = [
        xml_numbers(path, element, tag, 1)[0] if element.find(tag) is not None else 0.0 for tag in METASHAPE
    ]
    if values[0] <= 0 or not (0 < width < 10**6 and 0 < height < 10**6):
        raise not_such(path, WHAT, "A principal distance or format is not possible.")
    return ForeignCamera(f"metashape {PROJECTIONS[kind]}", np.array(values), Format(width, height, pitch),
                         label or "Metashape")  # fmt: skip


def _similarity(path: Path, chunk: Element, parts: Parts) -> Similarity | None:
    """Return ``world_from_chunk``; None where the chunk is not placed."""
    transform = chunk.find("transform")
    if transform is None or transform.find("rotation") is None:
        parts.remarks.append(
            "The chunk has no transform: coordinates are those of the chunk, without a unit."
        )
        return None
    parts.unit = "m"
    reference = xml_text(chunk, "reference")
    if reference.startswith(("GEOGCS", "PROJCS", "GEOCCS", "COMPD")):
        parts.remarks.append(
            "The chunk has a geographic reference: coordinates are geocentric (ECEF), as in the file."
        )
    scale = xml_numbers(path, transform, "scale", 1)[0] if transform.find("scale") is not None else 1.0
    return Similarity(float(scale), xml_numbers(path, transform, "rotation", 9).reshape(3, 3),
                      xml_numbers(path, transform, "translation", 3))  # fmt: skip


def _add_camera(
    path: Path, camera: Element, parts: Parts, sensors: dict[str, int], world: Similarity | None
) -> None:
    name = camera.attrib.get("label", camera.attrib.get("id", ""))
    sensor = camera.attrib.get("sensor_id", "")
    if sensor not in sensors:
        parts.remarks.append(Text("{name} was left out: its sensor has no calibration.", name=name))
        return
    if camera.find("transform") is None or camera.attrib.get("enabled", "true") in ("false", "0"):
        parts.add_photo(name, sensors[sensor], None, None)
        return
    matrix = xml_numbers(path, camera, "transform", 16).reshape(4, 4)
    rotation, centre = matrix[:3, :3].T, matrix[:3, 3]
    if world is not None:
        rotation, centre = world.rotate_camera(rotation), world.apply(centre)
    try:
        parts.add_photo(name, sensors[sensor], rotation, centre)
    except ValueError:
        raise not_such(path, WHAT, Text("The transform of {name} is no rigid motion.", name=name)) from None


def metashape_camera(camera: Camera) -> Conversion[ForeignCamera]:
    """Return a camera in Metashape's formula of the same kind of projection.

    Raises
    ------
    UserError
        When the format is unknown or the camera is a panorama.
    """
    projection = camera_model(camera.model).projection
    kind = {"central": "frame", "equidistant": "equidistant_fisheye", "equisolid": "equisolid_fisheye"}.get(
        projection
    )
    if kind is None:
        raise UserError("A panorama cannot be written for Metashape here.", "Its camera has no parameters.", "Choose another format.")  # fmt: skip
    return to_foreign(camera, f"metashape {kind}")


def metashape_calibration_xml(camera: ForeignCamera) -> str:
    """Return the text of a calibration file."""
    frame = camera.frame
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', "<calibration>",
             f"  <projection>{camera.formula.split()[1]}</projection>",
             f"  <width>{frame.width}</width>", f"  <height>{frame.height}</height>",
             *(f"  {line}" for line in _parameters(camera.values)), "</calibration>"]  # fmt: skip
    return "\n".join(lines) + "\n"


def _parameters(values: Array) -> list[str]:
    return [f"<{tag}>{float(v)!r}</{tag}>" for tag, v in zip(METASHAPE, values, strict=True)]


def write_metashape(block: Block, path: Path) -> Written:
    """Write cameras and orientations of a block as a camera file; photos without orientation stay without.

    Raises
    ------
    UserError
        When the file cannot be written or a camera not be expressed.
    """
    remarks = ["Tie points are not part of a camera file of Metashape."]
    worst = 0.0
    out = ['<?xml version="1.0" encoding="UTF-8"?>', '<document version="1.5.0">',
           '  <chunk label="GRAPHOS" enabled="true">', f'    <sensors next_id="{len(block.cameras)}">']  # fmt: skip
    for index, camera in enumerate(block.cameras):
        found = metashape_camera(camera)
        worst = max(worst, found.max_px)
        if not found.exact:
            remarks.append(found.says(camera.label or camera.model, found.camera.formula))
        out += _sensor_xml(index, camera, found.camera)
    out += ["    </sensors>", f'    <cameras next_id="{len(block.names)}" next_group_id="0">']
    for i, name in enumerate(block.names):
        head = f'      <camera id="{i}" sensor_id="{block.camera_of_photo[i]}" label={quoteattr(name)}'
        if not block.oriented[i]:
            out.append(head + "/>")
            continue
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = block.rotations[i].T, block.centres[i]
        numbers = " ".join(repr(float(v)) for v in matrix.ravel())
        out += [head + ' enabled="true">', f"        <transform>{numbers}</transform>", "      </camera>"]
    out.append("    </cameras>")
    if block.unit == "m":
        out += ["    <transform>", "      <rotation>1 0 0 0 1 0 0 0 1</rotation>",
                "      <translation>0 0 0</translation>", "      <scale>1</scale>", "    </transform>"]  # fmt: skip
    out += ["  </chunk>", "</document>"]
    write_text(path, "\n".join(out) + "\n")
    return Written((path,), tuple(remarks), worst)


def _sensor_xml(index: int, camera: Camera, found: ForeignCamera) -> list[str]:
    kind = found.formula.split()[1]
    size = f'<resolution width="{camera.width}" height="{camera.height}"/>'
    pitch = camera.pixel_pitch_mm
    properties = (
        [f'        <property name="pixel_{side}" value="{pitch!r}"/>' for side in ("width", "height")]
        if pitch
        else []
    )
    return [
        f'      <sensor id="{index}" label={quoteattr(camera.label or f"Camera {index + 1}")} type="{kind}">',
        f"        {size}", *properties, f'        <calibration type="{kind}" class="adjusted">', f"          {size}",
        *(f"          {line}" for line in _parameters(found.values)), "        </calibration>", "      </sensor>",
    ]  # fmt: skip
