"""Puts the report together from everything that exists for a recipe; see `graphos_core.report` for the keys."""

from __future__ import annotations

import hashlib
import sys
from typing import Any

from graphos_core import __version__
from graphos_core.data import Adjustment, Georeference, PhotoSet
from graphos_core.pipeline import Pipeline
from graphos_core.registry import STAGES
from graphos_core.report.adjustment_figures import orientation
from graphos_core.report.camera_figures import camera
from graphos_core.report.control_figures import check, control, georeferencing, other_groups
from graphos_core.report.point_figures import object_points
from graphos_core.report.problems import problems, warnings
from graphos_core.report.residual_figures import reliability, residuals
from graphos_core.report.statement import statement
from graphos_core.report.values import plain
from graphos_core.steps import STEPS, steps_of
from graphos_core.text import Text

SCHEMA = 1

PRODUCTS = {
    "sparse.ply": "Object points with colours, PLY",
    "colmap": "Orientation in COLMAP's text format: cameras.txt, images.txt, points3D.txt",
    "dense.ply": "Dense cloud, PLY",
    "recipe.toml": "Every parameter; graphos run --recipe repeats the run",
    "report.json": "This report as data",
}
"""Files beside the report, with what they hold."""


def build_report(pipeline: Pipeline) -> dict[str, Any]:
    """Return the report of everything that exists for the pipeline's recipe; see the package for the keys."""
    photos = pipeline.photos
    report: dict[str, Any] = {
        "schema": SCHEMA,
        "project": pipeline.project.name,
        "data_hash": data_hash(pipeline.project.photo_set),
        "results": {name: pipeline.key(name) for name in STEPS if pipeline.has(name)},
        "images": {
            "total": len(photos.photos),
            "oriented": 0,
            "names": [p.name for p in photos.photos],
            "not_oriented": [],
            "unusable": [{"name": f.item, "reason": str(f.reason)} for f in photos.failures],
        },
        "cameras": [camera(c) for c in photos.cameras],
        "matching": None,
        "orientation": None,
        "object_points": None,
        "residuals": None,
        "reliability": None,
        "georeferencing": None,
        "control": None,
        "check": None,
        "known": [],
        "left_out": [],
        "dense": {"points": 0, "depth_maps": 0, "unit": None},
        "quality": None,
    }
    matched = pipeline.result("features")
    if matched is not None:
        report["matching"] = _matching(matched)
    adjusted = pipeline.result("adjustment")
    if adjusted is not None:
        report |= adjustment_parts(adjusted.adjustment, adjusted.georeference)
        block = adjusted.adjustment.block
        report["images"]["oriented"] = int(block.oriented.sum())
        report["images"]["not_oriented"] = [{"name": f.item, "reason": str(f.reason)} for f in block.failures]
    dense = pipeline.result("dense")
    if dense is not None:
        report["dense"] = {
            "points": len(dense.cloud.points), "depth_maps": len(dense.maps), "unit": dense.cloud.unit,
        }  # fmt: skip
    quality = pipeline.result("quality")
    if quality is not None:
        report["quality"] = _quality(quality)
    report["statement"] = statement(report)
    report["products"] = _products(adjusted is not None, dense is not None)
    report["timings_s"] = _timings(pipeline)
    report["peak_memory_mb"] = peak_memory_mb()
    report["seed"] = pipeline.recipe.seed
    report["version"] = __version__
    report["warnings"] = warnings(pipeline)
    report["problems"] = problems(report, None if adjusted is None else adjusted.adjustment)
    return dict(plain(report))


def adjustment_parts(adjustment: Adjustment, placed: Georeference) -> dict[str, Any]:
    """Return the parts of the report that an adjusted block fills."""
    return {
        "cameras": [camera(c, i, adjustment) for i, c in enumerate(adjustment.block.cameras)],
        "orientation": orientation(adjustment),
        "object_points": object_points(adjustment),
        "residuals": residuals(adjustment),
        "reliability": reliability(adjustment),
        "georeferencing": georeferencing(placed),
        "control": control(adjustment, placed),
        "check": check(adjustment, placed),
        "known": other_groups(adjustment),
        "left_out": left_out(adjustment),
    }


def left_out(adjustment: Adjustment) -> list[dict[str, str]]:
    """Return the parts an adjustment does not fill, each with one line saying why."""
    stored = Text("the stored adjustment has none")
    test = Text("a priori standard deviations that were taken from the residuals cannot be tested by them")
    held = all(c.sigmas is None or not c.sigmas.any() for c in adjustment.block.cameras)
    missing = (
        (Text("Groups of observations"), bool(adjustment.groups), stored),
        (Text("Global test"), adjustment.global_test is not None, test if adjustment.groups else stored),
        (Text("Correlations of the camera parameters"), adjustment.covariance is not None, stored),
        (Text("Reliability"), adjustment.reliability is not None, stored),
        (Text("Significance of the camera parameters"), bool(adjustment.significance) or held, stored),
    )
    return [{"part": str(part), "reason": str(reason)} for part, there, reason in missing if not there]


def data_hash(photos: PhotoSet) -> str:
    """Return a hash of the photos that were used, 16 hexadecimal digits."""
    return hashlib.sha256("".join(p.digest for p in photos.photos).encode()).hexdigest()[:16]


def peak_memory_mb() -> float | None:
    """Return the largest resident memory of this process so far, MB; None where the system does not tell."""
    try:
        import resource
    except ImportError:
        return None
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(used / (1e6 if sys.platform == "darwin" else 1e6 / 1024), 1)


def _matching(matched: Any) -> dict[str, Any]:
    return {
        "keypoints": [len(f.xy) for f in matched.features],
        "pairs_tried": len(matched.pairs),
        "pairs_verified": sum(1 for pair in matched.pairs if not pair.reason),
        "tracks": matched.tracks.count,
        "components": [len(c) for c in matched.tracks.components],
    }


def _quality(found: Any) -> dict[str, Any]:
    comparison = None
    if found.comparison is not None:
        c = found.comparison
        comparison = {"statistics": c.statistics, "unit": c.unit, "definition": str(c.definition)}
    return {"figures": found.figures, "advice": [str(a) for a in found.advice], "comparison": comparison}


def _products(adjusted: bool, dense: bool) -> list[dict[str, str]]:
    there = {"sparse.ply": adjusted, "colmap": adjusted, "dense.ply": dense}
    return [{"file": name, "what": what} for name, what in PRODUCTS.items() if there.get(name, True)]


def _timings(pipeline: Pipeline) -> dict[str, float]:
    timings: dict[str, float] = {}
    for stage in STAGES:
        steps = [step for step in steps_of(stage) if pipeline.has(step.name)]
        if steps:
            timings[stage] = round(sum(pipeline.about(step.name).get("seconds", 0.0) for step in steps), 3)
    return timings
