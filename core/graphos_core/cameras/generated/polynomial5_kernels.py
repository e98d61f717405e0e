"""Kernel of the camera model “Polynomial of degree 5”.

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
    c50 = values[19]
    c41 = values[20]
    c32 = values[21]
    c23 = values[22]
    c14 = values[23]
    c05 = values[24]
    d30 = values[25]
    d21 = values[26]
    d12 = values[27]
    d03 = values[28]
    d40 = values[29]
    d31 = values[30]
    d22 = values[31]
    d13 = values[32]
    d04 = values[33]
    d50 = values[34]
    d41 = values[35]
    d32 = values[36]
    d23 = values[37]
    d14 = values[38]
    d05 = values[39]
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
    t10 = (v*v*v*v*v)
    t11 = (1.0 / (base_px*base_px*base_px*base_px*base_px))
    t12 = (focal_px*focal_px*focal_px*focal_px*focal_px)
    t13 = t11*t12
    t14 = t10*t13
    t15 = (u*u*u*u*u)
    t16 = t13*t15
    t17 = (v*v*v*v)
    t18 = (1.0 / (base_px*base_px*base_px*base_px))
    t19 = (focal_px*focal_px*focal_px*focal_px)
    t20 = t18*t19
    t21 = t17*t20
    t22 = (u*u*u*u)
    t23 = t20*t22
    t24 = (v*v*v)
    t25 = (1.0 / (base_px*base_px*base_px))
    t26 = (focal_px*focal_px*focal_px)
    t27 = t25*t26
    t28 = t24*t27
    t29 = (u*u*u)
    t30 = t27*t29
    t31 = (v*v)
    t32 = t31*t7
    t33 = (u*u)
    t34 = t33*t7
    t35 = 2*t34
    t36 = t13*t17
    t37 = c14*t36
    t38 = t13*t22
    t39 = c41*t38
    t40 = t20*t24
    t41 = c13*t40
    t42 = t20*t29
    t43 = c31*t42
    t44 = t27*t31
    t45 = c12*t44
    t46 = t27*t33
    t47 = c21*t46
    t48 = t13*t24
    t49 = t33*t48
    t50 = t13*t31
    t51 = t29*t50
    t52 = t20*t31
    t53 = t33*t52
    t54 = t7*v
    t55 = t54*u
    t56 = 2*t32
    t57 = t36*u
    t58 = t38*v
    t59 = t40*u
    t60 = t42*v
    t61 = t44*u
    t62 = t46*v
    t63 = focal_px*t1
    t64 = e1*t63
    t65 = t7*u
    t66 = e3*t65
    t67 = c21*v
    t68 = 2*u
    t69 = t27*t68
    t70 = 5*c50
    t71 = 4*c40
    t72 = 3*c30
    t73 = t48*t68
    t74 = c41*v
    t75 = 4*t29
    t76 = t13*t75
    t77 = t52*t68
    t78 = c31*v
    t79 = 3*t33
    t80 = t20*t79
    t81 = t50*t79
    t82 = e2*t63
    t83 = 2*e5
    t84 = t69*v
    t85 = 5*c05
    t86 = 4*c04
    t87 = 3*c03
    t88 = 4*u
    t89 = t48*t88
    t90 = c32*t29
    t91 = 2*v
    t92 = t13*t91
    t93 = 3*u
    t94 = t52*t93
    t95 = t20*t33*t91
    t96 = t1*u
    t97 = t1*v
    t98 = t0*t5*t91
    t99 = focal_px*t5
    t100 = 4*t33
    t101 = t31*t83
    t102 = t11*t19
    t103 = t10*t85
    t104 = t15*t70
    t105 = t18*t26
    t106 = t17*t86
    t107 = t22*t71
    t108 = t25*t6
    t109 = t24*t87
    t110 = t29*t72
    t111 = 5*t102
    t112 = t17*u
    t113 = c14*t112
    t114 = t22*t74
    t115 = t24*t88
    t116 = c13*t115
    t117 = t75*t78
    t118 = t31*t93
    t119 = c12*t118
    t120 = t67*t79
    t121 = t24*t33
    t122 = c23*t121
    t123 = t31*t90
    t124 = t100*t31
    t125 = c22*t124
    t126 = e2*t5
    t127 = t108*v
    t128 = t127*t68
    t129 = t12/(base_px*base_px*base_px*base_px*base_px*base_px)
    t130 = 5*t129
    t131 = 2*e6
    t132 = 5*d50
    t133 = 4*d40
    t134 = 3*d30
    t135 = d41*v
    t136 = d31*v
    t137 = 5*d05
    t138 = 4*d04
    t139 = 3*d03
    t140 = d32*t29
    t141 = t131*t33
    t142 = t10*t137
    t143 = t132*t15
    t144 = t138*t17
    t145 = t133*t22
    t146 = t139*t24
    t147 = t134*t29
    t148 = d14*t112
    t149 = t135*t22
    t150 = d13*t115
    t151 = t136*t75
    t152 = d12*t118
    t153 = d21*t79
    t154 = d23*t121
    t155 = t140*t31
    t156 = d22*t124
    pixel[0] = c03*t28 + c04*t21 + c05*t14 + c22*t53 + c23*t49 + c30*t30 + c32*t51 + c40*t23 + c50*t16 + e1*t2 + e2*t4 - e3*t35 + e5*t32 + t0 + t37*u + t39*v + t41*u + t43*v + t45*u + t47*v + t9*u + x0
    pixel[1] = d03*t28 + d04*t21 + d05*t14 + d12*t61 + d13*t59 + d14*t57 + d21*t62 + d22*t53 + d23*t49 + d30*t30 + d31*t60 + d32*t51 + d40*t23 + d41*t58 + d50*t16 - e1*t4 + e2*t2 + e3*t55 - e4*t56 + e6*t34 + t3 + y0
    x_u = c22*t77 + c23*t73 + c32*t81 + focal_px + t37 + t38*t70 + t41 + t42*t71 + t45 + t46*t72 + t64 - 4*t66 + t67*t69 + t74*t76 + t78*t80 + t9
    x_v = c12*t84 + c13*t94 + c14*t89 + c22*t95 + c23*t81 + t36*t85 + t39 + t40*t86 + t43 + t44*t87 + t47 + t54*t83 + t8*u + t82 + t90*t92
    d_values[0, 0] = e1*t96 + e2*t97 - e3*t100*t99 + e4*t98 + t101*t99 + t102*t103 + t102*t104 + t105*t106 + t105*t107 + t105*t116 + t105*t117 + t105*t125 + t108*t109 + t108*t110 + t108*t119 + t108*t120 + t111*t113 + t111*t114 + t111*t122 + t111*t123 + u
    d_values[0, 1] = 1.0
    d_values[0, 2] = 0.0
    d_values[0, 3] = -e1*t0*t5 + 4*e3*t25*t33*t6 - e4*t128 - t101*t108 - t102*t106 - t102*t107 - t102*t116 - t102*t117 - t102*t125 - t103*t129 - t104*t129 - t105*t109 - t105*t110 - t105*t119 - t105*t120 - t113*t130 - t114*t130 - t122*t130 - t123*t130 - t126*t3
    d_values[0, 4] = t2
    d_values[0, 5] = t4
    d_values[0, 6] = -t35
    d_values[0, 7] = t55
    d_values[0, 8] = t32
    d_values[0, 9] = 0.0
    d_values[0, 10] = t30
    d_values[0, 11] = t62
    d_values[0, 12] = t61
    d_values[0, 13] = t28
    d_values[0, 14] = t23
    d_values[0, 15] = t60
    d_values[0, 16] = t53
    d_values[0, 17] = t59
    d_values[0, 18] = t21
    d_values[0, 19] = t16
    d_values[0, 20] = t58
    d_values[0, 21] = t51
    d_values[0, 22] = t49
    d_values[0, 23] = t57
    d_values[0, 24] = t14
    d_values[0, 25] = 0.0
    d_values[0, 26] = 0.0
    d_values[0, 27] = 0.0
    d_values[0, 28] = 0.0
    d_values[0, 29] = 0.0
    d_values[0, 30] = 0.0
    d_values[0, 31] = 0.0
    d_values[0, 32] = 0.0
    d_values[0, 33] = 0.0
    d_values[0, 34] = 0.0
    d_values[0, 35] = 0.0
    d_values[0, 36] = 0.0
    d_values[0, 37] = 0.0
    d_values[0, 38] = 0.0
    d_values[0, 39] = 0.0
    y_u = d12*t44 + d13*t40 + d14*t36 + d21*t84 + d22*t77 + d23*t73 + d32*t81 + e3*t54 + t131*t65 + t132*t38 + t133*t42 + t134*t46 + t135*t76 + t136*t80 + t82
    y_v = d12*t84 + d13*t94 + d14*t89 + d21*t46 + d22*t95 + d23*t81 + d31*t42 + d41*t38 + focal_px + t137*t36 + t138*t40 + t139*t44 + t140*t92 - t64 + t66 - 4*t9
    d_values[1, 0] = -e1*t97 + e2*t96 + e3*t98 - 4*e4*t31*t99 + t102*t142 + t102*t143 + t105*t144 + t105*t145 + t105*t150 + t105*t151 + t105*t156 + t108*t146 + t108*t147 + t108*t152 + t111*t148 + t111*t149 + t111*t154 + t111*t155 + t127*t153 + t141*t99 + v
    d_values[1, 1] = 0.0
    d_values[1, 2] = 1.0
    d_values[1, 3] = e1*focal_px*t5*v - e3*t128 + 4*e4*t25*t31*t6 - t0*t126 - t102*t144 - t102*t145 - t102*t150 - t102*t151 - t102*t156 - t105*t146 - t105*t147 - t105*t152 - t105*t153*v - t108*t141 - t129*t142 - t129*t143 - t130*t148 - t130*t149 - t130*t154 - t130*t155
    d_values[1, 4] = -t4
    d_values[1, 5] = t2
    d_values[1, 6] = t55
    d_values[1, 7] = -t56
    d_values[1, 8] = 0.0
    d_values[1, 9] = t34
    d_values[1, 10] = 0.0
    d_values[1, 11] = 0.0
    d_values[1, 12] = 0.0
    d_values[1, 13] = 0.0
    d_values[1, 14] = 0.0
    d_values[1, 15] = 0.0
    d_values[1, 16] = 0.0
    d_values[1, 17] = 0.0
    d_values[1, 18] = 0.0
    d_values[1, 19] = 0.0
    d_values[1, 20] = 0.0
    d_values[1, 21] = 0.0
    d_values[1, 22] = 0.0
    d_values[1, 23] = 0.0
    d_values[1, 24] = 0.0
    d_values[1, 25] = t30
    d_values[1, 26] = t62
    d_values[1, 27] = t61
    d_values[1, 28] = t28
    d_values[1, 29] = t23
    d_values[1, 30] = t60
    d_values[1, 31] = t53
    d_values[1, 32] = t59
    d_values[1, 33] = t21
    d_values[1, 34] = t16
    d_values[1, 35] = t58
    d_values[1, 36] = t51
    d_values[1, 37] = t49
    d_values[1, 38] = t57
    d_values[1, 39] = t14
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
            carray(values, (40,)),
            x,
            y,
            z,
            carray(pixel, (2,)),
            carray(d_point, (2, 3)),
            carray(d_values, (2, row)),
        )
    )
