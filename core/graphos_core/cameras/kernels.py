"""Compiled projection for every camera model: one dispatch, used by adjustment, simulation and dense matching.

The distortion-free and the basic camera are inlined, every other model is called by the address of its entry.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.cameras import basic, pinhole
from graphos_core.cameras.entry import call_entry
from graphos_core.data.record import Array

MAX_VALUES = 72
"""Bound of the number of parameters of any model: safe size of a scratch array in kernels."""

_pinhole = pinhole.kernel
_basic = basic.kernel


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def project(
    code: int, values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array
) -> bool:
    """Project one point of the camera frame with the model `code`; see `graphos_core.cameras.model`.

    Inlined into its callers. The arrays must be contiguous float64; ``d_values`` may have more columns than the model
    has parameters, never fewer.
    """
    if code == 0:
        return _pinhole(values, x, y, z, pixel, d_point, d_values)
    if code == 1:
        return _basic(values, x, y, z, pixel, d_point, d_values)
    return call_entry(code, values, x, y, z, pixel, d_point, d_values) != 0


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
def differentiate_many(code: int, values: Array, points: Array) -> tuple[Array, Array, Array]:
    """Project (n, 3) points with derivatives: (n, 2) pixels, (n, 2, 3) by the point and (n, 2, k) by the values.

    NaN where there is no image.
    """
    n = points.shape[0]
    pixels = np.empty((n, 2))
    by_point = np.empty((n, 2, 3))
    by_values = np.empty((n, 2, values.shape[0]))
    for i in range(n):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        if not project(code, values, x, y, z, pixels[i], by_point[i], by_values[i]):
            for a in range(2):
                pixels[i, a] = np.nan
                for k in range(3):
                    by_point[i, a, k] = np.nan
                for k in range(values.shape[0]):
                    by_values[i, a, k] = np.nan
    return pixels, by_point, by_values


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


@njit(cache=True, nogil=True)
def unproject_wide(code: int, values: Array, pixels: Array, start: Array) -> Array:
    """Invert `project_many` on the unit sphere, where a field of 180° and more has no singular direction.

    Newton's method in the tangent plane of the current direction, with step halving; ``start`` (n, 3) unit directions.
    The tangent basis is that of Duff et al. 2017, Building an orthonormal basis, revisited (right-handed with the
    direction), so the determinant changes its sign where the distortion folds the picture.
    """
    n = pixels.shape[0]
    out = np.full((n, 3), np.nan)
    pixel = np.empty(2)
    d_point = np.empty((2, 3))
    d_values = np.empty((2, values.shape[0]))
    d = np.empty(3)
    new = np.empty(3)
    for i in range(n):
        d[:] = start[i]
        new[:] = start[i]
        su = 0.0
        sv = 0.0
        last = np.inf
        for _ in range(60):
            seen = project(code, values, new[0], new[1], new[2], pixel, d_point, d_values)
            ex = pixels[i, 0] - pixel[0]
            ey = pixels[i, 1] - pixel[1]
            error = ex * ex + ey * ey if seen else np.inf
            if error < 1e-20:
                out[i] = new
                break
            side = 1.0 if new[2] >= 0.0 else -1.0
            a = -1.0 / (side + new[2])
            b = new[0] * new[1] * a
            e = (1.0 + side * new[0] * new[0] * a, side * b, -side * new[0])
            g = (b, side + new[1] * new[1] * a, -new[1])
            ue = d_point[0, 0] * e[0] + d_point[0, 1] * e[1] + d_point[0, 2] * e[2]
            ug = d_point[0, 0] * g[0] + d_point[0, 1] * g[1] + d_point[0, 2] * g[2]
            ve = d_point[1, 0] * e[0] + d_point[1, 1] * e[1] + d_point[1, 2] * e[2]
            vg = d_point[1, 0] * g[0] + d_point[1, 1] * g[1] + d_point[1, 2] * g[2]
            det = ue * vg - ug * ve
            if error >= last or not det > 0.0:  # overshot, or past the fold: halve the last step
                if last == np.inf or su * su + sv * sv < 1e-26:
                    if error < 1e-16:
                        out[i] = new
                    break
                su *= 0.5
                sv *= 0.5
            else:
                last = error
                d[:] = new
                p = e
                q = g
                su = (vg * ex - ug * ey) / det
                sv = (ue * ey - ve * ex) / det
            for k in range(3):
                new[k] = d[k] + su * p[k] + sv * q[k]
            new /= np.sqrt(new[0] ** 2 + new[1] ** 2 + new[2] ** 2)
    return out
