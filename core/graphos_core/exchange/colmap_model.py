"""A COLMAP model in memory: from and to a `Block`, for its text and its binary form."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Parts, Read, reprojection_px
from graphos_core.exchange.camera_fit import Conversion, to_foreign
from graphos_core.exchange.colmap_lines import Model
from graphos_core.exchange.formulas import ForeignCamera, Format
from graphos_core.geometry.rotation import matrix_from_quaternion
from graphos_core.text import Text

HALF = 0.5
"""What COLMAP's pixel coordinates have more than ours."""

CENTRAL = ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "PINHOLE", "RADIAL", "OPENCV", "FULL_OPENCV")
FISHEYE = (
    "SIMPLE_FISHEYE",
    "SIMPLE_RADIAL_FISHEYE",
    "RADIAL_FISHEYE",
    "OPENCV_FISHEYE",
    "THIN_PRISM_FISHEYE",
)
"""COLMAP's models in the order in which they are tried."""


def block_from_model(model: Model) -> Read:
    """Return the block of a model; photos sorted by name, points by number."""
    parts = Parts()
    camera_ids = sorted(model.cameras)
    place = {}
    for number in camera_ids:
        name, width, height, values = model.cameras[number]
        plain = _plain_camera(name, width, height, values)
        if plain is not None:
            parts.cameras.append(plain)
            place[number] = len(parts.cameras) - 1
        else:
            place[number] = parts.add_camera(ForeignCamera(
                f"colmap {name}", np.array(values), Format(width, height), f"COLMAP {name}"
            ))  # fmt: skip
    numbers = sorted(model.points)
    row = {number: i for i, number in enumerate(numbers)}
    for i, image in enumerate(sorted(model.images, key=lambda image: image.name)):
        rotation = matrix_from_quaternion(image.quaternion)
        parts.add_photo(image.name, place[image.camera], rotation, -rotation.T @ image.translation)
        for number, (x, y) in zip(image.point_ids.tolist(), image.xy.tolist(), strict=True):
            if number in row:
                parts.observations.append((row[number], i, x - HALF, y - HALF))
    parts.points = [model.points[n][0] for n in numbers]
    parts.colours = [model.points[n][1] for n in numbers]
    return parts.read()


def _plain_camera(name: str, width: int, height: int, p: tuple[float, ...]) -> Camera | None:
    """Return the camera of a model that has exactly our formula; None for another one."""
    if name == "PINHOLE" and p[0] == p[1]:
        values = [p[0], p[2] - HALF, p[3] - HALF]
    elif name == "SIMPLE_PINHOLE":
        values = [p[0], p[1] - HALF, p[2] - HALF]
    elif name in ("SIMPLE_RADIAL", "RADIAL"):
        values = [p[0], p[1] - HALF, p[2] - HALF, p[3], p[4] if name == "RADIAL" else 0.0]
    else:
        return None
    return Camera(
        model="basic" if "RADIAL" in name else "pinhole", width=width, height=height, values=np.array(values),
        label=f"COLMAP {name}", focal_source="COLMAP model",
    )  # fmt: skip


def colmap_camera(camera: Camera) -> tuple[str, Array, Conversion[ForeignCamera] | None]:
    """Return COLMAP's model and parameters of a camera, and its conversion; None where the formula is the same.

    ``pinhole`` and ``basic`` have the formulas of SIMPLE_PINHOLE and RADIAL; for others the first of `CENTRAL` or
    `FISHEYE` that expresses the camera, else the one with the smallest residual.

    Raises
    ------
    UserError
        For a panorama.
    """
    same = {"pinhole": "SIMPLE_PINHOLE", "basic": "RADIAL"}.get(camera.model)
    if same is not None:
        rest = [0.0] * (len(camera.values) - 3)
        return same, camera.values + np.array([0.0, HALF, HALF, *rest]), None
    if camera_model(camera.model).projection == "spherical":
        raise UserError(
            Text("The camera model {model} cannot be written for COLMAP.", model=camera.model),
            "Its panoramas are read by few versions of COLMAP.", "Cut perspective photos from the panorama.",
        )  # fmt: skip
    best: Conversion[ForeignCamera] | None = None
    for name in FISHEYE if camera.model.startswith("fisheye") else CENTRAL:
        found = to_foreign(camera, f"colmap {name}")
        if best is None or found.rms_px < best.rms_px:
            best = found
        if found.exact:
            break
    assert best is not None
    return best.camera.formula.split()[1], best.camera.values, best


def distances_px(block: Block) -> Array:
    """Return the distance (m,) of each observation from its projected point, px; −1 where there is none."""
    return np.nan_to_num(np.linalg.norm(reprojection_px(block), axis=1), nan=-1.0)
