"""Control targets as a surveyor and an operator would deliver them: coordinates, and measurements in the photos."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.simulation.scene import Scene
from graphos_core.simulation.targets import MARGIN, NUMBER_HEIGHT
from graphos_core.simulation.templates import Stations
from graphos_core.simulation.visibility import incidence, project_inside, unobstructed
from graphos_core.store import write_text

CONTROL_SIGMA_PX = 0.1
"""Standard deviation of the Gaussian noise on each coordinate of the target measurements, px."""


def write_control(
    scene: Scene, camera: Camera, stations: Stations, names: tuple[str, ...], out: Path, seed: int
) -> None:
    """Write ``control.csv`` (exact coordinates, m) and ``control_measurements.csv`` (px, with noise) to a folder.

    Every third target is a check point. Measured are the exact images of the visible centres plus Gaussian noise of
    `CONTROL_SIGMA_PX`. A scene without targets writes nothing.

    Raises
    ------
    UserError
        When the files cannot be written.
    """
    if not scene.targets:
        return
    points = io.StringIO()
    table = csv.writer(points, lineterminator="\n")
    table.writerow(["name", "x [m]", "y [m]", "z [m]", "role"])
    for target in scene.targets:
        table.writerow(
            [target.name, *(f"{v:.6f}" for v in target.xyz), "check" if target.check else "control"]
        )
    write_text(out / "control.csv", points.getvalue())
    measured = io.StringIO()
    table = csv.writer(measured, lineterminator="\n")
    table.writerow(["photo", "name", "x [px]", "y [px]"])
    rng = np.random.default_rng([seed, 1_000_003])
    for i, name in enumerate(names):
        pixels, seen = visible_targets(scene, camera, stations.rotations[i], stations.centres[i])
        noisy = pixels + CONTROL_SIGMA_PX * rng.standard_normal(pixels.shape)
        for k in np.flatnonzero(seen):
            table.writerow([name, scene.targets[k].name, f"{noisy[k, 0]:.4f}", f"{noisy[k, 1]:.4f}"])
    write_text(out / "control_measurements.csv", measured.getvalue())


def visible_targets(scene: Scene, camera: Camera, rotation: Array, centre: Array) -> tuple[Array, Array]:
    """Return the exact images (k, 2) of all target centres, px, and which of them can be measured, bool (k,).

    A target can be measured when its whole plate is inside the format and nothing hides its centre or corners,
    and its surface is seen under at most 70° from the normal.
    """
    centres = np.array([target.xyz for target in scene.targets])
    normals = np.array([target.normal for target in scene.targets])
    radius = np.array([target.diameter / 2 for target in scene.targets])[:, None]
    along = np.cross([0.0, 0.0, 1.0], normals)
    up = np.cross(normals, along)
    pixels, seen = project_inside(camera, rotation, centre, centres)
    seen &= incidence(normals, centres, centre) > np.cos(np.radians(70.0))
    seen &= unobstructed(scene.caster, centres, normals, centre)
    low = MARGIN + NUMBER_HEIGHT
    for a, b in (
        (-MARGIN, MARGIN),
        (MARGIN, MARGIN),
        (-MARGIN, -low),
        (MARGIN, -low),
        (0.0, 1.0),
        (0.0, -1.0),
    ):
        corner = centres + radius * (a * along + b * up)
        seen &= project_inside(camera, rotation, centre, corner)[1]
        seen &= unobstructed(scene.caster, corner, normals, centre)
    return pixels, seen
