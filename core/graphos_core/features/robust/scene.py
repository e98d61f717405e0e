r"""What a pair of photos shows: space from two places, a plane, or no change of place at all.

Where a homography explains the matches of a pair as well as the epipolar geometry does, the epipolar geometry is not
determined by them: the object is a plane, or the camera only turned. Three models are compared by the geometric robust
information criterion (Torr 1998, equation 11),

``GRIC = Σ min(e²/σ², 2 (r − d)) + d n ln r + k ln(r n)``

with the four-dimensional distance e of a match from the model's manifold, r = 4 coordinates of a match, the dimension
d of the manifold and k parameters: epipolar geometry (d = 3, k = 7 or 5), homography (d = 2, k = 8), rotation about
the projection centre (d = 2, k = 3). The smallest value wins. σ is the robust spread of the distances from the
epipolar geometry, so that unknown distortion of both photos does not decide.
"""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Camera
from graphos_core.features.pair_verdict import ideal_pixels
from graphos_core.features.robust.models import HomographyModel
from graphos_core.features.robust.search import search
from graphos_core.features.robust_scores import CONSISTENT
from graphos_core.geometry.epipolar import fundamental_from_essential, interior_matrix, sampson_distances
from graphos_core.geometry.homography import transfer_squares
from graphos_core.geometry.normalisation import homogeneous
from graphos_core.geometry.rays import rays_of
from graphos_core.geometry.relative_orientation import RayPairs
from graphos_core.text import Text

LARGEST = 400
"""Matches that decide, evenly taken from all: enough, and quick."""

SAMPLES = 40
"""Samples for the homography: one that explains nearly all matches is found soon."""

SMALLEST_SIGMA = 0.05
"""px; perfect matches of a simulation would otherwise have no scale."""

MEDIAN_OF_TWO = 2.0 * np.log(2.0)
"""Median of χ² with two degrees of freedom: of e²/σ² from a homography."""

FOCALS = np.linspace(0.5, 2.0, 31)
"""Factors tried on a principal distance that is only estimated."""

UNKNOWNS = {"essential": 5, "fundamental": 7}
"""Parameters of the epipolar geometry."""

SENTENCES = {
    "": "",
    "general": Text("Space, seen from two places."),
    "planar": Text(
        "One plane: a homography explains the pair as well as epipolar geometry does. Which photo stands where follows "
        "only with known principal distances; other pairs should start the orientation."
    ),
    "rotation": Text(
        "The camera only turned, or both photos are the same: there is no base, so this pair determines no object "
        "points. Take photos from other places."
    ),
}
"""What to tell people about `PairMatches.scene`."""


def pair_scene(
    kind: str, matrix: Array, xy_a: Array, xy_b: Array, cameras: tuple[Camera, Camera], seed: int
) -> str:
    """Return the scene of a verified pair: ``"general"``, ``"planar"`` or ``"rotation"``.

    Fish-eye and panorama cameras have no homography: only a rotation is recognised.

    Parameters
    ----------
    kind : {"essential", "fundamental", "homography"}
    matrix : float64 (3, 3)
        As in `graphos_core.data.PairMatches`.
    xy_a, xy_b : float64 (n, 2)
        Verified matches, measured pixels.
    cameras : (Camera, Camera)
    seed : int
    """
    if len(xy_a) > LARGEST:
        chosen = np.linspace(0, len(xy_a) - 1, LARGEST).astype(np.int64)
        xy_a, xy_b = xy_a[chosen], xy_b[chosen]
    if any(camera_model(camera.model).wide for camera in cameras):
        return recognise_turn(matrix, RayPairs(rays_of(cameras[0], xy_a), rays_of(cameras[1], xy_b)))
    if kind == "essential":
        xy_a, xy_b = ideal_pixels(cameras[0], xy_a), ideal_pixels(cameras[1], xy_b)
        matrix = fundamental_from_essential(matrix, *cameras)
    return recognise_scene(matrix, xy_a, xy_b, cameras, UNKNOWNS[kind], seed)


def recognise_turn(essential: Array, pairs: RayPairs) -> str:
    """Return ``"rotation"`` where a rotation explains rays of any field angle best, else ``"general"``."""
    epipolar = pairs.sampson(essential) ** 2
    sigma = max(SMALLEST_SIGMA, CONSISTENT * float(np.sqrt(np.median(epipolar))))
    good = np.ones(len(epipolar), bool)
    for _ in range(3):
        rotation = _kabsch(pairs.a.directions[good], pairs.b.directions[good])
        forth = _ray_squares(pairs.b.frames, pairs.a.directions @ rotation.T)
        back = _ray_squares(pairs.a.frames, pairs.b.directions @ rotation)
        squares = _joint(forth, back)
        good = squares <= max(float(np.median(squares)), (3.0 * sigma) ** 2)
    turned, general = gric(squares / sigma**2, 2, 3), gric(epipolar / sigma**2, 3, UNKNOWNS["essential"])
    return "rotation" if turned < general else "general"


