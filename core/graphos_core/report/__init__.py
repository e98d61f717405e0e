"""The report as data: what was computed, how well, and what to know about it; the keys are documented here.

``report.json`` holds exactly this dictionary; what was not computed is null, or 0 where it is a count:

=====================  ================================================================================================
key                    meaning
=====================  ================================================================================================
``schema``             1
``project``            name of the project
``images``             ``total``; ``oriented``; ``names`` (in order); ``not_oriented[]`` (``name``, ``reason``);
                       ``unusable[]`` (files that could not be read, ``name``, ``reason``)
``cameras[]``          ``label, model, width, height`` (px); ``focal_px``; ``focal_estimated`` (true while the principal
                       distance is a guess that no adjustment improved); ``focal_source``; ``parameters[]`` with
                       ``name, symbol, label, unit, value, sigma`` (sigma null where the parameter was not estimated)
``matching``           ``keypoints`` per photo; ``pairs_tried, pairs_verified``; ``tracks``; ``components`` (photos per
                       group of the image graph, largest first)
``orientation``        ``points``; ``observations`` (image points, two coordinates each); ``reprojection_rms_px``: per
                       coordinate, over all observations of the final model, px of the full photo; ``sigma0_px``: a
                       posteriori standard deviation of unit weight (1 px a priori); ``redundancy``; ``unknowns``;
                       ``mean_rays_per_point``; ``unit`` (``m`` or ``model units``); ``datum``; ``converged``;
                       ``iterations``; ``photos[]`` with ``name``, ``centre``, ``sigma_centre`` (in ``unit``),
                       ``omega_phi_kappa_deg``, ``sigma_rotation_deg``, ``observations``, ``rms_px``
``georeferencing``     ``method``; ``scale`` (m per model unit); ``origin_m`` (add it to coordinates); ``rms_m`` and ``check_rms_m`` per coordinate (null where
                       there are none); ``points[]`` with ``name, check, residual_m``
``dense``              ``points``; ``depth_maps``; ``unit``
``quality``            internal ``figures``; ``advice[]``; ``comparison`` (``statistics``, ``unit``, ``definition``) or null
``timings_s``          seconds of computing per stage (of an earlier run where the result was taken from the store)
``peak_memory_mb``     largest resident memory of this process; null where the system does not tell
``seed``, ``version``  of the recipe; of the program
``warnings[]``         sentences
=====================  ================================================================================================
"""

from __future__ import annotations

import math
import sys
from typing import Any

import numpy as np

from graphos_core import __version__
from graphos_core.cameras import camera_model
from graphos_core.data import Adjustment, Array, Camera, Georeference
from graphos_core.geometry.rotation import opk_from_matrix
from graphos_core.pipeline import Pipeline
from graphos_core.registry import STAGES
from graphos_core.steps import steps_of
from graphos_core.text import Text

SCHEMA = 1


def build_report(pipeline: Pipeline) -> dict[str, Any]:
    """Return the report of everything that exists for the pipeline's recipe; see the module for the keys."""
    photos = pipeline.photos
    report: dict[str, Any] = {
        "schema": SCHEMA,
        "project": pipeline.project.name,
        "images": {
            "total": len(photos.photos),
            "oriented": 0,
            "names": [p.name for p in photos.photos],
            "not_oriented": [],
            "unusable": [{"name": f.item, "reason": str(f.reason)} for f in photos.failures],
        },
        "cameras": [_camera(camera) for camera in photos.cameras],
        "matching": None,
        "orientation": None,
        "georeferencing": None,
        "dense": {"points": 0, "depth_maps": 0, "unit": None},
        "quality": None,
    }
    matched = pipeline.result("features")
    if matched is not None:
        report["matching"] = _matching(matched)
    adjusted = pipeline.result("adjustment")
    if adjusted is not None:
        block = adjusted.adjustment.block
        report["images"]["oriented"] = int(block.oriented.sum())
        report["images"]["not_oriented"] = [{"name": f.item, "reason": str(f.reason)} for f in block.failures]
        report["cameras"] = [_camera(camera) for camera in block.cameras]
        report["orientation"] = _orientation(adjusted.adjustment)
        report["georeferencing"] = _georeferencing(adjusted.georeference)
    dense = pipeline.result("dense")
    if dense is not None:
        report["dense"] = {
            "points": len(dense.cloud.points), "depth_maps": len(dense.maps), "unit": dense.cloud.unit,
        }  # fmt: skip
    quality = pipeline.result("quality")
    if quality is not None:
        report["quality"] = _quality(quality)
    report["timings_s"] = _timings(pipeline)
    report["peak_memory_mb"] = peak_memory_mb()
    report["seed"] = pipeline.recipe.seed
    report["version"] = __version__
    report["warnings"] = _warnings(pipeline)
    return plain(report)


