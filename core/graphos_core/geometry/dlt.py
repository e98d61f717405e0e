r"""Direct linear transformation: object points to pixels by eleven coefficients, and what they mean.

Collinearity without approximate values: ``x = (L₁X + L₂Y + L₃Z + L₄)/(L₉X + L₁₀Y + L₁₁Z + 1)``,
``y = (L₅X + L₆Y + L₇Z + L₈)/(L₉X + L₁₀Y + L₁₁Z + 1)`` (Abdel-Aziz and Karara 1971), in matrix form ``x ~ P X``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.normalisation import homogeneous, normalise, null_vector
from graphos_core.text import Text

FLAT = 1e-5
"""Object points count as coplanar when they leave their plane by less than this share of their extent."""


@dataclass(frozen=True)
class DirectLinear:
    """Eleven coefficients and how well they are determined; false in a condition when they are not.

    Attributes
    ----------
    matrix : float64 (3, 4)
        P of norm 1 with positive third homogeneous coordinate for points before the camera.
    residuals : float64 (n, 2)
        Projected − measured, px.
    singular_values : float64 (12,)
        Of the normalised linear system: the last is the misfit, a second small one means that the points do not
        determine the coefficients.
    reason : str
        Why there are none; empty where there are.
    """

    matrix: Array
    residuals: Array
    singular_values: Array
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason

    @property
    def coefficients(self) -> Array:
        """L₁ … L₁₁ (11,); infinite when the object's origin lies in the plane through the centre, parallel to the image."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return (self.matrix / self.matrix[2, 3]).ravel()[:11]

    @property
    def rms_px(self) -> float:
        """Root mean square of the residuals per coordinate, px."""
        return float(np.sqrt((self.residuals**2).mean()))


@dataclass(frozen=True)
class Decomposed:
    """Interior and exterior orientation of a projection matrix, ``P ~ K R [I | −C]``.

    Attributes
    ----------
    interior : float64 (3, 3)
        K: upper triangular, ``K[2, 2] = 1``, positive diagonal; ``K[0, 0]`` and ``K[1, 1]`` are the principal
        distances along x and y, ``K[0, 1]`` the shear, ``K[:2, 2]`` the principal point, px.
    rotation : float64 (3, 3)
        ``cam_from_world``.
    centre : float64 (3,)
        Projection centre in the object frame.
    """

    interior: Array
    rotation: Array
    centre: Array


def direct_linear_transformation(points: Array, pixels: Array) -> DirectLinear:
    """Estimate the eleven coefficients from object points and their pixels.

    The smallest singular vector of ``x × P X = 0`` in normalised coordinates (Hartley and Zisserman 2004, algorithm
    7.1 without the iteration).

    Parameters
    ----------
    points : float64 (n, 3)
        Object points, n ≥ 6, not in one plane.
    pixels : float64 (n, 2)
        Their measured positions, px.

    Returns
    -------
    DirectLinear
    """
    points, pixels = np.asarray(points, dtype=np.float64), np.asarray(pixels, dtype=np.float64)
    if len(points) < 6:
        return _failed(pixels, Text("only {count} points, 6 needed", count=len(points)))
    if not (np.isfinite(points).all() and np.isfinite(pixels).all()):
        return _failed(pixels, Text("some coordinates are not numbers"))
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[2] < FLAT * spread[0]:
        return _failed(pixels, Text("the object points lie in one plane"))
    x, from_points = normalise(points)
    u, from_pixels = normalise(pixels)
    zero = np.zeros_like(x)
    rows = np.vstack([np.hstack([x, zero, -u[:, :1] * x]), np.hstack([zero, x, -u[:, 1:2] * x])])
    solution, singular = null_vector(rows)
    if singular[-2] < max(1e-9 * singular[0], 2.0 * singular[-1]):
        return _failed(
            pixels,
            Text("the points and the projection centre lie on one twisted cubic or nearly so"),
            singular,
        )
    matrix = np.linalg.inv(from_pixels) @ solution.reshape(3, 4) @ from_points
    projected = homogeneous(points) @ matrix.T
    matrix /= np.copysign(np.linalg.norm(matrix), np.median(projected[:, 2]))
    with np.errstate(divide="ignore", invalid="ignore"):
        residuals = projected[:, :2] / projected[:, 2:] - pixels
    return DirectLinear(matrix, residuals, singular)


def decompose_projection(matrix: Array) -> Decomposed:
    """Split a projection matrix (3, 4) into interior orientation, rotation and projection centre.

    RQ decomposition of its left 3 × 3 part (Hartley and Zisserman 2004, section 6.2.4). The sign of the matrix is
    chosen so that the rotation is proper; a photo that is mirrored has no such rotation with the points before the
    camera.

    Raises
    ------
    ValueError
        When the left part is singular: the projection centre lies at infinity.
    """
    left = np.asarray(matrix, dtype=np.float64)[:, :3]
    if np.linalg.cond(left) > 1e12:
        raise ValueError("the projection centre lies at infinity")
    sign = np.sign(np.linalg.det(left))
    flip = np.eye(3)[::-1]
    q, r = np.linalg.qr((flip @ (sign * left)).T)
    interior, rotation = flip @ r.T @ flip, flip @ q.T
    signs = np.sign(np.diag(interior))
    interior, rotation = interior * signs, rotation * signs[:, None]
    return Decomposed(interior / interior[2, 2], rotation, -np.linalg.solve(left, np.asarray(matrix)[:, 3]))


def compose_projection(interior: Array, rotation: Array, centre: Array) -> Array:
    """Return ``P = K R [I | −C]`` (3, 4)."""
    left = np.asarray(interior) @ np.asarray(rotation)
    return np.column_stack([left, -left @ np.asarray(centre)])


def _failed(pixels: Array, reason: str, singular: Array | None = None) -> DirectLinear:
    return DirectLinear(
        np.zeros((3, 4)),
        np.full((len(pixels), 2), np.nan),
        np.full(12, np.nan) if singular is None else singular,
        reason,
    )
