"""Kernel of the camera model “Radial polynomial”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.radial`: do not edit.
"""

from numba import cfunc

from graphos_core.cameras.entry import SIGNATURE
from graphos_core.data.record import Array


@cfunc(SIGNATURE, cache=True, error_model="numpy")
def entry(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array, row: int
) -> int:
    """Project one point with derivatives; see `graphos_core.cameras.entry`."""
    if z <= 0.0:
        return 0
    s0 = (1.0 / z)
    s1 = (1.0 / (z*z))
    u = s0*x
    v = s0*y
    u_x = s0
    u_y = 0.0
    u_z = -s1*x
    v_x = 0.0
    v_y = s0
    v_z = -s1*y
    focal_px = values[0]
    x0 = values[1]
    y0 = values[2]
    k1 = values[3]
    k2 = values[4]
    k3 = values[5]
    k4 = values[6]
    k5 = values[7]
    t0 = (u*u)
    t1 = (v*v)
    t2 = t0 + t1
    t3 = k5*t2
    t4 = k4 + t3
    t5 = k3 + t2*t4
    t6 = k2 + t2*t5
    t7 = k1 + t2*t6
    t8 = t2*t7
    t9 = t8*u + u
    t10 = t8*v + v
    t11 = 2*t7
    t12 = 2*u
    t13 = t12*t6 + t2*(t12*t5 + t2*(t12*t3 + t12*t4))
    t14 = t2*u
    t15 = t8 + 1
    t16 = t11*u*v
    t17 = 2*v
    t18 = t17*t6 + t2*(t17*t5 + t2*(t17*t3 + t17*t4))
    t19 = (t2*t2)
    t20 = focal_px*u
    t21 = (t2*t2*t2)
    t22 = (t2*t2*t2*t2)
    t23 = (t2*t2*t2*t2*t2)
    t24 = t2*v
    t25 = focal_px*v
    pixel[0] = focal_px*t9 + x0
    pixel[1] = focal_px*t10 + y0
    x_u = focal_px*(t0*t11 + t13*t14 + t15)
    x_v = focal_px*(t14*t18 + t16)
    d_values[0] = t9
    d_values[1] = 1.0
    d_values[2] = 0.0
    d_values[3] = focal_px*t14
    d_values[4] = t19*t20
    d_values[5] = t20*t21
    d_values[6] = t20*t22
    d_values[7] = t20*t23
    y_u = focal_px*(t13*t24 + t16)
    y_v = focal_px*(t1*t11 + t15 + t18*t24)
    d_values[row + 0] = t10
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_values[row + 3] = focal_px*t24
    d_values[row + 4] = t19*t25
    d_values[row + 5] = t21*t25
    d_values[row + 6] = t22*t25
    d_values[row + 7] = t23*t25
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    return 1
