"""How far a computed block or cloud is from the truth of a simulated one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from graphos_core.data.block import Block
from graphos_core.data.cloud import Mesh
from graphos_core.data.record import Array, record
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_core.simulation.scene import ray_caster
from graphos_core.simulation.truth import Truth
from graphos_core.simulation.visibility import incidence, project_inside, unobstructed


@record
class CentreErrors:
    """Errors of projection centres after the similarity that fits them best to the truth.

    Attributes
    ----------
    names : tuple of str
        Oriented photos that are in the truth.
    similarity : Similarity
        ``truth_from_block``.
    errors : float64 (k, 3)
        Transformed − true, m.
    rms_m : float
        Root mean square of the lengths of `errors` (3-D), m.
    rotation_errors : float64 (k,)
        Angle between transformed and true rotation, radians.
    object_distance_m : float
    """

    names: tuple[str, ...]
    similarity: Similarity
    errors: Array
    rms_m: float
    rotation_errors: Array
    object_distance_m: float

    @property
    def relative(self) -> float:
        """RMS over object distance."""
        return self.rms_m / self.object_distance_m


@record
class SurfaceErrors:
    """Distances of cloud points from the true surface.

    Attributes
    ----------
    distances : float64 (n,)
        To the nearest point of the surface, not signed, m.
    median_m, q90_m : float
        Median and 90 % quantile.
    """

    distances: Array
    median_m: float
    q90_m: float

    def share_within(self, distance: float) -> float:
        """Share of the points at most `distance` m from the surface."""
        return float((self.distances <= distance).mean()) if len(self.distances) else 0.0


@record
class Coverage:
    """How much of the surface that enough photos see is covered by cloud points.

    Attributes
    ----------
    share : float
        0 to 1.
    seen : float64 (k, 3)
        Samples of the surface that enough photos see, m, evenly over its area.
    covered : bool (k,)
    definition : str
        What counts, in words.
    """

    share: float
    seen: Array
    covered: Array
    definition: str


def camera_centre_errors(block: Block, truth: Truth) -> CentreErrors:
    """Compare projection centres and rotations with the truth after a similarity over the centres.

    Raises
    ------
    UserError
        With fewer than three oriented photos in common.
    """
    place = {name: i for i, name in enumerate(truth.names)}
    mine = [i for i, name in enumerate(block.names) if block.oriented[i] and name in place]
    theirs = [place[block.names[i]] for i in mine]
    similarity = estimate_similarity(block.centres[mine], truth.centres[theirs])
    errors = similarity.apply(block.centres[mine]) - truth.centres[theirs]
    relative = similarity.rotate_camera(block.rotations[mine]) @ np.swapaxes(truth.rotations[theirs], 1, 2)
    # |R − I| = 2√2 sin(α/2) keeps small angles exact, where the arc cosine of the trace loses them
    chord = np.linalg.norm(relative - np.eye(3), axis=(1, 2))
    return CentreErrors(
        names=tuple(block.names[i] for i in mine),
        similarity=similarity,
        errors=errors,
        rms_m=float(np.sqrt((errors**2).sum(axis=1).mean())),
        rotation_errors=2.0 * np.arcsin(np.minimum(chord / (2.0 * np.sqrt(2.0)), 1.0)),
        object_distance_m=truth.object_distance_m,
    )


def surface_errors(points: Array, mesh: Mesh) -> SurfaceErrors:
    """Return the distance of each cloud point (n, 3), in the frame of the truth, from the true surface."""
    import open3d as o3d

    caster = ray_caster(mesh.vertices, mesh.triangles)
    query = o3d.core.Tensor.from_numpy(np.ascontiguousarray(points, dtype=np.float32))
    distances = caster.compute_distance(query).numpy().astype(np.float64)
    median, q90 = np.quantile(distances, [0.5, 0.9]) if len(distances) else (np.nan, np.nan)
    return SurfaceErrors(distances=distances, median_m=float(median), q90_m=float(q90))


def coverage(
    points: Array,
    truth: Truth,
    radius: float,
    *,
    min_photos: int = 3,
    max_incidence_deg: float = 75.0,
    max_distance: float = 1.5,
    samples: int = 400_000,
    seed: int = 0,
) -> Coverage:
    """Return the share of the surface seen by enough photos that has a cloud point near.

    Parameters
    ----------
    points : float64 (n, 3)
        Cloud in the frame of the truth, m.
    truth : Truth
    radius : float
        A sample is covered when a cloud point is at most this far, m.
    min_photos : int
        A sample counts when at least so many photos see it: inside the format, not hidden, within the two limits.
    max_incidence_deg : float
        Largest angle between the ray and the surface normal, degrees.
    max_distance : float
        Largest distance from the projection centre, in object distances.
    samples, seed : int
        Number of random samples over the surface, most of them where something is seen, and their seed.
    """
    from scipy.spatial import cKDTree

    limits = _Limits(
        min_photos, np.cos(np.radians(max_incidence_deg)), max_distance * truth.object_distance_m
    )
    caster = ray_caster(truth.mesh.vertices, truth.mesh.triangles)
    corners = truth.mesh.vertices[truth.mesh.triangles]
    rough = _seen(truth, caster, limits, *_sample(corners, samples // 10, seed))
    if len(rough):  # the second time only where something is seen at all
        low, high = rough.min(axis=0) - 0.5, rough.max(axis=0) + 0.5
        corners = corners[((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high)).all(axis=1)]
    seen = _seen(truth, caster, limits, *_sample(corners, samples, seed + 1))
    covered = np.zeros(len(seen), bool)
    if len(points) and len(seen):
        distance, _ = cKDTree(np.asarray(points)).query(seen, distance_upper_bound=radius)
        covered = np.isfinite(distance)
    return Coverage(
        share=float(covered.mean()) if len(covered) else 0.0,
        seen=seen,
        covered=covered,
        definition=f"surface seen by at least {min_photos} photos under at most {max_incidence_deg:g}° from its "
        f"normal and within {max_distance:g} object distances; covered within {radius:.4g} m",
    )


@dataclass(frozen=True)
class _Limits:
    """What counts as seen: number of photos, smallest cosine of the incidence angle, largest distance, m."""

    photos: int
    cosine: float
    distance: float


def _seen(truth: Truth, caster: Any, limits: _Limits, xyz: Array, normals: Array) -> Array:
    """Return the samples that enough photos see."""
    photos = np.zeros(len(xyz), np.int32)
    for i, (rotation, centre) in enumerate(zip(truth.rotations, truth.centres, strict=True)):
        _, inside = project_inside(truth.cameras[truth.camera_of_photo[i]], rotation, centre, xyz)
        inside &= incidence(normals, xyz, centre) >= limits.cosine
        inside &= np.linalg.norm(xyz - centre, axis=1) <= limits.distance
        which = np.flatnonzero(inside)
        photos[which] += unobstructed(caster, xyz[which], normals[which], centre)
    result: Array = xyz[photos >= limits.photos]
    return result


def _sample(corners: Array, count: int, seed: int) -> tuple[Array, Array]:
    """Return points and unit normals, evenly at random over triangles (f, 3, 3)."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    rng = np.random.default_rng([seed, 11])
    which = rng.choice(len(corners), count, p=area / area.sum())
    a, b = rng.random(count), rng.random(count)
    a, b = np.where(a + b > 1.0, 1.0 - a, a), np.where(a + b > 1.0, 1.0 - b, b)
    c = corners[which]
    xyz = c[:, 0] + a[:, None] * (c[:, 1] - c[:, 0]) + b[:, None] * (c[:, 2] - c[:, 0])
    return xyz, cross[which] / area[which, None]
