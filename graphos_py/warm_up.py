"""Compiles the numba kernels once per machine: ``python -m graphos_py.warm_up``, started behind the window.

A process of its own, at low priority, so that compiling never slows the window. It computes a tiny simulated block
through all five steps, then every camera model and every simulator, which compiles every kernel into numba's cache on
disk; the window's own process then only loads them. A stamp beside the cache says that it was done for these sources and this version of numba.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sys
import tempfile
from importlib import resources
from importlib.metadata import version
from pathlib import Path

SIZE = (320, 240)
PHOTOS = 4


def kernel_files() -> list[Path]:
    """Return the engine's source files with compiled functions."""
    folder = Path(str(resources.files("graphos_core")))
    found = []
    for file in sorted(folder.rglob("*.py")):
        source = file.read_text("utf-8")
        if "@njit" in source or "@cfunc" in source:
            found.append(file)
    return found


def stamp_file() -> Path:
    """Return where the stamp lies: beside numba's cache, so that both are removed together."""
    return Path(str(resources.files("graphos_core"))) / "cameras" / "__pycache__" / "kernels.warm"


def stamp() -> str:
    """Return what the cache depends on: numba, Python, and the sources of the kernels."""
    digest = hashlib.sha256(f"{version('numba')} {sys.version}".encode())
    for file in kernel_files():
        digest.update(file.read_bytes())
    return digest.hexdigest()


def is_warm() -> bool:
    """Say whether the kernels were compiled on this machine since they last changed."""
    try:
        return stamp_file().read_text("utf-8") == stamp()
    except OSError:
        return False


def compile_kernels() -> None:
    """Simulate and compute a tiny block; what fails there has still compiled what came before."""
    from graphos_core.errors import GraphosError
    from graphos_core.pipeline import Pipeline
    from graphos_core.project import Project
    from graphos_core.recipe import Recipe
    from graphos_core.registry import STAGES
    from graphos_core.run import Run
    from graphos_core.simulation.photo_block import simulate_photos

    run = Run(threads=2)
    with tempfile.TemporaryDirectory(prefix="graphos-warm-up-") as place:
        out = Path(place)
        with contextlib.suppress(GraphosError):
            simulate_photos("facade", out / "sim", width=SIZE[0], height=SIZE[1], photos=PHOTOS, run=run)
            project = Project.create(out / "model", out / "sim" / "photos", run=run)
            recipe = Recipe.default().choose("preprocessing", "filter", ("wallis",))
            for stage in STAGES:
                Pipeline(project, recipe).run(stage, run, with_earlier=False)


def compile_lessons() -> None:
    """Project and look back through every camera model, and draw every simulator once."""
    import numpy as np

    from graphos_core.cameras import pixel_from_ray, ray_from_pixel
    from graphos_core.cameras.model import camera_models, derivatives
    from graphos_core.data import Camera
    from graphos_didactic.simulator import simulators

    for simulator in simulators():
        simulator.scene(simulator.params())
    for model in camera_models().values():
        values = np.zeros(len(model.parameters))
        values[:3] = 200.0, (SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2
        values[[k for k, x in enumerate(model.parameters) if x.default == "constant"]] = 100.0
        camera = Camera(model=model.name, width=SIZE[0], height=SIZE[1], values=values)
        rays = ray_from_pixel(camera, pixel_from_ray(camera, np.array([[0.1, 0.2, 1.0]])))
        derivatives(camera, rays)


def main() -> int:
    """Warm up unless that was done; returns the exit code."""
    if is_warm():
        return 0
    with contextlib.suppress(OSError, AttributeError):
        os.nice(15)
    compile_kernels()
    compile_lessons()
    with contextlib.suppress(OSError):
        stamp_file().parent.mkdir(exist_ok=True)
        stamp_file().write_text(stamp(), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
