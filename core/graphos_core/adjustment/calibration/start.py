"""Where the calibration starts: a principal distance that fits all photos, and the orientation of each photo."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from graphos_core.cameras import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Camera

CANDIDATES = np.geomspace(0.35, 8.0, 22)
"""Principal distances that are tried, in longer sides of the photo."""
WIDEST = np.tan(np.radians(75.0))
"""Rays farther from the axis do not take part in the first orientation."""
GOOD_ENOUGH = 1.1
"""A principal distance that is known from elsewhere is kept when it fits this much worse than the best, or less."""


@dataclass(frozen=True)
class Pose:
    """Approximate exterior orientation of one photo, and its misfit, px (root mean square of distances)."""

    rotation: Array
    centre: Array
    misfit: float


def start_camera(camera: Camera, model: str) -> Camera:
    """Return a camera of another model with the same principal distance and point and without distortion."""
    if camera.model == model:
        return camera
    half = 0.5 * max(camera.width, camera.height)
    values = np.array([half if p.default == "constant" else 0.0 for p in camera_model(model).parameters])
    values[:3] = camera.values[:3]
    return replace(camera, model=model, values=values, sigmas=None)


def find_focal(camera: Camera, seen: list[tuple[Array, Array]]) -> Camera:
    """Return the camera with the principal distance under which all photos fit the flat board best.

    For every candidate each photo is oriented by the plane-based pose of Collins and Bartoli 2014 (Infinitesimal
    plane-based pose estimation) on ideal rays; the candidate with the smallest median misfit wins. Works for every
    model whose first parameter is the principal distance, fish-eye included. A principal distance from EXIF stays
    when it fits nearly as well, which is so when all photos face the board and the misfit hardly depends on it.

    Parameters
    ----------
    camera : Camera
        Without distortion.
    seen : list of (float64 (m, 3), float64 (m, 2))
        Board points, m, and their measured positions, px, per photo.
    """
    longer = max(camera.width, camera.height)
    candidates = list(CANDIDATES * longer)
    best = min(candidates, key=lambda f: _misfit(with_focal(camera, f), seen))
    step = float(CANDIDATES[1] / CANDIDATES[0])
    for _ in range(3):  # narrow it down
        step **= 1.0 / 3.0
        best = min((best / step, best, best * step), key=lambda f: _misfit(with_focal(camera, f), seen))
    if not camera.focal_estimated:
        kept = _misfit(camera, seen)
        if kept <= GOOD_ENOUGH * _misfit(with_focal(camera, best), seen):
            return camera
    return with_focal(camera, best)


def with_focal(camera: Camera, focal: float) -> Camera:
    """Return the camera with another principal distance."""
    values = np.array(camera.values)
    values[0] = focal
    return replace(camera, values=values)


def _misfit(camera: Camera, seen: list[tuple[Array, Array]]) -> float:
    found = [board_pose(camera, points, xy) for points, xy in seen]
    return float(np.median([np.inf if pose is None else pose.misfit for pose in found]))


def board_pose(camera: Camera, points: Array, xy: Array) -> Pose | None:
    """Orient one photo of a flat board; None where it cannot be done.

    Of the two poses that fit a flat board nearly alike the one with the smaller misfit in the photo is taken.

    Parameters
    ----------
    camera : Camera
    points : float64 (m, 3)
        Board points, m, z = 0 or nearly so.
    xy : float64 (m, 2)
        px.
    """
    directions = ray_from_pixel(camera, xy)
    with np.errstate(divide="ignore", invalid="ignore"):
        rays = directions[:, :2] / directions[:, 2:]
    usable = np.isfinite(rays).all(axis=1) & (np.hypot(*rays.T) < WIDEST) & (directions[:, 2] > 0)
    if usable.sum() < 4:
        return None
    flat = np.ascontiguousarray(points[usable]) * [1.0, 1.0, 0.0]
    try:
        count, vectors, shifts, _ = cv2.solvePnPGeneric(
            flat, np.ascontiguousarray(rays[usable]), np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
        )
    except cv2.error:
        return None
    poses = [_pose(camera, points, xy, vectors[k], shifts[k]) for k in range(count)]
    good = [pose for pose in poses if np.isfinite(pose.misfit)]
    return min(good, key=lambda pose: pose.misfit) if good else None


def _pose(camera: Camera, points: Array, xy: Array, vector: Array, shift: Array) -> Pose:
    rotation = cv2.Rodrigues(vector)[0]
    projected = pixel_from_ray(camera, points @ rotation.T + shift.ravel())
    misfit = float(np.sqrt(((projected - xy) ** 2).sum(axis=1).mean()))
    return Pose(rotation, -rotation.T @ shift.ravel(), misfit)
