r"""How an undistorted ray becomes a position (u, v) in units of the principal distance.

With the angle θ from the viewing axis: ``central`` r = tan θ, ``equidistant`` r = θ, ``equisolid`` r = 2 sin(θ/2)
(Schneider, Schwalbe and Maas 2009, Validation of geometric models for fisheye lenses, ISPRS Journal 64), and
``spherical``: u the longitude atan2(X, Z), v the latitude downwards, the equirectangular panorama. The formulas take a
library ``m`` (numpy or sympy), so that the generator differentiates the same lines that the tests evaluate.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data.record import Array

TINY = 1e-60
"""Added to squared distances from the axis, where 0/0 has a limit; far below what rounding keeps."""


def central(m: Any, x: Any, y: Any, z: Any) -> tuple[Any, Any]:
    """Return (X/Z, Y/Z)."""
    return x / z, y / z


def equidistant(m: Any, x: Any, y: Any, z: Any) -> tuple[Any, Any]:
    """Return the direction across the axis times θ."""
    across = m.sqrt(x * x + y * y + TINY)
    factor = m.atan2(across, z) / across
    return x * factor, y * factor


def equisolid(m: Any, x: Any, y: Any, z: Any) -> tuple[Any, Any]:
    """Return the direction across the axis times 2 sin(θ/2), which is (X, Y)·√(2/(D (D + Z))) with the distance D."""
    distance = m.sqrt(x * x + y * y + z * z)
    factor = m.sqrt(2 / (distance * (distance + z)))
    return x * factor, y * factor


def spherical(m: Any, x: Any, y: Any, z: Any) -> tuple[Any, Any]:
    """Return longitude and latitude, both 0 on the viewing axis, the latitude positive downwards."""
    return m.atan2(x, z), m.atan2(y, m.sqrt(x * x + z * z))


PROJECTIONS = {
    "central": central,
    "equidistant": equidistant,
    "equisolid": equisolid,
    "spherical": spherical,
}

NO_IMAGE = {
    "central": "z <= 0.0",
    "equidistant": "z <= 0.0 and x == 0.0 and y == 0.0",
    "equisolid": "z <= 0.0 and x == 0.0 and y == 0.0",
    "spherical": "x == 0.0 and z == 0.0",
}
"""Condition, in compiled code, for a point that has no image."""


def ideal_direction(projection: str, position: Array) -> Array:
    """Return the unit directions of undistorted positions; positions beyond the sphere are brought to its edge.

    Parameters
    ----------
    projection : str
        A wide one.
    position : float64 (n, 2)
        (u, v).

    Returns
    -------
    float64 (n, 3)
    """
    u, v = position[:, 0], position[:, 1]
    if projection == "spherical":
        latitude = np.clip(v, -1.57, 1.57)
        return np.stack(
            [np.sin(u) * np.cos(latitude), np.sin(latitude), np.cos(u) * np.cos(latitude)], axis=1
        )
    r = np.hypot(u, v)
    theta = r if projection == "equidistant" else 2.0 * np.arcsin(np.minimum(0.5 * r, 1.0))
    theta = np.minimum(theta, 3.1)
    across = np.sin(theta) / np.where(r > 0.0, r, 1.0)
    return np.stack([across * u, across * v, np.cos(theta)], axis=1)


REACH = {"central": np.inf, "equidistant": np.pi, "equisolid": 2.0, "spherical": 0.5 * np.pi}
"""Distance from the axis, in units of f, up to which positions in every direction belong to a ray."""


def on_sphere(projection: str, position: Array) -> Array:
    """Say which positions (n, 2) of a wide projection belong to a direction: bool (n,)."""
    if projection == "spherical":
        return np.asarray((np.abs(position[:, 0]) <= np.pi) & (np.abs(position[:, 1]) < 0.5 * np.pi))
    return np.asarray(np.hypot(*position.T) < REACH[projection])
