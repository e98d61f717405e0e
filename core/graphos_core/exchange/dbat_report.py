"""What a report of the Damped Bundle Adjustment Toolbox (DBAT) prints: the reference numbers of its cases.

Formats of ``result/report.txt`` and ``…-dbatreport.txt``, versions 0.7 to 0.9; older ones print fewer items.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.text import Text

INTERIOR = {
    "Camera Constant": "cc", "px": "px", "py": "py", "as": "as", "sk": "sk",
    "K1": "K1", "K2": "K2", "K3": "K3", "P1": "P1", "P2": "P2",
    "Format width": "format_width", "Format height": "format_height",
    "Pixel width": "pixel_width", "Pixel height": "pixel_height",
}  # fmt: skip
"""Short name of each item in the section of a camera."""

EXTERIOR = ("Omega", "Phi", "Kappa", "Xc", "Yc", "Zc")


@dataclass(frozen=True)
class Printed:
    """One printed value.

    Attributes
    ----------
    value : float
    sigma : float or None
        Standard deviation; None where it was not estimated.
    unit : str
        As printed: ``"mm"``, ``"deg"``. DBAT writes the exponents of K and P one too low: they are mm⁻², mm⁻⁴ ….
    correlations : dict of str to float
        Those above 95 %, −1 to 1.
    """

    value: float
    sigma: float | None = None
    unit: str = ""
    correlations: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Station:
    """An exterior orientation as a report prints it.

    Attributes
    ----------
    photo : str
    opk : float64 (3,)
        Omega, phi, kappa, radians.
    sigma_opk : float64 (3,)
        Their standard deviations, radians.
    centre, sigma_centre : float64 (3,)
        Projection centre and its standard deviations, in the object unit.
    """

    photo: str
    opk: Array
    sigma_opk: Array
    centre: Array
    sigma_centre: Array


@dataclass(frozen=True)
class DbatReport:
    """The numbers of a report; None where a version does not print them.

    Attributes
    ----------
    sigma0, sigma0_px : float
        Without dimension, against the prior σ of the image points; and times that σ, px.
    redundancy : int or None
    unknowns : dict of str to int
        ``"all"``, ``"IO"``, ``"EO"``, ``"OP"``.
    observations : dict of str to int
        ``"all"``, ``"IP"``, ``"IO"``, ``"EO"``, ``"OP"``.
    interior : tuple of dict of str to Printed
        One per camera, keys as in `INTERIOR`.
    stations : tuple of Station
    point_rms_px : float or None
        RMS of the residual *vectors*, √2 larger than per coordinate, px.
    control_rms, check_rms : float or None
        RMS of the difference vectors, object unit.
    """

    sigma0: float
    sigma0_px: float
    redundancy: int | None
    unknowns: dict[str, int]
    observations: dict[str, int]
    interior: tuple[dict[str, Printed], ...]
    stations: tuple[Station, ...]
    point_rms_px: float | None
    control_rms: float | None
    check_rms: float | None


def read_report(path: str | Path) -> DbatReport:
    """Read a report.

    Raises
    ------
    UserError
        When the file cannot be read or is not such a report.
    """
    text = _text(Path(path))
    sigma0, pixels = _number(r"Sigma0:\s+(\S+)", text), _number(r"Sigma0 \(pixels\):\s+(\S+)", text)
    if sigma0 is None or pixels is None:
        raise UserError(Text("{name} prints no sigma0.", name=Path(path).name), todo="Give a DBAT report.")
    redundancy = _number(r"Redundancy:?\s+(\d+)", text)
    return DbatReport(
        sigma0=sigma0, sigma0_px=pixels,
        redundancy=None if redundancy is None else int(redundancy),
        unknowns=_counts(r"Number of params:\s+(.+)", text),
        observations=_counts(r"Number of observations:\s+(.+)", text),
        interior=_cameras(text), stations=_stations(text),
        point_rms_px=_number(r"Overall point RMS: (\S+) pixels", text),
        control_rms=_number(r"Ctrl point delta(?s:.*?)RMS: (\S+) ou", text),
        check_rms=_number(r"Check point delta(?s:.*?)RMS: (\S+) ou", text),
    )  # fmt: skip


def read_stations(report: str | Path) -> tuple[Station, ...]:
    """Read the exterior orientations with their standard deviations from a report.

    Raises
    ------
    UserError
        When the report prints none.
    """
    found = _stations(_text(Path(report)))
    if not found:
        raise UserError(
            Text("{name} prints no exterior orientations.", name=Path(report).name),
            todo="Give a DBAT report.",
        )
    return found


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as problem:
        raise UserError(
            Text("{name} could not be read.", name=path.name),
            problem.strerror or str(problem),
            "Check the path.",
        ) from problem


def _number(pattern: str, text: str) -> float | None:
    match = re.search(pattern, text)
    try:
        return float(match[1]) if match else None
    except ValueError:
        return None


def _counts(pattern: str, text: str) -> dict[str, int]:
    """Read ``423 (9 IO, 126 EO, 288 OP)``."""
    match = re.search(pattern, text)
    if match is None:
        return {}
    counts = {kind: int(number) for number, kind in re.findall(r"(\d+) ([A-Z]{2})", match[1])}
    whole = re.match(r"\d+", match[1])
    return {"all": int(whole[0]), **counts} if whole else counts


def _cameras(text: str) -> tuple[dict[str, Printed], ...]:
    section = re.search(r"\n {6}Cameras:\n(.*?)\n {6}\S", text, re.DOTALL)
    if section is None:
        return ()
    cameras = []
    for part in re.split(r"\n {9}Camera\d+ ", "\n" + section[1])[1:]:
        items = _items(part)
        cameras.append({INTERIOR[title]: items[title] for title in INTERIOR if title in items})
    return tuple(cameras)


def _items(section: str) -> dict[str, Printed]:
    """Read "title:" lines, each followed by Value, Deviation and Correlations lines."""
    items: dict[str, Printed] = {}
    for match in re.finditer(r"\n +([^:\n]+):\n +Value:([^\n]*)((?:\n +(?:Deviation|Significance|Cumulative|Correl)[^\n]*)*)",
                             section):  # fmt: skip
        title = match[1].split(" - ")[0].strip()
        try:
            items[title] = _printed(match[2], match[3])
        except (ValueError, IndexError):
            continue  # an item that is no number, such as a setting
    return items


def _printed(value: str, rest: str) -> Printed:
    words = value.split()
    sigma = re.search(r"Deviation:\s+(\S+)", rest)
    strong = re.findall(r"(\w+):(-?[\d.]+)%", rest)
    return Printed(
        float(words[0]), float(sigma[1]) if sigma else None, " ".join(words[1:]),
        {name: float(percent) / 100.0 for name, percent in strong},
    )  # fmt: skip


def _stations(text: str) -> tuple[Station, ...]:
    found = []
    for part in re.split(r"\n\s+Photo \d+: ", text)[1:]:
        name, _, rest = part.partition("\n")
        items = _items("\n" + rest)
        if not all(title in items and items[title].sigma is not None for title in EXTERIOR):
            continue
        value = np.array([items[title].value for title in EXTERIOR])
        sigma = np.array([items[title].sigma for title in EXTERIOR], dtype=np.float64)
        found.append(Station(
            name.strip(), np.radians(value[:3]), np.radians(sigma[:3]), value[3:], sigma[3:]
        ))  # fmt: skip
    return tuple(found)
