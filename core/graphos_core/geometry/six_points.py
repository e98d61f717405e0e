r"""Three photos of six points: the minimal case of the trifocal tensor, and a robust estimation built on it.

Five of the points become a basis of space, four of them a basis of each image; what is left of a camera then has four
coefficients (α, β, γ, δ) and maps the fifth and sixth point like two cameras that see *it*. The matrix F of that dual
pair has five unknowns, three photos give three equations, and ``det F = 0`` is a cubic: one or three solutions
(Quan 1995; Carlsson and Weinshall 1998; Hartley and Zisserman 2004, section 20.2.4).
"""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.normalisation import homogeneous, normalise, null_vector
from graphos_core.geometry.rotation import skew
from graphos_core.geometry.trifocal import (
    Trifocal,
    linear_trifocal,
    projections_from_trifocal,
    transfer_distances,
    transfer_misfits,
    trifocal_from_projections,
)
from graphos_core.text import Text

SAMPLES, CONFIDENCE = 1000, 0.999

OFF_DIAGONAL = tuple((i, j) for i in range(3) for j in range(3) if i != j)


def six_point_trifocal(xy_a: Array, xy_b: Array, xy_c: Array) -> list[Array]:
    """Return the one to three tensors (3, 3, 3) of six points in three photos; none when they are degenerate.

    Parameters
    ----------
    xy_a, xy_b, xy_c : float64 (6, 2)
        No three of the first four on one line in any photo.
    """
    bases, rows = [], []
    for xy in (xy_a, xy_b, xy_c):
        to_basis = _to_basis(homogeneous(xy))
        if to_basis is None:
            return []
        fifth, sixth = (homogeneous(xy[4:]) @ to_basis.T) / np.linalg.norm(to_basis)
        bases.append((to_basis, fifth, sixth))
        rows.append([sixth[i] * fifth[j] for i, j in OFF_DIAGONAL])
    system = np.vstack(
        [np.array(rows), np.ones(6)]
    )  # the sum is zero: both dual cameras map (0, 0, 0, 1) alike
    _, size, vt = np.linalg.svd(system)
    if size[3] < 1e-12 * size[0]:
        return []
    found = []
    for dual in _singular_members(_matrix(vt[4]), _matrix(vt[5])):
        cameras = _cameras(dual, bases)
        if cameras is not None:
            found.append(trifocal_from_projections(*cameras))
    return [tensor for tensor in found if np.isfinite(tensor).all() and tensor.any()]


def _to_basis(points: Array) -> Array | None:
    """Return the homography (3, 3) that takes the first four points to e₁, e₂, e₃ and (1, 1, 1)."""
    corners = points[:3].T
    if np.linalg.cond(corners) > 1e12:
        return None
    weights = np.linalg.solve(corners, points[3])
    if np.abs(weights).min() < 1e-9 * np.abs(weights).max():
        return None
    return np.linalg.inv(corners * weights)


def _matrix(six: Array) -> Array:
    full = np.zeros((3, 3))
    for value, (i, j) in zip(six, OFF_DIAGONAL, strict=True):
        full[i, j] = value
    return full


def _singular_members(first: Array, second: Array) -> list[Array]:
    """Return the real members of the pencil ``first + s · second`` with determinant 0."""
    at = np.array([-1.0, 0.0, 1.0, 2.0])
    cubic = np.polyfit(at, [np.linalg.det(first + s * second) for s in at], 3)
    if not np.isfinite(cubic).all() or np.abs(cubic).max() == 0.0:
        return []
    roots = np.roots(cubic)
    return [first + s.real * second for s in roots if abs(s.imag) < 1e-6 * max(1.0, abs(s))]


def _cameras(dual: Array, bases: list[tuple[Array, Array, Array]]) -> list[Array] | None:
    """Return the projection matrices for a dual matrix ``F = [e]× diag(X, Y, Z)``, ``e ~ (X − T, Y − T, Z − T)``."""
    left, right = null_vector(dual.T)[0], null_vector(dual)[0]
    if np.abs(right).min() < 1e-12:
        return None
    scaled = left / right  # F right = 0: diag(X, Y, Z) right ~ e
    (t, _), *_ = np.linalg.lstsq(np.column_stack([np.ones(3), left]), scaled, rcond=None)
    sixth_camera = np.column_stack([np.diag(scaled), np.full(3, t)])
    fifth_camera = np.column_stack([np.eye(3), np.ones(3)])
    found = []
    for to_basis, fifth, sixth in bases:
        system = np.vstack([_cross(fifth) @ fifth_camera, _cross(sixth) @ sixth_camera])
        alpha, beta, gamma, delta = null_vector(system)[0]
        reduced = np.column_stack([np.diag([alpha, beta, gamma]), np.full(3, delta)])
        found.append(np.linalg.inv(to_basis) @ reduced)
    return found


def _cross(v: Array) -> Array:
    unit = v / np.linalg.norm(v)
    return np.array([[0.0, -unit[2], unit[1]], [unit[2], 0.0, -unit[0]], [-unit[1], unit[0], 0.0]])


