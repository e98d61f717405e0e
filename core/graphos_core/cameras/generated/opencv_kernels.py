"""Kernel of the camera model “OpenCV (rational, thin prism)”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.opencv`: do not edit.
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
    k6 = values[8]
    p1 = values[9]
    p2 = values[10]
    s1 = values[11]
    s2 = values[12]
    s3 = values[13]
    s4 = values[14]
    b1 = values[15]
    t0 = 2*p1
    t1 = t0*v
    t2 = (v*v)
    t3 = (u*u)
    t4 = t2 + 3*t3
    t5 = t2 + t3
    t6 = s2*t5
    t7 = s1 + t6
    t8 = k3*t5
    t9 = k2 + t8
    t10 = k1 + t5*t9
    t11 = t10*t5 + 1
    t12 = k6*t5
    t13 = k5 + t12
    t14 = k4 + t13*t5
    t15 = t14*t5 + 1
    t16 = (1.0 / t15)
    t17 = t11*t16
    t18 = p2*t4 + t1*u + t17*u + t5*t7
    t19 = b1*t18 + t18
    t20 = 2*u
    t21 = t20*v
    t22 = 3*t2 + t3
    t23 = s4*t5
    t24 = s3 + t23
    t25 = p1*t22 + p2*t21 + t17*v + t24*t5
    t26 = t10*t20 + t5*(t20*t8 + t20*t9)
    t27 = t16*u
    t28 = -t14*t20 - t5*(t12*t20 + t13*t20)
    t29 = t11/(t15*t15)
    t30 = t29*u
    t31 = 6*p2*u + t1 + t17 + t20*t6 + t20*t7 + t26*t27 + t28*t30
    t32 = 2*v
    t33 = t10*t32 + t5*(t32*t8 + t32*t9)
    t34 = -t14*t32 - t5*(t12*t32 + t13*t32)
    t35 = p2*t32 + t0*u
    t36 = t27*t33 + t30*t34 + t32*t6 + t32*t7 + t35
    t37 = b1*t5
    t38 = (t5*t5)
    t39 = b1*t38
    t40 = (t5*t5*t5)
    t41 = t27*t40
    t42 = -t5
    t43 = t30*t42
    t44 = t30*t40
    t45 = t16*v
    t46 = t29*v
    t47 = focal_px*t5
    t48 = focal_px*t38
    t49 = focal_px*t40
    pixel[0] = focal_px*t19 + x0
    pixel[1] = focal_px*t25 + y0
    x_u = focal_px*(b1*t31 + t31)
    x_v = focal_px*(b1*t36 + t36)
    d_values[0] = t19
    d_values[1] = 1.0
    d_values[2] = 0.0
    d_values[3] = focal_px*(t27*t37 + t27*t5)
    d_values[4] = focal_px*(t27*t38 + t27*t39)
    d_values[5] = focal_px*(b1*t41 + t41)
    d_values[6] = focal_px*(b1*t43 + t43)
    d_values[7] = focal_px*(-t30*t38 - t30*t39)
    d_values[8] = focal_px*(-b1*t44 - t44)
    d_values[9] = focal_px*(b1*t21 + t21)
    d_values[10] = focal_px*(b1*t4 + t4)
    d_values[11] = focal_px*(t37 + t5)
    d_values[12] = focal_px*(t38 + t39)
    d_values[13] = 0.0
    d_values[14] = 0.0
    d_values[15] = focal_px*t18
    y_u = focal_px*(t20*t23 + t20*t24 + t26*t45 + t28*t46 + t35)
    y_v = focal_px*(6*p1*v + p2*t20 + t17 + t23*t32 + t24*t32 + t33*t45 + t34*t46)
    d_values[row + 0] = t25
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_values[row + 3] = t45*t47
    d_values[row + 4] = t45*t48
    d_values[row + 5] = t45*t49
    d_values[row + 6] = focal_px*t42*t46
    d_values[row + 7] = -t46*t48
    d_values[row + 8] = -t46*t49
    d_values[row + 9] = focal_px*t22
    d_values[row + 10] = focal_px*t21
    d_values[row + 11] = 0.0
    d_values[row + 12] = 0.0
    d_values[row + 13] = t47
    d_values[row + 14] = t48
    d_values[row + 15] = 0.0
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    return 1
