r"""Coplanarity of two rays and the base, and its linear solution by eight points.

Two rays that meet lie in one plane with the base: ``t · (R y_a × y_b) = 0``, written ``y_bᵀ E y_a = 0`` with
``E = [t]× R`` (Longuet-Higgins 1981). Nine coefficients up to scale are linear in eight points; for pixels of
cameras that nobody calibrated the same holds with the fundamental matrix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.normalisation import normalise, null_vector
from graphos_core.text import Text


@dataclass(frozen=True)
class EightPoint:
    """A linear solution; false in a condition when the points do not determine one.

    Attributes
    ----------
    matrix : float64 (3, 3)
        Essential or fundamental matrix of Frobenius norm 1 that fulfils its inner constraints; zeros where none.
    linear : float64 (3, 3)
        The same before its constraints were imposed.
    singular_values : float64 (9,)
        Of the normalised linear system; the last but one is small when the points are degenerate (a plane, all
        rays through one line, a twisted surface through both centres).
    reason : str
    """

    matrix: Array
    linear: Array
    singular_values: Array
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


def coplanarity(rotation: Array, translation: Array, a: Array, b: Array) -> Array:
    """Return the volume (n,) spanned by the base and both rays, ``t · (R y_a × y_b)``: 0 where they meet.

    Parameters
    ----------
    rotation, translation : float64 (3, 3), (3,)
        ``b_from_a``: ``p_b = R p_a + t``.
    a, b : float64 (n, 3)
        Rays in the camera frames, any length.
    """
    return np.cross(np.asarray(a) @ np.asarray(rotation).T, np.asarray(b)) @ np.asarray(translation)


def longuet_higgins(a: Array, b: Array) -> EightPoint:
    """Return the essential matrix of eight or more pairs of rays (Longuet-Higgins 1981).

    The linear solution is projected to the nearest matrix with two equal singular values and a zero
    (Hartley and Zisserman 2004, section 11.7.3).

    Parameters
    ----------
    a, b : float64 (n, 3)
        Corresponding rays in the camera frames, any length; all field angles.
    """
    a, b = (np.asarray(side, dtype=np.float64) for side in (a, b))
    a, b = (side / np.linalg.norm(side, axis=1, keepdims=True) for side in (a, b))
    linear, singular, reason = _linear(a, b)
    u, _, vt = np.linalg.svd(linear)
    essential = (u * [1.0, 1.0, 0.0]) @ vt / np.sqrt(2.0)
    return EightPoint(np.zeros((3, 3)) if reason else essential, linear, singular, reason)


def eight_point_fundamental(xy_a: Array, xy_b: Array, weights: Array | None = None) -> EightPoint:
    """Return the fundamental matrix of eight or more pairs of pixels (Hartley 1997, normalised eight points).

    Parameters
    ----------
    xy_a, xy_b : float64 (n, 2)
        Corresponding distortion-free pixels.
    weights : float64 (n,), optional
        Of the squared algebraic residuals.
    """
    a, from_a = normalise(xy_a)
    b, from_b = normalise(xy_b)
    linear, singular, reason = _linear(a, b, weights)
    u, s, vt = np.linalg.svd(linear)
    constrained = from_b.T @ ((u * [s[0], s[1], 0.0]) @ vt) @ from_a
    raw = from_b.T @ linear @ from_a
    unit = constrained / np.linalg.norm(constrained)
    return EightPoint(np.zeros((3, 3)) if reason else unit, raw / np.linalg.norm(raw), singular, reason)


def _linear(a: Array, b: Array, weights: Array | None = None) -> tuple[Array, Array, str]:
    """Return the matrix (3, 3) of ``b_iᵀ M a_i = 0``, the singular values, and why it is not determined."""
    if len(a) < 8:
        return np.eye(3), np.full(9, np.nan), Text("only {count} pairs of points, 8 needed", count=len(a))
    rows = (b[:, :, None] * a[:, None, :]).reshape(len(a), 9)
    if weights is not None:
        rows = rows * np.sqrt(weights)[:, None]
    solution, singular = null_vector(rows)
    reason = ""
    if singular[-2] < max(1e-9 * singular[0], 2.0 * singular[-1]):
        reason = Text("the points are degenerate: they lie in one plane, or the photos have no base")
    return solution.reshape(3, 3), singular, reason


def decompose_essential(essential: Array) -> list[tuple[Array, Array]]:
    """Return the four relative orientations (R, t) of an essential matrix, ``|t| = 1``.

    Only one puts points before both cameras (Hartley and Zisserman 2004, result 9.19).
    """
    u, _, vt = np.linalg.svd(np.asarray(essential, dtype=np.float64))
    w = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    sign = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    return [(sign * u @ m @ vt, s * u[:, 2]) for m in (w, w.T) for s in (1.0, -1.0)]