def flat_scene(matrix: Array, xy_a: Array, xy_b: Array, cameras: tuple[Camera, Camera]) -> str:
    """Return ``"rotation"`` or ``"planar"`` for matches (n, 2), px, that fulfil a homography."""
    plane = _manifold_squares(matrix, xy_a, xy_b)
    sigma = max(SMALLEST_SIGMA, float(np.sqrt(np.median(plane) / MEDIAN_OF_TWO)))
    turned = _turned_squares(xy_a, xy_b, cameras, sigma)
    flat = gric(plane / sigma**2, 2, 8)
    return "rotation" if gric(turned / sigma**2, 2, 3) < flat else "planar"


def recognise_scene(
    fundamental: Array, xy_a: Array, xy_b: Array, cameras: tuple[Camera, Camera], unknowns: int, seed: int
) -> str:
    """Return ``"general"``, ``"planar"`` or ``"rotation"``.

    Parameters
    ----------
    fundamental : float64 (3, 3)
        Of the pair, for distortion-free pixels.
    xy_a, xy_b : float64 (n, 2)
        Verified matches, distortion-free pixels.
    cameras : (Camera, Camera)
        Central; where a principal distance is estimated, others are tried for the rotation.
    unknowns : int
        Of the epipolar geometry, 7 or 5.
    seed : int
    """
    epipolar = sampson_distances(fundamental, xy_a, xy_b) ** 2
    sigma = max(SMALLEST_SIGMA, CONSISTENT * float(np.sqrt(np.median(epipolar))))
    model = HomographyModel(xy_a, xy_b)
    plane = search(model, "msac", 4.0 * sigma, confidence=0.99, most=SAMPLES, seed=seed)
    turned = _turned_squares(xy_a, xy_b, cameras, sigma)
    scores = {
        "general": gric(epipolar / sigma**2, 3, unknowns),
        "planar": gric(_manifold_squares(plane.matrix, xy_a, xy_b) / sigma**2, 2, 8) if plane else np.inf,
        "rotation": gric(turned / sigma**2, 2, 3),
    }
    return min(scores, key=lambda name: scores[name])


def gric(squares: Array, dimension: int, parameters: int) -> float:
    """Return Torr's criterion of a model for squared distances (n,) in units of σ²."""
    n, r = len(squares), 4.0
    misfit = np.minimum(squares, 2.0 * (r - dimension)).sum()
    return float(misfit + dimension * n * np.log(r) + parameters * np.log(r * n))


def _manifold_squares(matrix: Array, xy_a: Array, xy_b: Array) -> Array:
    """Squared distance of a match from fulfilling ``x_b ∝ H x_a`` when both points may move: 1/e² = 1/e_a² + 1/e_b²."""
    return _joint(*transfer_squares(matrix, xy_a, xy_b))


def _joint(forth: Array, back: Array) -> Array:
    with np.errstate(invalid="ignore"):
        joint = forth * back / np.maximum(forth + back, 1e-300)
    return np.where(np.isfinite(joint), joint, np.inf)


def _turned_squares(xy_a: Array, xy_b: Array, cameras: tuple[Camera, Camera], sigma: float) -> Array:
    """Squared distances of the matches from the rotation that suits them best."""
    estimated = any(camera.focal_estimated for camera in cameras)
    best, lowest = np.full(len(xy_a), np.inf), np.inf
    for factor in FOCALS if estimated else (1.0,):
        inner = [interior_matrix(camera) @ np.diag([1.0, 1.0, 1.0 / factor]) for camera in cameras]
        squares = _rotation_squares(xy_a, xy_b, inner, sigma)
        cost = float(np.minimum(squares, 4.0 * sigma**2).sum())
        if cost < lowest:
            best, lowest = squares, cost
    return best


def _rotation_squares(xy_a: Array, xy_b: Array, inner: list[Array], sigma: float) -> Array:
    """Squared distances from the rotation between two bundles of rays, found by Kabsch's solution, twice without outliers."""
    a, b = (homogeneous(xy) @ np.linalg.inv(k).T for xy, k in zip((xy_a, xy_b), inner, strict=True))
    a, b = (rays / np.linalg.norm(rays, axis=1, keepdims=True) for rays in (a, b))
    good = np.ones(len(a), bool)
    squares = np.full(len(a), np.inf)
    for _ in range(3):
        matrix = inner[1] @ _kabsch(a[good], b[good]) @ np.linalg.inv(inner[0])
        squares = _manifold_squares(matrix, xy_a, xy_b)
        good = squares <= max(float(np.median(squares)), (3.0 * sigma) ** 2)
        if good.sum() < 3:
            break
    return squares


def _kabsch(a: Array, b: Array) -> Array:
    """Return the rotation that takes unit vectors a to b best (Kabsch 1976)."""
    u, _, vt = np.linalg.svd(b.T @ a)
    return np.asarray((u * [1.0, 1.0, np.sign(np.linalg.det(u @ vt))]) @ vt)


def _ray_squares(frames: Array, directions: Array) -> Array:
    """Squared distances, px², of directions (n, 3) from measured rays with their planes (n, 3, 3)."""
    x, y, z = np.einsum("nij,nj->in", frames, directions)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(z > 0.0, (x**2 + y**2) / z**2, np.inf)
