"""Photos to sparse model: our pipeline beside pycolmap with default options, two threads each, in one run.

usage: python benchmarks/sparse_model.py PHOTO_FOLDER [PHOTO_FOLDER …]

Each program runs in a process of its own with warm caches. Points, observations and RMS are computed by one function
from both programs' models: RMS per coordinate over all observations of the model, px of the full photo.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

THREADS = 2


def ours(photos: Path, out: Path) -> None:
    from graphos_core.exchange.colmap import write_colmap
    from graphos_core.pipeline import Pipeline
    from graphos_core.project import Project
    from graphos_core.recipe import Recipe
    from graphos_core.registry import algorithms
    from graphos_core.run import Run

    algorithms()  # imports are not timed, as those of pycolmap are not
    started = time.perf_counter()
    run = Run(threads=THREADS)
    pipeline = Pipeline(Project.create(out / "project", photos, run=run), Recipe.default())
    pipeline.run("adjustment", run)
    seconds = time.perf_counter() - started
    write_colmap(pipeline.result("adjustment").adjustment.block, out / "model")
    (out / "seconds.json").write_text(json.dumps(seconds))


def colmap(photos: Path, out: Path) -> None:
    import pycolmap

    extraction = pycolmap.FeatureExtractionOptions()
    matching = pycolmap.FeatureMatchingOptions()
    mapping = pycolmap.IncrementalPipelineOptions()
    extraction.num_threads = matching.num_threads = mapping.num_threads = THREADS
    database = out / "database.db"
    started = time.perf_counter()
    pycolmap.extract_features(
        database, photos, camera_mode=pycolmap.CameraMode.AUTO, extraction_options=extraction
    )
    pycolmap.match_exhaustive(database, matching_options=matching)
    (out / "sparse").mkdir()
    models = pycolmap.incremental_mapping(database, photos, out / "sparse", mapping)
    seconds = time.perf_counter() - started
    best = max(models.values(), key=lambda m: m.num_reg_images())
    (out / "model").mkdir()
    best.write_text(out / "model")
    (out / "seconds.json").write_text(json.dumps(seconds))


def figures(out: Path) -> dict[str, float]:
    """Read a model in COLMAP text form and count and measure it."""
    from graphos_core.cameras import pixel_from_ray
    from graphos_core.exchange.colmap import read_colmap

    block = read_colmap(out / "model")
    squares = []
    for i in np.flatnonzero(block.oriented):
        mine = block.obs_photo == i
        local = (block.points[block.obs_point[mine]] - block.centres[i]) @ block.rotations[i].T
        pixels = pixel_from_ray(block.cameras[block.camera_of_photo[i]], local)
        squares.append(((pixels - block.obs_xy[mine]) ** 2).ravel())
    return {
        "seconds": json.loads((out / "seconds.json").read_text()),
        "photos": int(block.oriented.sum()),
        "points": len(np.unique(block.obs_point)),
        "observations": len(block.obs_xy),
        "rms_px": float(np.sqrt(np.concatenate(squares).mean())),
    }


def main() -> None:
    if sys.argv[1] in ("ours", "colmap"):
        {"ours": ours, "colmap": colmap}[sys.argv[1]](Path(sys.argv[2]), Path(sys.argv[3]))
        return
    environment = dict(os.environ, OMP_NUM_THREADS=str(THREADS))
    for folder in sys.argv[1:]:
        rows = {}
        for program in ("ours", "colmap"):
            with tempfile.TemporaryDirectory() as out:
                command = [sys.executable, __file__, program, folder, out]
                subprocess.run(
                    command, check=True, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
                )
                rows[program] = figures(Path(out))
                print(
                    f"{Path(folder).parent.name:16} {program:8}",
                    {k: round(v, 3) for k, v in rows[program].items()},
                )
        print(f"{'':16} time ratio ours/pycolmap {rows['ours']['seconds'] / rows['colmap']['seconds']:.3f}")


if __name__ == "__main__":
    main()
