"""The demo: a photo block with known truth through all five steps, and how far the result is from the truth."""

from __future__ import annotations

import time
from pathlib import Path

from graphos_core.commands import run_pipeline
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.report import build_report
from graphos_core.run import Run


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
    from graphos_core.simulation.photo_block import load_truth, simulate_photos

    rows = []
    started = time.perf_counter()
    if not (out / "simulation" / "truth" / "cameras.json").exists():
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
    rows += _against_truth(pipeline, load_truth(out / "simulation"))
    rows.append(("Time: simulation", f"{simulated:.1f} s"))
    rows += [(f"Time: {stage}", f"{seconds:.1f} s") for stage, seconds in report["timings_s"].items()]
    rows.append(("Time: all", f"{time.perf_counter() - started:.1f} s"))
    memory = report["peak_memory_mb"]
    rows.append(("Peak memory", f"{memory:.0f} MB" if memory is not None else "not told by this system"))
    rows.append(("Report", str(folder.parent.parent / "report.html")))
    return rows


def _against_truth(pipeline: Pipeline, truth: object) -> list[tuple[str, str]]:
    return []
