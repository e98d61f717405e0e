"""Script projects (XML) of the Damped Bundle Adjustment Toolbox (DBAT), version 1.

Read are control and check points with their filters, photos, image points, and one camera. Start values are made as
the scripts say: spatial resection from the control points, then forward intersection.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, ParseError

import numpy as np

from graphos_core.data import Array, Control
from graphos_core.errors import UserError
from graphos_core.exchange.control import local_origin
from graphos_core.exchange.dbat_case import PIXEL_ORIGIN, DbatCamera, DbatCase, Measured, assemble
from graphos_core.exchange.dbat_tables import DbatTable, read_table
from graphos_core.text import Text

INTERIOR = ("cc", "px", "py", "as", "sk", "K1", "K2", "K3", "P1", "P2")
"""DBAT's interior unknowns in its order."""


def read_script(path: str | Path) -> DbatCase:
    """Read a script with all files it names; they must lie in its folder.

    Raises
    ------
    UserError
        When a file is missing, damaged, or asks for something this reader does not do.
    """
    path = Path(path)
    root = _parse(path)
    try:
        return _case(path, root)
    except (ValueError, KeyError, AttributeError) as problem:
        raise UserError(
            Text("{name} could not be read as a DBAT script.", name=path.name),
            Text("The reader says: {why}.", why=problem),
            "Give a script of version 1 with control points, photos, image points and one camera.",
        ) from problem


def _parse(path: Path) -> Element:
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import parse

    try:
        root: Element = parse(path).getroot()
    except OSError as problem:
        raise UserError(
            Text("{name} could not be read.", name=path.name),
            problem.strerror or str(problem),
            "Check the path.",
        ) from problem
    except (ParseError, DefusedXmlException, ValueError, LookupError) as problem:
        raise UserError(
            Text("{name} is not a DBAT script.", name=path.name),
            Text("It is not plain XML: {why}.", why=problem),
            "Give the .xml file of a project.",
        ) from problem
    return root


def _case(path: Path, root: Element) -> DbatCase:
    given = _required(root, "input")
    camera = camera_of_element(_required(given, "cameras/camera"), _word(root, ".//set_initial_values/io"))
    photos = [read_table(*_file(path, element)) for element in given.findall("images/file")]
    names = tuple(
        name.replace("\\", "/").rsplit("/", 1)[-1] for table in photos for name in table.words["path"]
    )
    number = {int(key): i for i, key in enumerate(np.concatenate([table.numbers["id"] for table in photos]))}
    control, labels, sigma = _control(path, given)
    return assemble(
        _word(root, "meta/name") or path.stem, camera, names, _measured(path, given, number), control, labels, sigma,
        estimated=_estimated(root, camera),
    )  # fmt: skip


def _file(path: Path, element: Element) -> tuple[Path, str]:
    """Return a named file and its columns; refuse what lies outside the folder of the script."""
    name = (element.text or "").strip()
    file = (path.parent / name).resolve()
    if not file.is_relative_to(path.parent.resolve()):
        raise ValueError(f"it names the file “{name[:60]}” outside its own folder")
    return file, element.attrib["format"]


def _measured(path: Path, given: Element, number: dict[int, int]) -> Measured:
    point, photo, xy, sigma = [], [], [], []
    for element in given.findall("image_pts/file"):
        table = read_table(*_file(path, element))
        point.append(table.numbers["id"].astype(np.int64))
        photo.append(np.array([number[int(key)] for key in table.numbers["im"]], dtype=np.int64))
        xy.append(table.columns("x", "y") - PIXEL_ORIGIN)
        every = element.attrib.get("sxy")
        sigma.append(table.numbers["sxy"] if every is None else np.full(len(table), float(every)))
    return Measured(*(np.concatenate(part) for part in (point, photo, xy, sigma)))


