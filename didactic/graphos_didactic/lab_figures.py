"""The figures a lab can ask for: taken from the student's own results, with the standard deviation where there is one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array, CheckPoints
from graphos_core.pipeline import Pipeline
from graphos_core.simulation.comparison import camera_centre_errors, surface_errors
from graphos_core.simulation.truth import Truth


@dataclass(frozen=True)
class Figure:
    """A number with its standard deviation and unit.

    Attributes
    ----------
    label : str
    value : float
    sigma : float
        Standard deviation; 0 where the number is exact by definition, such as a count.
    unit : str
    truth : float or None
        True value, where the block is simulated and the truth has one.
    """

    label: str
    value: float
    sigma: float
    unit: str
    truth: float | None = None


def figure_text(figure: Figure) -> str:
    """Return value, standard deviation with two digits, and unit: ``"920.24 ± 0.22 px"``."""
    value, sigma = figure.value, figure.sigma
    if sigma > 0:
        decimals = max(0, 1 - math.floor(math.log10(sigma)))
        number = f"{value:.{decimals}f} ± {sigma:.{decimals}f}"
    else:
        number = f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"
    return f"{number} {figure.unit}".rstrip().replace("-", "−")


READING = 0.02
"""How precisely, as a share, a value can be taken from numbers that are shown with two digits."""

Source = Callable[[Pipeline, Truth | None], Figure | None]


def _camera_parameter(label: str, index: int, unit: str) -> Source:
    def figure(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
        found = pipeline.result("adjustment")
        if found is None or len(found.adjustment.block.cameras[0].values) <= index:
            return None
        camera = found.adjustment.block.cameras[0]
        sigma = 0.0 if camera.sigmas is None else float(camera.sigmas[index])
        true = None if truth is None else float(truth.cameras[0].values[index])
        return Figure(label, float(camera.values[index]), sigma, unit, true)

    return figure


def _photos_oriented(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("adjustment")
    if found is None:
        return None
    block = found.adjustment.block
    return Figure("photos oriented", float(block.oriented.sum()), 0.0, "photos", float(len(block.names)))


def _pairs_verified(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("features")
    if found is None:
        return None
    return Figure("verified pairs", float(sum(not p.reason for p in found.pairs)), 0.0, "pairs")


def _tracks(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("features")
    return None if found is None else Figure("tracks", float(found.tracks.count), 0.0, "tracks")


def _sigma0(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("adjustment")
    if found is None:
        return None
    a = found.adjustment
    return Figure("sigma0", a.sigma0_px, a.sigma0_px / math.sqrt(2.0 * max(a.redundancy, 1)), "px")


def _rms(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("adjustment")
    return None if found is None else Figure("reprojection RMS", found.adjustment.rms_px, 0.0, "px")


def _rays(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("adjustment")
    if found is None:
        return None
    block = found.adjustment.block
    return Figure("rays per point", len(block.obs_xy) / max(len(np.unique(block.obs_point)), 1), 0.0, "rays")


def _check_rms(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("adjustment")
    if found is None or not math.isfinite(found.georeference.check_rms_m):
        return None
    return Figure("check point RMS", 1000.0 * found.georeference.check_rms_m, 0.0, "mm")


def _check_points(pipeline: Pipeline) -> CheckPoints | None:
    found = pipeline.result("adjustment")
    if found is None or found.adjustment.check is None or not len(found.adjustment.check.names):
        return None
    points: CheckPoints = found.adjustment.check
    return points if np.isfinite(points.sigmas).all() else None


def _check_accuracy(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    points = _check_points(pipeline)
    if points is None:
        return None
    return Figure("RMS of the check points", 1000.0 * float(np.sqrt((points.residuals**2).mean())), 0.0, "mm")


def _check_precision(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    points = _check_points(pipeline)
    if points is None:
        return None
    variance = points.sigmas**2 + points.given_sigmas**2
    return Figure(
        "standard deviation of the check points", 1000.0 * float(np.sqrt(variance.mean())), 0.0, "mm"
    )


def _check_ratio(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    """Accuracy over precision: 1 when the covariance is right, within the scatter of a root mean square of n values.

    Check points share the errors of the control points, so n is no more than the number of control coordinates.
    """
    points = _check_points(pipeline)
    roles = control_roles(pipeline) if points is not None else None
    if points is None or roles is None:
        return None
    ratio = points.residuals / np.sqrt(points.sigmas**2 + points.given_sigmas**2)
    value = float(np.sqrt((ratio**2).mean()))
    independent = max(1, min(ratio.size, 3 * len(roles[0])))
    return Figure("accuracy over precision", value, 1.0 / math.sqrt(2.0 * independent), "", 1.0)


def control_roles(pipeline: Pipeline) -> tuple[list[str], list[str], float] | None:
    """Return the names of control and of check points, and how much of the extent of all the control points span.

    The share is that of the diagonals of the two boxes, 0 to 1; None where the project has no control points. Points
    that are not measured in two photos count for nothing.
    """
    control, measured = pipeline.project.control()
    if control is None:
        return None
    known: Array = np.array(np.isfinite(control.xyz).all(axis=1), dtype=bool)
    if measured is not None:
        known &= np.bincount(measured.point, minlength=len(known)) >= 2
    used: Array = np.array(known if control.off is None else known & ~np.asarray(control.off), dtype=bool)
    check: Array = np.asarray(control.check)
    held, checked = used & ~check, used & check
    whole = float(np.linalg.norm(np.ptp(control.xyz[known], axis=0))) if known.any() else 0.0
    part = float(np.linalg.norm(np.ptp(control.xyz[held], axis=0))) if held.any() else 0.0
    names = [[n for n, use in zip(control.names, which, strict=True) if use] for which in (held, checked)]
    return names[0], names[1], part / whole if whole > 0 else 0.0


def _centre_error(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("adjustment")
    if found is None or truth is None:
        return None
    errors = camera_centre_errors(found.adjustment.block, truth)
    return Figure("error of the camera centres", 1000.0 * errors.rms_m, 0.0, "mm")


def _surface_error(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    adjusted, dense = pipeline.result("adjustment"), pipeline.result("dense")
    if adjusted is None or dense is None or truth is None:
        return None
    placed = camera_centre_errors(adjusted.adjustment.block, truth).similarity.apply(dense.cloud.points)
    return Figure("median surface error", 1000.0 * surface_errors(placed, truth.mesh).median_m, 0.0, "mm")


def _surface_error_gsd(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = _surface_error(pipeline, truth)
    if found is None or truth is None:
        return None
    return Figure("median surface error", found.value / (1000.0 * truth.gsd_m), 0.0, "GSD")


def _dense_points(pipeline: Pipeline, truth: Truth | None) -> Figure | None:
    found = pipeline.result("dense")
    return (
        None
        if found is None
        else Figure("points of the dense cloud", float(len(found.cloud.points)), 0.0, "points")
    )


FIGURES: dict[str, Source] = {
    "photos_oriented": _photos_oriented,
    "pairs_verified": _pairs_verified,
    "tracks": _tracks,
    "sigma0": _sigma0,
    "reprojection_rms": _rms,
    "rays_per_point": _rays,
    "focal_px": _camera_parameter("principal distance", 0, "px"),
    "x0": _camera_parameter("principal point x", 1, "px"),
    "y0": _camera_parameter("principal point y", 2, "px"),
    "k1": _camera_parameter("radial distortion k1", 3, ""),
    "check_rms": _check_rms,
    "check_accuracy": _check_accuracy,
    "check_precision": _check_precision,
    "check_ratio": _check_ratio,
    "centre_error": _centre_error,
    "surface_error": _surface_error,
    "surface_error_gsd": _surface_error_gsd,
    "dense_points": _dense_points,
}
"""Every figure by the name that labs use."""
