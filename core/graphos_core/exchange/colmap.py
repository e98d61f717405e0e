"""COLMAP's text model: ``cameras.txt``, ``images.txt``, ``points3D.txt``.

COLMAP puts the origin of pixels at the corner of the first pixel, so the centre of the top-left pixel is (0.5, 0.5);
here it is (0, 0). Principal point and image points are shifted by half a pixel on the way out and in. Rotations are
quaternions (w, x, y, z) of ``cam_from_world``, and ``t = −R C``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.colmap_lines import parse_model
from graphos_core.geometry.rotation import matrix_from_quaternion, quaternion_from_matrix
from graphos_core.store import write_text
from graphos_core.text import Text

HALF = 0.5
"""What COLMAP's pixel coordinates have more than ours."""

SAME_FOCAL_PX = 0.01
"""Largest effect over half the format, px, of two principal distances that are read as one."""


def write_colmap(block: Block, folder: Path) -> None:
    """Write the oriented photos of a block, its cameras and points, in COLMAP's text format.

    ``pinhole`` becomes SIMPLE_PINHOLE, ``basic`` RADIAL: the same formulas, so nothing is approximated.

    Raises
    ------
    UserError
        When a file cannot be written, or COLMAP has no such camera model.
    """
    oriented = np.flatnonzero(block.oriented)
    used = sorted({int(block.camera_of_photo[photo]) for photo in oriented})
    point, photo = block.obs_point, block.obs_photo
    position = np.zeros(len(photo), dtype=np.int64)  # place of each observation in the list of its photo
    for index in oriented:
        mine = np.flatnonzero(photo == index)
        position[mine] = np.arange(len(mine))
    write_text(folder / "cameras.txt", _cameras(block, used))
    write_text(folder / "images.txt", _images(block, oriented))
    write_text(folder / "points3D.txt", _points(block, point, photo, position))


def read_colmap(folder: Path) -> Block:
    """Read a COLMAP text model.

    Models SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL and RADIAL. A second observation of a point in the same photo is
    left out. Photos are sorted by name.

    Raises
    ------
    UserError
        When a file is missing or damaged (with the line), or a camera model is not supported.
    """
    model = parse_model(folder)
    camera_ids = sorted(model.cameras)
    cameras = tuple(_camera(*model.cameras[i]) for i in camera_ids)
    images = sorted(model.images, key=lambda image: image.name)
    photo_of = {image.number: i for i, image in enumerate(images)}
    points = sorted(model.points)
    observations: list[tuple[int, int, float, float]] = []
    row_of = {number: row for row, number in enumerate(points)}
    for image in images:
        kept = np.isin(image.point_ids, points) if len(points) else np.zeros(len(image.point_ids), dtype=bool)
        for number, (x, y) in zip(image.point_ids[kept].tolist(), image.xy[kept].tolist(), strict=True):
            observations.append((row_of[number], photo_of[image.number], x - HALF, y - HALF))
    table = np.array(observations, dtype=np.float64).reshape(-1, 4)
    _, first = np.unique(table[:, 0] * len(images) + table[:, 1], return_index=True)
    table = table[first]
    rotations = np.array([matrix_from_quaternion(image.quaternion) for image in images]).reshape(-1, 3, 3)
    centres = [-r.T @ image.translation for r, image in zip(rotations, images, strict=True)]
    return Block(
        cameras=cameras,
        names=tuple(image.name for image in images),
        camera_of_photo=np.array([camera_ids.index(image.camera) for image in images], dtype=np.int32),
        oriented=np.ones(len(images), dtype=bool),
        rotations=rotations,
        centres=np.array(centres).reshape(-1, 3),
        points=np.array([model.points[n][0] for n in points]).reshape(-1, 3),
        colours=np.array([model.points[n][1] for n in points], dtype=np.uint8).reshape(-1, 3),
        point_track=np.full(len(points), -1, dtype=np.int32),
        obs_photo=table[:, 1].astype(np.int32),
        obs_point=table[:, 0].astype(np.int32),
        obs_xy=table[:, 2:].copy(),
    )


