"""The photo that simulators show when no project is open: of the simulated façade, made by the engine's renderer.

The photo is kept with the resources because baking the façade takes many seconds. Run this module to make it anew::

    python -m graphos_didactic.simulators.simulated_photo
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from pathlib import Path

import numpy as np

from graphos_core.data import Camera
from graphos_core.data.record import Array

FOLDER, FILE = "simulated_photo", "facade.jpg"
WIDTH, HEIGHT = 720, 540


@cache
def simulated_photo() -> Array:
    """Return the photo of the simulated façade, uint8 (540, 720, 3) RGB, read-only."""
    import cv2

    data = (resources.files("graphos_resources") / FOLDER / FILE).read_bytes()
    photo = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_COLOR)
    if photo is None:
        raise OSError(f"{FILE} is damaged")
    photo = np.ascontiguousarray(photo[..., ::-1])
    photo.flags.writeable = False
    return photo


def make_simulated_photo() -> Array:
    """Render the façade (seed 0) with the engine: 2 rays per pixel side, sensor noise as `SensorParams` says."""
    from graphos_core.geometry.rotation import look_at
    from graphos_core.simulation.renderer import SensorParams, expose, ray_grid, render
    from graphos_core.simulation.scene import build_scene

    values = np.array([820.0, (WIDTH - 1) / 2, (HEIGHT - 1) / 2])
    camera = Camera(model="pinhole", width=WIDTH, height=HEIGHT, values=values)
    centre = np.array([1.2, -10.5, 3.1])
    rotation = look_at(centre, np.array([0.3, 0.0, 3.35]))
    grid = ray_grid(camera)
    light, _ = render(build_scene("facade", texel_m=0.008), grid, rotation, centre)
    return expose(light, grid, SensorParams(), np.random.default_rng(0))


if __name__ == "__main__":
    import cv2

    folder = Path(str(resources.files("graphos_resources"))) / FOLDER
    folder.mkdir(exist_ok=True)
    made = np.ascontiguousarray(make_simulated_photo()[..., ::-1])
    cv2.imwrite(str(folder / FILE), made, [cv2.IMWRITE_JPEG_QUALITY, 90])
