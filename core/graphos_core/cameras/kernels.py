"""Compiled projection for every camera model: one dispatch, used by adjustment, simulation and dense matching."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.cameras import basic, pinhole
from graphos_core.data.record import Array

MAX_VALUES = 5
"""Largest number of parameters of any model; size of scratch arrays in kernels."""

_pinhole = pinhole.kernel
_basic = basic.kernel


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def project(
    code: int, values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array
) -> bool:
    """Project one point of the camera frame with the model `code`; see `graphos_core.cameras.model`.

    Inlined into its callers: a call that passes arrays costs ten times the projection itself.
    """
    if code == 0:
        return _pinhole(values, x, y, z, pixel, d_point, d_values)
    return _basic(values, x, y, z, pixel, d_point, d_values)


@njit(cache=True, nogil=True)
def project_many(code: int, values: Array, points: Array) -> Array:
    """Project (n, 3) points of the camera frame; (n, 2) pixels, NaN where there is no image."""
    n = points.shape[0]
    out = np.empty((n, 2))
    d_point = np.empty((2, 3))
    d_values = np.empty((2, values.shape[0]))
    for i in range(n):
        if not project(code, values, points[i, 0], points[i, 1], points[i, 2], out[i], d_point, d_values):
            out[i, 0] = np.nan
            out[i, 1] = np.nan
    return out


@njit(cache=True, nogil=True)
def unproject_many(code: int, values: Array, pixels: Array) -> Array:
    """Invert `project_many` for (n, 2) pixels by Newton's method with step halving; (n, 3) directions."""
    n = pixels.shape[0]
    out = np.empty((n, 3))
    pixel = np.empty(2)
    d_point = np.empty((2, 3))
    d_values = np.empty((2, values.shape[0]))
    for i in range(n):
        u = (pixels[i, 0] - values[1]) / values[0]
        v = (pixels[i, 1] - values[2]) / values[0]
        done = False
        last = np.inf
        su = 0.0
        sv = 0.0
        for _ in range(60):
            project(code, values, u, v, 1.0, pixel, d_point, d_values)
            ex = pixels[i, 0] - pixel[0]
            ey = pixels[i, 1] - pixel[1]
            error = ex * ex + ey * ey
            if error < 1e-20:
                done = True
                break
            if error > last:  # overshot: halve the last step
                su *= 0.5
                sv *= 0.5
                u -= su
                v -= sv
                if su * su + sv * sv < 1e-26:
                    done = error < 1e-16
                    break
                continue
            last = error
            det = d_point[0, 0] * d_point[1, 1] - d_point[0, 1] * d_point[1, 0]
            if det <= 0.0:  # past the fold of the distortion: this pixel has no unique ray
                break
            su = (d_point[1, 1] * ex - d_point[0, 1] * ey) / det
            sv = (d_point[0, 0] * ey - d_point[1, 0] * ex) / det
            u += su
            v += sv
        out[i, 0] = u if done else np.nan
        out[i, 1] = v if done else np.nan
        out[i, 2] = 1.0 if done else np.nan
    return out
