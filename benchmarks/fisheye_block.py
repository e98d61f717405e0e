"""Fish-eye photos alone → oriented, self-calibrated block, against the truth of the simulation.

usage: python benchmarks/fisheye_block.py [LENS] [PHOTOS]

Renders photos of 1200 × 1200 px with a 180° lens inside a courtyard (`graphos simulate inside --lens …`), runs the
pipeline on the photos with the nominal principal distance of the EXIF header (whole millimetres of the 35 mm
equivalent, 5 % off) and a zero polynomial, and prints what came out beside what is true.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_core.simulation.comparison import camera_centre_errors
from graphos_core.simulation.photo_block import lens_camera, simulate_photos
from graphos_core.simulation.truth import load_truth


def main() -> None:
    lens = sys.argv[1] if len(sys.argv) > 1 else "fisheye-equisolid"
    photos = int(sys.argv[2]) if len(sys.argv) > 2 else 10
    run = Run(threads=2)
    with tempfile.TemporaryDirectory() as folder:
        block = Path(folder) / "block"
        simulate_photos("inside", block, camera=lens_camera(lens), photos=photos, run=run)
        truth = load_truth(block)
        project = Project.create(Path(folder) / "project", block / "photos", run=run, lens=lens)
        start = project.photo_set.cameras[0]
        pipeline = Pipeline(project, Recipe.default())
        begun = time.perf_counter()
        pipeline.run("adjustment", run)
        seconds = time.perf_counter() - begun
        adjustment = pipeline.result("adjustment").adjustment
    found, true = adjustment.block.cameras[0], truth.cameras[0]
    print(f"photos oriented            {int(adjustment.block.oriented.sum())} of {len(truth.names)}")
    print(f"observations, sigma0       {len(adjustment.block.obs_xy)}, {adjustment.sigma0_px:.3f} px")
    print("parameter        start      found      sigma       true")
    for name, *row in zip(
        camera_model(found.model).names, start.values, found.values, found.sigmas, true.values, strict=True
    ):
        if row[2]:
            print(f"{name:12} " + " ".join(f"{value:10.5g}" for value in row))
    errors = camera_centre_errors(adjustment.block, truth)
    print(f"projection centres, RMS    {1000 * errors.rms_m:.2f} mm at {errors.object_distance_m:.2f} m")
    print(f"rotations, largest error   {np.degrees(errors.rotation_errors.max()):.3f}°")
    print(f"features to adjustment     {seconds:.0f} s")


if __name__ == "__main__":
    main()
