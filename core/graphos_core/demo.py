"""The demo: a photo block with known truth through all five steps, and how far the result is from the truth."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np

from graphos_core.commands import run_pipeline
from graphos_core.data import Block, Cloud
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.report import build_report
from graphos_core.run import Run
from graphos_core.simulation.comparison import camera_centre_errors, coverage, surface_errors
from graphos_core.simulation.photo_block import simulate_photos
from graphos_core.simulation.truth import Truth, load_truth
from graphos_core.text import Text


def run_demo(out: Path, photos: int, progress: Run) -> list[tuple[str, str]]:
    """Simulate, compute, compare.

    Parameters
    ----------
    out : Path
        Gets ``simulation`` (photos and truth) and ``model`` (the project).
    photos : int
    progress : Run

    Returns
    -------
    list of (str, str)
        Rows of the table: what, and value with unit.
    """
    rows = []
    started = time.perf_counter()
    if not is_simulated(out / "simulation", photos, progress.seed):
        progress.say(Text("Simulating {n} photos of a façade, with known truth …", n=photos))
        simulate_photos("facade", out / "simulation", seed=progress.seed, photos=photos, run=progress)
    simulated = time.perf_counter() - started
    project = Project.create(
        out / "model", out / "simulation" / "photos", name="Demo façade", run=progress,
        control=out / "simulation" / "control.csv", reference="../simulation/truth/mesh.ply", seed=progress.seed,
    )  # fmt: skip
    pipeline = Pipeline(project, Recipe.default(progress.seed))
    folder = run_pipeline(pipeline, "quality", progress)
    report = build_report(pipeline)
    rows.append(("Photos oriented", f"{report['images']['oriented']} of {report['images']['total']}"))
    rows.append(("Reprojection RMS per coordinate", f"{report['orientation']['reprojection_rms_px']:.3f} px"))
    block = pipeline.result("adjustment").adjustment.block
    rows += truth_rows(block, pipeline.result("dense").cloud, load_truth(out / "simulation"))
    rows.append(("Time: simulation", f"{simulated:.1f} s"))
    rows += [(f"Time: {stage}", f"{seconds:.1f} s") for stage, seconds in report["timings_s"].items()]
    rows.append(("Time: all", f"{time.perf_counter() - started:.1f} s"))
    memory = report["peak_memory_mb"]
    rows.append(("Peak memory", f"{memory:.0f} MB" if memory is not None else "not told by this system"))
    rows.append(("Report", str(folder.parent.parent / "report.html")))
    return rows


def is_simulated(folder: Path, photos: int, seed: int) -> bool:
    """Say whether a folder holds a complete block of so many photos made with this seed."""
    try:
        index = json.loads((folder / "truth" / "cameras.json").read_text("utf-8"))
        return bool(index["seed"] == seed and len(index["photos"]) == photos)
    except (OSError, ValueError, KeyError, TypeError):
        return False


def truth_rows(block: Block, cloud: Cloud | None, truth: Truth) -> list[tuple[str, str]]:
    """Return what a comparison with the truth says; the cloud is placed by the camera centres, never by ICP."""
    centres = camera_centre_errors(block, truth)
    rows = [
        ("Camera centres: RMS error after similarity", f"{1000 * centres.rms_m:.2f} mm"),
        ("  as a share of the object distance", f"{100 * centres.relative:.4f} %"),
        ("Rotations: largest error", f"{np.degrees(centres.rotation_errors.max()):.4f}°"),
    ]
    if cloud is None or not len(cloud.points):
        return rows
    points = centres.similarity.apply(cloud.points)
    surface = surface_errors(points, truth.mesh)
    covered = coverage(points, truth, 3.0 * truth.gsd_m)
    gsd = truth.gsd_m
    return [
        *rows,
        ("Ground sampling distance (GSD)", f"{1000 * gsd:.2f} mm"),
        (
            "Surface error: median distance",
            f"{1000 * surface.median_m:.2f} mm = {surface.median_m / gsd:.2f} GSD",
        ),
        ("Surface error: 90 % within", f"{1000 * surface.q90_m:.2f} mm = {surface.q90_m / gsd:.2f} GSD"),
        ("Surface covered at 3 GSD", f"{100 * covered.share:.1f} %"),
    ]
