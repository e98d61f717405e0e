"""Kernel of the camera model “Brown, corrections of the measured position”.

Written by `graphos_core.cameras.generator` with SymPy 1.14.0 from `graphos_core.cameras.brown_backward`: do not edit.
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
    k1 = values[3]
    k2 = values[4]
    k3 = values[5]
    p1 = values[6]
    p2 = values[7]
    b1 = values[8]
    b2 = values[9]
    px = focal_px * u + x0
    py = focal_px * v + y0
    limit = 1e-11 / focal_px
    found = False
    for _ in range(30):
        t0 = px - x0
        t1 = (1.0 / focal_px)
        t2 = b1 + 1
        t3 = t1*t2
        t4 = t0*t3
        t5 = py - y0
        t6 = (1.0 / (focal_px*focal_px))
        t7 = 2*t2*t6
        t8 = t5*t7
        t9 = p2*t8
        t10 = (t5*t5)*t6
        t11 = (t2*t2)
        t12 = t11*t6
        t13 = (t0*t0)*t12
        t14 = t10 + t13
        t15 = k3*t14
        t16 = k2 + t15
        t17 = k1 + t14*t16
        t18 = t14*t17
        t19 = t1*t5
        t20 = p1*t8
        t21 = p2*(3*t10 + t13) + t0*t20 + t18*t19 + t19
        t22 = 2*px - 2*x0
        t23 = t12*t22
        t24 = t17/(focal_px*focal_px*focal_px)
        t25 = t0*t24
        t26 = t15*t23 + t16*t23
        t27 = t14*t4
        t28 = t24*t5
        t29 = t14*t19
        t30 = p2*t23 + t11*t22*t28 + t20 + t26*t29
        t31 = 2*py - 2*y0
        t32 = t31*t6
        t33 = t0*t7
        t34 = t15*t32 + t16*t32
        t35 = p1*t33 + 3*p2*t32 + t1*t18 + t1 + t28*t31 + t29*t34
        u_now = b2*t21 + p1*(t10 + 3*t13) + t0*t9 + t18*t4 + t4
        v_now = t21
        u_px = b2*t30 + 3*p1*t23 + t18*t3 + (t2*t2*t2)*t22*t25 + t26*t27 + t3 + t9
        u_py = b2*t35 + p1*t32 + p2*t33 + t2*t25*t31 + t27*t34
        v_px = t30
        v_py = t35
        determinant = u_px * v_py - u_py * v_px
        if not determinant > 0.0:
            return False
        du = u - u_now
        dv = v - v_now
        if found:
            break
        found = abs(du) + abs(dv) < 1e4 * limit  # one more step squares what is left
        px += (v_py * du - u_py * dv) / determinant
        py += (u_px * dv - v_px * du) / determinant
    if not found:
        return False
    pixel[0] = px
    pixel[1] = py
    x_u = v_py / determinant
    x_v = -u_py / determinant
    y_u = -v_px / determinant
    y_v = u_px / determinant
    w0 = (1.0 / (focal_px*focal_px))
    w1 = b1 + 1
    w2 = px - x0
    w3 = w1*w2
    w4 = w0*w3
    w5 = py - y0
    w6 = (1.0 / (focal_px*focal_px*focal_px))
    w7 = 4*w3*w5*w6
    w8 = (w5*w5)
    w9 = w6*w8
    w10 = 2*w9
    w11 = (w1*w1)
    w12 = (w2*w2)
    w13 = w11*w12
    w14 = w13*w6
    w15 = w0*w8
    w16 = w0*w13
    w17 = w15 + w16
    w18 = k3*w17
    w19 = k2 + w18
    w20 = k1 + w17*w19
    w21 = w17*w20
    w22 = 2*w14
    w23 = -w10 - w22
    w24 = w20*w23
    w25 = (1.0 / focal_px)
    w26 = w1*w25
    w27 = w2*w26
    w28 = w18*w23 + w19*w23
    w29 = w17*w27
    w30 = w0*w5
    w31 = w25*w5
    w32 = w17*w31
    w33 = -p1*w7 + p2*(-w22 - 6*w9) - w21*w30 + w24*w31 + w28*w32 - w30
    w34 = w1*w30
    w35 = 2*p2
    w36 = -2*px + 2*x0
    w37 = w11*w36
    w38 = w0*w37
    w39 = 3*p1
    w40 = w20*w6
    w41 = w0*w19
    w42 = w18*w38 + w37*w41
    w43 = 2*p1
    w44 = p2*w0
    w45 = w40*w5
    w46 = w32*w42 - w34*w43 + w37*w44 + w37*w45
    w47 = -2*py + 2*y0
    w48 = w0*w47
    w49 = w18*w48 + w19*w48
    w50 = 3*p2*w0*w47 + w17*w25*w49*w5 + w20*w47*w5*w6 - w21*w25 - w25 - w4*w43
    w51 = (w17*w17)
    w52 = w31*w51
    w53 = (w17*w17*w17)
    w54 = w31*w53
    w55 = w3*w30
    w56 = 2*w55
    w57 = 3*w15 + w16
    w58 = w2*w25
    w59 = w2*w30
    w60 = 2*b1 + 2
    w61 = w12*w60
    w62 = w0*w61
    w63 = w18*w62 + w41*w61
    w64 = w32*w63 + w43*w59 + w44*w61 + w45*w61
    u_p0 = b2*w33 + p1*(-w10 - 6*w14) - p2*w7 - w21*w4 + w24*w27 + w28*w29 - w4
    v_p0 = w33
    u_p1 = b2*w46 + (w1*w1*w1)*w2*w36*w40 - w21*w26 - w26 + w29*w42 - w34*w35 + w38*w39
    v_p1 = w46
    u_p2 = b2*w50 + p1*w48 + w29*w49 + w3*w40*w47 - w35*w4
    v_p2 = w50
    u_p3 = b2*w32 + w29
    v_p3 = w32
    u_p4 = b2*w52 + w27*w51
    v_p4 = w52
    u_p5 = b2*w54 + w27*w53
    v_p5 = w54
    u_p6 = b2*w56 + w15 + 3*w16
    v_p6 = w56
    u_p7 = b2*w57 + w56
    v_p7 = w57
    u_p8 = b2*w64 + w1*(w2*w2*w2)*w40*w60 + w21*w58 + w29*w63 + w35*w59 + w39*w62 + w58
    v_p8 = w64
    u_p9 = p2*w57 + w21*w31 + w31 + w43*w55
    v_p9 = 0.0
    d_values[0, 0] = -(x_u * u_p0 + x_v * v_p0)
    d_values[1, 0] = -(y_u * u_p0 + y_v * v_p0)
    d_values[0, 1] = -(x_u * u_p1 + x_v * v_p1)
    d_values[1, 1] = -(y_u * u_p1 + y_v * v_p1)
    d_values[0, 2] = -(x_u * u_p2 + x_v * v_p2)
    d_values[1, 2] = -(y_u * u_p2 + y_v * v_p2)
    d_values[0, 3] = -(x_u * u_p3 + x_v * v_p3)
    d_values[1, 3] = -(y_u * u_p3 + y_v * v_p3)
    d_values[0, 4] = -(x_u * u_p4 + x_v * v_p4)
    d_values[1, 4] = -(y_u * u_p4 + y_v * v_p4)
    d_values[0, 5] = -(x_u * u_p5 + x_v * v_p5)
    d_values[1, 5] = -(y_u * u_p5 + y_v * v_p5)
    d_values[0, 6] = -(x_u * u_p6 + x_v * v_p6)
    d_values[1, 6] = -(y_u * u_p6 + y_v * v_p6)
    d_values[0, 7] = -(x_u * u_p7 + x_v * v_p7)
    d_values[1, 7] = -(y_u * u_p7 + y_v * v_p7)
    d_values[0, 8] = -(x_u * u_p8 + x_v * v_p8)
    d_values[1, 8] = -(y_u * u_p8 + y_v * v_p8)
    d_values[0, 9] = -(x_u * u_p9 + x_v * v_p9)
    d_values[1, 9] = -(y_u * u_p9 + y_v * v_p9)
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
            carray(values, (10,)),
            x,
            y,
            z,
            carray(pixel, (2,)),
            carray(d_point, (2, 3)),
            carray(d_values, (2, row)),
        )
    )


@njit(cache=True, nogil=True, error_model="numpy")
def residual_kernel(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array
) -> bool:
    """Add to the measured position in `pixel` its residual in the corrected picture; see `graphos_core.cameras.model`."""
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
    k1 = values[3]
    k2 = values[4]
    k3 = values[5]
    p1 = values[6]
    p2 = values[7]
    b1 = values[8]
    b2 = values[9]
    px = pixel[0]
    py = pixel[1]
    t0 = px - x0
    t1 = (1.0 / focal_px)
    t2 = b1 + 1
    t3 = t1*t2
    t4 = t0*t3
    t5 = 2*p2
    t6 = (1.0 / (focal_px*focal_px))
    t7 = py - y0
    t8 = t6*t7
    t9 = t0*t2
    t10 = t8*t9
    t11 = (t7*t7)
    t12 = t11*t6
    t13 = (t2*t2)
    t14 = (t0*t0)
    t15 = t13*t14
    t16 = t15*t6
    t17 = t12 + 3*t16
    t18 = t12 + t16
    t19 = k3*t18
    t20 = k2 + t19
    t21 = k1 + t18*t20
    t22 = t18*t21
    t23 = t1*t7
    t24 = 2*p1
    t25 = 3*t12 + t16
    t26 = p2*t25 + t10*t24 + t22*t23 + t23
    t27 = t6*t9
    t28 = (1.0 / (focal_px*focal_px*focal_px))
    t29 = 4*t28*t7*t9
    t30 = t11*t28
    t31 = 2*t30
    t32 = t15*t28
    t33 = 2*t32
    t34 = -t31 - t33
    t35 = t21*t34
    t36 = t19*t34 + t20*t34
    t37 = t18*t4
    t38 = t18*t23
    t39 = -p1*t29 + p2*(-6*t30 - t33) - t22*t8 + t23*t35 + t36*t38 - t8
    t40 = t2*t8
    t41 = -2*px + 2*x0
    t42 = t13*t41
    t43 = t42*t6
    t44 = 3*p1
    t45 = t21*t28
    t46 = t20*t6
    t47 = t19*t43 + t42*t46
    t48 = p2*t6
    t49 = t45*t7
    t50 = -t24*t40 + t38*t47 + t42*t48 + t42*t49
    t51 = -2*py + 2*y0
    t52 = t51*t6
    t53 = t19*t52 + t20*t52
    t54 = 3*p2*t51*t6 + t1*t18*t53*t7 - t1*t22 - t1 + t21*t28*t51*t7 - t24*t27
    t55 = (t18*t18)
    t56 = t23*t55
    t57 = (t18*t18*t18)
    t58 = t23*t57
    t59 = 2*t10
    t60 = t0*t1
    t61 = t0*t8
    t62 = 2*b1 + 2
    t63 = t14*t62
    t64 = t6*t63
    t65 = t19*t64 + t46*t63
    t66 = t24*t61 + t38*t65 + t48*t63 + t49*t63
    u_now = b2*t26 + p1*t17 + t10*t5 + t22*t4 + t4
    v_now = t26
    u_p0 = b2*t39 + p1*(-t31 - 6*t32) - p2*t29 - t22*t27 - t27 + t35*t4 + t36*t37
    v_p0 = t39
    u_p1 = b2*t50 + t0*(t2*t2*t2)*t41*t45 - t22*t3 - t3 + t37*t47 - t40*t5 + t43*t44
    v_p1 = t50
    u_p2 = b2*t54 + p1*t52 - t27*t5 + t37*t53 + t45*t51*t9
    v_p2 = t54
    u_p3 = b2*t38 + t37
    v_p3 = t38
    u_p4 = b2*t56 + t4*t55
    v_p4 = t56
    u_p5 = b2*t58 + t4*t57
    v_p5 = t58
    u_p6 = b2*t59 + t17
    v_p6 = t59
    u_p7 = b2*t25 + t59
    v_p7 = t25
    u_p8 = b2*t66 + (t0*t0*t0)*t2*t45*t62 + t22*t60 + t37*t65 + t44*t64 + t5*t61 + t60
    v_p8 = t66
    u_p9 = t26
    v_p9 = 0.0
    pixel[0] = px + focal_px * (u - u_now)
    pixel[1] = py + focal_px * (v - v_now)
    d_values[0, 0] = u - u_now - focal_px * u_p0
    d_values[0, 1] = -focal_px * u_p1
    d_values[0, 2] = -focal_px * u_p2
    d_values[0, 3] = -focal_px * u_p3
    d_values[0, 4] = -focal_px * u_p4
    d_values[0, 5] = -focal_px * u_p5
    d_values[0, 6] = -focal_px * u_p6
    d_values[0, 7] = -focal_px * u_p7
    d_values[0, 8] = -focal_px * u_p8
    d_values[0, 9] = -focal_px * u_p9
    d_point[0, 0] = focal_px * u_x
    d_point[0, 1] = focal_px * u_y
    d_point[0, 2] = focal_px * u_z
    d_values[1, 0] = v - v_now - focal_px * v_p0
    d_values[1, 1] = -focal_px * v_p1
    d_values[1, 2] = -focal_px * v_p2
    d_values[1, 3] = -focal_px * v_p3
    d_values[1, 4] = -focal_px * v_p4
    d_values[1, 5] = -focal_px * v_p5
    d_values[1, 6] = -focal_px * v_p6
    d_values[1, 7] = -focal_px * v_p7
    d_values[1, 8] = -focal_px * v_p8
    d_values[1, 9] = -focal_px * v_p9
    d_point[1, 0] = focal_px * v_x
    d_point[1, 1] = focal_px * v_y
    d_point[1, 2] = focal_px * v_z
    return True


@cfunc(SIGNATURE, cache=True, error_model="numpy")
def residual_entry(
    values: Array, x: float, y: float, z: float, pixel: Array, d_point: Array, d_values: Array, row: int
) -> int:
    """Call `residual_kernel` from compiled code by address; see `graphos_core.cameras.entry`."""
    return int(
        residual_kernel(
            carray(values, (10,)),
            x,
            y,
            z,
            carray(pixel, (2,)),
            carray(d_point, (2, 3)),
            carray(d_values, (2, row)),
        )
    )
