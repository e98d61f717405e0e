"""Simulated photos of a test field with known camera: for tests, and for students who have no photos of their own."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from graphos_core.adjustment.calibration.drawing import Drawing, draw_target, paint
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Array, Camera
from graphos_core.exchange.calibration_file import write_calibration
from graphos_core.geometry.rotation import look_at, matrix_from_vector
from graphos_core.run import Run, each
from graphos_core.simulation.renderer import RayGrid, SensorParams, expose, jpeg_bytes, ray_grid
from graphos_core.store import write_bytes, write_text

SETTINGS = (
    # name, tilt about x and y, roll (degrees), share of the format the board fills, where it lies in the format
    ("facing", 3.0, -2.0, 0.0, 0.80, (0.0, 0.0)),
    ("facing", -4.0, 3.0, 2.0, 0.60, (0.3, 0.3)),
    ("facing", 2.0, 5.0, -3.0, 0.65, (-0.3, -0.3)),
    ("facing", -3.0, -4.0, 90.0, 0.85, (0.0, 0.0)),
    ("tilted", 35.0, 0.0, 0.0, 0.85, (0.0, 0.0)),
    ("tilted", -35.0, 5.0, 0.0, 0.85, (0.05, -0.1)),
    ("tilted", 0.0, 38.0, 0.0, 0.85, (0.1, 0.1)),
    ("tilted", 5.0, -38.0, 0.0, 0.85, (-0.1, 0.0)),
    ("rolled", 25.0, 20.0, 90.0, 0.85, (0.0, 0.0)),
    ("rolled", -25.0, 15.0, -90.0, 0.85, (0.05, 0.0)),
    ("corner", 20.0, -25.0, 0.0, 0.58, (0.4, -0.42)),
    ("corner", -20.0, 25.0, 10.0, 0.58, (-0.4, 0.42)),
    ("corner", 22.0, 22.0, -8.0, 0.58, (-0.4, -0.42)),
    ("corner", -22.0, -22.0, 0.0, 0.58, (0.4, 0.42)),
)
"""How the board is photographed: as the manuals advise, with some photos that face the board."""
TABLE_LIGHT = 0.25
"""Linear light of the table round the sheet."""
PAPER, INK = 0.8, 0.03
TEXEL_PER_PIXEL = 0.6
SIDE = 3
"""Subpixel samples per pixel side."""


@dataclass(frozen=True)
class TargetPhotos:
    """What is true about simulated photos of a test field.

    Attributes
    ----------
    folder : Path
        Holds ``photos/*.jpg``, ``target.svg`` and ``truth``.
    camera : Camera
    names : tuple of str
    rotations, centres : float64 (n, 3, 3), (n, 3)
        ``cam_from_board`` and projection centres, m, in the frame of the board.
    board : float64 (p, 3)
        True points of the board, m: those of the drawing where it is flat.
    """

    folder: Path
    camera: Camera
    names: tuple[str, ...]
    rotations: Array
    centres: Array
    board: Array


def simulate_target_photos(
    target: TargetParams,
    out: Path,
    camera: Camera,
    *,
    photos: int = len(SETTINGS),
    names: tuple[str, ...] = (),
    warp_mm: float = 0.0,
    sensor: SensorParams | None = None,
    seed: int = 0,
    run: Run | None = None,
) -> TargetPhotos:
    """Photograph a test field with a known camera.

    Every subpixel ray of the camera's own model is met with the board; light, noise and compression are those of the
    other simulated photos.

    Parameters
    ----------
    target : TargetParams
    out : Path
    camera : Camera
        Of any model.
    photos : int
        How many of the `SETTINGS`, evenly chosen.
    names : tuple of str, optional
        Only settings of these names: ``("facing",)``.
    warp_mm : float
        How far the board bulges in its middle towards the camera.
    sensor : SensorParams, optional
    seed : int
        Of small changes of the stations and of the noise.
    run : Run, optional

    Raises
    ------
    UserError, ParamError
        When the target cannot be drawn, or the folder cannot be written.
    Stopped
    """
    run, sensor = run or Run(seed=seed), sensor or SensorParams()
    drawing = draw_target(target)
    settings = [s for s in SETTINGS if not names or s[0] in names]
    chosen = [
        settings[i]
        for i in np.unique(np.linspace(0, len(settings) - 1, min(photos, len(settings))).round().astype(int))
    ]
    rng = np.random.default_rng([seed, 11])
    stations = [_station(drawing, camera, setting, rng) for setting in chosen]
    grid = ray_grid(camera, SIDE, run)
    texel = _texel(camera, stations)
    sheet = paint(drawing, texel)
    files = tuple(f"{i + 1:02d}_{setting[0]}.jpg" for i, setting in enumerate(chosen))
    for i, name in enumerate(each(run, files, "photos")):
        light = _light(drawing, (sheet, texel), grid, *stations[i], warp_mm)
        noise = np.random.default_rng([seed, 12, i])
        photo = expose(light, grid, sensor, noise)
        write_bytes(out / "photos" / name, jpeg_bytes(photo, camera, sensor.jpeg_quality))
    rotations, centres = np.array([r for r, _ in stations]), np.array([c for _, c in stations])
    board = drawing.target.points()
    board = board + np.column_stack(
        [np.zeros((len(board), 2)), _bulge(drawing, 1000 * board[:, :2], warp_mm) / 1000]
    )
    truth = [
        {"name": n, "cam_from_board": r.tolist(), "centre_m": c.tolist()}
        for n, r, c in zip(files, rotations, centres, strict=True)
    ]
    write_text(out / "truth" / "photos.json", json.dumps(truth, indent=1) + "\n")
    write_calibration(out / "truth" / "calibration.toml", [camera])  # last: with it the truth is complete
    return TargetPhotos(out, camera, files, rotations, centres, board)


def _station(
    drawing: Drawing, camera: Camera, setting: tuple[str, float, float, float, float, tuple[float, float]],
    rng: np.random.Generator,
) -> tuple[Array, Array]:  # fmt: skip
    """Return ``cam_from_board`` and projection centre, m, of one setting with small random changes."""
    _, tilt_x, tilt_y, roll, fill, (right, down) = setting
    x0, y0, x1, y1 = (1e-3 * v for v in drawing.frame)
    middle = np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0])
    a, b = np.radians(np.array([tilt_x, tilt_y]) + rng.uniform(-4, 4, 2))
    away = np.array([np.sin(b), np.sin(a) * np.cos(b), -np.cos(a) * np.cos(b)])
    field = 0.5 * min(camera.width / (x1 - x0), camera.height / (y1 - y0)) / camera.focal_px
    if abs(roll) > 45:
        field = 0.5 * min(camera.width / (y1 - y0), camera.height / (x1 - x0)) / camera.focal_px
    distance = 0.5 / (field * (fill + rng.uniform(-0.04, 0.04)))
    centre = middle + distance * away
    rotation = look_at(centre, middle, up=np.array([0.0, -1.0, 0.0]))
    turn = matrix_from_vector(np.array([0.0, 0.0, np.radians(roll + rng.uniform(-3, 3))]))
    rotation = turn @ rotation
    # turn the camera so that the board's middle lies where it should in the format
    want = np.array([right * camera.width, down * camera.height]) / camera.focal_px * 0.5
    swing = matrix_from_vector(np.array([-want[1], want[0], 0.0]))
    return swing @ rotation, centre


def _texel(camera: Camera, stations: list[tuple[Array, Array]]) -> float:
    """Return the size of a texel, mm, fine enough for the nearest photo."""
    nearest = min(abs(float(c[2])) for _, c in stations)
    return TEXEL_PER_PIXEL * 1000.0 * nearest / camera.focal_px


def _bulge(drawing: Drawing, xy_mm: Array, warp_mm: float) -> Array:
    """Return z of the board at places (…, 2), mm: a paraboloid that is 0 at the corners of the sheet."""
    x0, y0, x1, y1 = drawing.frame
    half = 0.5 * np.array([x1 - x0, y1 - y0])
    place = (xy_mm - np.array([0.5 * (x0 + x1), 0.5 * (y0 + y1)])) / half
    result: Array = -warp_mm * (1.0 - 0.5 * (place**2).sum(axis=-1))
    return result


def _light(
    drawing: Drawing,
    painted: tuple[Array, float],
    grid: RayGrid,
    rotation: Array,
    centre: Array,
    warp_mm: float,
) -> Array:
    """Return the linear light float32 (h, w, 3) of one photo."""
    height, width = grid.fine.shape[:2]
    fine = np.empty((height, width), np.float32)
    (x0, y0, _, _), (sheet, texel) = drawing.frame, painted
    for first in range(0, height, 512):
        rays = grid.fine[first : first + 512] @ rotation  # directions in the frame of the board
        z = np.zeros(rays.shape[:2])
        for _ in range(1 if warp_mm == 0.0 else 4):
            reach = (z - centre[2]) / rays[..., 2]
            xy = 1000.0 * (centre[:2] + reach[..., None] * rays[..., :2])
            z = 1e-3 * _bulge(drawing, xy, warp_mm)
        column = ((xy[..., 0] - x0) / texel - 0.5).astype(np.float32)
        row = ((xy[..., 1] - y0) / texel - 0.5).astype(np.float32)
        column[reach <= 0] = -1e6
        ink = cv2.remap(
            sheet, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=-1.0
        )
        # linear interpolation with −1 outside makes a soft edge of the sheet
        seen = np.clip(ink, 0.0, 1.0)
        fine[first : first + 512] = np.where(ink < 0.0, TABLE_LIGHT, INK + (PAPER - INK) * seen)
    h, w = grid.camera.height, grid.camera.width
    light = fine.reshape(h, grid.side, w, grid.side).mean(axis=(1, 3))
    return np.ascontiguousarray(np.repeat(light[:, :, None], 3, axis=2))


def varied_camera(camera: Camera, seed: int) -> Camera:
    """Return another specimen of a camera: principal distance, point and radial distortion differ by the seed."""
    rng = np.random.default_rng([seed, 13])
    values = np.array(camera.values)
    values[0] *= rng.uniform(0.95, 1.08)
    values[1:3] += rng.uniform(-0.01, 0.01, 2) * camera.width
    if len(values) > 3:
        values[3] += rng.uniform(-0.04, 0.04)
    return replace(camera, values=values)


def exact_observations(truth: TargetPhotos, photo: int) -> Array:
    """Return the exact images (p, 2) of the board's points in a photo, px."""
    points = (truth.board - truth.centres[photo]) @ truth.rotations[photo].T
    return pixel_from_ray(truth.camera, points)
