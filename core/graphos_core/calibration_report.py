"""The report of a calibration with a test field: as data (``report.json``) and as one self-contained page.

``report.json`` has the keys ``schema, kind, project, made, images, cameras[], orientation, warnings[], seed, version,
peak_memory_mb`` with the meanings of `graphos_core.report`, and beside them:

=====================  ================================================================================================
key                    meaning
=====================  ================================================================================================
``kind``               ``"calibration"``
``cameras[]``          also ``photos`` used, ``coverage`` (share of the parts of the format with points), ``largest_tilt_deg``
                       (largest angle between viewing axes), ``largest_roll_deg``, ``depth_ratio`` (largest over smallest
                       depth of a point)
``target``             the parameters that were given, ``points`` of the board, ``dictionary``, ``circle_mm``
``detection``          ``photos`` with the target, ``points`` measured, ``sigma_px`` (median over points, from grey values),
                       ``rejected`` points
``board``              null, or how it differs from its drawing: ``flatness_mm`` (root mean square out of the plane),
                       ``in_plane_mm`` (per coordinate), ``largest_mm``, ``statistic``, ``limit``, ``agrees``, ``free``
=====================  ================================================================================================
"""

from __future__ import annotations

from importlib import resources
from typing import Any

import jinja2
import numpy as np

from graphos_core import __version__
from graphos_core.adjustment.bundle.self_calibration import largest_roll
from graphos_core.adjustment.calibration.calibrate import CalibrateParams, Calibration
from graphos_core.adjustment.calibration.findings import coverage, depth_range, largest_tilt, photo_rms
from graphos_core.calibration_pictures import calibration_pictures
from graphos_core.cameras import camera_model
from graphos_core.data import PhotoSet
from graphos_core.geometry.rotation import opk_from_matrix
from graphos_core.number_format import format_value
from graphos_core.report import SCHEMA, peak_memory_mb, plain


def calibration_report(
    name: str, found: Calibration, photos: PhotoSet, params: CalibrateParams, *, seed: int, made: str
) -> dict[str, Any]:
    """Return the report of a calibration; see the module for the keys."""
    result, block = found.adjustment, found.adjustment.block
    used = np.unique(block.camera_of_photo[block.oriented])
    finite = found.sigma_detection[np.isfinite(found.sigma_detection)]
    return plain({
        "schema": SCHEMA,
        "kind": "calibration",
        "project": name,
        "made": made,
        "images": {
            "total": len(photos.photos),
            "oriented": int(block.oriented.sum()),
            "names": list(block.names),
            "not_oriented": [{"name": f.item, "reason": str(f.reason)} for f in block.failures],
            "unusable": [{"name": f.item, "reason": str(f.reason)} for f in photos.failures],
        },
        "cameras": [_camera(found, int(c)) for c in used],
        "orientation": _orientation(found),
        "target": {
            **params.to_dict(), "points": len(block.points), "dictionary": found.dictionary,
            "circle_mm": found.circle_mm or None,
        },
        "detection": {
            "photos": int(block.oriented.sum()), "points": len(block.obs_xy),
            "sigma_px": float(np.median(finite)) if len(finite) else None, "rejected": found.rejected,
        },
        "board": _board(found, params),
        "unit": block.unit,
        "sigma0_px": result.sigma0_px,
        "warnings": [str(f) for f in found.findings],
        "peak_memory_mb": peak_memory_mb(),
        "seed": seed,
        "version": __version__,
    })  # fmt: skip


def _camera(found: Calibration, c: int) -> dict[str, Any]:
    block = found.adjustment.block
    camera = block.cameras[c]
    model = camera_model(camera.model)
    sigmas = camera.sigmas if camera.sigmas is not None else np.zeros(len(camera.values))
    return {
        "label": camera.label, "model": camera.model, "width": camera.width, "height": camera.height,
        "focal_px": camera.focal_px, "focal_estimated": camera.focal_estimated,
        "focal_source": str(camera.focal_source),
        "parameters": [
            {"name": p.name, "symbol": p.symbol, "label": p.label, "unit": p.unit, "value": value,
             "sigma": sigma if sigma > 0 else None}
            for p, value, sigma in zip(model.parameters, camera.values, sigmas, strict=True)
        ],
        "photos": int((block.oriented & (block.camera_of_photo == c)).sum()),
        "coverage": float((coverage(block, c) > 0).mean()),
        "largest_tilt_deg": float(np.degrees(largest_tilt(block, c))),
        "largest_roll_deg": float(np.degrees(largest_roll(block, c))),
        "depth_ratio": depth_range(block, c),
    }  # fmt: skip


