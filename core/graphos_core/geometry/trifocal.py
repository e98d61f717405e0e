r"""The trifocal tensor: what three photos of the same points and lines have in common, whatever the object.

With projection matrices ``P_a = [I | 0]``, ``P_b = [A | a₄]``, ``P_c = [B | b₄]`` the tensor is
``T_i^{jk} = a_i^j b_4^k − a_4^j b_i^k``; lines fulfil ``l_i = l'_j l''_k T_i^{jk}``, points
``[x_b]× (Σ x_a^i T_i) [x_c]× = 0`` (Hartley and Zisserman 2004, chapter 15). Arrays are ``T[i, j, k]``. It holds for
distortion-free pixels and, with calibrated cameras, for rays; a photo's points are then rays of any field angle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.normalisation import homogeneous, normalise, null_vector
from graphos_core.geometry.rotation import skew
from graphos_core.text import Text


@dataclass(frozen=True)
class Trifocal:
    """A trifocal tensor; false in a condition when it was not found.

    Attributes
    ----------
    tensor : float64 (3, 3, 3)
        Of norm 1, in the units of the points.
    inliers : bool (n,)
        Points that agree; all where none was rejected.
    reason : str
        Why there is none; empty where there is.
    """

    tensor: Array
    inliers: Array
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


def trifocal_from_projections(p_a: Array, p_b: Array, p_c: Array) -> Array:
    """Return the tensor (3, 3, 3) of norm 1 of three projection matrices (3, 4).

    ``T_i^{jk} = (−1)^{i+1} det [~p_a^i; p_b^j; p_c^k]``, ``~p_a^i`` the matrix without row i (Hartley and Zisserman
    2004, equation 17.12): no need for a canonical first matrix.
    """
    p_a, p_b, p_c = (np.asarray(p, dtype=np.float64) for p in (p_a, p_b, p_c))
    tensor = np.empty((3, 3, 3))
    for i in range(3):
        others = np.delete(p_a, i, axis=0)
        for j in range(3):
            for k in range(3):
                tensor[i, j, k] = (-1) ** i * np.linalg.det(np.vstack([others, p_b[j], p_c[k]]))
    size = np.linalg.norm(tensor)
    return tensor / size if size > 0.0 else tensor


def epipoles(tensor: Array) -> tuple[Array, Array]:
    """Return the images of the first projection centre in b and in c, unit vectors (3,).

    The common perpendicular of the left, and of the right, null vectors of the three slices (Hartley and Zisserman
    2004, algorithm 15.1).
    """
    left = np.array([null_vector(matrix.T)[0] for matrix in tensor])
    right = np.array([null_vector(matrix)[0] for matrix in tensor])
    return null_vector(left)[0], null_vector(right)[0]


def projections_from_trifocal(tensor: Array) -> tuple[Array, Array, Array]:
    """Return three projection matrices (3, 4) with that tensor, the first ``[I | 0]``.

    ``P_b = [[T₁, T₂, T₃] e'' | e']``, ``P_c = [(e'' e''ᵀ − I)[T₁ᵀ, T₂ᵀ, T₃ᵀ] e' | e'']`` (Hartley and Zisserman 2004,
    algorithm 15.1). They stand in a projective frame: right up to a homography of space.
    """
    in_b, in_c = epipoles(tensor)
    p_b = np.column_stack([(tensor @ in_c).T, in_b])
    p_c = np.column_stack([(np.outer(in_c, in_c) - np.eye(3)) @ np.einsum("ijk,j->ki", tensor, in_b), in_c])
    return np.eye(3, 4), p_b, p_c


def fundamentals(tensor: Array) -> tuple[Array, Array]:
    """Return F_ba and F_ca (3, 3) of norm 1, ``x_bᵀ F_ba x_a = 0`` (Hartley and Zisserman 2004, section 15.1.4)."""
    in_b, in_c = epipoles(tensor)
    f_b = skew(in_b) @ (tensor @ in_c).T
    f_c = skew(in_c) @ np.einsum("ijk,j->ki", tensor, in_b)
    return f_b / np.linalg.norm(f_b), f_c / np.linalg.norm(f_c)


def transfer_points(tensor: Array, a: Array, b: Array, fundamental: Array | None = None) -> Array:
    """Return where points seen in a and b lie in c, homogeneous (n, 3); zero where they cannot be transferred.

    Point–line–point transfer ``x_c^k = x_a^i l_j T_i^{jk}`` with the line in b through the point at right angles to
    its epipolar line, which carries all that b says about depth (Hartley and Zisserman 2004, section 15.3.2). On
    the plane of the three centres (the trifocal plane) it stays defined, where intersecting epipolar lines fails.

    Parameters
    ----------
    tensor : float64 (3, 3, 3)
    a, b : float64 (n, 3)
        Homogeneous points, or rays.
    fundamental : float64 (3, 3), optional
        F_ba where it is known already.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    epipolar = a @ (fundamentals(tensor)[0] if fundamental is None else fundamental).T
    line = np.column_stack([
        -epipolar[:, 1] * b[:, 2], epipolar[:, 0] * b[:, 2], epipolar[:, 1] * b[:, 0] - epipolar[:, 0] * b[:, 1]
    ])  # fmt: skip
    return np.einsum("ijk,ni,nj->nk", tensor, a, line)