def _cameras(block: Block, used: list[int]) -> str:
    lines = [
        "# Camera list with one line of data per camera:",
        "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]",
    ]
    for index in used:
        camera = block.cameras[index]
        names = {"pinhole": "SIMPLE_PINHOLE", "basic": "RADIAL"}
        if camera.model not in names:
            raise UserError(
                Text("The camera model {model} cannot be written for COLMAP.", model=camera.model),
                "COLMAP has no model with the same formula.",
                "Adjust with the basic camera model before exporting.",
            )
        values = camera.values + np.array([0.0, HALF, HALF, *[0.0] * (len(camera.values) - 3)])
        numbers = " ".join(repr(v) for v in values.tolist())
        lines.append(f"{index + 1} {names[camera.model]} {camera.width} {camera.height} {numbers}")
    return "\n".join(lines) + "\n"


def _images(block: Block, oriented: Array) -> str:
    lines = [
        "# Image list with two lines of data per image:",
        "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME",
        "#   POINTS2D[] as (X, Y, POINT3D_ID)",
        f"# Unit of the object frame: {block.unit}",
    ]
    for index in oriented.tolist():
        rotation = block.rotations[index]
        pose = [*quaternion_from_matrix(rotation).tolist(), *(-rotation @ block.centres[index]).tolist()]
        numbers = " ".join(repr(v) for v in pose)
        lines.append(f"{index + 1} {numbers} {block.camera_of_photo[index] + 1} {block.names[index]}")
        mine = np.flatnonzero(block.obs_photo == index)
        xy, ids = (block.obs_xy[mine] + HALF).tolist(), (block.obs_point[mine] + 1).tolist()
        lines.append(" ".join(f"{x!r} {y!r} {n}" for (x, y), n in zip(xy, ids, strict=True)))
    return "\n".join(lines) + "\n"


def _points(block: Block, point: Array, photo: Array, position: Array) -> str:
    lines = [
        "# 3D point list with one line of data per point:",
        "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)",
        "# ERROR is the mean distance (2-D) of the observations from the projected point, px",
    ]
    keep = np.asarray(block.oriented)[photo]
    error = np.full(len(photo), np.nan)
    error[keep] = _distances(block)[keep]
    count = np.bincount(point[keep], minlength=len(block.points))
    mean = np.bincount(point[keep], error[keep], minlength=len(block.points)) / np.maximum(count, 1)
    order = np.flatnonzero(keep)[np.argsort(point[keep], kind="stable")]
    bounds = np.searchsorted(point[order], np.arange(len(block.points) + 1)).tolist()
    entries = [f"{i} {k}" for i, k in zip((photo[order] + 1).tolist(), position[order].tolist(), strict=True)]
    coordinates, colours = block.points.tolist(), block.colours.tolist()
    for row, ((x, y, z), (r, g, b)) in enumerate(zip(coordinates, colours, strict=True)):
        track = " ".join(entries[bounds[row] : bounds[row + 1]])
        if track:
            lines.append(f"{row + 1} {x!r} {y!r} {z!r} {r} {g} {b} {float(mean[row])!r} {track}")
    return "\n".join(lines) + "\n"


def _distances(block: Block) -> Array:
    """Distance (m,) of each observation from its projected point, px."""
    out = np.full(len(block.obs_photo), np.nan)
    for index in np.flatnonzero(block.oriented):
        mine = np.flatnonzero(block.obs_photo == index)
        camera = (block.points[block.obs_point[mine]] - block.centres[index]) @ block.rotations[index].T
        pixels = pixel_from_ray(block.cameras[block.camera_of_photo[index]], camera)
        out[mine] = np.linalg.norm(pixels - block.obs_xy[mine], axis=1)
    return np.nan_to_num(out, nan=-1.0)


def _camera(model: str, width: int, height: int, p: tuple[float, ...]) -> Camera:
    if model == "PINHOLE":
        if abs(p[0] - p[1]) / p[0] * max(width, height) / 2 > SAME_FOCAL_PX:
            raise UserError(
                "A camera of the COLMAP model cannot be represented.",
                Text(
                    "It has two principal distances, {x:.3f} and {y:.3f} px; the models here have one.",
                    x=p[0],
                    y=p[1],
                ),
                "Export with a model that has one focal length, such as RADIAL.",
            )
        p = ((p[0] + p[1]) / 2, p[2], p[3])
    values = [p[0], p[1] - HALF, p[2] - HALF]
    if "RADIAL" in model:
        values += [p[3], p[4] if model == "RADIAL" else 0.0]
    return Camera(
        model="basic" if "RADIAL" in model else "pinhole",
        width=width,
        height=height,
        values=np.array(values),
        label=f"COLMAP {model}",
        focal_source="COLMAP model",
    )
