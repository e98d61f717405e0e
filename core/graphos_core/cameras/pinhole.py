r"""The distortion-free camera: f, x0, y0."""

from __future__ import annotations

from numba import njit

from graphos_core.cameras.model import CameraModel
from graphos_core.cameras.sheet import INTERIOR
from graphos_core.data.record import Array

MODEL = CameraModel(
    name="pinhole",
    label="Distortion-free",
    parameters=INTERIOR,
    direction="ideal → measured (nothing is distorted)",
    source="Luhmann et al. 2020, Close-Range Photogrammetry and 3D Imaging, section 3.3.2",
    formula=r"x = f\,\frac{X}{Z} + x_0,\quad y = f\,\frac{Y}{Z} + y_0",
    inlined=0,
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
    w = 1.0 / z
    u = x * w
    v = y * w
    pixel[0] = f * u + values[1]
    pixel[1] = f * v + values[2]
    d_point[0, 0] = f * w
    d_point[0, 1] = 0.0
    d_point[0, 2] = -f * u * w
    d_point[1, 0] = 0.0
    d_point[1, 1] = f * w
    d_point[1, 2] = -f * v * w
    d_values[0, 0] = u
    d_values[1, 0] = v
    d_values[0, 1] = 1.0
    d_values[1, 1] = 0.0
    d_values[0, 2] = 0.0
    d_values[1, 2] = 1.0
    return True
