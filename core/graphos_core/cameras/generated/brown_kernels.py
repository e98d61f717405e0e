"""Kernel of the camera model “Brown”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.brown`: do not edit.
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
    p1 = values[7]
    p2 = values[8]
    b1 = values[9]
    b2 = values[10]
    t0 = 2*v
    t1 = p2*t0
    t2 = (v*v)
    t3 = (u*u)
    t4 = t2 + 3*t3
    t5 = t2 + t3
    t6 = k4*t5
    t7 = k3 + t6
    t8 = k2 + t5*t7
    t9 = k1 + t5*t8
    t10 = t5*t9
    t11 = p1*t4 + t1*u + t10*u + u
    t12 = p1*u
    t13 = 3*t2 + t3
    t14 = p2*t13 + t0*t12 + t10*v + v
    t15 = b1*t11 + b2*t14 + t11
    t16 = focal_px*t14
    t17 = 2*t9
    t18 = 2*u
    t19 = t18*t8 + t5*(t18*t6 + t18*t7)
    t20 = t5*u
    t21 = t10 + 1
    t22 = t1 + 6*t12 + t17*t3 + t19*t20 + t21
    t23 = t5*v
    t24 = t0*u
    t25 = p1*t0 + p2*t18 + t24*t9
    t26 = t19*t23 + t25
    t27 = t0*t8 + t5*(t0*t6 + t0*t7)
    t28 = t20*t27 + t25
    t29 = 6*p2*v + 2*t12 + t17*t2 + t21 + t23*t27
    t30 = (t5*t5)
    t31 = t30*u
    t32 = b2*v
    t33 = (t5*t5*t5)
    t34 = t33*u
    t35 = (t5*t5*t5*t5)
    t36 = t35*u
    t37 = focal_px*v
    pixel[0] = focal_px*t15 + x0
    pixel[1] = t16 + y0
    x_u = focal_px*(b1*t22 + b2*t26 + t22)
    x_v = focal_px*(b1*t28 + b2*t29 + t28)
    d_values[0] = t15
    d_values[1] = 1.0
    d_values[2] = 0.0
    d_values[3] = focal_px*(b1*t20 + b2*t23 + t20)
    d_values[4] = focal_px*(b1*t31 + t30*t32 + t31)
    d_values[5] = focal_px*(b1*t34 + t32*t33 + t34)
    d_values[6] = focal_px*(b1*t36 + t32*t35 + t36)
    d_values[7] = focal_px*(b1*t4 + b2*t24 + t4)
    d_values[8] = focal_px*(b1*t24 + b2*t13 + t24)
    d_values[9] = focal_px*t11
    d_values[10] = t16
    y_u = focal_px*t26
    y_v = focal_px*t29
    d_values[row + 0] = t14
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_values[row + 3] = focal_px*t23
    d_values[row + 4] = t30*t37
    d_values[row + 5] = t33*t37
    d_values[row + 6] = t35*t37
    d_values[row + 7] = focal_px*t24
    d_values[row + 8] = focal_px*t13
    d_values[row + 9] = 0.0
    d_values[row + 10] = 0.0
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    return 1
