"""Kernel of the camera model “Polynomial of degree 4”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.polynomial`: do not edit.
"""

from numba import carray, cfunc, njit

from graphos_core.cameras.entry import SIGNATURE
from graphos_core.data.record import Array


@njit(cache=True, nogil=True, error_model="numpy")
def kernel(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array
) -> bool:
    """Project one point with derivatives; see `graphos_core.cameras.model`."""
    if z <= 0.0:
        return False
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
    c40 = values[14]
    c31 = values[15]
    c22 = values[16]
    c13 = values[17]
    c04 = values[18]
    d30 = values[19]
    d21 = values[20]
    d12 = values[21]
    d03 = values[22]
    d40 = values[23]
    d31 = values[24]
    d22 = values[25]
    d13 = values[26]
    d04 = values[27]
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
    t10 = (v*v*v*v)
    t11 = (1.0 / (base_px*base_px*base_px*base_px))
    t12 = (focal_px*focal_px*focal_px*focal_px)
    t13 = t11*t12
    t14 = t10*t13
    t15 = (u*u*u*u)
    t16 = t13*t15
    t17 = (v*v*v)
    t18 = (1.0 / (base_px*base_px*base_px))
    t19 = (focal_px*focal_px*focal_px)
    t20 = t18*t19
    t21 = t17*t20
    t22 = (u*u*u)
    t23 = t20*t22
    t24 = (v*v)
    t25 = t24*t7
    t26 = (u*u)
    t27 = t26*t7
    t28 = 2*t27
    t29 = t13*t17
    t30 = c13*t29
    t31 = t13*t22
    t32 = c31*t31
    t33 = t20*t24
    t34 = c12*t33
    t35 = t20*t26
    t36 = c21*t35
    t37 = t13*t24
    t38 = t26*t37
    t39 = t7*v
    t40 = t39*u
    t41 = 2*t25
    t42 = t29*u
    t43 = t31*v
    t44 = t33*u
    t45 = t35*v
    t46 = focal_px*t1
    t47 = e1*t46
    t48 = t7*u
    t49 = e3*t48
    t50 = c21*v
    t51 = 2*u
    t52 = t20*t51
    t53 = 4*c40
    t54 = 3*c30
    t55 = t37*t51
    t56 = c31*v
    t57 = 3*t26
    t58 = t13*t57
    t59 = e2*t46
    t60 = 2*e5
    t61 = t52*v
    t62 = 4*c04
    t63 = 3*c03
    t64 = 3*u
    t65 = t37*t64
    t66 = 2*v
    t67 = t13*t26*t66
    t68 = t1*u
    t69 = t1*v
    t70 = t0*t5*t66
    t71 = focal_px*t5
    t72 = 4*t26
    t73 = t24*t60
    t74 = t11*t19
    t75 = t10*t62
    t76 = t15*t53
    t77 = t18*t6
    t78 = t17*t63
    t79 = t22*t54
    t80 = 4*t74
    t81 = t17*u
    t82 = c13*t81
    t83 = t22*t56
    t84 = t24*t64
    t85 = c12*t84
    t86 = t50*t57
    t87 = t24*t72
    t88 = c22*t87
    t89 = e2*t5
    t90 = t77*v
    t91 = t51*t90
    t92 = t12/(base_px*base_px*base_px*base_px*base_px)
    t93 = 4*t92
    t94 = 2*e6
    t95 = 4*d40
    t96 = 3*d30
    t97 = d31*v
    t98 = 4*d04
    t99 = 3*d03
    t100 = t26*t94
    t101 = t10*t98
    t102 = t15*t95
    t103 = t17*t99
    t104 = t22*t96
    t105 = d13*t81
    t106 = t22*t97
    t107 = d12*t84
    t108 = d21*t57
    t109 = d22*t87
    pixel[0] = c03*t21 + c04*t14 + c22*t38 + c30*t23 + c40*t16 + e1*t2 + e2*t4 - e3*t28 + e5*t25 + t0 + t30*u + t32*v + t34*u + t36*v + t9*u + x0
    pixel[1] = d03*t21 + d04*t14 + d12*t44 + d13*t42 + d21*t45 + d22*t38 + d30*t23 + d31*t43 + d40*t16 - e1*t4 + e2*t2 + e3*t40 - e4*t41 + e6*t27 + t3 + y0
    x_u = c22*t55 + focal_px + t30 + t31*t53 + t34 + t35*t54 + t47 - 4*t49 + t50*t52 + t56*t58 + t9
    x_v = c12*t61 + c13*t65 + c22*t67 + t29*t62 + t32 + t33*t63 + t36 + t39*t60 + t59 + t8*u
    d_values[0, 0] = e1*t68 + e2*t69 - e3*t71*t72 + e4*t70 + t71*t73 + t74*t75 + t74*t76 + t74*t88 + t77*t78 + t77*t79 + t77*t85 + t77*t86 + t80*t82 + t80*t83 + u
    d_values[0, 1] = 1.0
    d_values[0, 2] = 0.0
    d_values[0, 3] = -e1*t0*t5 + 4*e3*t18*t26*t6 - e4*t91 - t3*t89 - t73*t77 - t74*t78 - t74*t79 - t74*t85 - t74*t86 - t75*t92 - t76*t92 - t82*t93 - t83*t93 - t88*t92
    d_values[0, 4] = t2
    d_values[0, 5] = t4
    d_values[0, 6] = -t28
    d_values[0, 7] = t40
    d_values[0, 8] = t25
    d_values[0, 9] = 0.0
    d_values[0, 10] = t23
    d_values[0, 11] = t45
    d_values[0, 12] = t44
    d_values[0, 13] = t21
    d_values[0, 14] = t16
    d_values[0, 15] = t43
    d_values[0, 16] = t38
    d_values[0, 17] = t42
    d_values[0, 18] = t14
    d_values[0, 19] = 0.0
    d_values[0, 20] = 0.0
    d_values[0, 21] = 0.0
    d_values[0, 22] = 0.0
    d_values[0, 23] = 0.0
    d_values[0, 24] = 0.0
    d_values[0, 25] = 0.0
    d_values[0, 26] = 0.0
    d_values[0, 27] = 0.0
    y_u = d12*t33 + d13*t29 + d21*t61 + d22*t55 + e3*t39 + t31*t95 + t35*t96 + t48*t94 + t58*t97 + t59
    y_v = d12*t61 + d13*t65 + d21*t35 + d22*t67 + d31*t31 + focal_px + t29*t98 + t33*t99 - t47 + t49 - 4*t9
    d_values[1, 0] = -e1*t69 + e2*t68 + e3*t70 - 4*e4*t24*t71 + t100*t71 + t101*t74 + t102*t74 + t103*t77 + t104*t77 + t105*t80 + t106*t80 + t107*t77 + t108*t90 + t109*t74 + v
    d_values[1, 1] = 0.0
    d_values[1, 2] = 1.0
    d_values[1, 3] = e1*focal_px*t5*v - e3*t91 + 4*e4*t18*t24*t6 - t0*t89 - t100*t77 - t101*t92 - t102*t92 - t103*t74 - t104*t74 - t105*t93 - t106*t93 - t107*t74 - t108*t74*v - t109*t92
    d_values[1, 4] = -t4
    d_values[1, 5] = t2
    d_values[1, 6] = t40
    d_values[1, 7] = -t41
    d_values[1, 8] = 0.0
    d_values[1, 9] = t27
    d_values[1, 10] = 0.0
    d_values[1, 11] = 0.0
    d_values[1, 12] = 0.0
    d_values[1, 13] = 0.0
    d_values[1, 14] = 0.0
    d_values[1, 15] = 0.0
    d_values[1, 16] = 0.0
    d_values[1, 17] = 0.0
    d_values[1, 18] = 0.0
    d_values[1, 19] = t23
    d_values[1, 20] = t45
    d_values[1, 21] = t44
    d_values[1, 22] = t21
    d_values[1, 23] = t16
    d_values[1, 24] = t43
    d_values[1, 25] = t38
    d_values[1, 26] = t42
    d_values[1, 27] = t14
    d_point[0, 0] = x_u * u_x + x_v * v_x
    d_point[0, 1] = x_u * u_y + x_v * v_y
    d_point[0, 2] = x_u * u_z + x_v * v_z
    d_point[1, 0] = y_u * u_x + y_v * v_x
    d_point[1, 1] = y_u * u_y + y_v * v_y
    d_point[1, 2] = y_u * u_z + y_v * v_z
    return True


@cfunc(SIGNATURE, cache=True, error_model="numpy")
def entry(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array, row: int
) -> int:
    """Call `kernel` from compiled code by address; see `graphos_core.cameras.entry`."""
    return int(
        kernel(
            carray(values, (28,)),
            x,
            y,
            z,
            carray(pixel, (2,)),
            carray(d_point, (2, 3)),
            carray(d_values, (2, row)),
        )
    )