def plain(value: Any) -> Any:
    """Return `value` with only what JSON knows: numpy becomes plain, NaN and infinity become null."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def peak_memory_mb() -> float | None:
    """Return the largest resident memory of this process so far, MB; None where the system does not tell."""
    try:
        import resource
    except ImportError:
        return None
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(used / (1e6 if sys.platform == "darwin" else 1e6 / 1024), 1)


def _camera(camera: Camera) -> dict[str, Any]:
    model = camera_model(camera.model)
    sigmas = camera.sigmas if camera.sigmas is not None else np.zeros(len(camera.values))
    return {
        "label": camera.label,
        "model": camera.model,
        "width": camera.width,
        "height": camera.height,
        "focal_px": camera.focal_px,
        "focal_estimated": camera.focal_estimated,
        "focal_source": camera.focal_source,
        "parameters": [
            {"name": p.name, "symbol": p.symbol, "label": p.label, "unit": p.unit, "value": value,
             "sigma": sigma if sigma > 0 else None}
            for p, value, sigma in zip(model.parameters, camera.values, sigmas, strict=True)
        ],
    }  # fmt: skip


def _matching(matched: Any) -> dict[str, Any]:
    return {
        "keypoints": [len(f.xy) for f in matched.features],
        "pairs_tried": len(matched.pairs),
        "pairs_verified": sum(1 for pair in matched.pairs if not pair.reason),
        "tracks": matched.tracks.count,
        "components": [len(c) for c in matched.tracks.components],
    }


def _orientation(adjustment: Adjustment) -> dict[str, Any]:
    block = adjustment.block
    points = len(np.unique(block.obs_point))
    photos = []
    for i in np.flatnonzero(block.oriented):
        mine = block.obs_photo == i
        residuals = adjustment.residuals[mine]
        photos.append({
            "name": block.names[i],
            "centre": block.centres[i],
            "sigma_centre": adjustment.sigma_centres[i],
            "omega_phi_kappa_deg": np.degrees(opk_from_matrix(block.rotations[i])),
            "sigma_rotation_deg": np.degrees(adjustment.sigma_rotations[i]),
            "observations": int(mine.sum()),
            "rms_px": rms(residuals),
        })  # fmt: skip
    return {
        "points": points,
        "observations": len(block.obs_xy),
        "reprojection_rms_px": adjustment.rms_px,
        "sigma0_px": adjustment.sigma0_px,
        "redundancy": adjustment.redundancy,
        "unknowns": adjustment.unknowns,
        "mean_rays_per_point": len(block.obs_xy) / points if points else 0.0,
        "unit": block.unit,
        "datum": adjustment.datum,
        "converged": adjustment.converged,
        "iterations": len(adjustment.iterations),
        "photos": photos,
    }


def rms(values: Array) -> float:
    """Return the root mean square per coordinate; NaN of nothing."""
    return float(np.sqrt(np.mean(np.square(values)))) if np.size(values) else math.nan


def _georeferencing(found: Georeference) -> dict[str, Any]:
    return {
        "method": found.method,
        "scale": found.scale,
        "origin_m": found.origin,
        "rms_m": found.rms_m,
        "check_rms_m": found.check_rms_m,
        "points": [
            {"name": name, "check": bool(check), "residual_m": residual}
            for name, check, residual in zip(found.names, found.check, found.residuals, strict=True)
        ],
    }


def _quality(found: Any) -> dict[str, Any]:
    comparison = None
    if found.comparison is not None:
        c = found.comparison
        comparison = {"statistics": c.statistics, "unit": c.unit, "definition": str(c.definition)}
    return {"figures": found.figures, "advice": [str(a) for a in found.advice], "comparison": comparison}


def _timings(pipeline: Pipeline) -> dict[str, float]:
    timings: dict[str, float] = {}
    for stage in STAGES:
        steps = [step for step in steps_of(stage) if pipeline.has(step.name)]
        if steps:
            timings[stage] = round(sum(pipeline.about(step.name).get("seconds", 0.0) for step in steps), 3)
    return timings


def _warnings(pipeline: Pipeline) -> list[str]:
    found: list[str] = []
    for camera in pipeline.photos.cameras:
        if camera.focal_estimated:
            found.append(Text(
                "The principal distance of {label} is an estimate: {source}", label=camera.label or "the camera",
                source=camera.focal_source))  # fmt: skip
    for failure in pipeline.photos.failures:
        found.append(Text("{item} is not used: {reason}", item=failure.item, reason=failure.reason))
    for stage in STAGES:
        for step in steps_of(stage):
            if pipeline.has(step.name):
                found.extend(pipeline.about(step.name).get("warnings", []))
    return list(dict.fromkeys(str(f) for f in found))
