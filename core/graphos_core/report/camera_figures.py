"""Cameras as figures: parameters with σ and significance, correlations."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Adjustment, Camera, Significance


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
        "parameters": [
            {"name": p.name, "symbol": p.symbol, "label": p.label, "unit": p.unit, "value": value,
             "sigma": sigma if sigma > 0 else None, **_test(tests.get(p.name))}
            for p, value, sigma in zip(model.parameters, camera.values, sigmas, strict=True)
        ],
        "correlations": None if adjustment is None else correlations(camera, index, adjustment),
    }  # fmt: skip


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
