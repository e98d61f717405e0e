"""Dense matching: time, memory and error against the truth of a simulated block, for several picture sizes.

    python benchmarks/dense.py FOLDER [--sizes 800 1200 1600] [--threads N]

FOLDER is a simulated block (``graphos simulate facade --out FOLDER``; it is made when missing). The true cameras and
poses are used, so the errors are those of dense matching alone. Both wall time and processor time are given: on a busy
machine only the second says what the program costs. The first size is run once before, so compiled code is warm.
The aggregation alone is timed as well, in millions of hypotheses times directions per second.
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path

import cv2
import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Block
from graphos_core.dense.depth_maps import MultiViewParams, multiview
from graphos_core.dense.fusion import FusionParams, consistent
from graphos_core.dense.sgm import aggregate
from graphos_core.run import Run
from graphos_core.simulation.comparison import coverage, surface_errors
from graphos_core.simulation.photo_block import simulate_photos
from graphos_core.simulation.truth import Truth, load_truth


def true_block(truth: Truth, *, per_photo: int = 400, seed: int = 0) -> Block:
    """The block with true cameras and poses, and object points drawn from the true depths."""
    rng = np.random.default_rng(seed)
    depths = [truth.depth(i) for i in range(len(truth.names))]
    parts = []
    for i, depth in enumerate(depths):
        xy = np.column_stack([rng.integers(0, size, per_photo) for size in depth.shape[::-1]])
        z = depth[xy[:, 1], xy[:, 0]]
        known = np.isfinite(z)
        rays = ray_from_pixel(truth.cameras[truth.camera_of_photo[i]], xy[known].astype(float))
        parts.append((rays * z[known, None]) @ truth.rotations[i] + truth.centres[i])
    points = np.concatenate(parts)
    observed = [_observed(truth, i, depth, points) for i, depth in enumerate(depths)]
    photo = np.repeat(np.arange(len(observed)), [len(o[0]) for o in observed])
    point = np.concatenate([o[0] for o in observed])
    order = np.lexsort((photo, point))
    n = len(truth.names)
    return Block(
        cameras=truth.cameras, names=truth.names, camera_of_photo=truth.camera_of_photo, oriented=np.ones(n, bool),
        rotations=truth.rotations, centres=truth.centres, points=points,
        colours=np.zeros((len(points), 3), np.uint8), point_track=np.full(len(points), -1, np.int32),
        obs_photo=photo[order].astype(np.int32), obs_point=point[order].astype(np.int32),
        obs_xy=np.concatenate([o[1] for o in observed])[order], unit="m",
    )  # fmt: skip


def _observed(truth: Truth, photo: int, depth: Array, points: Array) -> tuple[Array, Array]:
    """Indices and pixels of the points that a photo sees."""
    inside = (points - truth.centres[photo]) @ truth.rotations[photo].T
    xy = pixel_from_ray(truth.cameras[truth.camera_of_photo[photo]], inside)
    good = np.isfinite(xy).all(axis=1) & (xy >= 0).all(axis=1)
    good &= (np.nan_to_num(xy) <= np.array(depth.shape[::-1]) - 1).all(axis=1)
    which = np.flatnonzero(good)
    at = np.rint(xy[which]).astype(int)
    which = which[np.abs(depth[at[:, 1], at[:, 0]] - inside[which, 2]) < 0.003 * truth.object_distance_m]
    return which, xy[which]


def one_size(block: Block, truth: Truth, size: int, threads: int) -> str:
    """Run one size; a line of the table."""

    def read(photo: int) -> Array:
        path = Path(truth.folder) / "photos" / truth.names[photo]
        return cv2.cvtColor(cv2.imread(str(path)), cv2.COLOR_BGR2RGB)

    wall, cpu = time.perf_counter(), time.process_time()
    maps = multiview(block, read, MultiViewParams(image_size=size), run=Run(threads=threads))
    depth_wall, depth_cpu = time.perf_counter() - wall, time.process_time() - cpu
    wall, cpu = time.perf_counter(), time.process_time()
    cloud = consistent(block, maps, read, FusionParams(), run=Run(threads=threads))
    fusion_wall, fusion_cpu = time.perf_counter() - wall, time.process_time() - cpu
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    error = surface_errors(cloud.points, truth.mesh)
    covered = coverage(cloud.points, truth, 3.0 * truth.gsd_m)
    return (
        f"{size:6d} {depth_wall:8.1f} {depth_cpu:8.1f} {fusion_wall:8.1f} {fusion_cpu:8.1f} {memory:8.0f} "
        f"{len(cloud.points):9d} {error.median_m / truth.gsd_m:8.3f} {error.q90_m / truth.gsd_m:8.3f} "
        f"{100 * error.share_within(3 * truth.gsd_m):8.1f} {100 * covered.share:8.1f}"
    )


def aggregation_speed() -> float:
    """Millions of hypotheses times directions per second, one thread, 900×1200×16."""
    rng = np.random.default_rng(0)
    cost = rng.integers(0, 1001, (900, 1200, 16)).astype(np.uint16)
    starts, grey = np.zeros((900, 1200), np.float32), np.full((900, 1200), 100, np.uint8)
    times = []
    for _ in range(4):
        begin = time.process_time()
        aggregate(cost, starts, grey, p1=60, p2=600, edge_grey=12.0, run=Run())
        times.append(time.process_time() - begin)
    return 8e-6 * cost.size / min(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--sizes", type=int, nargs="+", default=[800, 1200, 1600])
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    if not (options.folder / "truth" / "cameras.json").exists():
        simulate_photos("facade", options.folder, photos=12)
    truth = load_truth(options.folder)
    block = true_block(truth)
    one_size(block, truth, 400, options.threads)
    print(f"aggregation: {aggregation_speed():.0f} million hypotheses × directions per second and thread")
    print(
        f"{'size':>6} {'depth s':>8} {'cpu s':>8} {'fuse s':>8} {'cpu s':>8} {'MB':>8} {'points':>9} "
        f"{'med/GSD':>8} {'90%/GSD':>8} {'%<3GSD':>8} {'cover %':>8}"
    )
    for size in options.sizes:
        print(one_size(block, truth, size, options.threads), flush=True)


if __name__ == "__main__":
    main()
