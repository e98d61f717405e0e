"""Why the centre of an ellipse is not the image of the circle's centre, and by how much."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.calibration.observed import TargetObservations
from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Array, Camera

CORNERS = 48
"""Corners of the polygon that stands for a circle."""


def diameter_from_areas(
    cameras: list[Camera], poses: list[tuple[Array, Array]], board: Array, seen: list[TargetObservations]
) -> float:
    """Return the diameter of the circles, m: the median of what their areas in the photos say."""
    found = []
    for camera, pose, observed in zip(cameras, poses, seen, strict=True):
        unit = 1e-2 * float(np.ptp(board[:, :2]))
        _, area = _images(camera, pose, board[observed.point], unit)
        found.append(unit * np.sqrt(observed.area / area))
    return float(np.nanmedian(np.concatenate(found)))


def eccentricity(camera: Camera, pose: tuple[Array, Array], points: Array, diameter: float) -> Array:
    """Return centre of the image of a circle less the image of its centre, px (m, 2).

    Under perspective a circle's image is an ellipse whose centre lies farther from the camera's near side than the
    image of the circle's centre (Luhmann et al. 2020, Close-range photogrammetry, section 3.2.5.5; Heikkilä 2000). The
    circle is projected as a polygon through the full camera model, so distortion is included; the centre is the
    centroid of its area.

    Parameters
    ----------
    camera : Camera
    pose : (float64 (3, 3), float64 (3,))
        ``cam_from_world`` and projection centre, m.
    points : float64 (m, 3)
        Centres of circles that lie in planes z = const, m.
    diameter : float
        m.
    """
    centroid, _ = _images(camera, pose, points, diameter)
    rotation, centre = pose
    result: Array = centroid - pixel_from_ray(camera, (points - centre) @ rotation.T)
    return result


def _images(camera: Camera, pose: tuple[Array, Array], points: Array, diameter: float) -> tuple[Array, Array]:
    """Return centroids (m, 2) and areas (m,) of the images of circles, px and px²."""
    angle = 2.0 * np.pi * np.arange(CORNERS) / CORNERS
    # a polygon with the circle's own area
    radius = 0.5 * diameter * np.sqrt(2 * np.pi / CORNERS / np.sin(2 * np.pi / CORNERS))
    rim = radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(CORNERS)])
    rotation, centre = pose
    corners = (points[:, None, :] + rim - centre).reshape(-1, 3) @ rotation.T
    polygon = pixel_from_ray(camera, corners).reshape(len(points), CORNERS, 2)
    middle = polygon.mean(axis=1, keepdims=True)
    x, y = np.moveaxis(polygon - middle, -1, 0)
    cross = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
    area = 0.5 * cross.sum(axis=1)
    centroid = np.column_stack([
        ((x + np.roll(x, -1, axis=1)) * cross).sum(axis=1), ((y + np.roll(y, -1, axis=1)) * cross).sum(axis=1),
    ]) / (6.0 * area[:, None])  # fmt: skip
    return middle[:, 0] + centroid, np.abs(area)
