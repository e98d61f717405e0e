"""What a run leaves in its folder: report, recipe, clouds, calibrated cameras of the photos as taken and the orientation in COLMAP's text format.

Every run gets a folder of its own below ``runs``; the files of the newest run are also at the top, where people look
for them. Earlier runs are never touched.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from graphos_core.pipeline import Pipeline
from graphos_core.recipe import Recipe
from graphos_core.report import build_report
from graphos_core.seen_photos import block_as_taken
from graphos_core.store import cannot_write, write_text

COLMAP_FILES = ("cameras.txt", "images.txt", "points3D.txt")


@dataclass(frozen=True)
class PastRun:
    """One finished run.

    Attributes
    ----------
    number : int
    folder : Path
    report : dict
        As in ``report.json``.
    made : str
        ISO date and time, UTC.
    """

    number: int
    folder: Path
    report: dict[str, Any]
    made: str

    def recipe(self) -> Recipe:
        """Read the recipe of this run."""
        return Recipe.load(self.folder / "recipe.toml")


def run_history(project: Any) -> list[PastRun]:
    """Return the finished runs of a project, oldest first; unreadable ones are left out."""
    found = []
    for folder in sorted((project.folder / "runs").glob("[0-9]*")):
        try:
            report = json.loads((folder / "report.json").read_text("utf-8"))
            found.append(PastRun(int(folder.name), folder, report, str(report["made"])))
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            continue
    return found


def write_outputs(pipeline: Pipeline, made: str) -> Path:
    """Write the files of a run; return the run's own folder.

    Parameters
    ----------
    pipeline : Pipeline
        Whatever exists for its recipe is written.
    made : str
        ISO date and time of the run.

    Raises
    ------
    UserError
        When the disk is full or the folder cannot be written.
    """
    from graphos_core.report.sections import report_html

    home = pipeline.project.folder
    folder = _new_folder(home / "runs")
    report = build_report(pipeline) | {"made": made}
    try:
        pipeline.recipe.save(folder / "recipe.toml")
        _write_models(pipeline, folder)
        write_text(folder / "report.html", report_html(report, pipeline))
        write_text(folder / "report.json", json.dumps(report, indent=1, ensure_ascii=False, allow_nan=False))
        _publish(folder, home)
    except OSError as problem:
        raise cannot_write(folder, problem) from problem
    return folder


def _write_models(pipeline: Pipeline, folder: Path) -> None:
    from graphos_core.exchange.calibration_file import write_calibration
    from graphos_core.exchange.colmap import write_colmap
    from graphos_core.exchange.ply import write_ply_cloud

    notes: list[str] = []
    adjusted = pipeline.result("adjustment")
    if adjusted is not None:
        block = adjusted.adjustment.block
        origin = adjusted.georeference.origin
        if np.any(origin):
            notes = [f"coordinates less the local origin {origin[0]:.3f} {origin[1]:.3f} {origin[2]:.3f} m"]
        write_ply_cloud(folder / "sparse.ply", block.points, block.colours, unit=block.unit, comments=notes)
        write_colmap(block, folder / "colmap")
        write_calibration(folder / "cameras.toml", block_as_taken(pipeline, block).cameras)
    dense = pipeline.result("dense")
    if dense is not None:
        cloud = dense.cloud
        normals = cloud.normals if len(cloud.normals) == len(cloud.points) else None
        write_ply_cloud(
            folder / "dense.ply", cloud.points, cloud.colours, normals, unit=cloud.unit, comments=notes
        )


def _new_folder(runs: Path) -> Path:
    numbers = [int(p.name) for p in runs.glob("[0-9]*") if p.name.isdigit()]
    folder = runs / f"{max(numbers, default=0) + 1:04d}"
    try:
        folder.mkdir(parents=True)
    except OSError as problem:
        raise cannot_write(folder, problem) from problem
    return folder


def _publish(folder: Path, home: Path) -> None:
    """Copy the run's files to the top of the project; files that this run did not make are taken away from there.

    They stay in the folder of the run that made them, so nothing is lost and nothing at the top is out of date.
    """
    names = ["report.html", "report.json", "recipe.toml", "sparse.ply", "dense.ply", "cameras.toml"]
    names += [f"colmap/{name}" for name in COLMAP_FILES]
    for name in names:
        source, target = folder / name, home / name
        if not source.exists():
            target.unlink(missing_ok=True)
            continue
        target.parent.mkdir(exist_ok=True)
        temporary = target.with_name(f".{target.name}.part")
        shutil.copyfile(source, temporary)
        temporary.replace(target)


def check_writable(folder: Path) -> None:
    """Raise a `UserError` when `folder` cannot be written, before any work is done."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".graphos-write-test"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as problem:
        raise cannot_write(folder, problem) from problem


__all__ = ["PastRun", "check_writable", "run_history", "write_outputs"]
