"""How good the model is by its own figures, without any reference, and what would make it better."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from graphos_core.data import Adjustment, Array, Block, Cloud, PairMatches
from graphos_core.text import Text

CELLS = 10
"""Cells along the shorter side of a photo when its coverage with tie points is counted."""


def internal_figures(
    adjustment: Adjustment, cloud: Cloud | None, pairs: Sequence[PairMatches]
) -> dict[str, dict[str, Any]]:
    """Return the internal figures of a model.

    Parameters
    ----------
    adjustment : Adjustment
    cloud : Cloud or None
    pairs : sequence of PairMatches
        Every pair that was tried.

    Returns
    -------
    dict of str to dict
        By name: ``label``, ``value`` (float or None), ``unit``, ``reason`` (why there is no value; else empty) and
        ``definition``.
    """
    block = adjustment.block
    covers = image_coverage(block)
    gsd = ground_sampling_distance(block)
    sigma = median_point_sigma(adjustment)
    found = {
        "photos_oriented": _figure(
            Text("Photos oriented"), 100.0 * float(block.oriented.mean()), "%", "Share of all photos."
        ),
        "reprojection_rms": _figure(
            Text("Reprojection RMS"), adjustment.rms_px, "px",
            "Root mean square of the image residuals per coordinate.",
        ),
        "sigma0": _figure(
            Text("Standard deviation of unit weight"), adjustment.sigma0_px, "px",
            "A posteriori, of an image coordinate.",
        ),
        "mean_rays": _figure(
            Text("Rays per object point"), len(block.obs_point) / max(len(block.points), 1), "rays",
            "Mean number of photos in which an object point is measured.",
        ),
        "intersection_angle": _figure(
            Text("Intersection angle"), float(np.degrees(_median(widest_angles(block)))), "°",
            "Median over the object points of the widest angle between two of their rays.",
        ),
        "image_coverage": _figure(
            Text("Photo area with tie points"), 100.0 * _mean(covers[block.oriented]), "%",
            "Mean share of occupied grid cells over the oriented photos.",
        ),
        "image_coverage_least": _figure(
            Text("Least covered photo"), 100.0 * _least(covers[block.oriented]), "%",
            "Smallest share of occupied grid cells of an oriented photo.",
        ),
        "pairs_used": _figure(
            Text("Pairs with verified matches"), 100.0 * _mean([not p.reason for p in pairs]), "%",
            "Share of the pairs that were tried.",
        ),
        "overlap": _figure(
            Text("Overlapping photos"), overlapping_photos(block), "photos",
            "Mean number of photos that share at least 30 object points with a photo.",
        ),
        "gsd": _figure(
            Text("Ground sampling distance"), gsd, block.unit,
            "Median size of a pixel of the full photo on the object.",
        ),
        "point_precision": _figure(
            Text("Precision of object points"), sigma, block.unit,
            "Median standard deviation per coordinate, from the covariance.",
            "The adjustment computed no standard deviations of the points.",
        ),
    }  # fmt: skip
    if cloud is not None and len(cloud.points):
        found["dense_points"] = _figure(
            Text("Points of the dense cloud"), float(len(cloud.points)), "points", "Number."
        )
        found["point_spacing"] = _figure(
            Text("Point spacing"), point_spacing(cloud.points), block.unit,
            "Median distance of a dense point from its nearest neighbour.",
        )  # fmt: skip
    return found


def _figure(
    label: str,
    value: float,
    unit: str,
    definition: str,
    reason: str = "It cannot be computed from this block.",
) -> dict[str, Any]:
    known = bool(np.isfinite(value))
    return {
        "label": label,
        "value": float(value) if known else None,
        "unit": unit,
        "reason": "" if known else Text(reason),
        "definition": Text(definition),
    }


def _median(values: Array) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def _mean(values: Any) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _least(values: Array) -> float:
    return float(np.min(values)) if len(values) else float("nan")


def image_coverage(block: Block) -> Array:
    """Return for each photo the share of grid cells that contain a tie point; float64 (n,), 0 to 1.

    The shorter side has `CELLS` cells, the longer as many of about the same size.
    """
    shares = np.zeros(len(block.names))
    for photo in range(len(shares)):
        camera = block.cameras[int(block.camera_of_photo[photo])]
        side = min(camera.width, camera.height) / CELLS
        columns, rows = max(1, round(camera.width / side)), max(1, round(camera.height / side))
        xy = block.obs_xy[block.obs_photo == photo] + 0.5
        x = np.clip((xy[:, 0] / camera.width * columns).astype(int), 0, columns - 1)
        y = np.clip((xy[:, 1] / camera.height * rows).astype(int), 0, rows - 1)
        shares[photo] = len(np.unique(y * columns + x)) / (rows * columns)
    return shares


def widest_angles(block: Block) -> Array:
    """Return the widest angle between two rays of each object point with two rays or more; radians."""
    order = np.lexsort((block.obs_photo, block.obs_point))
    point, photo = block.obs_point[order], block.obs_photo[order]
    rays = block.points[point] - block.centres[photo]
    rays /= np.maximum(np.linalg.norm(rays, axis=1, keepdims=True), 1e-300)
    _, first, count = np.unique(point, return_index=True, return_counts=True)
    angles = []
    for rays_per_point in np.unique(count[count >= 2]):
        start = first[count == rays_per_point]
        group = rays[start[:, None] + np.arange(rays_per_point)]
        cosine = np.einsum("nik,njk->nij", group, group).min(axis=(1, 2))
        angles.append(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return np.concatenate(angles) if angles else np.empty(0)


def overlapping_photos(block: Block, *, least_common: int = 30) -> float:
    """Return with how many other photos an oriented photo shares at least `least_common` object points, mean."""
    seen = np.zeros((len(block.names), len(block.points)), np.float32)
    seen[block.obs_photo, block.obs_point] = 1.0
    common = seen[block.oriented] @ seen[block.oriented].T
    np.fill_diagonal(common, 0.0)
    return _mean((common >= least_common).sum(axis=1))


def ground_sampling_distance(block: Block) -> float:
    """Return the median over all observations of depth / principal distance, in the block's unit."""
    if len(block.obs_photo) == 0:
        return float("nan")
    focal = np.array([camera.focal_px for camera in block.cameras])[block.camera_of_photo[block.obs_photo]]
    rays = block.points[block.obs_point] - block.centres[block.obs_photo]
    depth = np.einsum("ij,ij->i", rays, block.rotations[block.obs_photo][:, 2])
    return float(np.median(depth / focal))


def median_point_sigma(adjustment: Adjustment) -> float:
    """Return the median standard deviation per coordinate of the object points, in the block's unit."""
    sigma = np.sqrt((np.asarray(adjustment.sigma_points) ** 2).mean(axis=1))
    return _median(sigma[np.isfinite(sigma) & (sigma > 0)])


def point_spacing(points: Array, *, samples: int = 20_000) -> float:
    """Return the median distance of points from their nearest neighbours, over evenly chosen samples."""
    if len(points) < 2:
        return float("nan")
    chosen = points[:: max(1, len(points) // samples)]
    near, _ = cKDTree(points).query(chosen, k=2)
    return float(np.median(near[:, 1]))