def _control(path: Path, given: Element) -> tuple[Control, tuple[str, ...], Array]:
    """Read control and check points, each section with its filter."""
    names: list[str] = []
    labels: list[str] = []
    xyz, sigmas, check = [], [], []
    for section, is_check in (("ctrl_pts", False), ("check_pts", True)):
        part = given.find(section)
        if part is None:
            continue
        for element in part.findall("file"):
            table = read_table(*_file(path, element))
            keep = _filtered(table.numbers["id"].astype(int), part.findall("filter"))
            names += [str(int(key)) for key in table.numbers["id"][keep]]
            labels += [label for label, kept in zip(table.words["label"], keep, strict=True) if kept]
            xyz.append(table.columns("x", "y", "z")[keep])
            sigmas.append(_sigma(table)[keep])
            check += [is_check] * int(keep.sum())
    coordinates = np.concatenate(xyz)
    origin = local_origin(coordinates)
    control = Control(names=tuple(names), xyz=coordinates - origin, check=np.array(check), origin=origin)
    return control, tuple(labels), np.concatenate(sigmas)


def _filtered(identifiers: Array, filters: list[Element]) -> Array:
    """Return which points pass; ``keep`` and ``remove`` name identifiers."""
    passed = np.ones(len(identifiers), dtype=bool)
    for one in filters:
        named = np.isin(identifiers, [int(word) for word in one.attrib["id"].split(",")])
        verb = (one.text or "").strip()
        if verb not in ("keep", "remove"):
            raise ValueError(f"the filter “{verb[:30]}” is neither keep nor remove")
        passed &= named if verb == "keep" else ~named
    return passed


def _sigma(table: DbatTable) -> Array:
    if "sxyz" in table.numbers:
        return np.repeat(table.columns("sxyz"), 3, axis=1)
    if "sx" in table.numbers:
        return table.columns("sx", "sy", "sz")
    return np.zeros((len(table), 3))


def camera_of_element(element: Element, initial: str) -> DbatCamera:
    """Read the camera; with initial values ``default`` it starts at the focal length, centred, undistorted."""
    width, height = (int(word) for word in _word(element, "image").split(","))
    sensor = [word.strip() for word in _word(element, "sensor").split(",")]
    pitch = (
        float(sensor[0]) / width if sensor[1] == "auto" else float(sensor[1]) / height
    )  # width has the aspect in it
    model = int(_word(element, "model") or 3)
    if model not in (1, 3):
        raise ValueError(f"lens model {model} is not read, only 1 and 3")
    if _word(element, "unit") not in ("mm", ""):
        raise ValueError("the camera is not in mm")
    loaded = initial == "loaded"
    aspect = 1.0 - float(_word(element, "aspect") or 1.0)
    return DbatCamera(
        width=width, height=height, pitch_mm=pitch, model=model, name=_word(element, "name"), aspect=aspect,
        constant_mm=float(_word(element, "cc" if loaded else "focal")),
        principal_mm=_vector(_word(element, "pp"), 2) if loaded else np.array([width, height]) * pitch / 2,
        k=_vector(_word(element, "K"), 3) if loaded else np.zeros(3),
        p=_vector(_word(element, "P"), 2) if loaded else np.zeros(2),
        skew=float(_word(element, "skew") or 0.0) if loaded else 0.0,
    )  # fmt: skip


def _vector(text: str, length: int) -> Array:
    values = [float(word) for word in text.split(",") if word.strip()]
    if len(values) > length:
        raise ValueError(f"more than {length} values in “{text[:40]}”")
    return np.array(values + [0.0] * (length - len(values)))


def _estimated(root: Element, camera: DbatCamera) -> tuple[str, ...]:
    """Return the interior unknowns that ``set_bundle_estimate_params`` frees."""
    io = root.find(".//set_bundle_estimate_params/io")
    if io is None:
        return ()
    free = dict.fromkeys(INTERIOR, (_word(io, "all") or (io.text or "").strip()) == "true")
    groups: dict[str, Any] = {"aspect": ("as",), "skew": ("sk",), "cc": ("cc",), "pp": ("px", "py"),
                              "K": ("K1", "K2", "K3"), "P": ("P1", "P2")}  # fmt: skip
    for group, members in groups.items():
        word = _word(io, group)
        if word:
            free.update(dict.fromkeys(members, word == "true"))
    if camera.model == 1:
        free["as"] = free["sk"] = False
    return tuple(name for name in INTERIOR if free[name])


def _required(element: Element, path: str) -> Element:
    found = element.find(path)
    if found is None:
        raise ValueError(f"it has no section “{path}”")
    return found


def _word(element: Element, path: str) -> str:
    """Return the text of an element, or of its ``all``; empty where there is none."""
    found = element.find(path)
    if found is None:
        return ""
    inner = found.find("all")
    return ((found if inner is None else inner).text or "").strip()
