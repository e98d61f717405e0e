"""Photos changed in known ways: viewpoint, scale, rotation, blur, noise, light.

The homography from the photo to the changed one is exactly known, so that every detector can be measured on somebody's
own photo.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.data import Array

LONGEST = 640
"""The photo is reduced to so many px along its longer side: enough to compare, fast enough to compare many."""

SENSOR_NOISE = 1.0
"""Standard deviation of the noise, grey levels, that every changed photo gets: no two photos are alike."""

ANTI_ALIASING = 0.8
"""Blur before a reduction by t: 0.8·√(t² − 1) px (Morel and Yu 2009, section 4.3)."""

DISTANCE = 1.2
"""Distance of the pictured plane in units of the photo's longer side, for the change of viewpoint."""


@dataclass(frozen=True)
class Disturbance:
    """One way to change a photo.

    Attributes
    ----------
    name, label, unit : str
    levels : tuple of float
        From hardly any change to much.
    change : callable
        ``change(grey, level, rng) -> (grey, homography)``, the homography from the photo to the changed one, px.
    """

    name: str
    label: str
    unit: str
    levels: tuple[float, ...]
    change: Callable[[Array, float, np.random.Generator], tuple[Array, Array]]


def small(grey: Array) -> Array:
    """Return the photo reduced to `LONGEST` px along its longer side, uint8; smaller ones as they are."""
    factor = LONGEST / max(grey.shape)
    if factor >= 1.0:
        return grey
    size = (max(1, round(grey.shape[1] * factor)), max(1, round(grey.shape[0] * factor)))
    return cv2.resize(grey, size, interpolation=cv2.INTER_AREA)


def changed(grey: Array, disturbance: Disturbance, level: float, seed: int) -> tuple[Array, Array]:
    """Return the changed photo with sensor noise, uint8, and the homography to it, float64 (3, 3)."""
    rng = np.random.default_rng([seed, *disturbance.name.encode(), round(level * 1000)])
    image, homography = disturbance.change(grey, level, rng)
    noisy = image.astype(np.float64) + rng.normal(0.0, SENSOR_NOISE, image.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8), homography


def _warped(grey: Array, homography: Array, size: tuple[int, int]) -> Array:
    return cv2.warpPerspective(
        grey, homography, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT,
        borderValue=float(np.median(grey)),
    )  # fmt: skip


def viewpoint(grey: Array, degrees: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return the photo as a plane seen from the side, turned about the vertical by an angle."""
    height, width = grey.shape
    angle, away = math.radians(degrees), DISTANCE * max(height, width)
    to_middle = np.array([[1.0, 0.0, -(width - 1) / 2], [0.0, 1.0, -(height - 1) / 2], [0.0, 0.0, 1.0]])
    plane = np.array([
        [away * math.cos(angle), 0.0, 0.0], [0.0, away, 0.0], [math.sin(angle), 0.0, away]
    ])  # fmt: skip
    homography = np.linalg.inv(to_middle) @ plane @ to_middle
    tilt = 1.0 / math.cos(angle)
    blur = ANTI_ALIASING * math.sqrt(tilt * tilt - 1.0)
    source = cv2.GaussianBlur(grey, (0, 0), sigmaX=blur, sigmaY=0.01) if blur > 0.1 else grey
    return _warped(source, homography, (width, height)), homography


def scale(grey: Array, factor: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return the photo reduced by a factor, as from farther away."""
    height, width = grey.shape
    size = (max(1, round(width / factor)), max(1, round(height / factor)))
    sx, sy = size[0] / width, size[1] / height
    homography = np.array([[sx, 0.0, 0.5 * sx - 0.5], [0.0, sy, 0.5 * sy - 0.5], [0.0, 0.0, 1.0]])
    return cv2.resize(grey, size, interpolation=cv2.INTER_AREA), homography


def rotation(grey: Array, degrees: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return the photo turned in its plane, large enough to hold all of it."""
    height, width = grey.shape
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    size = (
        math.ceil(width * abs(cos) + height * abs(sin) - 1e-6),
        math.ceil(width * abs(sin) + height * abs(cos) - 1e-6),
    )
    x0, y0, x1, y1 = (width - 1) / 2, (height - 1) / 2, (size[0] - 1) / 2, (size[1] - 1) / 2
    homography = np.array([
        [cos, -sin, x1 - cos * x0 + sin * y0], [sin, cos, y1 - sin * x0 - cos * y0], [0.0, 0.0, 1.0]
    ])  # fmt: skip
    return _warped(grey, homography, size), homography


def blur(grey: Array, sigma: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return the photo blurred by a Gaussian."""
    return cv2.GaussianBlur(grey, (0, 0), sigma), np.eye(3)


def noise(grey: Array, sigma: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return the photo with Gaussian noise."""
    noisy = grey + rng.normal(0.0, sigma, grey.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8), np.eye(3)


def light(grey: Array, share: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """Return the photo with only a share of its light, in whole grey levels."""
    return np.rint(grey * share).astype(np.uint8), np.eye(3)


DISTURBANCES = {
    d.name: d
    for d in (
        Disturbance("viewpoint", "Viewpoint", "°", (10.0, 25.0, 40.0, 50.0, 60.0), viewpoint),
        Disturbance("scale", "Scale", "times smaller", (1.2, 1.5, 2.0, 3.0, 4.0), scale),
        Disturbance("rotation", "Rotation", "°", (10.0, 30.0, 45.0, 90.0, 150.0), rotation),
        Disturbance("blur", "Blur", "px (σ)", (0.7, 1.5, 2.5, 4.0, 6.0), blur),
        Disturbance("noise", "Noise", "grey levels (σ)", (3.0, 8.0, 15.0, 25.0, 40.0), noise),
        Disturbance("light", "Light left", "of 1", (0.8, 0.6, 0.4, 0.2, 0.1), light),
    )
}
"""Every disturbance by name."""
