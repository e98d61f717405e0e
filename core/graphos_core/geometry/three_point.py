r"""Three points and their rays determine the exterior orientation: all solutions of many samples at once.

Grunert's problem: the distances s₁, s₂, s₃ of the points from the centre fulfil three cosine laws; with
``s₂ = u s₁``, ``s₃ = v s₁`` a quartic in v remains (Grunert 1841; Haralick et al. 1994, section 3.1). For rays of any
field angle.
"""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array


def three_point(points: Array, directions: Array) -> tuple[Array, Array, Array]:
    """Return the exterior orientations of samples of three points.

    Parameters
    ----------
    points : float64 (s, 3, 3)
        Object points of each sample.
    directions : float64 (s, 3, 3)
        Their unit rays in the camera frame.

    Returns
    -------
    float64 (k, 3, 3), (k, 3)
        ``cam_from_world`` and translation, ``p_cam = R X + t``, of all real solutions before the camera.
    int (k,)
        Sample from which each came.
    """
    side = np.stack(
        [((points[:, i] - points[:, j]) ** 2).sum(axis=1) for i, j in ((1, 2), (0, 2), (0, 1))], 1
    )
    cosine = np.stack(
        [(directions[:, i] * directions[:, j]).sum(axis=1) for i, j in ((1, 2), (0, 2), (0, 1))], 1
    )
    good = np.flatnonzero((side > 0.0).all(axis=1))
    side, cosine = side[good], cosine[good]
    roots = _quartic_roots(_quartic(side, cosine))
    which, root = np.nonzero((np.abs(roots.imag) < 1e-4 * (1.0 + np.abs(roots.real))) & (roots.real > 0.0))
    distances = _distances(side[which], cosine[which], roots[which, root].real)
    kept = (distances > 0.0).all(axis=1) & np.isfinite(distances).all(axis=1)
    which, distances = good[which[kept]], distances[kept]
    rotations, translations = _poses(points[which], distances[:, :, None] * directions[which])
    return rotations, translations, which


def _quartic(side: Array, cosine: Array) -> Array:
    """Coefficients (s, 5) of the quartic in v, highest first; squared sides a², b², c² and cosines α, β, γ."""
    (a2, b2, c2), (ca, cb, cg) = side.T, cosine.T
    p, q = (a2 - c2) / b2, (a2 + c2) / b2
    r, w = c2 / b2, a2 / b2
    return np.stack([
        (p - 1) ** 2 - 4 * r * ca**2,
        4 * (p * (1 - p) * cb - (1 - q) * ca * cg + 2 * r * ca**2 * cb),
        2 * (p**2 - 1 + 2 * p**2 * cb**2 + 2 * (1 - r) * ca**2 - 4 * q * ca * cb * cg + 2 * (1 - w) * cg**2),
        4 * (-p * (1 + p) * cb + 2 * w * cg**2 * cb - (1 - q) * ca * cg),
        (1 + p) ** 2 - 4 * w * cg**2,
    ], axis=1)  # fmt: skip


def _quartic_roots(coefficients: Array) -> Array:
    """Return the roots (s, 4) by the companion matrices; NaN where the quartic degenerates."""
    lead = coefficients[:, 0]
    usable = np.abs(lead) > 1e-12 * np.abs(coefficients).max(axis=1)
    roots = np.full((len(coefficients), 4), np.nan + 0j)
    companion = np.zeros((int(usable.sum()), 4, 4))
    companion[:, 0] = -coefficients[usable, 1:] / lead[usable, None]
    companion[:, [1, 2, 3], [0, 1, 2]] = 1.0
    roots[usable] = np.linalg.eigvals(companion)
    return roots


def _distances(side: Array, cosine: Array, v: Array) -> Array:
    """Return the distances (k, 3) of the three points, polished by Newton's method on the cosine laws."""
    (a2, b2, c2), (ca, cb, cg) = side.T, cosine.T
    p = (a2 - c2) / b2
    with np.errstate(divide="ignore", invalid="ignore"):
        u = ((p - 1) * v**2 - 2 * p * cb * v + 1 + p) / (2 * (cg - v * ca))
        first = np.sqrt(b2 / (1 + v**2 - 2 * v * cb))
    s = np.stack([first, u * first, v * first], axis=1)
    for _ in range(3):
        s1, s2, s3 = s.T
        misfit = np.stack([
            s2**2 + s3**2 - 2 * s2 * s3 * ca - a2, s1**2 + s3**2 - 2 * s1 * s3 * cb - b2,
            s1**2 + s2**2 - 2 * s1 * s2 * cg - c2,
        ], axis=1)  # fmt: skip
        zero = np.zeros_like(s1)
        slope = 2.0 * np.stack([
            np.stack([zero, s2 - s3 * ca, s3 - s2 * ca], 1), np.stack([s1 - s3 * cb, zero, s3 - s1 * cb], 1),
            np.stack([s1 - s2 * cg, s2 - s1 * cg, zero], 1),
        ], axis=1)  # fmt: skip
        safe = np.flatnonzero(np.isfinite(slope).all(axis=(1, 2)))
        size = np.abs(slope[safe]).max(axis=(1, 2)) ** 3
        safe = safe[np.abs(np.linalg.det(slope[safe])) > 1e-12 * size]
        s[safe] -= np.linalg.solve(slope[safe], misfit[safe][:, :, None])[:, :, 0]
    return s


def _poses(points: Array, seen: Array) -> tuple[Array, Array]:
    """Return the rigid motions (k) that take triangles (k, 3, 3) to congruent ones: their frames onto each other."""
    rotations = np.swapaxes(_frame(seen), 1, 2) @ _frame(points)
    return rotations, seen.mean(axis=1) - np.einsum("kij,kj->ki", rotations, points.mean(axis=1))


def _frame(triangle: Array) -> Array:
    """Return a right-handed frame (k, 3, 3) by rows, bound to a triangle."""
    first = triangle[:, 1] - triangle[:, 0]
    normal = np.cross(first, triangle[:, 2] - triangle[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        first = first / np.linalg.norm(first, axis=1, keepdims=True)
        normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first), normal], axis=1)
