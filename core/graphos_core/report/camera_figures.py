"""Cameras as figures: parameters with σ and significance, correlations, distortion profiles, uncertainty."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.cameras.profile import Profile, balanced_profile, projection_covariance, radial_profile
from graphos_core.data import Adjustment, Array, Camera, Significance
from graphos_core.text import Text

RADII = 41
"""Radii of the stored profile: from 0 to the farthest corner."""

COLUMNS = 13
"""Positions along the longer side of the format at which the projection uncertainty is given."""


def camera(camera: Camera, index: int = 0, adjustment: Adjustment | None = None) -> dict[str, Any]:
    """Return one entry of the part ``cameras``."""
    model = camera_model(camera.model)
    sigmas = camera.sigmas if camera.sigmas is not None else np.zeros(len(camera.values))
    tests = (
        {} if adjustment is None else {s.parameter: s for s in adjustment.significance if s.camera == index}
    )
    return {
        "label": camera.label,
        "model": camera.model,
        "model_label": model.label,
        "direction": model.direction,
        "width": camera.width,
        "height": camera.height,
        "pixel_pitch_mm": camera.pixel_pitch_mm,
        "focal_px": camera.focal_px,
        "focal_estimated": camera.focal_estimated,
        "focal_source": camera.focal_source,
        "pre_corrections": [c.label or camera_model(c.model).label for c in camera.before],
        "parameters": [
            {"name": p.name, "symbol": p.symbol, "label": p.label, "unit": p.unit, "value": value,
             "sigma": sigma if sigma > 0 else None, "reason": p.reason if not sigma > 0 else "",
             **_test(tests.get(p.name))}
            for p, value, sigma in zip(model.parameters, camera.values, sigmas, strict=True)
        ],
        "correlations": None if adjustment is None else correlations(camera, index, adjustment),
        "profile": None if adjustment is None else profile(camera, _covariance(index, adjustment)),
        "projection_uncertainty": None if adjustment is None
        else projection_uncertainty(camera, _covariance(index, adjustment)),
    }  # fmt: skip


def _covariance(index: int, adjustment: Adjustment) -> Array | None:
    if adjustment.covariance is None:
        return None
    found = np.asarray(adjustment.covariance.cameras[index])
    return found if found.any() else None


def profile(camera: Camera, covariance: Array | None) -> dict[str, Any] | None:
    """Return the Gaussian and the balanced profile with σ; None for a panorama, which no lens drew as a whole."""
    if camera_model(camera.model).projection == "spherical":
        return None
    gaussian = radial_profile(camera, covariance)
    step = max(1, (len(gaussian.radius_px) - 1) // (RADII - 1))
    return {
        "radius_px": gaussian.radius_px[::step],
        "gaussian": _curve(gaussian, step),
        "balanced": _curve(balanced_profile(camera, covariance), step),
        "note": Text(
            "Radial distortion: measured minus ideal distance of an image point from the principal point, mean over all "
            "directions. Gaussian: with the principal distance as it is. Balanced: the principal distance takes up what "
            "makes it 0 at two thirds of half the diagonal. Both describe the same camera."
        ),
    }


def _curve(found: Profile, step: int) -> dict[str, Any]:
    sigma = None if found.sigma_px is None else found.sigma_px[::step]
    return {"focal_px": found.focal_px, "shift_px": found.displacement_px[::step], "sigma_px": sigma}


def projection_uncertainty(camera: Camera, covariance: Array | None) -> dict[str, Any] | None:
    """Return the largest semi-axis of the error ellipse of an image point over the format; None without covariance."""
    if covariance is None or camera.width <= 0 or camera.height <= 0:
        return None
    long = max(camera.width, camera.height)
    columns, rows = (max(3, round((COLUMNS - 1) * side / long) + 1) for side in (camera.width, camera.height))
    pixels, spread = projection_covariance(camera, covariance, (columns, rows))
    sigma = np.full((rows, columns), np.nan)
    good = np.isfinite(spread).all(axis=(2, 3))
    sigma[good] = np.sqrt(np.maximum(np.linalg.eigvalsh(spread[good])[:, -1], 0.0))
    return {
        "columns_px": pixels[0, :, 0],
        "rows_px": pixels[:, 0, 1],
        "sigma_px": sigma,
        "note": Text(
            "Standard deviation, in px, of where the calibration images a given ray (largest semi-axis of the error "
            "ellipse), from the middle of the format to its corners. It holds for a use of this calibration elsewhere; in "
            "the block itself the orientations take part of it up."
        ),
    }


def _test(found: Significance | None) -> dict[str, Any]:
    if found is None:
        return dict.fromkeys(("t", "limit", "significant", "correlation", "correlated_with"))
    return {
        "t": found.t, "limit": found.limit, "significant": found.significant, "correlation": found.correlation,
        "correlated_with": found.correlated_with,
    }  # fmt: skip


def correlations(camera: Camera, index: int, adjustment: Adjustment) -> dict[str, Any] | None:
    """Return ``names, symbols, matrix`` of the estimated parameters of a camera; None with fewer than two."""
    if adjustment.covariance is None:
        return None
    covariance = adjustment.covariance.cameras[index]
    sigma = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    free = np.flatnonzero(sigma > 0)
    if len(free) < 2:
        return None
    parameters = camera_model(camera.model).parameters
    matrix = covariance[np.ix_(free, free)] / np.outer(sigma[free], sigma[free])
    return {
        "names": [parameters[i].name for i in free], "symbols": [parameters[i].symbol for i in free],
        "matrix": np.round(matrix, 4),
    }  # fmt: skip
