"""Compiled triangulation of many points; used by `graphos_core.geometry.triangulation` only."""

from __future__ import annotations

import numpy as np
from numba import njit

from graphos_core.data.record import Array

MAX_PAIRS = 60
"""Ray pairs tried per point when the common solution of all its rays does not fit."""


@njit(cache=True, nogil=True)
def _solve3(a: Array, b: Array, x: Array) -> bool:
    """Solve the symmetric 3×3 system ``a x = b`` by cofactors; False when it is singular."""
    c00 = a[1, 1] * a[2, 2] - a[1, 2] * a[1, 2]
    c01 = a[0, 2] * a[1, 2] - a[0, 1] * a[2, 2]
    c02 = a[0, 1] * a[1, 2] - a[0, 2] * a[1, 1]
    c11 = a[0, 0] * a[2, 2] - a[0, 2] * a[0, 2]
    c12 = a[0, 1] * a[0, 2] - a[0, 0] * a[1, 2]
    c22 = a[0, 0] * a[1, 1] - a[0, 1] * a[0, 1]
    det = a[0, 0] * c00 + a[0, 1] * c01 + a[0, 2] * c02
    size = a[0, 0] * a[1, 1] * a[2, 2]
    if not det > 1e-14 * size:
        return False
    x[0] = (c00 * b[0] + c01 * b[1] + c02 * b[2]) / det
    x[1] = (c01 * b[0] + c11 * b[1] + c12 * b[2]) / det
    x[2] = (c02 * b[0] + c12 * b[1] + c22 * b[2]) / det
    return True


@njit(cache=True, nogil=True)
def _nearest_to_rays(
    use: Array, first: int, photo: Array, world: Array, centres: Array, a: Array, b: Array, x: Array
) -> bool:
    """Point with the least sum of squared distances to the used rays: ``Σ(I − d dᵀ)(X − C) = 0``."""
    a[:] = 0.0
    b[:] = 0.0
    for k in range(use.shape[0]):
        if not use[k]:
            continue
        i = first + k
        c = photo[i]
        for r in range(3):
            for s in range(3):
                m = (1.0 if r == s else 0.0) - world[i, r] * world[i, s]
                a[r, s] += m
                b[r] += m * centres[c, s]
    return _solve3(a, b, x)


@njit(cache=True, nogil=True)
def _error(i: int, photo: Array, frames: Array, centres: Array, x: Array) -> float:
    """Squared distance of `x` from ray i in its plane, px²; infinite behind it."""
    c = photo[i]
    m = frames[i]
    dx = x[0] - centres[c, 0]
    dy = x[1] - centres[c, 1]
    dz = x[2] - centres[c, 2]
    z = m[2, 0] * dx + m[2, 1] * dy + m[2, 2] * dz
    if not z > 0.0:
        return np.inf
    u = (m[0, 0] * dx + m[0, 1] * dy + m[0, 2] * dz) / z
    v = (m[1, 0] * dx + m[1, 1] * dy + m[1, 2] * dz) / z
    return u * u + v * v


@njit(cache=True, nogil=True)
def _refine(
    use: Array,
    first: int,
    photo: Array,
    frames: Array,
    centres: Array,
    a: Array,
    b: Array,
    x: Array,
) -> None:
    """Gauss–Newton on the distances in the planes of the rays, at most 8 steps; `x` is changed in place."""
    step = np.empty(3)
    trial = np.empty(3)
    jac = np.empty((2, 3))
    cost = 0.0
    for k in range(use.shape[0]):
        if use[k]:
            cost += _error(first + k, photo, frames, centres, x)
    for _ in range(8):
        if not cost < np.inf:
            return
        a[:] = 0.0
        b[:] = 0.0
        for k in range(use.shape[0]):
            if not use[k]:
                continue
            i = first + k
            c = photo[i]
            m = frames[i]
            px = 0.0
            py = 0.0
            z = 0.0
            for s in range(3):
                d = x[s] - centres[c, s]
                px += m[0, s] * d
                py += m[1, s] * d
                z += m[2, s] * d
            u = px / z
            v = py / z
            for s in range(3):
                jac[0, s] = (m[0, s] - u * m[2, s]) / z
                jac[1, s] = (m[1, s] - v * m[2, s]) / z
            for p in range(3):
                b[p] -= jac[0, p] * u + jac[1, p] * v
                for q in range(3):
                    a[p, q] += jac[0, p] * jac[0, q] + jac[1, p] * jac[1, q]
        if not _solve3(a, b, step):
            return
        trial[:] = x + step
        after = 0.0
        for k in range(use.shape[0]):
            if use[k]:
                after += _error(first + k, photo, frames, centres, trial)
        if not after < cost:
            return
        gain = cost - after
        x[:] = trial
        cost = after
        if gain < 1e-12 * cost:
            return


@njit(cache=True, nogil=True)
def _mark(
    use: Array,
    first: int,
    limit: float,
    photo: Array,
    frames: Array,
    centres: Array,
    x: Array,
) -> tuple[int, float]:
    """Mark the rays that pass within the limit; their number and the sum of their squared distances."""
    count = 0
    cost = 0.0
    for k in range(use.shape[0]):
        e = _error(first + k, photo, frames, centres, x)
        use[k] = e <= limit
        if use[k]:
            count += 1
            cost += e
    return count, cost