def _orientation(found: Calibration) -> dict[str, Any]:
    result, block = found.adjustment, found.adjustment.block
    rms = photo_rms(result)
    counts = np.bincount(block.obs_photo, minlength=len(block.names))
    return {
        "points": len(block.points), "observations": len(block.obs_xy), "reprojection_rms_px": result.rms_px,
        "sigma0_px": result.sigma0_px, "redundancy": result.redundancy, "unknowns": result.unknowns,
        "mean_rays_per_point": len(block.obs_xy) / len(block.points), "unit": block.unit, "datum": str(result.datum),
        "converged": result.converged, "iterations": len(result.iterations),
        "photos": [
            {"name": block.names[i], "centre": block.centres[i], "sigma_centre": result.sigma_centres[i],
             "omega_phi_kappa_deg": np.degrees(opk_from_matrix(block.rotations[i])),
             "sigma_rotation_deg": np.degrees(result.sigma_rotations[i]), "observations": int(counts[i]),
             "rms_px": float(rms[i])}
            for i in np.flatnonzero(block.oriented)
        ],
    }  # fmt: skip


def _board(found: Calibration, params: CalibrateParams) -> dict[str, Any] | None:
    shape = found.board
    if shape is None:
        return None
    return {
        "flatness_mm": 1000 * shape.flatness_m, "in_plane_mm": 1000 * shape.in_plane_m,
        "largest_mm": 1000 * float(np.linalg.norm(shape.deviations, axis=1).max()), "statistic": shape.statistic,
        "limit": shape.limit, "agrees": shape.agrees, "free": params.free_board,
    }  # fmt: skip


def calibration_html(report: dict[str, Any], found: Calibration) -> str:
    """Return the page for a report from `calibration_report`."""
    template = resources.files("graphos_resources").joinpath("report/calibration.html.j2").read_text("utf-8")
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters["number"] = format_value
    problems = report["warnings"] + [
        f"{f['name']}: {f['reason']}" for f in report["images"]["not_oriented"] + report["images"]["unusable"]
    ]
    return environment.from_string(template).render(
        r=report,
        problems=problems,
        tiles=_tiles(report),
        pictures=calibration_pictures(found),
        cameras=[_camera_rows(camera) for camera in report["cameras"]],
        photos=[_photo_row(photo) for photo in report["orientation"]["photos"]],
    )


def _tiles(report: dict[str, Any]) -> list[dict[str, str]]:
    focal = report["cameras"][0]["parameters"][0]
    tiles = [
        ("principal distance f ± σ", format_value(focal["value"], focal["sigma"], "px")),
        ("reprojection RMS per coordinate", format_value(report["orientation"]["reprojection_rms_px"], unit="px", digits=3)),
        ("photos with the target", f"{report['images']['oriented']} of {report['images']['total']}"),
        ("of the format covered by points", format_value(100 * report["cameras"][0]["coverage"], unit="%", digits=3)),
        ("largest angle between viewing axes", format_value(report["cameras"][0]["largest_tilt_deg"], unit="°", digits=3)),
    ]  # fmt: skip
    return [{"label": label, "value": value} for label, value in tiles]


def _camera_rows(camera: dict[str, Any]) -> dict[str, Any]:
    return {
        "label": camera["label"] or "Camera",
        "line": f"Model {camera['model']}, {camera['width']} × {camera['height']} px, {camera['photos']} photos; largest "
        f"angle between viewing axes {camera['largest_tilt_deg']:.0f}°, largest roll {camera['largest_roll_deg']:.0f}°, "
        f"depth {camera['depth_ratio']:.1f} : 1, {100 * camera['coverage']:.0f} % of the format covered.",
        "rows": [
            {"label": p["label"], "symbol": p["symbol"].replace("_", ""),
             "value": format_value(p["value"], p["sigma"], p["unit"], digits=6) + ("" if p["sigma"] else " (held fixed)")}
            for p in camera["parameters"]
        ],
    }  # fmt: skip


def _photo_row(photo: dict[str, Any]) -> list[str]:
    cells = [photo["name"]]
    for value, sigma in zip(photo["centre"], photo["sigma_centre"], strict=True):
        cells.append(format_value(1000 * value, None if sigma is None else 1000 * sigma))
    sigma = max((s for s in photo["sigma_rotation_deg"] if s is not None), default=0.0)
    cells += [format_value(angle, sigma) for angle in photo["omega_phi_kappa_deg"]]
    return [*cells, format_value(photo["observations"]), format_value(photo["rms_px"], digits=2)]
