"""Rotations: vectors, matrices, quaternions, and omega, phi, kappa."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array

FLIP = np.diag([1.0, -1.0, -1.0])
"""Image frame (x right, y up, z backward) from camera frame (x right, y down, z forward), and back."""


def skew(v: Array) -> Array:
    """Return the matrix (3, 3) with ``skew(v) @ w == cross(v, w)``."""
    x, y, z = (float(c) for c in v)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def matrix_from_vector(vector: Array) -> Array:
    """Return the rotation (3, 3) about ``vector`` by its length in radians (Rodrigues)."""
    vector = np.asarray(vector, dtype=np.float64)
    angle = float(np.linalg.norm(vector))
    k = skew(vector)
    if angle < 1e-8:
        return np.eye(3) + k + 0.5 * k @ k
    return np.eye(3) + np.sin(angle) / angle * k + (1.0 - np.cos(angle)) / angle**2 * (k @ k)


def vector_from_matrix(rotation: Array) -> Array:
    """Return the rotation vector (3,) of a rotation (3, 3), length 0 to π radians."""
    w, x, y, z = quaternion_from_matrix(rotation)
    sine = float(np.sqrt(x * x + y * y + z * z))
    if sine < 1e-12:
        return np.array([2.0 * x, 2.0 * y, 2.0 * z])
    return 2.0 * np.arctan2(sine, w) / sine * np.array([x, y, z])


def angle_between(a: Array, b: Array) -> float:
    """Return the angle of the rotation from `a` to `b`, radians, 0 to π."""
    return float(np.linalg.norm(vector_from_matrix(np.asarray(b) @ np.asarray(a).T)))


def quaternion_from_matrix(rotation: Array) -> Array:
    """Return the unit quaternion (w, x, y, z) with w ≥ 0 of a rotation (3, 3)."""
    m = np.asarray(rotation, dtype=np.float64)
    t = np.array([1 + m[0, 0] + m[1, 1] + m[2, 2], 1 + m[0, 0] - m[1, 1] - m[2, 2],
                  1 - m[0, 0] + m[1, 1] - m[2, 2], 1 - m[0, 0] - m[1, 1] + m[2, 2]])  # fmt: skip
    i = int(np.argmax(t))  # the largest component keeps the division well conditioned
    s = 0.5 / np.sqrt(t[i])
    a, b, c = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    d, e, f = m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1]
    q = np.array([[t[0], a, b, c], [a, t[1], d, e], [b, d, t[2], f], [c, e, f, t[3]]][i]) * s
    q /= np.linalg.norm(q)
    return -q if q[0] < 0 else q


def matrix_from_quaternion(q: Array) -> Array:
    """Return the rotation (3, 3) of a quaternion (w, x, y, z), which need not have length 1."""
    w, x, y, z = np.asarray(q, dtype=np.float64) / np.linalg.norm(q)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def matrix_from_opk(omega: float, phi: float, kappa: float) -> Array:
    """Return ``cam_from_world`` (3, 3) from omega, phi, kappa in radians.

    ``world_from_image = Rx(ω) Ry(φ) Rz(κ)`` with right-handed active rotations and an image frame x right, y up,
    z backward (Kraus 2007, section 2.1.2; Luhmann et al. 2020, section 2.2.2).
    """
    co, so, cp, sp, ck, sk = (
        np.cos(omega),
        np.sin(omega),
        np.cos(phi),
        np.sin(phi),
        np.cos(kappa),
        np.sin(kappa),
    )
    rx = np.array([[1, 0, 0], [0, co, -so], [0, so, co]])
    ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    rz = np.array([[ck, -sk, 0], [sk, ck, 0], [0, 0, 1]])
    return FLIP @ (rx @ ry @ rz).T


def opk_from_matrix(cam_from_world: Array) -> tuple[float, float, float]:
    """Return omega, phi, kappa in radians; the inverse of `matrix_from_opk`, φ in [−π/2, π/2].

    At φ = ±π/2 only κ ± ω is defined (gimbal lock): ω is then 0.
    """
    m = (FLIP @ np.asarray(cam_from_world)).T
    phi = float(np.arcsin(np.clip(m[0, 2], -1.0, 1.0)))
    if np.hypot(m[0, 0], m[0, 1]) < 1e-9:
        return 0.0, phi, float(np.arctan2(m[1, 0], m[1, 1]))
    return float(np.arctan2(-m[1, 2], m[2, 2])), phi, float(np.arctan2(-m[0, 1], m[0, 0]))


def look_at(centre: Array, target: Array, up: Array = (0.0, 0.0, 1.0)) -> Array:  # type: ignore[assignment]
    """Return ``cam_from_world`` (3, 3) of a camera at `centre` that looks at `target`, image top towards `up`."""
    z = np.asarray(target, dtype=np.float64) - np.asarray(centre, dtype=np.float64)
    z /= np.linalg.norm(z)
    x = np.cross(z, np.asarray(up, dtype=np.float64))
    if np.linalg.norm(x) < 1e-9:
        x = np.cross(z, [0.0, 1.0, 0.0])
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def matrix_from_turns(axes: str, angles: Array) -> Array:
    """Return the product of three right-handed turns about axes, in the order written.

    ``matrix_from_turns("xyz", (ω, φ, κ))`` is ``Rx(ω) Ry(φ) Rz(κ)``, the ``world_from_image`` of `matrix_from_opk`.

    Parameters
    ----------
    axes : str
        Three different letters of ``"xyz"``; from left to right each axis is carried along by the turns before it.
    angles : float64 (3,)
        Radians, in the order of `axes`.
    """
    turned = np.eye(3)
    for axis, angle in zip(axes, angles, strict=True):
        turned = turned @ matrix_from_vector(float(angle) * np.eye(3)["xyz".index(axis)])
    return turned


def turns_from_matrix(axes: str, rotation: Array) -> Array:
    """Return the three angles (3,), radians, of a rotation (3, 3); the inverse of `matrix_from_turns`.

    The middle angle is in [−π/2, π/2]. At its ends only sum or difference of the others is defined (gimbal lock):
    the first is then 0. Source: Diebel 2006, Representing attitude, section 8, for the six sequences without repetition.
    """
    i, j, k = ("xyz".index(axis) for axis in axes)
    sign = 1.0 if (i, j, k) in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1.0
    m = np.asarray(rotation, dtype=np.float64)
    cosine = float(np.hypot(m[i, i], m[i, j]))
    middle = float(np.arctan2(sign * m[i, k], cosine))
    if cosine < 1e-9:
        return np.array([0.0, middle, np.arctan2(sign * m[j, i], m[j, j])])
    return np.array([np.arctan2(-sign * m[j, k], m[k, k]), middle, np.arctan2(-sign * m[i, j], m[i, i])])


def turn_axes(axes: str, angles: Array) -> Array:
    """Return the axes (3, 3), one per row, about which a small change of each angle turns: unit vectors, outer frame.

    ``∂R/∂αᵢ = [aᵢ]× R``. Their determinant is ±cos of the middle angle: at ±90° the first and the third coincide
    (gimbal lock).
    """
    first, second = (float(angle) for angle in list(angles)[:2])
    unit = np.eye(3)
    i, j, k = ("xyz".index(axis) for axis in axes)
    outer = matrix_from_vector(first * unit[i])
    return np.stack([unit[i], outer @ unit[j], outer @ matrix_from_vector(second * unit[j]) @ unit[k]])


def shortest_turn(a: Array, b: Array) -> Array:
    """Return the rotation (3, 3) by the smallest angle that takes the direction `a` (3,) to `b` (3,).

    For opposite directions, where every axis across is as good, one of them.
    """
    a, b = (np.asarray(v, dtype=np.float64) / np.linalg.norm(v) for v in (a, b))
    axis, cosine = np.cross(a, b), float(a @ b)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        if cosine > 0:
            return np.eye(3)
        axis = np.cross(a, np.eye(3)[int(np.argmin(np.abs(a)))])
        sine = float(np.linalg.norm(axis))
    return matrix_from_vector(axis / sine * np.arctan2(float(np.linalg.norm(np.cross(a, b))), cosine))
