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
from graphos_core.exchange.known_values import (
    KEYS,
    names,
    number,
    positive,
    positive_vector,
    section,
    sections,
    vector,
    vectors,
    word,
    yes,
)
from graphos_core.exchange.photo_tables import read_attitudes, read_positions
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.text import Text

SHAPES = ("horizontal plane", "plane", "line", "vertical line", "x axis", "y axis", "z axis")
GIVEN = ("given", "estimated")


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
    unknown = [name for name in content if name not in KEYS]
    if unknown:
        raise _bad(
            path,
            Text("“{name}” is no section; sections are {all}", name=unknown[0], all=", ".join(KEYS)),
        )
    try:
        return _known(path, content, first, photos)
    except (KeyError, TypeError, ValueError) as problem:
        what = Text("{key} is missing", key=problem) if isinstance(problem, KeyError) else problem.args[0]
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
    return replace(
        first, distances=first.distances + tuple(_distance(d) for d in sections(content, "distance")),
        centres=_centres(path, section(content, "gnss"), origin, photos) if "gnss" in content else None,
        attitudes=_attitudes(path, section(content, "attitudes")) if "attitudes" in content else None,
        shapes=tuple(_shape(s) for s in sections(content, "shape")),
        rigs=tuple(_rig(r) for r in sections(content, "rig")),
    )  # fmt: skip


def _distance(section: dict[str, Any]) -> KnownDistance:
    a, b = names([section["a"], section["b"]], "a distance")
    sigma = section.get("sigma")
    return KnownDistance(
        a=a, b=b, metres=positive(section["metres"], "metres"),
        sigma=None if sigma is None else positive(sigma, "sigma"), check=yes(section.get("check", False), "check"),
    )  # fmt: skip


def _centres(path: Path, section: dict[str, Any], origin: Array, photos: PhotoSet) -> KnownCentres:
    of, xyz, sigma = read_positions(path, str(section.get("source", "photos")), origin, photos)
    usual = positive_vector(section.get("sigma_m", [3.0, 3.0, 5.0]), "sigma_m")
    return KnownCentres(
        photo=of, xyz=xyz, sigma=np.where(np.isfinite(sigma), sigma, usual),
        lever_arm=vector(section.get("lever_arm_m", [0.0, 0.0, 0.0]), "lever_arm_m"),
        lever_arm_free=word(section.get("lever_arm", "given"), "lever_arm", GIVEN) == "estimated",
    )  # fmt: skip


def _attitudes(path: Path, section: dict[str, Any]) -> KnownAttitudes:
    of, rotations = read_attitudes(path, str(section["source"]))
    sigma = np.radians(positive_vector(section.get("sigma_deg", [0.01, 0.01, 0.02]), "sigma_deg"))
    boresight = matrix_from_vector(
        np.radians(vector(section.get("boresight_deg", [0.0, 0.0, 0.0]), "boresight_deg"))
    )
    return KnownAttitudes(
        photo=of, rotations=rotations, sigma=np.tile(sigma, (len(of), 1)), boresight=boresight,
        boresight_free=word(section.get("boresight", "given"), "boresight", GIVEN) == "estimated",
    )  # fmt: skip


def _shape(section: dict[str, Any]) -> KnownShape:
    value = section.get("value")
    return KnownShape(
        kind=word(section["kind"], "kind", SHAPES), points=names(section["points"], "points"),
        sigma=positive(section.get("sigma_m", 0.01), "sigma_m"), value=None if value is None else number(value, "value"),
        name=str(section.get("name", "")),
    )  # fmt: skip


def _rig(section: dict[str, Any]) -> KnownRig:
    moments = section["photos"]
    if not isinstance(moments, list) or not moments:
        raise ValueError(
            Text("photos is {value}, needs a list of names for each moment", value=str(moments)[:40])
        )
    photos = tuple(names(moment, "a moment in photos", empty=True) for moment in moments)
    count = max(len(moment) for moment in photos)
    if count < 2:
        raise ValueError("a rig has moments of one photo each, needs two or more cameras")
    nothing = [[0.0, 0.0, 0.0]] * count
    centres = vectors(section.get("centres", nothing), "centres", count)
    turns = np.radians(vectors(section.get("rotations_deg", nothing), "rotations_deg", count))
    return KnownRig(
        photos=photos, rotations=np.array([matrix_from_vector(t) for t in turns]), centres=centres,
        sigma_rotation=float(np.radians(positive(section.get("sigma_deg", 1e-3), "sigma_deg"))),
        sigma_centre=positive(section.get("sigma", 1e-4), "sigma"), free=yes(section.get("free", True), "free"),
        name=str(section.get("name", "")),
    )  # fmt: skip
