"""Calibrations in a lab: made with the student's own or simulated photos of a test field, kept in the lab's folder."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from graphos_core.adjustment.calibration.calibrate import CalibrateParams
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.photo_files import list_photo_files
from graphos_core.run import Run
from graphos_core.text import Text
from graphos_didactic.lab_figures import READING, Figure

SELECTIONS: dict[str, str] = {
    "all": "all photos",
    "even": "every second photo, beginning with the second",
    "odd": "every second photo, beginning with the first",
    "facing": "the half of the photos that looks at the board most directly",
}
"""Choices of photos by name, in words."""
FEWEST = 3


@dataclass(frozen=True)
class Bench:
    """Where a student calibrates.

    Attributes
    ----------
    folder : Path
        Of the lab; each calibration gets ``calibrations/SELECTION``.
    photos : Path
        Folder of the photos.
    target : TargetParams
        The test field they show.
    truth : Camera or None
        The true camera of simulated photos.
    """

    folder: Path
    photos: Path
    target: TargetParams
    truth: Camera | None

    def place(self, selection: str) -> Path:
        """Return the folder of one calibration."""
        return self.folder / "calibrations" / selection

    def report(self, selection: str) -> dict[str, Any] | None:
        """Return the report of one calibration; None where it was not made or cannot be read."""
        try:
            found: dict[str, Any] = json.loads((self.place(selection) / "report.json").read_text("utf-8"))
        except (OSError, ValueError):
            return None
        return found if found.get("cameras") and found.get("orientation") else None

    def calibrate(self, selection: str, model: str, run: Run) -> dict[str, Any]:
        """Calibrate with a choice of the photos, write everything, and return the report.

        Raises
        ------
        UserError
            When the target is not found, photos are too few, or all have to be calibrated first.
        Stopped
        """
        from graphos_core.calibrate_command import calibrate_folder

        params = CalibrateParams.from_dict(self.target.to_dict() | {"calibration": model})
        files = self._chosen(selection)
        return calibrate_folder(files, self.place(selection), params, run=run)

    def _chosen(self, selection: str) -> list[Path]:
        files = list_photo_files(self.photos)
        if selection == "all":
            return files
        report = self.report("all")
        if report is None:
            raise UserError(
                "All photos have to be calibrated first.", todo="Go back to that step of the lab."
            )
        tilts = {p["name"]: tilt_deg(p["omega_phi_kappa_deg"]) for p in report["orientation"]["photos"]}
        seen = [f for f in files if f.name in tilts]
        if selection == "facing":
            nearest = sorted(seen, key=lambda f: tilts[f.name])
            return sorted(nearest[: max(FEWEST, len(seen) // 2)])
        return seen[(1 if selection == "even" else 0) :: 2]


def tilt_deg(omega_phi_kappa_deg: list[float]) -> float:
    """Return the angle between the viewing axis and the normal of the board, degrees."""
    omega, phi = (math.radians(a) for a in omega_phi_kappa_deg[:2])
    return math.degrees(math.acos(min(1.0, abs(math.cos(omega) * math.cos(phi)))))


def calibration_line(report: dict[str, Any], selection: str) -> Text:
    """Say in a line what a calibration found."""
    focal = report["cameras"][0]["parameters"][0]
    return Text(
        "Calibrated with {what}: {n} photos with the target, f = {f:.2f} ± {s:.2f} px, reprojection RMS {rms:.3f} px.",
        what=SELECTIONS[selection], n=report["images"]["oriented"], f=focal["value"], s=focal["sigma"] or 0.0,
        rms=report["orientation"]["reprojection_rms_px"],
    )  # fmt: skip


BenchFigure = Callable[[Bench], Figure | None]


def _parameter(selection: str, name: str, label: str, unit: str) -> BenchFigure:
    def figure(bench: Bench) -> Figure | None:
        found = _value(bench, selection, name)
        if found is None:
            return None
        true = None
        if bench.truth is not None:
            names = [p["name"] for p in (bench.report(selection) or {})["cameras"][0]["parameters"]]
            values = bench.truth.values
            true = float(values[names.index(name)]) if names.index(name) < len(values) else None
        return Figure(label, found[0], found[1], unit, true)

    return figure


def _value(bench: Bench, selection: str, name: str) -> tuple[float, float] | None:
    report = bench.report(selection)
    if report is None:
        return None
    for parameter in report["cameras"][0]["parameters"]:
        if parameter["name"] == name:
            return float(parameter["value"]), float(parameter["sigma"] or 0.0)
    return None


def _halves(bench: Bench) -> Figure | None:
    even, odd = (_value(bench, half, "focal_px") for half in ("even", "odd"))
    if even is None or odd is None:
        return None
    sigma = math.hypot(even[1], odd[1])
    return Figure("difference of f between the two halves", even[0] - odd[0], sigma, "px", 0.0)


def _sigma_ratio(bench: Bench) -> Figure | None:
    facing, whole = (_value(bench, s, "focal_px") for s in ("facing", "all"))
    if facing is None or whole is None or not whole[1] > 0:
        return None
    ratio = facing[1] / whole[1]
    return Figure("σ of f with facing photos over σ with all", ratio, READING * ratio, "")


def _sigma(selection: str) -> BenchFigure:
    def figure(bench: Bench) -> Figure | None:
        found = _value(bench, selection, "focal_px")
        return None if found is None else Figure("standard deviation of f", found[1], 0.0, "px")

    return figure


def _of_report(label: str, unit: str, read: Callable[[dict[str, Any]], float]) -> BenchFigure:
    def figure(bench: Bench) -> Figure | None:
        report = bench.report("all")
        return None if report is None else Figure(label, float(read(report)), 0.0, unit)

    return figure


CALIBRATION_FIGURES: dict[str, BenchFigure] = {
    "calibrated_f": _parameter("all", "focal_px", "principal distance", "px"),
    "calibrated_x0": _parameter("all", "x0", "principal point x", "px"),
    "calibrated_k1": _parameter("all", "k1", "radial distortion k1", ""),
    "calibrated_sigma_f": _sigma("all"),
    "calibrated_rms": _of_report("reprojection RMS", "px", lambda r: r["orientation"]["reprojection_rms_px"]),
    "calibrated_photos": _of_report("photos with the target", "photos", lambda r: r["images"]["oriented"]),
    "calibrated_coverage": _of_report("coverage of the format", "%", lambda r: 100.0 * r["cameras"][0]["coverage"]),
    "facing_f": _parameter("facing", "focal_px", "principal distance from facing photos", "px"),
    "facing_sigma_f": _sigma("facing"),
    "facing_sigma_ratio": _sigma_ratio,
    "halves_f": _halves,
}  # fmt: skip
"""Every figure of a calibration by the name that labs use."""