def transfer_pixels(tensor: Array, xy_a: Array, xy_b: Array, fundamental: Array | None = None) -> Array:
    """Return the pixels (n, 2) in c of points measured in a and b, px; NaN or infinite where there are none."""
    found = transfer_points(tensor, homogeneous(xy_a), homogeneous(xy_b), fundamental)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(found[:, :2] / found[:, 2:])


def transfer_line(tensor: Array, line_b: Array, line_c: Array) -> Array:
    """Return the line (3,) in a of an object line seen as `line_b` and `line_c`: ``l_i = l'_j l''_k T_i^{jk}``."""
    return np.einsum("ijk,j,k->i", tensor, np.asarray(line_b), np.asarray(line_c))


def transfer_distances(tensor: Array, xy_a: Array, xy_b: Array, xy_c: Array) -> Array:
    """Return the larger distance (n,) of a measured point from the one transferred to its photo, in b and c, px."""
    misfit = np.linalg.norm(transfer_misfits(tensor, fundamentals(tensor), xy_a, xy_b, xy_c), axis=2)
    return np.asarray(np.nan_to_num(misfit.max(axis=0), nan=np.inf))


def transfer_misfits(
    tensor: Array, both: tuple[Array, Array], xy_a: Array, xy_b: Array, xy_c: Array
) -> Array:
    """Return transferred − measured in b and in c (2, n, 2), with F_ba and F_ca given."""
    in_b = transfer_pixels(np.swapaxes(tensor, 1, 2), xy_a, xy_c, both[1]) - xy_b
    return np.stack([in_b, transfer_pixels(tensor, xy_a, xy_b, both[0]) - xy_c])


def linear_trifocal(xy_a: Array, xy_b: Array, xy_c: Array) -> Trifocal:
    """Estimate the tensor from seven or more points in three photos.

    Normalised linear solution, then the nearest algebraic solution that three cameras can have: with the epipoles
    of the first one, ``T_i = a_i e''ᵀ − e' b_iᵀ`` is linear in 18 unknowns (Hartley and Zisserman 2004, algorithms
    16.1 and 16.2, the latter without the iteration over the epipoles).

    Parameters
    ----------
    xy_a, xy_b, xy_c : float64 (n, 2)
        Corresponding distortion-free points.
    """
    count = len(xy_a)
    everything = np.ones(count, dtype=bool)
    if count < 7:
        return Trifocal(np.zeros((3, 3, 3)), ~everything, Text("only {count} points, 7 needed", count=count))
    (a, from_a), (b, from_b), (c, from_c) = (normalise(side) for side in (xy_a, xy_b, xy_c))
    rows = _incidences(a, b, c)
    linear, singular = null_vector(rows)
    if singular[-2] < max(1e-9 * singular[0], 2.0 * singular[-1]):
        return Trifocal(
            np.zeros((3, 3, 3)),
            ~everything,
            Text("the points are degenerate: they lie in one plane, or nearly so"),
        )
    tensor = _constrained(rows, linear.reshape(3, 3, 3))
    return Trifocal(_denormalised(tensor, from_a, from_b, from_c), everything)


def _incidences(a: Array, b: Array, c: Array) -> Array:
    """Return the rows (9 n, 27) of ``[x_b]× (Σ x_a^i T_i) [x_c]× = 0``."""
    cross_b = np.stack([skew(x) for x in b])
    cross_c = np.stack([skew(x) for x in c])
    return np.einsum("ni,nrj,nks->nrsijk", a, cross_b, cross_c).reshape(-1, 27)


def _constrained(rows: Array, linear: Array) -> Array:
    """Return the tensor that three cameras with the epipoles of `linear` can have and that fits `rows` best."""
    in_b, in_c = epipoles(linear)
    span = np.zeros((3, 3, 3, 18))
    for i in range(3):
        for j in range(3):
            span[i, j, :, 3 * i + j] = in_c  # a_i^j e''^k
            span[i, :, j, 9 + 3 * i + j] = -in_b  # −e'^j b_i^k
    u, size, _ = np.linalg.svd(span.reshape(27, 18), full_matrices=False)
    basis = u[:, size > 1e-10 * size[0]]
    return (basis @ null_vector(rows @ basis)[0]).reshape(3, 3, 3)


def _denormalised(tensor: Array, from_a: Array, from_b: Array, from_c: Array) -> Array:
    """Undo the normalisation: ``T_i^{jk} = N_a[r, i] N_b⁻¹[j, s] N_c⁻¹[k, t] T_r^{st}``."""
    inverse_b, inverse_c = np.linalg.inv(from_b), np.linalg.inv(from_c)
    full = np.einsum("ri,js,kt,rst->ijk", from_a, inverse_b, inverse_c, tensor)
    return np.asarray(full / np.linalg.norm(full))
