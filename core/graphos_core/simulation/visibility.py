"""What a photo can see: inside the format, in front of the camera, not hidden, not too slanted, not too far."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.cameras.lens import within_field
from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array


def project_inside(camera: Camera, rotation: Array, centre: Array, points: Array) -> tuple[Array, Array]:
    """Project object points into a photo.

    Parameters
    ----------
    camera : Camera
    rotation, centre : float64 (3, 3), (3,)
        ``cam_from_world`` and projection centre.
    points : float64 (n, 3)
        Object frame.

    Returns
    -------
    pixels : float64 (n, 2)
        NaN behind the camera.
    inside : bool (n,)
        Whether the image lies within the format and the image circle, where the distortion maps one to one.
    """
    local = (np.asarray(points) - centre) @ np.asarray(rotation).T
    pixels = pixel_from_ray(camera, local)
    limit = np.array([camera.width - 0.5, camera.height - 0.5])
    with np.errstate(invalid="ignore"):
        inside: Array = np.asarray(((pixels >= -0.5) & (pixels < limit)).all(axis=1))
    inside &= within_field(camera, local)
    back, true = ray_from_pixel(camera, pixels[inside]), local[inside]
    true = true / np.linalg.norm(true, axis=1, keepdims=True)
    back = back / np.linalg.norm(back, axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        inside[inside] = np.abs(back - true).max(axis=1) < 1e-6
    return pixels, inside


def incidence(normals: Array, points: Array, centre: Array) -> Array:
    """Return the cosine of the angle between the surface normal and the ray to the camera, (n,); 1 without normal."""
    away = np.asarray(centre) - np.asarray(points)
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-300)
    cosine = (np.asarray(normals) * away).sum(axis=1)
    result: Array = np.where(np.abs(normals).max(axis=1) > 0.0, cosine, 1.0)
    return result


def unobstructed(caster: Any, points: Array, normals: Array, centre: Array, *, lift: float = 0.002) -> Array:
    """Say which points (n, 3) no surface hides from `centre`, bool (n,).

    Parameters
    ----------
    caster : open3d.t.geometry.RaycastingScene
    points, normals : float64 (n, 3)
        On the surface, with outward normals.
    centre : float64 (3,)
    lift : float
        The ray starts this far, m, above the surface, so that it does not meet its own surface.
    """
    import open3d as o3d

    rays = np.empty((len(points), 6), np.float32)
    start = np.asarray(points) + lift * np.asarray(normals)
    rays[:, :3], rays[:, 3:] = start, np.asarray(centre) - start
    blocked = caster.test_occlusions(o3d.core.Tensor.from_numpy(rays), 0.0, 1.0).numpy()
    result: Array = ~blocked
    return result
