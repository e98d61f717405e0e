"""Kernel of the camera model “Complete (Fraser)”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.complete`: do not edit.
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
    x1 = values[3]
    y1 = values[4]
    k1 = values[5]
    k2 = values[6]
    k3 = values[7]
    p1 = values[8]
    p2 = values[9]
    b1 = values[10]
    b2 = values[11]
    t0 = (1.0 / focal_px)
    t1 = t0*x1
    t2 = -t1 + u
    t3 = t0*y1
    t4 = -t3 + v
    t5 = 2*p2
    t6 = t4*t5
    t7 = -2*t1 + 2*u
    t8 = t2*t7
    t9 = (t2*t2)
    t10 = (t4*t4)
    t11 = t10 + t9
    t12 = t11 + t8
    t13 = k3*t11
    t14 = k2 + t13
    t15 = k1 + t11*t14
    t16 = t11*t15
    t17 = b1*u + b2*v + p1*t12 + t16*t2 + t2*t6 + u
    t18 = 2*p1
    t19 = t18*t4
    t20 = -2*t3 + 2*v
    t21 = t20*t4
    t22 = t11 + t21
    t23 = p2*t22 + t16*t4 + t19*t2 + v
    t24 = t13*t7 + t14*t7
    t25 = t11*t2
    t26 = t16 + 1
    t27 = t2*t5
    t28 = t15*t2
    t29 = t13*t20 + t14*t20
    t30 = (1.0 / (focal_px*focal_px))
    t31 = t30*x1
    t32 = t30*y1
    t33 = t2*t31
    t34 = 2*t4
    t35 = t32*t34
    t36 = 2*t33
    t37 = t35 + t36
    t38 = t13*t37 + t14*t37
    t39 = 4*t0
    t40 = 2*t0
    t41 = t15*t40
    t42 = t0*t16
    t43 = t2*t40
    t44 = -t13*t43 - t14*t43
    t45 = t0*t34
    t46 = -t13*t45 - t14*t45
    t47 = t0*t19 + t0*t27 + t28*t45
    t48 = (t11*t11)
    t49 = focal_px*t2
    t50 = (t11*t11*t11)
    t51 = t34*t49
    t52 = t15*t4
    t53 = t11*t4
    t54 = t18*t2
    t55 = focal_px*t4
    pixel[0] = focal_px*t17 + x0
    pixel[1] = focal_px*t23 + y0
    x_u = focal_px*(b1 + p1*(-6*t1 + 6*u) + t15*t8 + t24*t25 + t26 + t6)
    x_v = focal_px*(b2 + p1*t20 + t20*t28 + t25*t29 + t27)
    d_values[0] = focal_px*(p1*(t31*t7 + 4*t33 + t35) + t16*t31 + t25*t38 + t27*t32 + t28*t37 + t31*t6) + t17
    d_values[1] = 1.0
    d_values[2] = 0.0
    d_values[3] = focal_px*(p1*(-t0*t7 - t2*t39) - t0*t6 + t11*t2*t44 - t41*t9 - t42)
    d_values[4] = focal_px*(t11*t2*t46 - t47)
    d_values[5] = focal_px*t25
    d_values[6] = t48*t49
    d_values[7] = t49*t50
    d_values[8] = focal_px*t12
    d_values[9] = t51
    d_values[10] = focal_px*u
    d_values[11] = focal_px*v
    y_u = focal_px*(p2*t7 + t19 + t24*t53 + t52*t7)
    y_v = focal_px*(p2*(-6*t3 + 6*v) + t15*t21 + t26 + t29*t53 + t54)
    d_values[row + 0] = focal_px*(p2*(t20*t32 + 4*t32*t4 + t36) + t16*t32 + t19*t31 + t32*t54 + t37*t52 + t38*t53) + t23
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_values[row + 3] = focal_px*(t11*t4*t44 - t47)
    d_values[row + 4] = focal_px*(p2*(-t0*t20 - t39*t4) - t0*t54 - t10*t41 + t11*t4*t46 - t42)
    d_values[row + 5] = focal_px*t53
    d_values[row + 6] = t48*t55
    d_values[row + 7] = t50*t55
    d_values[row + 8] = t51
    d_values[row + 9] = focal_px*t22
    d_values[row + 10] = 0.0
    d_values[row + 11] = 0.0
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    return 1
