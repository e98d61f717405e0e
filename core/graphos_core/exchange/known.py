"""What is known of the object beside control points, as text: ``known.toml`` in a project.

::

    [[distance]]                     # between two measured points, or two photos
    a = "S1"
    b = "S2"
    metres = 1.2345
    sigma = 0.0005                   # optional, m
    check = false                    # true: takes no part, only checks the scale

    [gnss]                           # positions of photos
    source = "photos"                # from the photos themselves (EXIF), or the name of a table beside this file:
                                     # photo,x,y,z[,sx,sy,sz] in m
    sigma_m = [3.0, 3.0, 5.0]        # where the table says none
    lever_arm_m = [0.0, 0.0, 0.0]    # antenna in the camera frame: x right, y down, z forward
    lever_arm = "given"              # or "estimated"

    [attitudes]                      # from an inertial system: photo,omega,phi,kappa of its body in degrees
    source = "ins.csv"
    sigma_deg = [0.01, 0.01, 0.02]
    boresight_deg = [0.0, 0.0, 0.0]  # rotation vector cam_from_body
    boresight = "given"              # or "estimated"

    [[shape]]
    kind = "horizontal plane"        # plane, line, vertical line, x axis, y axis, z axis
    points = ["T1", "T2", "T3"]
    sigma_m = 0.002
    value = 12.5                     # optional: known height of a horizontal plane
    name = "floor"

    [[rig]]                          # cameras fixed to each other; the first is the reference
    name = "stereo"
    photos = [["l1.jpg", "r1.jpg"], ["l2.jpg", "r2.jpg"]]
    centres = [[0, 0, 0], [0.2, 0, 0]]
    rotations_deg = [[0, 0, 0], [0, 0, 0]]   # rotation vectors cam_from_reference
    sigma_deg = 0.001
    sigma = 1e-5
    free = true
"""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from graphos_core.data import (
    Array,
    Known,
    KnownAttitudes,
    KnownCentres,
    KnownDistance,
    KnownRig,
    KnownShape,
    PhotoSet,
)
from graphos_core.errors import UserError
from graphos_core.exchange.photo_tables import read_attitudes, read_positions
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.text import Text

SECTIONS = ("distance", "gnss", "attitudes", "shape", "rig")


def read_known(path: Path, first: Known, photos: PhotoSet) -> Known:
    """Read what a file adds to what is known; without the file nothing is added.

    Parameters
    ----------
    path : Path
        ``known.toml``; tables it names stand in the same folder.
    first : Known
        Control points and what else is known already; its local origin is taken off positions.
    photos : PhotoSet
        For positions that the photos say themselves.

    Raises
    ------
    UserError
        When the file or a table cannot be read, or says something that makes no sense.
    """
    if not path.is_file():
        return first
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as problem:
        raise UserError(Text("{name} could not be read.", name=path.name), Text("It says: {why}.", why=problem),
                        "Correct the file; it is TOML.") from problem  # fmt: skip
    unknown = [name for name in content if name not in SECTIONS]
    if unknown:
        raise _bad(
            path,
            Text("there is no section “{name}”; there are {all}", name=unknown[0], all=", ".join(SECTIONS)),
        )
    try:
        return _known(path, content, first, photos)
    except (AttributeError, KeyError, TypeError, ValueError) as problem:
        what = Text("{key} is missing", key=problem) if isinstance(problem, KeyError) else str(problem)
        raise _bad(path, what) from problem


