r"""Extrema of the difference of Gaussians: found, fitted between the samples, and rejected with a reason.

Source: Lowe 2004, Distinctive image features from scale-invariant keypoints, sections 3.1 and 4. Where the paper leaves a
number open it is OpenCV's, whose keypoints the tests compare: at most five moves of the fit, a border of five pixels, and
no fit for extrema below half the contrast threshold.
"""

from __future__ import annotations

import cv2
import numpy as np

from graphos_core.data.record import Array, record
from graphos_core.features.detectors.scale_space import ScaleSpace

KEPT, UNSTABLE, WEAK, EDGE = 0, 1, 2, 3
"""What became of an extremum: a keypoint; its fit wandered off; too little contrast; on an edge."""
BORDER = 5
"""Pixels of an octave at its ends that are not examined."""
MOVES = 5
"""So often the fit may move to another sample."""
GREY = 255.0
"""Contrasts are given in the grey range 0 to 1."""


@record
class Extrema:
    r"""Extrema of the difference of Gaussians D, one row each.

    Attributes
    ----------
    octave, layer, row, column : int32 (n,)
        Sample at which the fit ended (for those without a fit: where they were found).
    sample : float64 (n,)
        D at the sample where it was found, grey range 0 to 1.
    offset : float64 (n, 3)
        x̂, the fitted extremum from that sample: columns, rows, layers.
    value : float64 (n,)
        D(x̂), grey range 0 to 1.
    ratio : float64 (n,)
        r of the principal curvatures, at least 1; infinite where they have different signs.
    verdict : int8 (n,)
        `KEPT`, `UNSTABLE`, `WEAK` or `EDGE`.
    xy : float64 (n, 2)
        Fitted place, px of the photo.
    diameter : float64 (n,)
        Twice the fitted blur, px of the photo: the scale of `graphos_core.data.Features`.
    """

    octave: Array
    layer: Array
    row: Array
    column: Array
    sample: Array
    offset: Array
    value: Array
    ratio: Array
    verdict: Array
    xy: Array
    diameter: Array

    def __len__(self) -> int:
        return len(self.octave)


def find_extrema(
    space: ScaleSpace, *, contrast: float = 0.04, edge: float = 10.0, least: float | None = None
) -> Extrema:
    r"""Find, fit and judge the extrema of the difference of Gaussians.

    A sample that is the largest (positive) or smallest (negative) of its 26 neighbours in place and scale is fitted by
    the quadratic ``D(x) = D + gᵀx + ½ xᵀHx`` (eq. 2): ``x̂ = −H⁻¹g``, ``D(x̂) = D + ½ gᵀx̂`` (eq. 3). Rejected are:
    fits that do not come to rest; ``n |D(x̂)| < C``; and edges, ``tr²/det ≥ (r + 1)²/r`` with the 2 × 2 Hessian of the
    place (section 4.1).

    Parameters
    ----------
    space : ScaleSpace
    contrast : float
        C; divided by the layers per octave n it is the smallest contrast, grey range 0 to 1.
    edge : float
        r, largest ratio of the principal curvatures.
    least : float, optional
        Smaller samples are not looked at, grey range 0 to 1; without it half the smallest contrast.

    Returns
    -------
    Extrema
        By octave, then layer, row and column of where they were found.
    """
    least = 0.5 * contrast / space.layers if least is None else least
    parts = [_of_octave(space, octave, contrast, edge, least) for octave in range(len(space.differences))]
    return Extrema(**{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})


def extreme_samples(differences: Array, layer: int, least: float) -> Array:
    """Return rows and columns (n, 2) where a layer has the largest or smallest value of all 26 neighbours.

    Parameters
    ----------
    differences : float32 (layers + 2, h, w)
    layer : int
        1 to layers.
    least : float
        Smaller values than this, grey range 0 to 1, are left out.
    """
    here = differences[layer]
    if min(here.shape) <= 2 * BORDER:
        return np.empty((0, 2), np.intp)
    box = np.ones((3, 3), np.uint8)
    below, above = differences[layer - 1], differences[layer + 1]
    top = cv2.dilate(cv2.max(cv2.max(below, here), above), box)
    low = cv2.erode(cv2.min(cv2.min(below, here), above), box)
    found = ((here > 0) & (here >= top)) | ((here < 0) & (here <= low))
    found &= np.abs(here) > max(GREY * least, 1e-6)
    return np.argwhere(found[BORDER:-BORDER, BORDER:-BORDER]) + BORDER


