"""Signed distances of a cloud from the nearest place of a reference: a mesh, or the local plane of a cloud."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from scipy.spatial import cKDTree

from graphos_core.data import Array, Cloud, Mesh
from graphos_core.errors import UserError
from graphos_core.params import About, Params
from graphos_core.quality.statistics import distance_statistics
from graphos_core.registry import algorithm
from graphos_core.roles import ComparisonResult
from graphos_core.run import Run
from graphos_core.text import Text

CHUNK = 200_000
"""Points between two looks at whether the work should stop."""


class NearestParams(Params):
    """How distances are taken."""

    plane_points: Annotated[int, About(
        label="Points of the local plane", symbol="k", unit="points", low=3, high=100, step=1,
        help="Nearest reference points to which a plane is fitted; a mesh has its own planes.",
        effect="Higher: noise of the reference is averaged, edges are rounded. Lower: the reference's noise is "
        "measured too.", learn="quality/distances")] = 8  # fmt: skip
    farthest: Annotated[float | None, About(
        label="Farthest distance", symbol="d_{max}", unit="reference units", low=0, low_open=True,
        help="Points farther from the reference are left out, because the reference does not show them; none: all count.",
        effect="Lower: only what both have is compared. Higher: large errors are counted too.",
        learn="quality/distances")] = None  # fmt: skip


@algorithm(
    stage="quality",
    role="comparison",
    name="nearest",
    version=2,
    label="Distance from the nearest surface",
    source="Cloud to mesh, and cloud to local least-squares plane: Lague et al. 2013, section 2.2",
    learn="quality/distances",
)
def nearest(cloud: Cloud, reference: Cloud | Mesh, params: NearestParams, *, run: Run) -> ComparisonResult:
    """Measure how far each cloud point is from the reference, positive on its outside.

    Parameters
    ----------
    cloud : Cloud
        In the frame and unit of the reference.
    reference : Cloud or Mesh
    params : NearestParams
    run : Run

    Returns
    -------
    ComparisonResult
        Distances are NaN for points that are left out.

    Raises
    ------
    UserError
        When cloud or reference are empty.
    Stopped
        When the person asked to stop.
    """
    _refuse_empty(cloud, reference)
    shift = (reference.vertices if isinstance(reference, Mesh) else reference.points).mean(axis=0)
    if isinstance(reference, Mesh):
        distances = mesh_distances(cloud.points - shift, reference.vertices - shift, reference.triangles, run)
        how = Text(
            "Distance from the nearest point of the reference mesh, positive on the outside of its triangles"
        )
    else:
        distances = plane_distances(cloud, reference, shift, params.plane_points, run)
        how = Text(
            "Distance from the plane through the {k} nearest reference points; the distance from the nearest point "
            "where that is more than three point spacings away",
            k=params.plane_points,
        )
    if params.farthest is not None:
        distances[np.abs(distances) > params.farthest] = np.nan
    unit = reference.unit
    return ComparisonResult(
        distances=distances, statistics=distance_statistics(distances), unit=unit, definition=how
    )


def _refuse_empty(cloud: Cloud, reference: Cloud | Mesh) -> None:
    empty = len(reference.triangles) == 0 if isinstance(reference, Mesh) else len(reference.points) < 3
    if len(cloud.points) == 0 or empty:
        raise UserError(
            Text("There is nothing to compare."),
            Text("The cloud or the reference is empty."),
            Text("Compute a dense cloud and choose a reference with points or triangles."),
        )


def mesh_distances(points: Array, vertices: Array, triangles: Array, run: Run) -> Array:
    """Return the signed distance of points (n, 3) from a mesh; float64 (n,).

    The sign is that of the side of the nearest triangle, which also holds for surfaces that enclose nothing.
    Coordinates should be small: the nearest triangle is found in single precision.
    """
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(
        o3d.core.Tensor.from_numpy(np.ascontiguousarray(vertices, dtype=np.float32)),
        o3d.core.Tensor.from_numpy(np.ascontiguousarray(triangles, dtype=np.uint32)),
    )
    distances = np.empty(len(points))
    for start in range(0, len(points), CHUNK):
        run.check()
        part = points[start : start + CHUNK]
        found = scene.compute_closest_points(o3d.core.Tensor.from_numpy(part.astype(np.float32)))
        away = part - found["points"].numpy().astype(np.float64)
        side = np.einsum("ij,ij->i", away, found["primitive_normals"].numpy().astype(np.float64))
        distances[start : start + CHUNK] = np.linalg.norm(away, axis=1) * np.where(side < 0.0, -1.0, 1.0)
        run.progress(min(start + CHUNK, len(points)), len(points), "points compared")
    return distances


def plane_distances(cloud: Cloud, reference: Cloud, shift: Array, k: int, run: Run) -> Array:
    """Return the signed distance of each cloud point from the local plane of a reference cloud; float64 (n,).

    The sign follows the reference normals, else those of the cloud, else the normal's side away from zero.
    """
    theirs = reference.points - shift
    tree = cKDTree(theirs)
    k = min(k, len(theirs))
    distances = np.empty(len(cloud.points))
    for start in range(0, len(cloud.points), CHUNK // 4):
        run.check()
        rows = slice(start, start + CHUNK // 4)
        part = cloud.points[rows] - shift
        near, index = tree.query(part, k=k)
        group = theirs[index]
        middle = group.mean(axis=1)
        normals = plane_normals(group - middle[:, None])
        outwards = _outwards(cloud, reference, rows, index[:, 0], middle)
        normals *= np.where(np.einsum("ij,ij->i", normals, outwards) < 0.0, -1.0, 1.0)[:, None]
        signed = np.einsum("ij,ij->i", part - middle, normals)
        # the fourth neighbour of the nearest point: the very nearest may be the same point, or almost
        spacing = np.sort(np.linalg.norm(group - group[:, :1], axis=2)[:, 1:], axis=1)[:, min(3, k - 2)]
        beyond = near[:, 0] > 3.0 * np.maximum(spacing, 1e-300)
        distances[rows] = np.where(beyond, np.copysign(near[:, 0], signed), signed)
        run.progress(min(rows.stop, len(cloud.points)), len(cloud.points), "points compared")
    return distances


def _outwards(cloud: Cloud, reference: Cloud, rows: slice, nearest_point: Array, middle: Array) -> Array:
    if len(reference.normals) == len(reference.points):
        return reference.normals[nearest_point].astype(np.float64)
    if len(cloud.normals) == len(cloud.points):
        return cloud.normals[rows].astype(np.float64)
    return middle


def plane_normals(centred: Array) -> Array:
    """Return the normal of the least-squares plane of each group of points; (n, k, 3) centred → (n, 3)."""
    _, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", centred, centred))
    normals: Array = vectors[:, :, 0].copy()
    return normals
