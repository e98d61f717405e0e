"""Our bundle adjustment beside pyceres on BAL Ladybug-49: time to a stated cost, set-up included.

Run: ``GRAPHOS_DATA=… python benchmarks/bundle_adjustment.py [--repeats N] [--threads N]``

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
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyceres
import pycolmap

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.data import Block
from graphos_core.exchange.bal import FREE, read_bal
from graphos_core.geometry.rotation import quaternion_from_matrix
from graphos_core.run import Run

TARGET = 1.3410e4
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


def ours(block: Block, iterations: int, threads: int, *, guard: bool) -> tuple[float, list[float]]:
    """Adjust; seconds, and the cost after each iteration."""
    begin = time.perf_counter()
    options = Options(max_iterations=iterations, statistics=False, guard=guard)
    adjusted = adjust_block(
        block, Freedom(interior=(FREE,) * len(block.cameras)), options, run=Run(threads=threads)
    )
    return time.perf_counter() - begin, [record.cost for record in adjusted.iterations]


def reconstruction_of(block: Block) -> pycolmap.Reconstruction:
    """The same block as a reconstruction, camera model RADIAL (f, cx, cy, k1, k2)."""
    made = pycolmap.Reconstruction()
    place = np.zeros(len(block.obs_photo), dtype=int)
    for i, name in enumerate(block.names):
        f, _, _, k1, k2 = block.cameras[i].values
        made.add_camera_with_trivial_rig(
            pycolmap.Camera(camera_id=i + 1, model="RADIAL", width=1, height=1, params=[f, 0, 0, k1, k2])
        )
        mine = np.flatnonzero(block.obs_photo == i)
        place[mine] = np.arange(len(mine))
        w, x, y, z = quaternion_from_matrix(block.rotations[i])
        pose = pycolmap.Rigid3d(
            pycolmap.Rotation3d(np.array([x, y, z, w])), -block.rotations[i] @ block.centres[i]
        )
        image = pycolmap.Image(name=name, camera_id=i + 1, image_id=i + 1, keypoints=block.obs_xy[mine])
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


def needed(run: Callable[[int], tuple[float, list[float]]]) -> tuple[int, float]:
    """How many iterations reach the target, and the cost there."""
    costs = run(40)[1]
    count = next(k for k, cost in enumerate(costs) if cost <= TARGET)
    return count, costs[count]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--threads", type=int, default=2)
    given = parser.parse_args()
    block = read_bal(Path(os.environ["GRAPHOS_DATA"]) / "bal" / "problem-49-7776-pre.txt")
    runs: dict[str, Callable[[int], tuple[float, list[float]]]] = {
        "GRAPHOS-Py": lambda k: ours(block, k, given.threads, guard=True),
        "GRAPHOS-Py, all observations": lambda k: ours(block, k, given.threads, guard=False),
    }
    for solver in SOLVERS:
        runs[f"pyceres {solver}"] = lambda k, solver=solver: theirs(block, solver, k, given.threads)  # type: ignore[misc]
    counts = {name: needed(run) for name, run in runs.items()}
    times: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(given.repeats):
        for name, run in runs.items():
            times[name].append(run(counts[name][0])[0])
    print(f"{'solver':32} {'iterations':>10} {'cost':>10} {'best s':>8} {'median s':>9}")
    for name, (count, cost) in counts.items():
        best, middle = min(times[name]), statistics.median(times[name])
        print(f"{name:32} {count:10d} {cost:10.1f} {best:8.3f} {middle:9.3f}")
    mine = times["GRAPHOS-Py"]
    others = [times[name] for name in runs if name.startswith("pyceres")]
    print(f"ours / best pyceres: {min(mine) / min(map(min, others)):.2f} (best), "
          f"{statistics.median(mine) / min(map(statistics.median, others)):.2f} (median)")  # fmt: skip


if __name__ == "__main__":
    main()
