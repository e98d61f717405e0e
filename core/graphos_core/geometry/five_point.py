r"""Five pairs of rays determine the relative orientation: all solutions of many samples at once.

The four-dimensional null space of the five coplanarity conditions, ``E = x E₁ + y E₂ + z E₃ + E₄``, the ten cubic
conditions ``det E = 0`` and ``2 E Eᵀ E − tr(E Eᵀ) E = 0``, and the eigenvectors of the matrix that multiplies by x
modulo these equations (Stewénius, Engels and Nistér 2006; Nistér 2004). For rays of any field angle.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from graphos_core.data.record import Array

_VARIABLES = "xyz1"


def _monomials(degree: int) -> list[str]:
    """Monomials in x, y, z, 1 of a degree, those of higher degree in x, y, z first."""
    found = ["".join(m) for m in combinations_with_replacement(_VARIABLES, degree)]
    return sorted(found, key=lambda m: m.count("1"))


def _products(first: list[str], second: list[str], result: list[str]) -> Array:
    """Return the tensor (p, q, r) that multiplies polynomials."""
    table = np.zeros((len(first), len(second), len(result)))
    for i, a in enumerate(first):
        for j, b in enumerate(second):
            table[i, j, result.index("".join(sorted(a + b, key=_VARIABLES.index)))] = 1.0
    return table


_ONE, _TWO, _THREE = (_monomials(degree) for degree in (1, 2, 3))
_SQUARE = _products(_ONE, _ONE, _TWO)
_CUBE = _products(_TWO, _ONE, _THREE)
_TIMES_X = [_THREE.index("x" + m) for m in _TWO]
"""Where x times each monomial of degree two stands among those of degree three."""


def five_point(a: Array, b: Array) -> tuple[Array, Array]:
    """Return the essential matrices of samples of five pairs of rays.

    Parameters
    ----------
    a, b : float64 (s, 5, 3)
        Corresponding rays in the camera frames, any length.

    Returns
    -------
    float64 (k, 3, 3)
        All real solutions, of norm 1.
    int (k,)
        Sample from which each came.
    """
    rows = (b[:, :, :, None] * a[:, :, None, :]).reshape(len(a), 5, 9)
    null = np.linalg.svd(rows, full_matrices=True)[2][:, 5:]  # (s, 4, 9)
    unknown = np.swapaxes(null, 1, 2).reshape(-1, 3, 3, 4)  # polynomials in x, y, z, 1
    conditions = _conditions(unknown)
    usable = np.abs(np.linalg.det(conditions[:, :, :10])) > 1e-300
    samples = np.flatnonzero(usable)
    reduced = np.linalg.solve(conditions[samples, :, :10], conditions[samples, :, 10:])
    # modulo the conditions a cubic monomial is minus its row; a lower one stays
    whole = np.concatenate([-reduced, np.broadcast_to(np.eye(10), reduced.shape)], axis=1)
    values, vectors = np.linalg.eig(whole[:, _TIMES_X])
    last = vectors[:, 9]
    real = (np.abs(values.imag) < 1e-9 * (1.0 + np.abs(values.real))) & (np.abs(last) > 1e-12)
    which, solution = np.nonzero(real)
    xyz = (vectors[which, 6:9, solution] / last[which, solution][:, None]).real
    full = np.column_stack([xyz, np.ones(len(xyz))])
    found = np.einsum("kijc,kc->kij", unknown[samples[which]], full)
    return found / np.linalg.norm(found, axis=(1, 2), keepdims=True), samples[which]


def _conditions(unknown: Array) -> Array:
    """Return the ten cubic conditions (s, 10, 20) on matrices of linear polynomials (s, 3, 3, 4)."""
    square = np.einsum("sikp,sjkq,pqm->sijm", unknown, unknown, _SQUARE, optimize=True)  # E Eᵀ
    trace = np.einsum("siim->sm", square)
    square = 2.0 * square
    for i in range(3):
        square[:, i, i] -= trace
    cubic = np.einsum("sikm,skjp,mpr->sijr", square, unknown, _CUBE, optimize=True).reshape(-1, 9, 20)
    rows = unknown.transpose(1, 0, 2, 3)
    minors = np.stack([_minor(rows[1], rows[2], i) for i in range(3)], axis=1)
    determinant = np.einsum("sim,sip,mpr->sr", minors, rows[0], _CUBE, optimize=True)
    return np.concatenate([determinant[:, None], cubic], axis=1)


def _minor(second: Array, third: Array, i: int) -> Array:
    j, k = (i + 1) % 3, (i + 2) % 3
    return np.einsum("sp,sq,pqm->sm", second[:, j], third[:, k], _SQUARE, optimize=True) - np.einsum(
        "sp,sq,pqm->sm", second[:, k], third[:, j], _SQUARE, optimize=True
    )
