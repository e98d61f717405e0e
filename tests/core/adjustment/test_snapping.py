"""Snapping against rendered targets: the place is known, blur and noise are injected."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from graphos_core.adjustment.measuring.snapping import snap
from graphos_core.errors import UserError

FINE = 16
"""Samples per pixel and axis of the rendered targets."""


def render(shape, centre, size: int = 61, noise: float = 2.0, seed: int = 0, blur: float = 0.8) -> np.ndarray:
    """Render `shape(dx, dy) -> bool` about `centre`, area-sampled, blurred like a lens, with Gaussian noise."""
    grid = (np.arange(size * FINE) + 0.5) / FINE - 0.5
    dx, dy = np.meshgrid(grid - centre[0], grid - centre[1])
    image = np.where(shape(dx, dy), 200.0, 60.0).reshape(size, FINE, size, FINE).mean(axis=(1, 3))
    image = cv2.GaussianBlur(image, (0, 0), blur) + noise * np.random.default_rng(seed).standard_normal(
        (size, size)
    )
    return np.clip(np.round(image), 0, 255).astype(np.uint8)


def ellipse(a: float, b: float, angle: float):
    c, s = np.cos(angle), np.sin(angle)
    return lambda x, y: ((c * x + s * y) / a) ** 2 + ((-s * x + c * y) / b) ** 2 <= 1


def cross(width: float, arm: float, angle: float):
    c, s = np.cos(angle), np.sin(angle)

    def shape(x, y):
        u, v = np.abs(c * x + s * y), np.abs(-s * x + c * y)
        return ((u <= width / 2) & (v <= arm)) | ((v <= width / 2) & (u <= arm))

    return shape


def chessboard(angle: float):
    c, s = np.cos(angle), np.sin(angle)
    return lambda x, y: (c * x + s * y) * (-s * x + c * y) > 0


def quadrant(angle: float):
    c, s = np.cos(angle), np.sin(angle)
    return lambda x, y: (c * x + s * y > 0) & (-s * x + c * y > 0)


CASES = {
    "circle r 3": ("circle", ellipse(3, 3, 0), 12.0),
    "circle r 8": ("circle", ellipse(8, 8, 0), 12.0),
    "ellipse": ("circle", ellipse(9, 4.5, 0.6), 12.0),
    "cross": ("cross", cross(4, 18, 0.3), 12.0),
    "cross, thin": ("cross", cross(1.5, 18, 0.1), 10.0),
    "chessboard": ("corner", chessboard(0.4), 9.0),
    "quadrant": ("corner", quadrant(0.2), 12.0),
}


@pytest.mark.parametrize("case", CASES)
def test_place_is_found_within_a_twentieth_of_a_pixel_and_sigma_says_how_well(case: str) -> None:
    target, shape, radius = CASES[case]
    rng = np.random.default_rng(5)
    errors, sigmas = [], []
    for seed in range(12):
        centre = 30 + rng.uniform(-0.5, 0.5, 2)
        image = render(shape, centre, seed=seed)
        found = snap(image, centre + rng.uniform(-2, 2, 2), target, radius)
        errors.append(found.xy - centre)
        sigmas.append(found.sigma_px)
    errors = np.array(errors)
    assert np.abs(errors).max() <= 0.05, np.abs(errors).max()
    assert np.abs(errors.mean(axis=0)).max() <= 0.02, errors.mean(axis=0)
    ratio = np.sqrt((errors**2).mean()) / np.sqrt(np.mean(np.square(sigmas)))
    assert 0.6 <= ratio <= 1.6, ratio


def test_dark_disc_and_colour_photo_are_alike() -> None:
    image = 255 - render(ellipse(6, 5, 0.2), (30.25, 29.6))
    colour = np.repeat(image[:, :, None], 3, axis=2)
    assert np.allclose(snap(colour, [31, 30], "circle").xy, [30.25, 29.6], atol=0.05)


def test_disc_inside_a_ring_is_found_and_not_the_ring() -> None:
    def shape(x, y):
        r = np.hypot(x, y)
        return (r <= 5) | (r > 11)

    assert np.allclose(snap(render(shape, (30.3, 30.1)), [32, 29], "circle").xy, [30.3, 30.1], atol=0.05)


@pytest.mark.parametrize("target", ["circle", "cross", "corner"])
def test_noise_and_a_single_edge_are_no_target(target: str) -> None:
    noise = render(lambda x, y: x < -1000, (30, 30), noise=3.0)
    edge = render(lambda x, y: x + 0.2 * y > 0, (30, 30), noise=1.0)
    for image in (noise, edge):
        with pytest.raises(UserError, match="There is no"):
            snap(image, [30, 30], target)  # type: ignore[arg-type]
