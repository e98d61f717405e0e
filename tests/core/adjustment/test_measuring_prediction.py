"""Predicted places against a theoretical block whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.measuring.prediction import epipolar, intersect, project
from graphos_core.data import Block, Camera
from graphos_core.simulation.model import NoiseParams, theoretical_model
from graphos_core.simulation.objects import ObjectParams, cube
from graphos_core.simulation.templates import OrbitalParams, place

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]))


@pytest.fixture(scope="module")
def block() -> Block:
    stations = place("orbital", OrbitalParams(axis_x=9, axis_y=9, axis_z=6, equators=1, per_equator=8))
    return theoretical_model(
        stations, CAMERA, cube(ObjectParams(count=200)), NoiseParams(sigma_px=0.0), seed=2
    ).as_block()


def sights(block: Block, fewest: int) -> tuple[int, dict[int, np.ndarray]]:
    """A point that at least so many photos see, and its exact images."""
    point = int(np.argmax(np.bincount(block.obs_point) >= fewest))
    mine = np.flatnonzero(np.asarray(block.obs_point) == point)
    return point, {int(block.obs_photo[i]): np.asarray(block.obs_xy[i]) for i in mine}


def test_two_rays_predict_the_place_in_a_third_photo_exactly(block: Block) -> None:
    point, exact = sights(block, 3)
    first, second, third = list(exact)[:3]
    found = intersect(block, {first: exact[first], second: exact[second]})
    assert found.xyz is not None and np.allclose(found.xyz, block.points[point], atol=1e-6)
    assert np.allclose(project(block, third, found.xyz), exact[third], atol=1e-4)
    assert found.rms_px < 1e-5


def test_one_ray_gives_the_line_on_which_the_point_lies_and_no_point(block: Block) -> None:
    _, exact = sights(block, 2)
    first, second = list(exact)[:2]
    assert intersect(block, {first: exact[first]}).xyz is None
    line = epipolar(block, first, exact[first], second)
    a, b = line[:-1], line[1:]
    along = np.clip(
        np.einsum("ij,ij->i", exact[second] - a, b - a) / np.maximum(((b - a) ** 2).sum(axis=1), 1e-12), 0, 1
    )
    assert np.hypot(*(a + along[:, None] * (b - a) - exact[second]).T).min() < 0.05


def test_sigma_is_the_spread_of_points_from_noisy_measurements(block: Block) -> None:
    point, exact = sights(block, 4)
    rng = np.random.default_rng(3)
    found = [
        intersect(block, {p: xy + 0.5 * rng.standard_normal(2) for p, xy in exact.items()}).xyz
        for _ in range(300)
    ]
    sigma = intersect(block, exact).sigma
    assert sigma is not None
    assert np.allclose(np.std(found, axis=0), 0.5 * sigma, rtol=0.15)
    assert np.allclose(np.mean(found, axis=0), block.points[point], atol=4 * 0.5 * sigma.max() / np.sqrt(300))


def test_a_blunder_shows_in_the_residuals_of_its_photo(block: Block) -> None:
    _, exact = sights(block, 5)
    wrong = next(iter(exact))
    found = intersect(block, {**exact, wrong: exact[wrong] + [12.0, -9.0]})
    sizes = {photo: float(np.hypot(*v)) for photo, v in found.residuals.items()}
    assert max(sizes, key=lambda photo: sizes[photo]) == wrong


def test_photos_that_are_not_oriented_take_no_part(block: Block) -> None:
    _, exact = sights(block, 3)
    photos = list(exact)
    flags = np.array(block.oriented)
    flags[photos[0]] = False
    less = replace(block, oriented=flags)
    assert set(intersect(less, exact).residuals) == set(photos[1:])
    assert not len(epipolar(less, photos[0], exact[photos[0]], photos[1]))