def robust_trifocal(xy_a: Array, xy_b: Array, xy_c: Array, threshold_px: float, *, seed: int) -> Trifocal:
    """Find the tensor that most points agree with and refine it with them.

    Six-point solutions in a seeded consensus search (Torr and Zisserman 1997), the linear solution of the agreeing
    points, then least squares of the transfer distances over the two projection matrices, a parametrisation in
    which every tensor is valid (Hartley and Zisserman 2004, section 16.6).

    Parameters
    ----------
    xy_a, xy_b, xy_c : float64 (n, 2)
        Corresponding distortion-free points, px.
    threshold_px : float
        Largest transfer distance of an agreeing point, px.
    seed : int
        Of the consensus search.
    """
    count = len(xy_a)
    nothing = Trifocal(np.zeros((3, 3, 3)), np.zeros(count, dtype=bool), Text("only {n} points", n=count))
    if count < 7:
        return nothing
    rng = np.random.default_rng(seed)
    best, most, needed, tried = nothing, 0, SAMPLES, 0
    while tried < needed:
        tried += 1
        pick = rng.choice(count, 6, replace=False)
        for tensor in six_point_trifocal(xy_a[pick], xy_b[pick], xy_c[pick]):
            inliers = transfer_distances(tensor, xy_a, xy_b, xy_c) <= threshold_px
            if inliers.sum() <= most:
                continue
            better = _improved(Trifocal(tensor, inliers), xy_a, xy_b, xy_c, threshold_px)
            best, most = better, int(better.inliers.sum())
            if most >= 7:
                good = np.clip((most / count) ** 6, 1e-12, 1.0 - 1e-12)
                needed = min(SAMPLES, int(np.ceil(np.log(1.0 - CONFIDENCE) / np.log(1.0 - good))))
    if most < 7:
        return Trifocal(
            best.tensor, nothing.inliers, Text("the points do not agree on one geometry of three photos")
        )
    for _ in range(3):  # with the better tensor more points agree, which makes it better again
        good = best.inliers
        refined = refine_trifocal(best.tensor, xy_a[good], xy_b[good], xy_c[good])
        agreeing = transfer_distances(refined, xy_a, xy_b, xy_c) <= threshold_px
        if agreeing.sum() < best.inliers.sum():
            break
        grown = agreeing.sum() > best.inliers.sum()
        best = Trifocal(refined, agreeing)
        if not grown:
            break
    return best


def _improved(found: Trifocal, xy_a: Array, xy_b: Array, xy_c: Array, threshold_px: float) -> Trifocal:
    """Return the linear solution of the agreeing points when at least as many agree with it."""
    for _ in range(3):
        linear = linear_trifocal(*(side[found.inliers] for side in (xy_a, xy_b, xy_c)))
        if not linear:
            break
        inliers = transfer_distances(linear.tensor, xy_a, xy_b, xy_c) <= threshold_px
        if inliers.sum() <= found.inliers.sum():
            break
        found = Trifocal(linear.tensor, inliers)
    return found


def refine_trifocal(tensor: Array, xy_a: Array, xy_b: Array, xy_c: Array, steps: int = 20) -> Array:
    """Return the tensor with the least squares of the transfer distances in b and c, over P_b and P_c.

    Levenberg–Marquardt over 24 elements; the damping also holds the six that only change the projective frame.
    """
    (a, from_a), (b, from_b), (c, from_c) = (normalise(side) for side in (xy_a, xy_b, xy_c))
    points = a[:, :2], b[:, :2], c[:, :2]
    start = np.einsum("ir,sj,tk,ijk->rst", np.linalg.inv(from_a), from_b, from_c, tensor)
    _, p_b, p_c = projections_from_trifocal(start)
    values = np.concatenate([(p / np.linalg.norm(p)).ravel() for p in (p_b, p_c)])
    misfit = _misfit(values, points)
    damping = 1e-3
    for _ in range(steps):
        slopes = np.stack([(_misfit(values + 1e-6 * u, points) - misfit) / 1e-6 for u in np.eye(24)], axis=1)
        normal, gradient = slopes.T @ slopes, slopes.T @ misfit
        step = np.linalg.solve(normal + damping * np.trace(normal) / 24.0 * np.eye(24), -gradient)
        moved = _misfit(values + step, points)
        gain = float(misfit @ misfit - moved @ moved)
        if not gain > 0.0:
            damping *= 30.0
            continue
        values, misfit, damping = values + step, moved, 0.1 * damping
        if gain < 1e-6 * float(moved @ moved):
            break
    refined = trifocal_of_canonical(values[:12].reshape(3, 4), values[12:].reshape(3, 4))
    inverse_b, inverse_c = np.linalg.inv(from_b), np.linalg.inv(from_c)
    full = np.einsum("ri,js,kt,rst->ijk", from_a, inverse_b, inverse_c, refined)
    return np.asarray(full / np.linalg.norm(full))


def _misfit(values: Array, points: tuple[Array, Array, Array]) -> Array:
    """Return the transfer misfits of two projection matrices, one after the other; large where there is none."""
    p_b, p_c = values[:12].reshape(3, 4), values[12:].reshape(3, 4)
    both = skew(p_b[:, 3]) @ p_b[:, :3], skew(p_c[:, 3]) @ p_c[:, :3]
    misfits = transfer_misfits(trifocal_of_canonical(p_b, p_c), both, *points)
    return np.nan_to_num(misfits.ravel(), nan=1e3, posinf=1e3, neginf=-1e3)


def trifocal_of_canonical(p_b: Array, p_c: Array) -> Array:
    """Return ``T_i^{jk} = a_i^j b_4^k − a_4^j b_i^k`` of norm 1, with the first projection matrix ``[I | 0]``."""
    tensor = np.einsum("ji,k->ijk", p_b[:, :3], p_c[:, 3]) - np.einsum("j,ki->ijk", p_b[:, 3], p_c[:, :3])
    return np.asarray(tensor / np.linalg.norm(tensor))
