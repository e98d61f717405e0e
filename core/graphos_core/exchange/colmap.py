"""COLMAP's text model: ``cameras.txt``, ``images.txt``, ``points3D.txt``.

COLMAP puts the origin of pixels at the corner of the first pixel, so the centre of the top-left pixel is (0.5, 0.5);
here it is (0, 0). Principal point and image points are shifted by half a pixel on the way out and in. Rotations are
quaternions (w, x, y, z) of ``cam_from_world``, and ``t = −R C``.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Block
from graphos_core.exchange.colmap_lines import parse_model
from graphos_core.exchange.colmap_model import HALF, block_from_model, colmap_camera, distances_px
from graphos_core.geometry.rotation import quaternion_from_matrix
from graphos_core.store import write_text


def write_colmap(block: Block, folder: Path) -> None:
    """Write the oriented photos of a block, its cameras and points, in COLMAP's text format.

    ``pinhole`` becomes SIMPLE_PINHOLE, ``basic`` RADIAL, others COLMAP's simplest model that expresses them, or the
    best: see `graphos_core.exchange.colmap_model.colmap_camera`. Panoramas, which COLMAP's readers rarely take, are left
    out.

    Raises
    ------
    UserError
        When a file cannot be written.
    """
    flat = np.array(
        [camera_model(camera.model).projection != "spherical" for camera in block.cameras], dtype=bool
    )
    block = replace(block, oriented=block.oriented & flat[block.camera_of_photo])
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

    A second observation of a point in the same photo is left out. Photos are sorted by name.

    Raises
    ------
    UserError
        When a file is missing or damaged (with the line), or a camera model is not supported.
    """
    return block_from_model(parse_model(folder)).block


def _cameras(block: Block, used: list[int]) -> str:
    lines = [
        "# Camera list with one line of data per camera:",
        "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]",
    ]
    for index in used:
        model, values, _ = colmap_camera(block.cameras[index])
        camera = block.cameras[index]
        numbers = " ".join(repr(v) for v in values.tolist())
        lines.append(f"{index + 1} {model} {camera.width} {camera.height} {numbers}")
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
    error[keep] = distances_px(block)[keep]
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
