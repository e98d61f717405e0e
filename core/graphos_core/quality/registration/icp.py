"""Iterative closest point: moves the cloud until it fits the reference best."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from threadpoolctl import threadpool_limits

from graphos_core.data import Array, Cloud, Mesh
from graphos_core.errors import UserError
from graphos_core.geometry.similarity import Similarity
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text


class IcpParams(Params):
    """How the closest points are found and the motion is solved."""

    reach: Annotated[float | None, About(
        label="Reach", symbol="d_{max}", unit="reference units", low=0, low_open=True,
        help="Largest distance of two points that are taken as the same place at the end; none: 1 % of the size of "
        "the reference. The first rounds reach four times as far.",
        effect="Higher: finds home from farther away, wrong pairs pull at the edges. Lower: exact, needs a good start.",
        learn="quality/registration")] = None  # fmt: skip
    rounds: Annotated[int, About(
        label="Rounds", symbol="n", unit="iterations", low=1, high=1000, step=10, level="expert",
        help="Largest number of iterations at each reach.",
        effect="Higher: comes to rest more surely. Lower: faster.")] = 60  # fmt: skip
    points: Annotated[int, About(
        label="Points used", symbol="m", unit="points", low=100, high=5_000_000, step=10_000, level="expert",
        help="At most so many points of the cloud and of the reference take part.",
        effect="Higher: slower, hardly more exact. Lower: faster.")] = 100_000  # fmt: skip


@algorithm(
    stage="quality",
    role="registration",
    name="icp",
    label="Iterative closest point (point to plane)",
    source="Besl and McKay 1992; Chen and Medioni 1992 (point to plane); Open3D",
    learn="quality/registration",
)
def icp(
    cloud: Cloud, reference: Cloud | Mesh, initial: Similarity | None, params: IcpParams, *, run: Run
) -> Similarity:
    """Move the cloud rigidly onto the reference; the scale stays that of the start.

    What the cloud and reference have in common as an error (a wrong orientation of the block) is moved away too,
    so the distances afterwards say less than those of a cloud that was placed by control.

    Parameters
    ----------
    cloud : Cloud
    reference : Cloud or Mesh
    initial : Similarity or None
        ``reference_from_cloud``; None: the same frame.
    params : IcpParams
    run : Run

    Returns
    -------
    Similarity
        ``reference_from_cloud``.

    Raises
    ------
    UserError
        When hardly any points are within reach of each other.
    Stopped
        When the person asked to stop.
    """
    import open3d as o3d

    start = initial or Similarity(1.0, np.eye(3), np.zeros(3))
    theirs = reference.vertices if isinstance(reference, Mesh) else reference.points
    shift = theirs.mean(axis=0)
    size = float(np.linalg.norm(theirs.max(axis=0) - theirs.min(axis=0)))
    reach = params.reach or 0.01 * size
    rng = np.random.default_rng(run.seed)
    moving = _point_cloud(_some(start.apply(cloud.points) - shift, params.points, rng))
    motion = np.eye(4)
    estimation = o3d.pipelines.registration.TransformationEstimationPointToPlane()
    with threadpool_limits(limits=1):  # sums in threads differ in the last bits from run to run
        target = _target(reference, shift, params.points, rng, 2.0 * reach, run.seed)
        for distance in (4.0 * reach, 2.0 * reach, reach):
            for _ in range(0, params.rounds, 20):
                run.check()
                stop = o3d.pipelines.registration.ICPConvergenceCriteria(1e-9, 1e-9, min(20, params.rounds))
                found = o3d.pipelines.registration.registration_icp(
                    moving, target, distance, motion, estimation, stop
                )
                motion = np.array(found.transformation)
    if found.fitness < 0.05:
        raise UserError(
            Text("The cloud could not be registered to the reference."),
            Text(
                "Only {share:.1f} % of its points have a reference point within reach.",
                share=100 * found.fitness,
            ),
            Text("Georeference the block with control points first, or raise “Reach”."),
            "quality/registration",
        )
    turn, move = motion[:3, :3], motion[:3, 3]
    return Similarity(start.scale, turn @ start.rotation, turn @ (start.translation - shift) + move + shift)


def _some(points: Array, most: int, rng: np.random.Generator) -> Array:
    if len(points) <= most:
        return points
    return points[np.sort(rng.choice(len(points), most, replace=False))]


def _point_cloud(points: Array) -> Any:
    import open3d as o3d

    made = o3d.geometry.PointCloud()
    made.points = o3d.utility.Vector3dVector(np.ascontiguousarray(points, dtype=np.float64))
    return made


def _target(
    reference: Cloud | Mesh, shift: Array, most: int, rng: np.random.Generator, radius: float, seed: int
) -> Any:
    """Return the reference as points with normals, relative to `shift`."""
    import open3d as o3d

    if isinstance(reference, Mesh):
        return _point_cloud_on(reference, shift, most, seed)
    keep = np.arange(len(reference.points))
    if len(keep) > most:
        keep = np.sort(rng.choice(len(keep), most, replace=False))
    made = _point_cloud(reference.points[keep] - shift)
    if len(reference.normals) == len(reference.points):
        made.normals = o3d.utility.Vector3dVector(reference.normals[keep].astype(np.float64))
    else:
        made.estimate_normals(o3d.geometry.KDTreeSearchParamHybrid(radius=radius, max_nn=30))
    return made


def _point_cloud_on(mesh: Mesh, shift: Array, most: int, seed: int) -> Any:
    """Return points with normals, evenly at random over the triangles."""
    import open3d as o3d

    corners = (mesh.vertices - shift)[mesh.triangles]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    rng = np.random.default_rng(seed)
    which = rng.choice(len(corners), most, p=area / area.sum())
    a, b = rng.random((2, most, 1))
    a, b = np.where(a + b > 1.0, 1.0 - a, a), np.where(a + b > 1.0, 1.0 - b, b)
    c = corners[which]
    made = _point_cloud(c[:, 0] + a * (c[:, 1] - c[:, 0]) + b * (c[:, 2] - c[:, 0]))
    made.normals = o3d.utility.Vector3dVector(cross[which] / area[which, None])
    return made
