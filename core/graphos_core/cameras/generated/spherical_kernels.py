"""Kernel of the camera model “Spherical (panorama)”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.sheet`: do not edit.
"""

from math import atan2, pi, sqrt

from numba import cfunc

from graphos_core.cameras.entry import SIGNATURE
from graphos_core.data.record import Array


@cfunc(SIGNATURE, cache=True, error_model="numpy")
def entry(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array, row: int
) -> int:
    """Project one point with derivatives; see `graphos_core.cameras.entry`."""
    if x == 0.0 and z == 0.0:
        return 0
    s0 = (x*x) + (z*z)
    s1 = sqrt(s0)
    s2 = (1.0 / s0)
    s3 = (1.0 / (s0 + (y*y)))
    s4 = s3*y/s1
    u = atan2(x, z)
    v = atan2(y, s1)
    u_x = s2*z
    u_y = 0.0
    u_z = -s2*x
    v_x = -s4*x
    v_y = s1*s3
    v_z = -s4*z
    focal_px = values[0]
    x0 = values[1]
    y0 = values[2]
    pixel[0] = focal_px*u + x0
    pixel[1] = focal_px*v + y0
    x_u = focal_px
    x_v = 0.0
    d_values[0] = u
    d_values[1] = 1.0
    d_values[2] = 0.0
    y_u = 0.0
    y_v = focal_px
    d_values[row + 0] = v
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    return 1


@cfunc(SIGNATURE, cache=True, error_model="numpy")
def residual_entry(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array, row: int
) -> int:
    """Compare with the measured position that `pixel` holds, as `residual_code` says; see `graphos_core.cameras.entry`."""
    if x == 0.0 and z == 0.0:
        return 0
    measured = pixel[0]
    s0 = (x*x) + (z*z)
    s1 = sqrt(s0)
    s2 = (1.0 / s0)
    s3 = (1.0 / (s0 + (y*y)))
    s4 = s3*y/s1
    u = atan2(x, z)
    v = atan2(y, s1)
    u_x = s2*z
    u_y = 0.0
    u_z = -s2*x
    v_x = -s4*x
    v_y = s1*s3
    v_z = -s4*z
    focal_px = values[0]
    x0 = values[1]
    y0 = values[2]
    pixel[0] = focal_px*u + x0
    pixel[1] = focal_px*v + y0
    x_u = focal_px
    x_v = 0.0
    d_values[0] = u
    d_values[1] = 1.0
    d_values[2] = 0.0
    y_u = 0.0
    y_v = focal_px
    d_values[row + 0] = v
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    turns = round((measured - pixel[0]) / (2.0 * pi * focal_px))
    pixel[0] += 2.0 * pi * focal_px * turns
    d_values[0] += 2.0 * pi * turns
    return 1
