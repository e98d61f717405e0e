"""Predicted places against a theoretical block whose truth is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.measuring.prediction import epipolar, intersect, predict, project
from graphos_core.adjustment.measuring.sights import image_rms
from graphos_core.cameras import camera_model
from graphos_core.data import Block, Camera
from graphos_core.exchange.control_sheet import ControlSheet, Mark
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


def test_all_points_at_once_are_as_one_by_one(block: Block) -> None:
    rng = np.random.default_rng(1)
    chosen = np.flatnonzero(np.bincount(block.obs_point) >= 3)[:8]
    marks = {}
    for point in chosen:
        for i in np.flatnonzero(np.asarray(block.obs_point) == point):
            x, y = np.asarray(block.obs_xy[i]) + 0.4 * rng.standard_normal(2)
            marks[f"P{point}", block.names[block.obs_photo[i]]] = Mark(float(x), float(y))
    marks["alone", block.names[0]] = Mark(10.0, 10.0)
    found = image_rms(ControlSheet(marks=marks), block)
    assert set(found) == {f"P{point}" for point in chosen}
    for name in found:
        places = {block.names.index(photo): mark.xy for (n, photo), mark in marks.items() if n == name}
        assert np.isclose(found[name], intersect(block, places).rms_px)


def test_a_fish_eye_predicts_beyond_a_right_angle() -> None:
    fisheye = Camera(
        model="fisheye_equidistant", width=1600, height=1600,
        values=np.zeros(len(camera_model("fisheye_equidistant").names)),
    )  # fmt: skip
    values = np.array(fisheye.values)
    values[:3] = 480.0, 799.5, 799.5
    fisheye = replace(fisheye, values=values)
    centres = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    xyz = np.array([2.0, 0.5, -0.3])  # behind the plane of the sensor
    seen = Block(
        cameras=(fisheye,), names=("a", "b", "c"), camera_of_photo=np.zeros(3, np.int32),
        oriented=np.ones(3, bool), rotations=np.repeat(np.eye(3)[None], 3, axis=0), centres=centres,
        points=xyz[None], colours=np.zeros((1, 3), np.uint8), point_track=np.zeros(1, np.int32),
        obs_photo=np.array([0, 1], np.int32), obs_point=np.zeros(2, np.int32), obs_xy=np.zeros((2, 2)),
    )  # fmt: skip
    exact = {photo: project(seen, photo, xyz) for photo in (0, 1, 2)}
    found = predict(seen, {0: exact[0], 1: exact[1]}, 2)
    assert found.source == "rays" and found.xy is not None and np.allclose(found.xy, exact[2], atol=1e-5)
    line = predict(seen, {0: exact[0]}, 1).lines[0]
    assert np.hypot(*(line - exact[1]).T).min() < 20
