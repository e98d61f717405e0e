"""Significance of the parameters of a self-calibration, and their correlations."""

from __future__ import annotations

import numpy as np
from scipy import stats

from graphos_core.cameras import camera_model
from graphos_core.data import Adjustment, Array, Significance

INTERIOR = ("focal_px", "x0", "y0")
"""Tested against nothing: a camera has a principal distance and point whatever their values."""


def correlations(covariance: Array) -> Array:
    """Return the correlation matrix of a covariance matrix (k, k); 0 where a variance is 0."""
    sigma = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    safe = np.where(sigma > 0, sigma, 1.0)
    return np.asarray(covariance / safe[:, None] / safe)


def significance(adjustment: Adjustment, alpha: float) -> tuple[Significance, ...]:
    """Test every estimated additional parameter against zero (Student's t, two-sided).

    The principal distance and point are listed with their correlations and are significant by definition.

    Parameters
    ----------
    adjustment : Adjustment
        With covariances.
    alpha : float
        Error probability.
    """
    if adjustment.covariance is None:
        return ()
    limit = float(stats.t.isf(alpha / 2.0, max(adjustment.redundancy, 1)))
    out = []
    for c, camera in enumerate(adjustment.block.cameras):
        matrix = correlations(adjustment.covariance.cameras[c])
        names = camera_model(camera.model).names
        for i, name in enumerate(names):
            sigma = 0.0 if camera.sigmas is None else float(camera.sigmas[i])
            if sigma <= 0.0:
                continue
            others = np.abs(matrix[i])
            others[i] = 0.0
            most = int(np.argmax(others))
            alone = others[most] == 0.0
            value = float(camera.values[i])
            t = abs(value) / sigma
            out.append(Significance(
                camera=c, parameter=name, value=value, sigma=sigma, t=t, limit=limit,
                significant=name in INTERIOR or t > limit, correlation=0.0 if alone else float(matrix[i, most]),
                correlated_with="" if alone else names[most],
            ))  # fmt: skip
    return tuple(out)
