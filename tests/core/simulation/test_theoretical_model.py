"""Theoretical models: observations are the camera's own projection, noise and outliers are as injected."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.cameras import camera_models, pixel_from_ray
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import angle_between
from graphos_core.simulation.model import NoiseParams, theoretical_model
from graphos_core.simulation.objects import OBJECTS, ObjectParams, imported
from graphos_core.simulation.photo_block import demo_camera
from graphos_core.simulation.templates import FacadeParams, OrbitalParams, place

PINHOLE = Camera(model="pinhole", width=1600, height=1200, values=np.array([1840.0, 800.0, 600.0]))


def cube_model(**noise):
    stations = place("facade", FacadeParams(distance=12.0))
    points = OBJECTS["cube"](ObjectParams(size=5.0, count=1500), seed=1)
    return theoretical_model(stations, demo_camera(), points, NoiseParams(**noise), seed=3), points


@pytest.mark.parametrize("camera", [PINHOLE, demo_camera()], ids=lambda camera: camera.model)
def test_exact_observations_are_the_projection_by_the_camera_model(camera):
    assert camera.model in camera_models()
    points = OBJECTS["sphere"](ObjectParams(size=2.0, count=400))
    model = theoretical_model(place("orbital"), camera, points, NoiseParams(sigma_px=0.0))
    rotations, centres = model.stations.rotations[model.obs_photo], model.stations.centres[model.obs_photo]
    local = np.einsum("nij,nj->ni", rotations, model.points[model.obs_point] - centres)
    assert np.abs(pixel_from_ray(camera, local) - model.obs_xy_true).max() < 1e-9
    assert model.obs_xy == pytest.approx(model.obs_xy_true)


def test_noise_has_the_injected_standard_deviation_and_no_bias():
    model, _ = cube_model(sigma_px=0.4)
    noise = model.obs_xy - model.obs_xy_true
    assert noise.size > 8_000
    # 5 standard deviations of the estimates
    assert noise.std() == pytest.approx(0.4, abs=5 * 0.4 / np.sqrt(2 * noise.size))
    assert np.abs(noise.mean(axis=0)).max() < 5 * 0.4 / np.sqrt(len(noise))


def test_outliers_have_the_injected_share_and_size():
    model, _ = cube_model(sigma_px=0.2, outlier_share=0.05, outlier_px=40.0)
    n = len(model.outlier)
    assert model.outlier.mean() == pytest.approx(0.05, abs=5 * np.sqrt(0.05 * 0.95 / n))
    size = np.linalg.norm(model.obs_xy - model.obs_xy_true, axis=1)
    assert (size[model.outlier] <= 40.0).all() and (size[model.outlier] >= 8.0).all()
    assert size[~model.outlier].max() < 0.2 * 6


def test_visibility_limits_hold():
    model, points = cube_model(max_incidence=60.0, max_distance=11.0)
    away = model.stations.centres[model.obs_photo] - model.points[model.obs_point]
    distance = np.linalg.norm(away, axis=1)
    normals = points.normals[model.point_index[model.obs_point]]
    assert distance.max() <= 11.0
    assert ((normals * away).sum(axis=1) / distance).min() >= np.cos(np.radians(60.0)) - 1e-12
    assert (model.obs_xy_true >= -0.5).all() and (model.obs_xy_true < [1599.5, 1199.5]).all()


def test_observations_are_sorted_unique_and_every_point_has_the_fewest_rays():
    model, points = cube_model(drop_share=0.4, min_rays=3)
    key = model.obs_point.astype(np.int64) * 1000 + model.obs_photo
    assert (np.diff(key) > 0).all()
    assert np.bincount(model.obs_point, minlength=len(model.points)).min() >= 3
    assert model.points == pytest.approx(points.xyz[model.point_index])


def test_same_seed_same_model_and_another_seed_another_noise():
    a, points = cube_model(sigma_px=0.3, outlier_share=0.02)
    b, _ = cube_model(sigma_px=0.3, outlier_share=0.02)
    assert a.obs_xy.tobytes() == b.obs_xy.tobytes()
    c = theoretical_model(a.stations, demo_camera(), points, a.noise, seed=4)
    assert a.obs_xy.tobytes() != c.obs_xy.tobytes()


def test_block_is_disturbed_as_asked_and_exact_otherwise():
    model, _ = cube_model(sigma_px=0.3)
    exact = model.as_block(exact_observations=True)
    assert (exact.rotations == model.stations.rotations).all() and (exact.points == model.points).all()
    assert (exact.obs_xy == model.obs_xy_true).all() and exact.unit == "m"
    block = model.as_block(perturb_rotation=0.01, perturb_centre=0.1, perturb_points=0.05, seed=2)
    turned = [angle_between(a, b) for a, b in zip(block.rotations, model.stations.rotations, strict=True)]
    assert np.sqrt(np.mean(np.square(turned)) / 3) == pytest.approx(0.01, rel=0.5)
    assert (block.centres - model.stations.centres).std() == pytest.approx(0.1, rel=0.5)
    assert (block.points - model.points).std() == pytest.approx(0.05, rel=0.1)


def test_several_cameras_each_project_their_own_photos():
    stations = place("orbital", OrbitalParams(equators=1, per_equator=6))
    points = OBJECTS["sphere"](ObjectParams(size=2.0, count=300))
    owner = np.arange(6) % 2
    both = theoretical_model(
        stations,
        [PINHOLE, demo_camera()],
        points,
        NoiseParams(sigma_px=0.0, min_rays=1),
        camera_of_photo=owner,
    )
    alone = theoretical_model(stations, demo_camera(), points, NoiseParams(sigma_px=0.0, min_rays=1))
    mine, same = both.obs_photo == 1, alone.obs_photo == 1
    assert both.obs_xy[mine] == pytest.approx(alone.obs_xy[same])


@pytest.mark.parametrize("name", list(OBJECTS))
def test_object_points_lie_on_the_object_with_unit_normals(name):
    made = OBJECTS[name](ObjectParams(size=4.0, count=600, relief=0.5))
    assert np.linalg.norm(made.normals, axis=1) == pytest.approx(1.0)
    if name == "cube":
        assert np.abs(made.xyz).max(axis=1) == pytest.approx(2.0)
    elif name == "sphere":
        assert np.linalg.norm(made.xyz, axis=1) == pytest.approx(2.0)
    else:
        assert np.abs(made.xyz[:, 2]).max() <= 0.5 and (made.normals[:, 2] > 0).all()


def test_clouds_from_elsewhere_are_checked():
    assert not imported(np.ones((4, 3))).normals.any()
    with pytest.raises(UserError, match="three coordinates"):
        imported(np.ones((4, 2)))
    with pytest.raises(UserError, match="finite"):
        imported(np.full((4, 3), np.nan))


def test_a_model_that_nobody_sees_is_refused():
    far = OBJECTS["cube"](ObjectParams()).moved(np.array([0.0, -500.0, 0.0]))
    with pytest.raises(UserError, match="enough photos"):
        theoretical_model(place("couple"), PINHOLE, far)
