"""Attitude angles of photos in the orders that programs use, and back to rotations."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array
from graphos_core.geometry.rotation import FLIP, matrix_from_opk, opk_from_matrix

ORDERS = {
    "omega phi kappa": "omega first: world from image = Rx(ω) Ry(φ) Rz(κ), image frame x right, y up, z backward "
    "(Kraus 2007, section 2.1.2)",
    "phi omega kappa": "phi first: world from image = Ry(φ) Rx(ω) Rz(κ), the same image frame (Kraus 2007, section 2.1.2)",
    "yaw pitch roll": "aircraft angles (ARINC 705): north-east-down from body = Rz(yaw) Ry(pitch) Rx(roll); the camera "
    "looks along the body's z, the top of the image points forward, the world is east-north-up",
}
"""Angle orders by name, and what each means."""

UNITS = {"deg": np.pi / 180.0, "gon": np.pi / 200.0, "rad": 1.0}
"""Radians per unit of angle."""

NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
BODY_FROM_CAM = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Camera x right is the body's y, camera y down is backward, the axis is the body's z."""


def rotation_from_angles(first: float, second: float, third: float, order: str) -> Array:
    """Return ``cam_from_world`` (3, 3) from three angles, radians, in the sequence that `order` names."""
    if order == "omega phi kappa":
        return matrix_from_opk(first, second, third)
    if order == "phi omega kappa":
        return FLIP @ (_ry(first) @ _rx(second) @ _rz(third)).T
    ned_from_body = _rz(first) @ _ry(second) @ _rx(third)
    cam_from_world: Array = (NED_FROM_ENU.T @ ned_from_body @ BODY_FROM_CAM).T
    return cam_from_world


def angles_from_rotation(rotation: Array, order: str) -> tuple[float, float, float]:
    """Return the three angles, radians, of ``cam_from_world`` (3, 3); the inverse of `rotation_from_angles`."""
    if order == "omega phi kappa":
        return opk_from_matrix(rotation)
    if order == "phi omega kappa":
        m = (FLIP @ np.asarray(rotation)).T
        omega = float(np.arcsin(np.clip(-m[1, 2], -1.0, 1.0)))
        return float(np.arctan2(m[0, 2], m[2, 2])), omega, float(np.arctan2(m[1, 0], m[1, 1]))
    b = NED_FROM_ENU @ np.asarray(rotation).T @ BODY_FROM_CAM.T
    pitch = float(np.arcsin(np.clip(-b[2, 0], -1.0, 1.0)))
    return float(np.arctan2(b[1, 0], b[0, 0])), pitch, float(np.arctan2(b[2, 1], b[2, 2]))


def _rx(a: float) -> Array:
    return np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])


def _ry(a: float) -> Array:
    return np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])


def _rz(a: float) -> Array:
    return np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
