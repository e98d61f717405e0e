"""Two calibrations of a camera: parameter by parameter, and as what they do over the format."""

from __future__ import annotations

import math

import numpy as np

from graphos_core.cameras import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.cameras.model import Parameter
from graphos_core.data import Array, Block, Camera
from graphos_core.run_comparison.records import CalibrationDifference, CameraParameterDifference
from graphos_core.text import Text

LIMIT = 1.959964
"""Difference in units of its standard deviation from which it is called significant: 5 % error probability."""

GRID = 24
"""Points along the longer side of the format at which two calibrations are compared."""


def camera_differences(
    a: Block, b: Block, photos: list[tuple[int, int]]
) -> tuple[tuple[CameraParameterDifference, ...], tuple[CalibrationDifference, ...]]:
    """Return the parameters of every pair of cameras that took a common photo, and how far their images are apart."""
    pairs = dict.fromkeys((int(a.camera_of_photo[i]), int(b.camera_of_photo[j])) for i, j in photos)
    rows, calibrations = [], []
    for one, two in pairs:
        label = a.cameras[one].label or Text("Camera {n}", n=one + 1)
        rows += _camera(label, a.cameras[one], b.cameras[two])
        apart = calibration_difference(a.cameras[one], b.cameras[two])
        calibrations.append(
            CalibrationDifference(label, float(np.sqrt(np.mean(apart**2))), float(apart.max()))
            if len(apart) else CalibrationDifference(label, math.nan, math.nan)
        )  # fmt: skip
    return tuple(rows), tuple(calibrations)


def _camera(label: str, a: Camera, b: Camera) -> list[CameraParameterDifference]:
    declared = {_meaning(camera, p): p for camera in (a, b) for p in camera_model(camera.model).parameters}
    rows = []
    for meaning, parameter in declared.items():
        one, sigma_one = _value(a, meaning)
        two, sigma_two = _value(b, meaning)
        difference = None if one is None or two is None else two - one
        sigma = math.hypot(sigma_one or 0.0, sigma_two or 0.0) or None
        significant = None if difference is None or sigma is None else abs(difference) > LIMIT * sigma
        rows.append(
            CameraParameterDifference(
                label, parameter.name, parameter.symbol, parameter.label, parameter.unit, one, sigma_one, two, sigma_two,
                difference, sigma, significant,
            )
        )  # fmt: skip
    return rows


def _meaning(camera: Camera, parameter: Parameter) -> str:
    """Return what a parameter means in every model that has it; its own name with that of the model in no other."""
    return parameter.meaning or f"{camera.model}.{parameter.name}"


def _value(camera: Camera, meaning: str) -> tuple[float | None, float | None]:
    for index, parameter in enumerate(camera_model(camera.model).parameters):
        if _meaning(camera, parameter) == meaning:
            sigma = 0.0 if camera.sigmas is None else float(camera.sigmas[index])
            return float(camera.values[index]), sigma if sigma > 0 else None
    return None, None


def calibration_difference(a: Camera, b: Camera) -> Array:
    """Return how far apart two calibrations image the same rays, px, over a grid of the format.

    The directions of the pixels under A are turned by the rotation that fits those under B best (Kabsch 1976), since
    such a rotation goes into the exterior orientation, and projected by B.
    """
    side = max(a.width, a.height) / GRID
    x = np.linspace(0.0, a.width - 1.0, max(2, round(a.width / side)))
    y = np.linspace(0.0, a.height - 1.0, max(2, round(a.height / side)))
    pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    one, two = ray_from_pixel(a, pixels), ray_from_pixel(b, pixels)
    good = np.isfinite(one).all(axis=1) & np.isfinite(two).all(axis=1)
    pixels, one, two = pixels[good], one[good], two[good]
    if len(pixels) < 3:
        return np.empty(0)
    one, two = (rays / np.linalg.norm(rays, axis=1, keepdims=True) for rays in (one, two))
    u, _, vt = np.linalg.svd(two.T @ one)
    turn = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
    apart = np.linalg.norm(pixel_from_ray(b, one @ turn.T) - pixels, axis=1)
    return np.asarray(apart[np.isfinite(apart)])
