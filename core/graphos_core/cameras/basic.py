r"""The basic camera: f, x0, y0 and two radial coefficients k1, k2."""

from __future__ import annotations

from numba import njit

from graphos_core.cameras.model import CameraModel
from graphos_core.cameras.sheet import INTERIOR, RADIAL_FIXED_AGAINST_F, radial_parameters
from graphos_core.data.record import Array

MODEL = CameraModel(
    name="basic",
    label="Basic (f, x0, y0, k1, k2)",
    parameters=(
        *INTERIOR,
        *radial_parameters(0.1, 0.05),
    ),
    direction="ideal → measured",
    source="Brown 1971, Close-range camera calibration, radial terms, in normalised units r = √(X²+Y²)/Z",
    formula=r"x = f\,\frac{X}{Z}\,(1 + k_1 r^2 + k_2 r^4) + x_0,\quad r^2 = \frac{X^2 + Y^2}{Z^2}",
    dependences=(RADIAL_FIXED_AGAINST_F,),
    inlined=1,
)

MODELS = (MODEL,)


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def kernel(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array
) -> bool:
    """Project one point with derivatives; see `graphos_core.cameras.model` for the signature."""
    if z <= 0.0:
        return False
    f = values[0]
    k1 = values[3]
    k2 = values[4]
    w = 1.0 / z
    u = x * w
    v = y * w
    r2 = u * u + v * v
    d = 1.0 + r2 * (k1 + r2 * k2)
    pixel[0] = f * u * d + values[1]
    pixel[1] = f * v * d + values[2]
    slope = 2.0 * (k1 + 2.0 * k2 * r2)  # ∂d/∂u = slope·u, ∂d/∂v = slope·v
    uu = f * (d + u * u * slope)
    uv = f * u * v * slope
    vv = f * (d + v * v * slope)
    d_point[0, 0] = uu * w
    d_point[0, 1] = uv * w
    d_point[0, 2] = -(uu * u + uv * v) * w
    d_point[1, 0] = uv * w
    d_point[1, 1] = vv * w
    d_point[1, 2] = -(uv * u + vv * v) * w
    d_values[0, 0] = u * d
    d_values[1, 0] = v * d
    d_values[0, 1] = 1.0
    d_values[1, 1] = 0.0
    d_values[0, 2] = 0.0
    d_values[1, 2] = 1.0
    d_values[0, 3] = f * u * r2
    d_values[1, 3] = f * v * r2
    d_values[0, 4] = f * u * r2 * r2
    d_values[1, 4] = f * v * r2 * r2
    return True
