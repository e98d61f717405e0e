"""Our bundle adjustment beside pyceres: time to a stated cost, set-up included.

Run: ``GRAPHOS_DATA=… python benchmarks/bundle_adjustment.py [--problem ladybug|photos100|photos400] [--repeats N]``

Problems: BAL Ladybug-49 until its cost is at most 1.3410e4; simulated aerial blocks of 100 photos with 50 000 points
and 400 photos with 120 000 points (80 % and 60 % overlap, noise 0.5 px, one camera with f, k1, k2 free, start
disturbed) until the cost is within 1e-6 of the minimum.

Both solve the same unknowns (6 per photo, f, k1, k2 per photo, 3 per point) from the same start with two threads. In
both an observation behind its camera counts as zero, as the cost functions of pycolmap have it that pyceres uses here
(31 observations at the start, cost 850802.1). The line "all observations" is our adjustment with the cost of BAL
itself, where these count too (850912.5).

Our time starts with the `Block` and ends with the adjusted one. The time of pyceres starts with a finished
`pycolmap.Reconstruction`: making the problem in C++ counts, our Python loop that fills the reconstruction does not.
Compiled code is warm. Each program first finds out how many iterations it needs; the times are of runs with that many,
alternating, best and median of several.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyceres
import pycolmap

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Block, Camera
from graphos_core.exchange.bal import FREE, read_bal
from graphos_core.geometry.rotation import matrix_from_vector, quaternion_from_matrix
from graphos_core.run import Run

LADYBUG_COST = 1.3410e4
CLOSE = 1e-6
"""Relative distance from the minimum at which a simulated block counts as solved."""
SOLVERS = {
    "DENSE_SCHUR (Eigen)": (
        pyceres.LinearSolverType.DENSE_SCHUR,
        pyceres.DenseLinearAlgebraLibraryType.EIGEN,
    ),
    "DENSE_SCHUR (LAPACK)": (
        pyceres.LinearSolverType.DENSE_SCHUR,
        pyceres.DenseLinearAlgebraLibraryType.LAPACK,
    ),
    "SPARSE_SCHUR": (pyceres.LinearSolverType.SPARSE_SCHUR, pyceres.DenseLinearAlgebraLibraryType.EIGEN),
}


def aerial_block(photos: int, points: int, seed: int = 0) -> Block:
    """Photos in strips over hilly ground; observations with noise, everything else disturbed."""
    rng = np.random.default_rng(seed)
    camera = Camera(model="basic", width=6000, height=4000, values=np.array([5000.0, 0.0, 0.0, -0.05, 0.01]))
    columns = round(np.sqrt(photos) * 1.25)
    index = np.arange(photos)
    height, along, across = 100.0, 0.2 * 80.0, 0.4 * 120.0  # 80 % along a strip, 60 % between strips
    centres = np.column_stack(
        [across * (index // columns), along * (index % columns), np.full(photos, height)]
    )
    centres += rng.normal(0.0, 1.0, centres.shape)
    down = np.diag([1.0, -1.0, -1.0])
    rotations = np.stack([matrix_from_vector(rng.normal(0.0, 0.03, 3)) @ down for _ in index])
    margin = np.array([50.0, 35.0, 0.0])
    low, high = centres.min(axis=0) - margin, centres.max(axis=0) + margin
    ground = np.column_stack([rng.uniform(low[i], high[i], points) for i in (0, 1)])
    ground = np.column_stack([ground, 8.0 * np.sin(ground[:, 0] / 20.0) * np.cos(ground[:, 1] / 15.0)])
    rows = []
    for n in index:
        pixel = pixel_from_ray(camera, (ground - centres[n]) @ rotations[n].T)
        inside = np.flatnonzero((np.abs(pixel) < [3000.0, 2000.0]).all(axis=1))
        rows.append(np.column_stack([inside, np.full(len(inside), n), pixel[inside]]))
    table = np.concatenate(rows)
    table = table[rng.random(len(table)) < 0.6]
    seen = np.bincount(table[:, 0].astype(int), minlength=points)
    table = table[seen[table[:, 0].astype(int)] >= 2]
    kept, place = np.unique(table[:, 0].astype(int), return_inverse=True)
    order = np.lexsort((table[:, 1], place))
    table, place, ground = table[order], place[order], ground[kept]
    return Block(
        cameras=(replace(camera, values=camera.values * [1.01, 1.0, 1.0, 0.0, 0.0]),),
        names=tuple(f"{n:04d}.jpg" for n in index), camera_of_photo=np.zeros(photos, dtype=np.int32),
        oriented=np.ones(photos, dtype=bool),
        rotations=np.stack([matrix_from_vector(rng.normal(0.0, 0.002, 3)) @ r for r in rotations]),
        centres=centres + rng.normal(0.0, 0.3, centres.shape),
        points=ground + rng.normal(0.0, 0.3, ground.shape), colours=np.zeros((len(kept), 3), dtype=np.uint8),
        point_track=np.arange(len(kept), dtype=np.int32), obs_photo=table[:, 1].astype(np.int32),
        obs_point=place.astype(np.int32), obs_xy=table[:, 2:] + rng.normal(0.0, 0.5, (len(table), 2)),
    )  # fmt: skip


def ours(block: Block, iterations: int, threads: int, *, guard: bool) -> tuple[float, list[float]]:
    """Adjust; seconds, and the cost after each iteration."""
    begin = time.perf_counter()
    options = Options(max_iterations=iterations, tolerance=1e-14, statistics=False, guard=guard)
    adjusted = adjust_block(
        block, Freedom(interior=(FREE,) * len(block.cameras)), options, run=Run(threads=threads)
    )
    return time.perf_counter() - begin, [record.cost for record in adjusted.iterations]


def reconstruction_of(block: Block) -> pycolmap.Reconstruction:
    """The same block as a reconstruction, camera model RADIAL (f, cx, cy, k1, k2)."""
    made = pycolmap.Reconstruction()
    place = np.zeros(len(block.obs_photo), dtype=int)
    for c, camera in enumerate(block.cameras):
        f, _, _, k1, k2 = camera.values
        made.add_camera_with_trivial_rig(
            pycolmap.Camera(camera_id=c + 1, model="RADIAL", width=1, height=1, params=[f, 0, 0, k1, k2])
        )
    for i, name in enumerate(block.names):
        mine = np.flatnonzero(block.obs_photo == i)
        place[mine] = np.arange(len(mine))
        w, x, y, z = quaternion_from_matrix(block.rotations[i])
        pose = pycolmap.Rigid3d(
            pycolmap.Rotation3d(np.array([x, y, z, w])), -block.rotations[i] @ block.centres[i]
        )
        image = pycolmap.Image(
            name=name,
            camera_id=int(block.camera_of_photo[i]) + 1,
            image_id=i + 1,
            keypoints=block.obs_xy[mine],
        )
        made.add_image_with_trivial_frame(image, pose)
    start = np.searchsorted(block.obs_point, np.arange(len(block.points) + 1))
    for p, xyz in enumerate(block.points):
        track = pycolmap.Track()
        for o in range(start[p], start[p + 1]):
            track.add_element(int(block.obs_photo[o]) + 1, int(place[o]))
        made.add_point3D(xyz, track)
    return made


def theirs(block: Block, solver: str, iterations: int, threads: int) -> tuple[float, list[float]]:
    """Adjust with pyceres; seconds, and the cost after each iteration."""
    made = reconstruction_of(block)
    options = pycolmap.BundleAdjustmentOptions()
    options.refine_principal_point = False
    config = pycolmap.BundleAdjustmentConfig()
    for i in range(len(block.names)):
        config.add_image(i + 1)
    settings = pyceres.SolverOptions()
    settings.linear_solver_type, settings.dense_linear_algebra_library_type = SOLVERS[solver]
    settings.num_threads = threads
    settings.max_num_iterations = iterations
    settings.function_tolerance = settings.gradient_tolerance = settings.parameter_tolerance = 1e-14
    settings.logging_type = pyceres.LoggingType.SILENT
    costs: list[float] = []

    class Listen(pyceres.IterationCallback):
        def __call__(self, summary: pyceres.IterationSummary) -> pyceres.CallbackReturnType:
            costs.append(summary.cost)
            return pyceres.CallbackReturnType.SOLVER_CONTINUE

    listen = Listen()
    settings.callbacks = [listen]
    begin = time.perf_counter()
    problem = pycolmap.create_default_ceres_bundle_adjuster(options, config, made).problem
    pyceres.solve(settings, problem, pyceres.SolverSummary())
    return time.perf_counter() - begin, costs


def needed(costs: list[float], target: float) -> tuple[int, float]:
    """How many iterations reach the target, and the cost there."""
    count = next(k for k, cost in enumerate(costs) if cost <= target)
    return count, costs[count]


def problem(name: str) -> Block:
    """The block of a name."""
    if name == "ladybug":
        return read_bal(Path(os.environ["GRAPHOS_DATA"]) / "bal" / "problem-49-7776-pre.txt")
    return aerial_block(100, 50_000) if name == "photos100" else aerial_block(400, 120_000)


def peak_mb(name: str, which: str) -> float:
    """Largest resident memory while one program solves the problem, less that before, MB; in a process of its own."""
    code = (
        "import sys, threading, time; sys.path.insert(0, sys.argv[1]); import bundle_adjustment as b\n"
        "rss = lambda: int(open('/proc/self/statm').read().split()[1]) * 4096 / 2**20\n"
        "block = b.problem(sys.argv[2]); small = b.aerial_block(6, 300); mine = sys.argv[3] == 'ours'\n"
        "solve = (lambda x: b.ours(x, 2, 2, guard=True)) if mine else (lambda x: b.theirs(x, 'SPARSE_SCHUR', 2, 2))\n"
        "solve(small); base = peak = rss(); done = False\n"
        "def watch():\n"
        "    global peak\n"
        "    while not done: peak = max(peak, rss()); time.sleep(0.002)\n"
        "t = threading.Thread(target=watch); t.start(); solve(block); done = True; t.join(); print(peak - base)"
    )
    done = subprocess.run([sys.executable, "-c", code, str(Path(__file__).parent), name, which], check=True,
                          capture_output=True, text=True)  # fmt: skip
    return float(done.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problem", choices=("ladybug", "photos100", "photos400"), default="ladybug")
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument(
        "--memory", action="store_true", help="measure peak memory too, in processes of their own"
    )
    given = parser.parse_args()
    block = problem(given.problem)
    print(f"{len(block.names)} photos, {len(block.points)} points, {len(block.obs_xy)} observations")
    runs: dict[str, Callable[[int], tuple[float, list[float]]]] = {
        "GRAPHOS-Py": lambda k: ours(block, k, given.threads, guard=True),
    }
    if given.problem == "ladybug":
        runs["GRAPHOS-Py, all observations"] = lambda k: ours(block, k, given.threads, guard=False)
    for solver in SOLVERS if given.problem == "ladybug" else list(SOLVERS)[1:]:
        runs[f"pyceres {solver}"] = lambda k, solver=solver: theirs(block, solver, k, given.threads)  # type: ignore[misc]
    traces = {name: run(40 if given.problem == "ladybug" else 15)[1] for name, run in runs.items()}
    target = LADYBUG_COST
    if given.problem != "ladybug":
        target = min(min(costs) for costs in traces.values()) * (1.0 + CLOSE)
    counts = {name: needed(costs, target) for name, costs in traces.items()}
    times: dict[str, list[float]] = {name: [] for name in runs}
    rng = np.random.default_rng(0)
    for _ in range(given.repeats):  # in random order: the first after another program finds cold caches
        for name in rng.permutation(list(runs)):
            times[name].append(runs[name](counts[name][0])[0])
    print(f"{'solver':32} {'iterations':>10} {'cost':>12} {'best s':>8} {'median s':>9}")
    for name, (count, cost) in counts.items():
        best, middle = min(times[name]), statistics.median(times[name])
        print(f"{name:32} {count:10d} {cost:12.2f} {best:8.3f} {middle:9.3f}")
    mine = times["GRAPHOS-Py"]
    others = [times[name] for name in runs if name.startswith("pyceres")]
    print(f"ours / best pyceres: {min(mine) / min(map(min, others)):.2f} (best), "
          f"{statistics.median(mine) / min(map(statistics.median, others)):.2f} (median)")  # fmt: skip
    if given.memory:
        print(f"peak memory over the base: ours {peak_mb(given.problem, 'ours'):.0f} MB, "
              f"pyceres {peak_mb(given.problem, 'theirs'):.0f} MB")  # fmt: skip


if __name__ == "__main__":
    main()
