"""Kernel of the camera model “Ebner (12)”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.ebner`: do not edit.
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
    base_px = values[3]
    e1 = values[4]
    e2 = values[5]
    e3 = values[6]
    e4 = values[7]
    e5 = values[8]
    e6 = values[9]
    e7 = values[10]
    e8 = values[11]
    e9 = values[12]
    e10 = values[13]
    e11 = values[14]
    e12 = values[15]
    t0 = focal_px*u
    t1 = (1.0 / base_px)
    t2 = t0*t1
    t3 = focal_px*v
    t4 = t1*t3
    t5 = (1.0 / (base_px*base_px))
    t6 = (focal_px*focal_px)
    t7 = t5*t6
    t8 = e4*t7
    t9 = t8*v
    t10 = (v*v)
    t11 = t10*t5*t6 - 0.6666666666666666
    t12 = (u*u)
    t13 = t12*t5*t6 - 0.6666666666666666
    t14 = 2*t13
    t15 = e7*t11
    t16 = e9*t13
    t17 = t11*t13
    t18 = t7*v
    t19 = t18*u
    t20 = 2*t11
    t21 = t11*t2
    t22 = t13*t4
    t23 = focal_px*t1
    t24 = e1*t23
    t25 = t7*u
    t26 = e3*t25
    t27 = 2*v
    t28 = e9*t27
    t29 = (1.0 / (base_px*base_px*base_px))
    t30 = (focal_px*focal_px*focal_px)
    t31 = t30*u
    t32 = t29*t31
    t33 = e11*t20
    t34 = e2*t23
    t35 = 2*e5
    t36 = t27*t32
    t37 = e11*t14
    t38 = t1*u
    t39 = t1*v
    t40 = t0*t5
    t41 = e4*t27
    t42 = focal_px*t5
    t43 = t10*t35
    t44 = 2*e7
    t45 = t29*t6
    t46 = t10*t45
    t47 = t46*u
    t48 = t12*t28
    t49 = t12*t33
    t50 = t10*t42
    t51 = e2*t5
    t52 = t45*u
    t53 = (1.0 / (base_px*base_px*base_px*base_px))
    t54 = t10*t31*t53
    t55 = t30*t53
    t56 = t3*t5
    t57 = 2*e6
    t58 = e10*t11
    t59 = e12*t20
    t60 = e8*t13
    t61 = e12*t14
    t62 = e3*t27
    t63 = t12*t57
    t64 = 2*e10
    t65 = e8*t12*t27
    t66 = t12*t59
    pixel[0] = e1*t2 + e11*t17 + e2*t4 - e3*t14 + e5*t11 + t0 + t15*t2 + t16*t4 + t9*u + x0
    pixel[1] = -e1*t4 + e10*t21 + e12*t17 + e2*t2 + e3*t19 - e4*t20 + e6*t13 + e8*t22 + t3 + y0
    x_u = focal_px + t15*t23 + t24 + t25*t33 - 4*t26 + t28*t32 + t9
    x_v = e7*t36 + t16*t23 + t18*t35 + t18*t37 + t34 + t8*u
    d_values[0] = e1*t38 + e2*t39 - 4*e3*t12*t42 + t15*t38 + t16*t39 + t37*t50 + t40*t41 + t42*t43 + t42*t49 + t44*t47 + t45*t48 + u
    d_values[1] = 1.0
    d_values[2] = 0.0
    d_values[3] = -e1*t0*t5 + 4*e3*t12*t29*t6 - t15*t40 - t16*t56 - t3*t51 - t37*t46 - t41*t52 - t43*t45 - t44*t54 - t45*t49 - t48*t55
    d_values[4] = t2
    d_values[5] = t4
    d_values[6] = -2*t12*t7 + 1.3333333333333333
    d_values[7] = t19
    d_values[8] = t11
    d_values[9] = 0.0
    d_values[10] = t21
    d_values[11] = 0.0
    d_values[12] = t22
    d_values[13] = 0.0
    d_values[14] = t17
    d_values[15] = 0.0
    y_u = e3*t18 + e8*t36 + t23*t58 + t25*t57 + t25*t59 + t34
    y_v = e10*t36 + focal_px + t18*t61 + t23*t60 - t24 + t26 - 4*t9
    d_values[row + 0] = -e1*t39 + e2*t38 - 4*e4*t50 + t38*t58 + t39*t60 + t40*t62 + t42*t63 + t42*t66 + t45*t65 + t47*t64 + t50*t61 + v
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_values[row + 3] = e1*focal_px*t5*v + 4*e4*t10*t29*t6 - t0*t51 - t40*t58 - t45*t63 - t45*t66 - t46*t61 - t52*t62 - t54*t64 - t55*t65 - t56*t60
    d_values[row + 4] = -t4
    d_values[row + 5] = t2
    d_values[row + 6] = t19
    d_values[row + 7] = -2*t10*t7 + 1.3333333333333333
    d_values[row + 8] = 0.0
    d_values[row + 9] = t13
    d_values[row + 10] = 0.0
    d_values[row + 11] = t22
    d_values[row + 12] = 0.0
    d_values[row + 13] = t21
    d_values[row + 14] = 0.0
    d_values[row + 15] = t17
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    return 1