def known_tables(path: Path) -> tuple[Path, ...]:
    """Return the tables that a file names; none where it cannot be read, which `read_known` says."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError):
        return ()
    sections = [content.get(name) for name in ("gnss", "attitudes")]
    sources = [section.get("source") for section in sections if isinstance(section, dict)]
    return tuple(path.parent / name for name in sources if isinstance(name, str) and name != "photos")


def _bad(path: Path, why: str) -> UserError:
    return UserError(Text("{name} cannot be used.", name=path.name), Text("There {why}.", why=why),
                     "Correct the file; `graphos_core.exchange.known` documents it.")  # fmt: skip


def _known(path: Path, content: dict[str, Any], first: Known, photos: PhotoSet) -> Known:
    origin = np.zeros(3) if first.control is None else first.control.origin
    distances = tuple(
        KnownDistance(
            a=str(d["a"]), b=str(d["b"]), metres=_positive(d["metres"], "metres"),
            sigma=None if d.get("sigma") is None else _positive(d["sigma"], "sigma"), check=bool(d.get("check", False)),
        )
        for d in content.get("distance", ())
    )  # fmt: skip
    return replace(
        first, distances=first.distances + distances,
        centres=_centres(path, content["gnss"], origin, photos) if "gnss" in content else None,
        attitudes=_attitudes(path, content["attitudes"]) if "attitudes" in content else None,
        shapes=tuple(_shape(s) for s in content.get("shape", ())),
        rigs=tuple(_rig(r) for r in content.get("rig", ())),
    )  # fmt: skip


def _centres(path: Path, section: dict[str, Any], origin: Array, photos: PhotoSet) -> KnownCentres:
    names, xyz, sigma = read_positions(path, str(section.get("source", "photos")), origin, photos)
    usual = _above_zero(section.get("sigma_m", [3.0, 3.0, 5.0]), "sigma_m")
    if not (sigma[np.isfinite(sigma)] > 0).all():
        raise ValueError(f"a standard deviation in {section['source']} is not above 0")
    return KnownCentres(
        photo=names, xyz=xyz, sigma=np.where(np.isfinite(sigma), sigma, usual),
        lever_arm=_vector(section.get("lever_arm_m", [0.0, 0.0, 0.0]), "lever_arm_m"),
        lever_arm_free=_choice(section.get("lever_arm", "given"), "lever_arm"),
    )  # fmt: skip


def _attitudes(path: Path, section: dict[str, Any]) -> KnownAttitudes:
    names, rotations = read_attitudes(path, str(section["source"]))
    sigma = np.radians(_above_zero(section.get("sigma_deg", [0.01, 0.01, 0.02]), "sigma_deg"))
    boresight = matrix_from_vector(
        np.radians(_vector(section.get("boresight_deg", [0.0, 0.0, 0.0]), "boresight_deg"))
    )
    return KnownAttitudes(
        photo=names, rotations=rotations, sigma=np.tile(sigma, (len(names), 1)), boresight=boresight,
        boresight_free=_choice(section.get("boresight", "given"), "boresight"),
    )  # fmt: skip


def _shape(section: dict[str, Any]) -> KnownShape:
    value = section.get("value")
    return KnownShape(
        kind=str(section["kind"]), points=tuple(str(p) for p in section["points"]),
        sigma=_positive(section.get("sigma_m", 0.01), "sigma_m"), value=None if value is None else float(value),
        name=str(section.get("name", "")),
    )  # fmt: skip


def _rig(section: dict[str, Any]) -> KnownRig:
    photos = tuple(tuple(str(p) for p in moment) for moment in section["photos"])
    count = max((len(moment) for moment in photos), default=0)
    centres = np.array(section.get("centres", np.zeros((count, 3))), dtype=np.float64)
    turns = np.radians(np.array(section.get("rotations_deg", np.zeros((count, 3))), dtype=np.float64))
    if centres.shape != (count, 3) or turns.shape != (count, 3) or not np.isfinite([centres, turns]).all():
        raise ValueError(
            f"a rig of {count} cameras needs {count} centres and {count} rotations of three numbers each"
        )
    return KnownRig(
        photos=photos, rotations=np.array([matrix_from_vector(t) for t in turns]), centres=centres,
        sigma_rotation=float(np.radians(_positive(section.get("sigma_deg", 1e-3), "sigma_deg"))),
        sigma_centre=_positive(section.get("sigma", 1e-4), "sigma"), free=bool(section.get("free", True)),
        name=str(section.get("name", "")),
    )  # fmt: skip


def _positive(value: Any, name: str) -> float:
    number = float(value)
    if not (np.isfinite(number) and number > 0):
        raise ValueError(f"{name} is {value}, needs a number above 0")
    return number


def _vector(value: Any, name: str) -> Array:
    vector = np.array(value, dtype=np.float64)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise ValueError(f"{name} is {value}, needs three numbers")
    return vector


def _above_zero(value: Any, name: str) -> Array:
    vector = _vector(value, name)
    if not (vector > 0).all():
        raise ValueError(f"{name} is {value}, needs three numbers above 0")
    return vector


def _choice(value: Any, name: str) -> bool:
    if value not in ("given", "estimated"):
        raise ValueError(f"{name} is {value}, needs “given” or “estimated”")
    return bool(value == "estimated")
