"""Camera models of COLMAP and of OpenCV.

COLMAP: ``src/colmap/sensor/models.h``; origin of pixels in the corner of the first pixel. OpenCV: documentation of
calib3d and of its fisheye namespace; origin in the centre of the first pixel. Both map ideal to measured positions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from graphos_core.data import Array
from graphos_core.exchange.formulas import CORNER, Format, Formula, fisheye, perspective, radial, register

HALF_RADIAN = 0.5
"""Where a fit of the field-of-view model starts."""

Distort = Callable[[Array, Array, Array], Array]
"""``(coefficients, u, v) -> (n, 2)``: distorted normalised coordinates."""


def _opencv(d: Array, u: Array, v: Array) -> Array:
    """k1, k2, p1, p2, k3, k4, k5, k6, s1 … s4; p1 and p2 stand the other way round than Brown's."""
    c = np.zeros(12)
    c[: len(d)] = d
    r2 = u * u + v * v
    ratio = (1 + radial(r2, c[[0, 1, 4]])) / (1 + radial(r2, c[5:8]))
    x = u * ratio + 2 * c[2] * u * v + c[3] * (r2 + 2 * u * u) + c[8] * r2 + c[9] * r2 * r2
    y = v * ratio + c[2] * (r2 + 2 * v * v) + 2 * c[3] * u * v + c[10] * r2 + c[11] * r2 * r2
    return np.column_stack([x, y])


def _radial(d: Array, u: Array, v: Array) -> Array:
    factor = 1 + radial(u * u + v * v, d)
    return np.column_stack([u * factor, v * factor])


def _thin_prism(d: Array, u: Array, v: Array) -> Array:
    """k1, k2, p1, p2, k3, k4, sx1, sy1 on fish-eye coordinates."""
    r2 = u * u + v * v
    factor = 1 + radial(r2, d[[0, 1, 4, 5]])
    x = u * factor + 2 * d[2] * u * v + d[3] * (r2 + 2 * u * u) + d[6] * r2
    y = v * factor + 2 * d[3] * u * v + d[2] * (r2 + 2 * v * v) + d[7] * r2
    return np.column_stack([x, y])


def _fov(d: Array, u: Array, v: Array) -> Array:
    """Devernay and Faugeras 2001: ``r_d = atan(2 r tan(ω/2)) / ω``."""
    omega = float(d[0])
    if abs(omega) < 1e-9:
        return np.column_stack([u, v])
    r = np.hypot(u, v)
    scale = np.where(r > 1e-12, np.arctan(2 * r * np.tan(omega / 2)) / np.maximum(r * omega, 1e-300),
                     2 * np.tan(omega / 2) / omega)  # fmt: skip
    return np.column_stack([u * scale, v * scale])


def _identity(angle: Array) -> Array:
    return angle


def _make(
    name: str, two: bool, extra: tuple[str, ...], distort: Distort, shift: float, *, wide: bool = False
) -> None:
    """Register a model with one or two principal distances and its coefficients."""
    heads = ("fx", "fy", "cx", "cy") if two else ("f", "cx", "cy")

    def function(values: Array, _format: Format, rays: Array) -> Array:
        fx, fy, cx, cy = values[:4] if two else (values[0], *values[:3])
        uv = fisheye(rays, _identity) if wide else perspective(rays)
        xy = distort(np.asarray(values[len(heads) :]), uv[:, 0], uv[:, 1])
        return xy * [fx, fy] + np.array([cx, cy]) - shift

    def start(focal: float, principal: Array, _format: Format) -> Array:
        focals = [focal, focal] if two else [focal]
        first = HALF_RADIAN if extra == ("omega",) else 0.0  # at 0 nothing tells which way to go
        return np.array([*focals, *(np.asarray(principal) + shift), *[first] * len(extra)])

    register(Formula(name, (*heads, *extra), "ideal → measured", function, start, wide))


_K14 = ("k1", "k2", "k3", "k4")
_FULL = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
_PRISM = ("k1", "k2", "p1", "p2", "k3", "k4", "sx1", "sy1")

_make("colmap SIMPLE_PINHOLE", False, (), _radial, CORNER)
_make("colmap PINHOLE", True, (), _radial, CORNER)
_make("colmap SIMPLE_RADIAL", False, ("k",), _radial, CORNER)
_make("colmap RADIAL", False, ("k1", "k2"), _radial, CORNER)
_make("colmap OPENCV", True, _FULL[:4], _opencv, CORNER)
_make("colmap FULL_OPENCV", True, _FULL, _opencv, CORNER)
_make("colmap FOV", True, ("omega",), _fov, CORNER)
_make("colmap SIMPLE_FISHEYE", False, (), _radial, CORNER, wide=True)
_make("colmap FISHEYE", True, (), _radial, CORNER, wide=True)
_make("colmap SIMPLE_RADIAL_FISHEYE", False, ("k",), _radial, CORNER, wide=True)
_make("colmap RADIAL_FISHEYE", False, ("k1", "k2"), _radial, CORNER, wide=True)
_make("colmap OPENCV_FISHEYE", True, _K14, _radial, CORNER, wide=True)
_make("colmap THIN_PRISM_FISHEYE", True, _PRISM, _thin_prism, CORNER, wide=True)

for _count in (4, 5, 8, 12):
    _make(f"opencv {_count}", True, (*_FULL, "s1", "s2", "s3", "s4")[:_count], _opencv, 0.0)
_make("opencv fisheye", True, _K14, _radial, 0.0, wide=True)
