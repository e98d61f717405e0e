"""Photos of a template with everything that is true about them, written to a folder."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.cameras.lens import with_lens
from graphos_core.data.cameras import Camera
from graphos_core.data.record import record
from graphos_core.errors import UserError
from graphos_core.exchange.ply import write_ply_mesh
from graphos_core.geometry.rotation import opk_from_matrix
from graphos_core.params import Params
from graphos_core.run import Run, each
from graphos_core.simulation.control_targets import CONTROL_SIGMA_PX, write_control
from graphos_core.simulation.renderer import (
    RayGrid,
    SensorParams,
    expose,
    jpeg_bytes,
    ray_grid,
    render,
)
from graphos_core.simulation.scene import Scene, build_scene
from graphos_core.simulation.templates import Stations, place, template
from graphos_core.simulation.truth import Truth, load_truth
from graphos_core.store import cannot_write, write_bytes, write_text
from graphos_core.text import Text

__all__ = ["SimulatedBlock", "Truth", "demo_camera", "load_truth", "simulate_photos"]

TEXEL_PER_GSD = 0.7
"""Size of a texel in ground sampling distances: fine enough to stay sharp, coarse enough not to alias."""


@record
class SimulatedBlock:
    """A photo block that was written to a folder.

    Attributes
    ----------
    folder : str
    names : tuple of str
        File names of the photos in ``photos``.
    camera : Camera
        True camera.
    stations : Stations
        True exterior orientations, m.
    object_distance_m : float
        Mean over the photos of the median true depth.
    gsd_m : float
        Ground sampling distance: object distance / principal distance.
    """

    folder: str
    names: tuple[str, ...]
    camera: Camera
    stations: Stations
    object_distance_m: float
    gsd_m: float


def demo_camera(width: int = 1600, height: int = 1200) -> Camera:
    """Return the camera of the demo: basic model, principal distance 1.15 widths, principal point off centre."""
    focal = 1.15 * width
    values = np.array(
        [focal, 0.5 * (width - 1) + 0.0052 * width, 0.5 * (height - 1) - 0.0034 * width, -0.08, 0.03]
    )
    return Camera(
        model="basic",
        width=width,
        height=height,
        values=values,
        label="Simulated camera",
        pixel_pitch_mm=23.5 / width,
        focal_source="true value of the simulation",
    )


def lens_camera(lens: str, width: int = 1200, height: int = 1200) -> Camera:
    """Return a simulated camera of a lens: `demo_camera`, or a fish-eye of 180° in the shorter side, or a panorama.

    The fish-eye has its principal point off centre and radial coefficients that move the edge by some pixels.
    """
    if lens == "perspective":
        return demo_camera(width, height)
    side = min(width, height)
    centre = 0.5 * (width - 1), 0.5 * (height - 1)
    start = Camera(model="basic", width=width, height=height, values=np.array([1.0, *centre, 0.0, 0.0]),
                   label="Simulated camera", pixel_pitch_mm=0.006, focal_estimated=True)  # fmt: skip
    start = with_lens(start, lens)
    values = np.array(start.values)
    if lens != "spherical":
        names = camera_model(start.model).names
        values[:3] = 0.97 * values[0], centre[0] + 0.003 * side, centre[1] - 0.002 * side
        values[names.index("k1")], values[names.index("k2")] = 0.012, -0.006
    source = "true value of the simulation"
    return replace(start, values=values, focal_estimated=False, focal_source=source)


def simulate_photos(
    template_name: str,
    out: Path,
    *,
    params: Params | None = None,
    camera: Camera | None = None,
    scene: str | Scene | None = None,
    sensor: SensorParams | None = None,
    width: int = 1600,
    height: int = 1200,
    seed: int = 0,
    photos: int | None = None,
    run: Run | None = None,
) -> SimulatedBlock:
    """Photograph a template and write photos and truth to a folder; same seed, same bytes on the same machine.

    Parameters
    ----------
    template_name : str
        One of `graphos_core.simulation.templates.TEMPLATES`.
    out : Path
        Gets ``photos/*.jpg``, ``truth/cameras.json``, ``truth/mesh.ply``, ``truth/depth/*.npz`` (true depth per
        pixel), ``control.csv`` and ``control_measurements.csv`` (targets, where the scene has them).
    params : Params, optional
        Parameter sheet of the template.
    camera : Camera, optional
        Any model; by default `demo_camera` of `width` × `height` pixels.
    scene : str or Scene, optional
        By default the template's own.
    sensor : SensorParams, optional
        Noise, vignetting, compression.
    seed : int
        Of the scene, the sensor noise and the measuring noise.
    photos : int, optional
        Only the first so many stations (for the façade: so many stations on the arc).
    run : Run, optional

    Raises
    ------
    UserError
        When template or scene do not exist, the camera's distortion folds over, or the folder cannot be written or
        holds other photos.
    Stopped
    """
    run, sensor = run or Run(seed=seed), sensor or SensorParams()
    camera = camera or demo_camera(width, height)
    found = template(template_name)
    sheet = params if params is not None else found.params()
    if photos is not None and "stations" in sheet.declarations():
        sheet, photos = sheet.replace(stations=photos), None
    stations = place(template_name, sheet).first(photos or 10**6)
    names = tuple(f"{name}.jpg" for name in stations.names)
    _prepare(out, names)
    grid = ray_grid(camera, sensor.supersampling, run)
    if not isinstance(scene, Scene):
        scene = build_scene(
            scene or found.scene, seed=seed, texel_m=_texel(stations, camera, scene or found.scene), run=run
        )
    stations = stations.moved(scene.focus)
    distances = []
    for i in each(run, range(len(names)), "photos"):
        rng = np.random.default_rng([seed, i])
        distances.append(_take(scene, grid, stations, i, sensor, rng, out, names[i], run))
    distance = float(np.mean(distances))
    write_control(scene, camera, stations, names, out, seed)
    write_ply_mesh(out / "truth" / "mesh.ply", scene.mesh)
    gsd = distance / camera.focal_px
    # the truth's index comes last: where it exists, the block is complete
    index = _index(template_name, sheet, scene, camera, stations, names, sensor, seed)
    index["object_distance_m"], index["gsd_m"] = distance, gsd
    write_text(out / "truth" / "cameras.json", json.dumps(index, indent=1, ensure_ascii=False) + "\n")
    return SimulatedBlock(
        folder=str(out), names=names, camera=camera, stations=stations, object_distance_m=distance, gsd_m=gsd
    )


def _prepare(out: Path, names: tuple[str, ...]) -> None:
    """Refuse a folder with photos of something else; an index of an earlier block is no longer true."""
    strangers = sorted({p.name for p in (out / "photos").glob("*")} - set(names))
    if strangers:
        raise UserError(
            Text(
                "{folder} holds other photos already, such as {name}.",
                folder=out / "photos",
                name=strangers[0],
            ),
            "They would be taken for photos of this block.",
            "Choose an empty folder.",
        )
    try:
        (out / "truth" / "cameras.json").unlink(missing_ok=True)
    except OSError as problem:
        raise cannot_write(out, problem) from problem


def _texel(stations: Stations, camera: Camera, scene: str) -> float:
    reach = {"statue": 1.0, "terrain": 1.0, "facade": 0.5, "courtyard": 0.0}.get(
        scene, 0.0
    )  # from the focus to what faces the camera
    distance = float(np.median(np.linalg.norm(stations.centres, axis=1)))
    return max(TEXEL_PER_GSD * max(distance - reach, 0.2 * distance) / camera.focal_px, 0.0005)


def _take(
    scene: Scene,
    grid: RayGrid,
    stations: Stations,
    i: int,
    sensor: SensorParams,
    rng: np.random.Generator,
    out: Path,
    name: str,
    run: Run,
) -> float:
    """Take one photo and write it with its depth; the median depth, m (NaN when it sees only sky)."""
    rotation, centre = stations.rotations[i], stations.centres[i]
    light, depth = render(scene, grid, rotation, centre, run)
    photo = expose(light, grid, sensor, rng)
    buffer = io.BytesIO()
    np.savez(buffer, depth=depth)
    write_bytes(out / "truth" / "depth" / f"{Path(name).stem}.npz", buffer.getvalue())
    write_bytes(out / "photos" / name, jpeg_bytes(photo, grid.camera, sensor.jpeg_quality))
    run.show("photo", photo)
    return float(np.nanmedian(depth)) if np.isfinite(depth).any() else float("nan")


def _index(
    template_name: str,
    params: Params,
    scene: Scene,
    camera: Camera,
    stations: Stations,
    names: tuple[str, ...],
    sensor: SensorParams,
    seed: int,
) -> dict[str, object]:
    model = camera_model(camera.model)
    return {
        "schema": 1,
        "template": template_name,
        "params": params.to_dict(),
        "scene": scene.name,
        "seed": seed,
        "unit": "m",
        "noise": {
            "sensor_sigma_grey_levels": "sqrt(read_noise² + shot_noise² · g / 255), before JPEG",
            **sensor.to_dict(),
            "control_measurement_sigma_px": CONTROL_SIGMA_PX,
        },
        "cameras": [
            {
                "model": camera.model,
                "width": camera.width,
                "height": camera.height,
                "label": camera.label,
                "pixel_pitch_mm": camera.pixel_pitch_mm,
                "parameters": dict(zip(model.names, map(float, camera.values), strict=True)),
            }
        ],
        "photos": [
            {
                "name": name,
                "camera": 0,
                "cam_from_world": rotation.tolist(),
                "centre_m": centre.tolist(),
                "omega_phi_kappa_deg": np.degrees(opk_from_matrix(rotation)).tolist(),
            }
            for name, rotation, centre in zip(names, stations.rotations, stations.centres, strict=True)
        ],
    }
