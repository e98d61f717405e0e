"""Kernel of the camera model “Polynomial of degree 3”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.polynomial`: do not edit.
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
    c30 = values[10]
    c21 = values[11]
    c12 = values[12]
    c03 = values[13]
    d30 = values[14]
    d21 = values[15]
    d12 = values[16]
    d03 = values[17]
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
    t10 = (v*v*v)
    t11 = (1.0 / (base_px*base_px*base_px))
    t12 = (focal_px*focal_px*focal_px)
    t13 = t11*t12
    t14 = t10*t13
    t15 = (u*u*u)
    t16 = t13*t15
    t17 = (v*v)
    t18 = t17*t7
    t19 = (u*u)
    t20 = t19*t7
    t21 = 2*t20
    t22 = t13*t17
    t23 = c12*t22
    t24 = t13*t19
    t25 = c21*t24
    t26 = t7*v
    t27 = t26*u
    t28 = 2*t18
    t29 = t22*u
    t30 = t24*v
    t31 = focal_px*t1
    t32 = e1*t31
    t33 = t7*u
    t34 = e3*t33
    t35 = 2*v
    t36 = t35*u
    t37 = t13*t36
    t38 = 3*c30
    t39 = e2*t31
    t40 = 2*e5
    t41 = 3*c03
    t42 = t1*u
    t43 = t1*v
    t44 = t0*t35*t5
    t45 = focal_px*t5
    t46 = t17*t40
    t47 = t11*t6
    t48 = t10*t41
    t49 = t15*t38
    t50 = 3*t47
    t51 = t17*u
    t52 = c12*t51
    t53 = t19*v
    t54 = c21*t53
    t55 = e2*t5
    t56 = t36*t47
    t57 = t12/(base_px*base_px*base_px*base_px)
    t58 = 3*t57
    t59 = 2*e6
    t60 = 3*d30
    t61 = 3*d03
    t62 = t19*t59
    t63 = t10*t61
    t64 = t15*t60
    t65 = d12*t51
    t66 = d21*t53
    pixel[0] = c03*t14 + c30*t16 + e1*t2 + e2*t4 - e3*t21 + e5*t18 + t0 + t23*u + t25*v + t9*u + x0
    pixel[1] = d03*t14 + d12*t29 + d21*t30 + d30*t16 - e1*t4 + e2*t2 + e3*t27 - e4*t28 + e6*t20 + t3 + y0
    x_u = c21*t37 + focal_px + t23 + t24*t38 + t32 - 4*t34 + t9
    x_v = c12*t37 + t22*t41 + t25 + t26*t40 + t39 + t8*u
    d_values[0] = e1*t42 + e2*t43 - 4*e3*t19*t45 + e4*t44 + t45*t46 + t47*t48 + t47*t49 + t50*t52 + t50*t54 + u
    d_values[1] = 1.0
    d_values[2] = 0.0
    d_values[3] = -e1*t0*t5 + 4*e3*t11*t19*t6 - e4*t56 - t3*t55 - t46*t47 - t48*t57 - t49*t57 - t52*t58 - t54*t58
    d_values[4] = t2
    d_values[5] = t4
    d_values[6] = -t21
    d_values[7] = t27
    d_values[8] = t18
    d_values[9] = 0.0
    d_values[10] = t16
    d_values[11] = t30
    d_values[12] = t29
    d_values[13] = t14
    d_values[14] = 0.0
    d_values[15] = 0.0
    d_values[16] = 0.0
    d_values[17] = 0.0
    y_u = d12*t22 + d21*t37 + e3*t26 + t24*t60 + t33*t59 + t39
    y_v = d12*t37 + d21*t24 + focal_px + t22*t61 - t32 + t34 - 4*t9
    d_values[row + 0] = -e1*t43 + e2*t42 + e3*t44 - 4*e4*t17*t45 + t45*t62 + t47*t63 + t47*t64 + t50*t65 + t50*t66 + v
    d_values[row + 1] = 0.0
    d_values[row + 2] = 1.0
    d_values[row + 3] = e1*focal_px*t5*v - e3*t56 + 4*e4*t11*t17*t6 - t0*t55 - t47*t62 - t57*t63 - t57*t64 - t58*t65 - t58*t66
    d_values[row + 4] = -t4
    d_values[row + 5] = t2
    d_values[row + 6] = t27
    d_values[row + 7] = -t28
    d_values[row + 8] = 0.0
    d_values[row + 9] = t20
    d_values[row + 10] = 0.0
    d_values[row + 11] = 0.0
    d_values[row + 12] = 0.0
    d_values[row + 13] = 0.0
    d_values[row + 14] = t16
    d_values[row + 15] = t30
    d_values[row + 16] = t29
    d_values[row + 17] = t14
    d_point[0] = x_u * u_x + x_v * v_x
    d_point[1] = x_u * u_y + x_v * v_y
    d_point[2] = x_u * u_z + x_v * v_z
    d_point[3] = y_u * u_x + y_v * v_x
    d_point[4] = y_u * u_y + y_v * v_y
    d_point[5] = y_u * u_z + y_v * v_z
    return 1