def quadratic(differences: Array, layer: Array, row: Array, column: Array) -> tuple[Array, Array, Array]:
    """Return value (n,), gradient (n, 3) and Hessian (n, 3, 3) of D at samples, by differences of neighbours.

    Order x, y, layer; grey range 0 to 1.
    """
    d = {
        (i, j, k): differences[layer + k, row + j, column + i].astype(np.float64) / GREY
        for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1) if abs(i) + abs(j) + abs(k) < 3
    }  # fmt: skip
    unit = np.eye(3, dtype=int)
    gradient = np.stack([(d[tuple(u)] - d[tuple(-u)]) / 2.0 for u in unit], axis=1)
    hessian = np.empty((len(row), 3, 3))
    for a in range(3):
        hessian[:, a, a] = d[tuple(unit[a])] - 2.0 * d[0, 0, 0] + d[tuple(-unit[a])]
        for b in range(a):
            both, apart = unit[a] + unit[b], unit[a] - unit[b]
            cross = (d[tuple(both)] + d[tuple(-both)] - d[tuple(apart)] - d[tuple(-apart)]) / 4.0
            hessian[:, a, b] = hessian[:, b, a] = cross
    return d[0, 0, 0], gradient, hessian


def _of_octave(
    space: ScaleSpace, octave: int, contrast: float, edge: float, least: float
) -> dict[str, Array]:
    differences = space.differences[octave]
    found = [extreme_samples(differences, layer, least) for layer in range(1, space.layers + 1)]
    layer = np.repeat(np.arange(1, space.layers + 1), [len(part) for part in found])
    at = np.stack([layer, *np.concatenate(found).T], axis=1)
    sample = differences[at[:, 0], at[:, 1], at[:, 2]].astype(np.float64) / GREY
    at, offset, settled = _fitted(differences, at, space.layers)
    single = np.sort(np.unique(at, axis=0, return_index=True)[1])  # two samples can lead to the same fit
    at, offset, settled, sample = at[single], offset[single], settled[single], sample[single]
    value, gradient, hessian = quadratic(differences, *at.T)
    value = value + 0.5 * np.einsum("ni,ni->n", gradient, offset)
    ratio = curvature_ratio(hessian)
    verdict = np.select(
        [~settled, np.abs(value) * space.layers < contrast, ~(ratio < edge)], [UNSTABLE, WEAK, EDGE], KEPT
    )
    pixel = space.pixel(octave)
    return {
        "octave": np.full(len(at), octave, np.int32), "layer": at[:, 0].astype(np.int32),
        "row": at[:, 1].astype(np.int32), "column": at[:, 2].astype(np.int32), "sample": sample, "offset": offset,
        "value": value, "ratio": ratio, "verdict": verdict.astype(np.int8),
        "xy": (at[:, :0:-1] + offset[:, :2]) * pixel,
        "diameter": 2.0 * pixel * space.sigma * 2.0 ** ((at[:, 0] + offset[:, 2]) / space.layers),
    }  # fmt: skip


def curvature_ratio(hessian: Array) -> Array:
    """Return the ratio r ≥ 1 of the principal curvatures in the place, float64 (n,); infinite for saddles.

    From ``tr²/det = (r + 1)²/r`` (Lowe 2004, section 4.1) without eigenvalues.
    """
    trace = hessian[:, 0, 0] + hessian[:, 1, 1]
    det = hessian[:, 0, 0] * hessian[:, 1, 1] - hessian[:, 0, 1] ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        half = np.maximum(trace**2 / det / 2.0 - 1.0, 1.0)
        return np.where(det > 0, half + np.sqrt(half**2 - 1.0), np.inf)


def _fitted(differences: Array, start: Array, layers: int) -> tuple[Array, Array, Array]:
    """Move every extremum to the sample nearest to its fit: samples (n, 3), offsets (n, 3), and whether it rests."""
    at, offset = start.copy(), np.zeros((len(start), 3))
    settled, active = np.zeros(len(start), bool), np.arange(len(start))
    high = np.array([layers + 1, differences.shape[1] - BORDER, differences.shape[2] - BORDER])
    for _ in range(MOVES):
        _, gradient, hessian = quadratic(differences, *at[active].T)
        solvable = np.abs(np.linalg.det(hessian)) > 1e-30
        active, gradient, hessian = active[solvable], gradient[solvable], hessian[solvable]
        step = -np.linalg.solve(hessian, gradient[:, :, None])[:, :, 0]
        near = (np.abs(step) < 0.5).all(axis=1)
        settled[active[near]], offset[active[near]] = True, step[near]
        active, step = active[~near], step[~near]
        moved = at[active] + np.rint(np.clip(step[:, ::-1], -1e6, 1e6)).astype(np.intp)
        inside = ((moved >= (1, BORDER, BORDER)) & (moved < high)).all(axis=1)
        active = active[inside]
        at[active] = moved[inside]
        if not len(active):
            break
    at[~settled] = start[~settled]
    return at, offset, settled