@njit(cache=True, nogil=True)
def _best_pair(
    use: Array,
    first: int,
    limit: float,
    photo: Array,
    frames: Array,
    world: Array,
    centres: Array,
    a: Array,
    b: Array,
    x: Array,
) -> int:
    """Try the pairs of rays, keep the point that most rays agree with, then the smallest sum of squares."""
    n = use.shape[0]
    best = 0
    best_cost = np.inf
    best_x = np.zeros(3)
    tried = 0
    for gap in range(n - 1, 0, -1):  # far apart in the list first: usually the larger angles
        for k in range(n - gap):
            if tried >= MAX_PAIRS:
                break
            tried += 1
            use[:] = False
            use[k] = True
            use[k + gap] = True
            if not _nearest_to_rays(use, first, photo, world, centres, a, b, x):
                continue
            count, cost = _mark(use, first, limit, photo, frames, centres, x)
            if count > best or (count == best and cost < best_cost):
                best = count
                best_cost = cost
                best_x[:] = x
    x[:] = best_x
    if best >= 2:
        _mark(use, first, limit, photo, frames, centres, x)
    return best


@njit(cache=True, nogil=True)
def largest_angle(use: Array, first: int, photo: Array, centres: Array, x: Array) -> float:
    """Largest angle at `x` between two of its used rays, radians."""
    smallest = 1.0
    n = use.shape[0]
    direction = np.empty((n, 3))
    for k in range(n):
        length = 0.0
        for s in range(3):
            direction[k, s] = x[s] - centres[photo[first + k], s]
            length += direction[k, s] ** 2
        direction[k] /= np.sqrt(length)
    for k in range(n):
        if not use[k]:
            continue
        for j in range(k):
            if use[j]:
                cosine = 0.0
                for s in range(3):
                    cosine += direction[k, s] * direction[j, s]
                smallest = min(smallest, cosine)
    return np.arccos(max(-1.0, smallest))


@njit(cache=True, nogil=True)
def triangulate_many(
    start: Array,
    photo: Array,
    world: Array,
    frames: Array,
    centres: Array,
    limit: float,
    min_angle: float,
    points: Array,
    angles: Array,
    used: Array,
    ok: Array,
) -> None:
    """Fill `points`, `angles`, `used`, `ok`; see `graphos_core.geometry.triangulation.triangulate`."""
    a = np.empty((3, 3))
    b = np.empty(3)
    x = np.empty(3)
    for t in range(start.shape[0] - 1):
        first = start[t]
        n = start[t + 1] - first
        use = used[first : first + n]
        ok[t] = False
        use[:] = True
        if n < 2:
            use[:] = False
            continue
        count = 0
        if _nearest_to_rays(use, first, photo, world, centres, a, b, x):
            _refine(use, first, photo, frames, centres, a, b, x)
            count = _mark(use, first, limit, photo, frames, centres, x)[0]
        if count < n and n > 2:
            count = _best_pair(use, first, limit, photo, frames, world, centres, a, b, x)
            for _ in range(2):
                if count >= 2:
                    _refine(use, first, photo, frames, centres, a, b, x)
                    count = _mark(use, first, limit, photo, frames, centres, x)[0]
        points[t] = x
        if count >= 2 and 2 * count > n:
            angles[t] = largest_angle(use, first, photo, centres, x)
            ok[t] = angles[t] >= min_angle
        if not ok[t]:
            use[:] = False


@njit(cache=True, nogil=True)
def intersection_angles(start: Array, photo: Array, used: Array, centres: Array, points: Array) -> Array:
    """Largest intersection angle of each point over its used rays, radians; 0 with fewer than two."""
    angles = np.zeros(start.shape[0] - 1)
    for t in range(start.shape[0] - 1):
        first = start[t]
        use = used[first : start[t + 1]]
        if use.sum() >= 2:
            angles[t] = largest_angle(use, first, photo, centres, points[t])
    return angles


@njit(cache=True, nogil=True)
def squared_errors(point: Array, photo: Array, frames: Array, centres: Array, points: Array) -> Array:
    """Squared distance of each ray from its point, px²; infinite behind it."""
    out = np.empty(photo.shape[0])
    for i in range(photo.shape[0]):
        out[i] = _error(i, photo, frames, centres, points[point[i]])
    return out


@njit(cache=True, nogil=True)
def turn(photo: Array, directions: Array, frames: Array, rotations: Array) -> tuple[Array, Array]:
    """Directions (m, 3) and frames (m, 3, 3) of rays in the object frame: ``Rᵀ d`` and ``M R``."""
    n = photo.shape[0]
    world = np.empty((n, 3))
    turned = np.empty((n, 3, 3))
    for i in range(n):
        r = rotations[photo[i]]
        for k in range(3):
            world[i, k] = r[0, k] * directions[i, 0] + r[1, k] * directions[i, 1] + r[2, k] * directions[i, 2]
            for j in range(3):
                turned[i, j, k] = (
                    frames[i, j, 0] * r[0, k] + frames[i, j, 1] * r[1, k] + frames[i, j, 2] * r[2, k]
                )
    return world, turned
