"""MicMac's calibration files (``AutoCal….xml``, ``CalibrationInternConique``): reading and writing one camera."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.exchange.camera_fit import Conversion, to_foreign
from graphos_core.exchange.formulas import ForeignCamera, Format, formula
from graphos_core.exchange.formulas_micmac import polynomial_terms
from graphos_core.exchange.text_files import finite, not_such, parse_xml, xml_numbers, xml_text
from graphos_core.text import Text

WHAT = "a calibration of MicMac"
CENTRAL = ("ModNoDist", "ModRad", "ModPhgrStd")
POLYNOMIAL = (*CENTRAL, *(f"eModelePolyDeg{degree}" for degree in range(3, 8)))
FISHEYE = ("eModele_FishEye_10_5_5", "eModele_EquiSolid_FishEye_10_5_5")
"""Distortion models in the order in which they are tried."""


def read_micmac_camera(path: Path) -> ForeignCamera:
    """Read a calibration.

    Raises
    ------
    UserError
        When it cannot be read, or has a distortion model or convention that is not supported.
    """
    root = parse_xml(path, WHAT)
    found = root if root.tag == "CalibrationInternConique" else root.find(".//CalibrationInternConique")
    if found is None:
        raise not_such(path, WHAT, "It has no CalibrationInternConique.")
    return camera_of(path, found)


def camera_of(path: Path, root: Element) -> ForeignCamera:
    """Return the camera of a ``CalibrationInternConique`` or ``Interne`` element; errors as `read_micmac_camera`."""
    convention = xml_text(root, "KnownConv")
    if convention not in ("", "eConvApero_DistM2C"):
        raise not_such(
            path,
            WHAT,
            Text("Its convention {name} is not read, only eConvApero_DistM2C.", name=convention[:40]),
        )
    focal = xml_numbers(path, root, "F", 1)[0]
    size = xml_numbers(path, root, "SzIm", 2)
    if focal <= 0 or size.min() < 1 or size.max() > 1e6:
        raise not_such(path, WHAT, "Its principal distance or format is not possible.")
    base = np.array([focal, *xml_numbers(path, root, "PP", 2)])
    layers = root.findall("CalibDistortion")
    if len(layers) > 1:
        raise not_such(path, WHAT, "It chains several distortions, which is not read.")
    kind, rest = _distortion(path, layers[0] if layers else None)
    values = np.array([*base, *rest])
    return ForeignCamera(f"micmac {kind}", values, Format(int(size[0]), int(size[1])), path.stem)


def _distortion(path: Path, layer: Element | None) -> tuple[str, list[float]]:
    """Return the name of the distortion model and its values after F and PP."""
    model = layer[0] if layer is not None and len(layer) else None
    if model is None or model.tag == "ModNoDist":
        return "ModNoDist", []
    if model.tag == "ModRad":
        return "ModRad", _radial(path, model)
    if model.tag == "ModPhgrStd":
        radial = model.find("RadialePart")
        if radial is None:
            raise not_such(path, WHAT, "ModPhgrStd has no RadialePart.")
        return "ModPhgrStd", [
            *_radial(path, radial),
            *(_optional(path, model, tag) for tag in ("P1", "P2", "b1", "b2")),
        ]
    if model.tag == "ModUnif":
        return _unified(path, model)
    raise not_such(path, WHAT, Text("Its distortion {name} is not read.", name=model.tag[:40]))


def _radial(path: Path, element: Element) -> list[float]:
    coefficients = _many(path, element, "CoeffDist")
    if len(coefficients) > 5:
        if any(coefficients[5:]):
            raise not_such(path, WHAT, "It has more than five radial coefficients.")
        coefficients = coefficients[:5]
    centre = xml_numbers(path, element, "CDist", 2)
    return [*centre, *coefficients, *[0.0] * (5 - len(coefficients))]


def _optional(path: Path, element: Element, tag: str) -> float:
    return float(xml_numbers(path, element, tag, 1)[0]) if element.find(tag) is not None else 0.0


def _many(path: Path, element: Element, tag: str) -> list[float]:
    try:
        return finite([(item.text or "").strip() for item in element.findall(tag)])
    except ValueError:
        raise not_such(path, WHAT, Text("A <{tag}> is no number.", tag=tag)) from None


def _unified(path: Path, model: Element) -> tuple[str, list[float]]:
    kind = xml_text(model, "TypeModele")
    params, states = _many(path, model, "Params"), _many(path, model, "Etats")
    if kind in FISHEYE and len(params) >= 24 and states:
        high = [*params[7:12], *params[14:22], *params[24:]]
        if any(high):
            raise not_such(path, WHAT, "It has fish-eye terms of high degree, which are not read.")
        return kind, [*params[0:7], *params[12:14], *params[22:24], states[0]]
    degree = int(kind[-1]) if kind.startswith("eModelePolyDeg") and kind[-1] in "234567" else 0
    if degree and len(states) >= 3:
        count = polynomial_terms(degree)
        params = [*params[:count], *[0.0] * (count - len(params))]
        return kind, [states[0], states[1], states[2], *params]
    raise not_such(path, WHAT, Text("Its distortion {name} is not read.", name=kind[:60]))


def micmac_camera(camera: Camera) -> Conversion[ForeignCamera]:
    """Return a camera in the first of MicMac's models that expresses it, else in the best one.

    Raises
    ------
    UserError
        When the format is unknown or the camera is a panorama.
    """
    model = camera_model(camera.model)
    if model.projection == "spherical":
        raise UserError(
            "A panorama cannot be written for MicMac.", "It has no such camera.", "Choose another format."
        )
    best: Conversion[ForeignCamera] | None = None
    central = POLYNOMIAL if model.name.startswith(("polynomial", "ebner")) else CENTRAL
    for name in FISHEYE if model.wide else central:
        found = to_foreign(camera, f"micmac {name}")
        if best is None or (found.without_image, found.rms_px) < (best.without_image, best.rms_px):
            best = found
        if best.exact:
            break
    assert best is not None
    return best


def micmac_xml(camera: ForeignCamera) -> str:
    """Return the text of a calibration file."""
    kind = camera.formula.split()[1]
    v = {p: float(x) for p, x in zip(formula(camera.formula).parameters, camera.values, strict=True)}
    body = [
        "<KnownConv>eConvApero_DistM2C</KnownConv>", f"<PP>{v['PPx']!r} {v['PPy']!r}</PP>", f"<F>{v['F']!r}</F>",
        f"<SzIm>{camera.frame.width} {camera.frame.height}</SzIm>", "<CalibDistortion>", *_distortion_xml(kind, v),
        "</CalibDistortion>",
    ]  # fmt: skip
    lines = ['<?xml version="1.0" ?>', "<ExportAPERO>", "<CalibrationInternConique>", *body,
             "</CalibrationInternConique>", "</ExportAPERO>"]  # fmt: skip
    return "\n".join(lines) + "\n"


def _distortion_xml(kind: str, v: dict[str, float]) -> list[str]:
    if kind == "ModNoDist":
        return ["<ModNoDist></ModNoDist>"]
    if kind in ("ModRad", "ModPhgrStd"):
        radial = [f"<CDist>{v['CDistx']!r} {v['CDisty']!r}</CDist>",
                  *(f"<CoeffDist>{v[r]!r}</CoeffDist>" for r in ("R3", "R5", "R7", "R9", "R11"))]  # fmt: skip
        if kind == "ModRad":
            return ["<ModRad>", *radial, "</ModRad>"]
        rest = [f"<{tag}>{v[tag]!r}</{tag}>" for tag in ("P1", "P2", "b1", "b2")]
        return ["<ModPhgrStd>", "<RadialePart>", *radial, "</RadialePart>", *rest, "</ModPhgrStd>"]
    if kind in FISHEYE:
        params = [v["CDistx"], v["CDisty"], *(v[r] for r in ("R3", "R5", "R7", "R9", "R11")), *[0.0] * 5,
                  v["P1"], v["P2"], *[0.0] * 8, v["l0"], v["l1"], *[0.0] * 26]  # fmt: skip
        states = [v["S"]]
    else:
        params = [value for name, value in v.items() if name[0] == "p"]
        states = [v["S"], v["Cx"], v["Cy"]]
    return ["<ModUnif>", f"<TypeModele>{kind}</TypeModele>", *(f"<Params>{p!r}</Params>" for p in params),
            *(f"<Etats>{s!r}</Etats>" for s in states), "</ModUnif>"]  # fmt: skip
