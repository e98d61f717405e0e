"""Photos show the scene where the camera model says, with the noise that is documented."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import look_at
from graphos_core.simulation.control_targets import visible_targets
from graphos_core.simulation.patches import Finish, plane
from graphos_core.simulation.photo_block import lens_camera
from graphos_core.simulation.render_kernels import fine_rays, shade_rays
from graphos_core.simulation.renderer import SensorParams, expose, jpeg_bytes, ray_grid, render
from graphos_core.simulation.scene import Design, bake_scene, build_scene
from graphos_core.simulation.targets import BITS, CODE_INNER, ring_codes
from graphos_core.simulation.texture_kernels import BRICK

CAMERA = Camera(
    model="basic",
    width=320,
    height=240,
    values=np.array([400.0, 162.3, 117.8, -0.08, 0.03]),
    label="Test camera",
)
CENTRE = np.array([0.5, -2.3, 1.2])
VIEW = look_at(CENTRE, np.array([0.85, 0.0, 0.7]))


@pytest.fixture(scope="module")
def wall():
    """Brick wall 1.8 m × 1.4 m in the plane y = 0 with two targets."""
    patch = plane(np.zeros(3), np.array([1.8, 0, 0]), np.array([0, 0, 1.4]), Finish(BRICK))
    patch = replace(patch, targets=((5, 0.7, 0.8, 0.3), (6, 1.25, 0.55, 0.3)))
    return bake_scene("wall", Design([patch], np.zeros(3)), texel_m=0.004)


@pytest.fixture(scope="module")
def view(wall):
    grid = ray_grid(CAMERA)
    return grid, *render(wall, grid, VIEW, CENTRE)


@pytest.fixture(scope="module")
def facade():
    return build_scene("facade", texel_m=0.04)


def test_every_pixel_ray_projects_back_to_its_pixel(view):
    grid, _, depth = view
    y, x = np.nonzero(np.isfinite(depth))
    points = grid.centre[y, x] * depth[y, x, None].astype(np.float64)
    assert np.abs(pixel_from_ray(CAMERA, points) - np.column_stack([x, y])).max() < 1e-6


def test_depth_is_where_the_ray_meets_the_wall(view):
    grid, _, depth = view
    directions = grid.centre @ VIEW
    true = -CENTRE[1] / directions[..., 1]
    hit = CENTRE + true[..., None] * directions
    inside = (
        (hit[..., 0] > 1e-4) & (hit[..., 0] < 1.8 - 1e-4) & (hit[..., 2] > 1e-4) & (hit[..., 2] < 1.4 - 1e-4)
    )
    assert 0.3 < inside.mean() < 1.0
    assert np.abs(depth[inside] - true[inside]).max() < 1e-5
    outside = (
        (hit[..., 0] < -1e-4)
        | (hit[..., 0] > 1.8 + 1e-4)
        | (hit[..., 2] < -1e-4)
        | (hit[..., 2] > 1.4 + 1e-4)
    )
    assert np.isnan(depth[outside]).all()


def test_painted_targets_are_photographed_where_their_centres_project(wall, view):
    grid, light, _ = view
    quiet = SensorParams(read_noise=0.5, shot_noise=0.5)
    grey = expose(light, grid, quiet, np.random.default_rng(0)).mean(axis=2)
    pixels, seen = visible_targets(wall, CAMERA, VIEW, CENTRE)
    assert seen.all()
    for (px, py), target in zip(pixels, wall.targets, strict=True):
        radius = 0.8 * CODE_INNER * target.diameter / 2 * 400.0 / np.linalg.norm(target.xyz - CENTRE)
        y, x = np.mgrid[0:240, 0:320]
        near = np.hypot(x - px, y - py) < radius
        weight = np.where(near, np.maximum(grey - np.quantile(grey[near], 0.3) - 10, 0.0), 0.0)
        found = np.array([(weight * x).sum(), (weight * y).sum()]) / weight.sum()
        assert np.abs(found - [px, py]).max() < 0.1


def test_the_shortcut_over_continuous_surfaces_gives_what_casting_every_ray_gives(facade):
    centre = facade.focus + np.array([3.0, -11.0, 1.0])
    rotation = look_at(centre, facade.focus)
    camera = replace(CAMERA, width=160, height=120, values=np.array([184.0, 80.5, 59.2, -0.08, 0.03]))
    grid = ray_grid(camera)
    light, _ = render(facade, grid, rotation, centre)
    where = np.argwhere(np.ones((120, 160), bool))
    rays = np.empty((len(where) * 4, 6), np.float32)
    fine_rays(grid.fine, rotation, centre, where, rays)
    import open3d as o3d

    hit = {k: v.numpy() for k, v in facade.caster.cast_rays(o3d.core.Tensor.from_numpy(rays)).items()}
    cast = np.zeros_like(light)
    shade_rays(
        rays, hit["t_hit"], hit["primitive_ids"], hit["primitive_uvs"], hit["primitive_normals"], where,
        facade.corner_st, facade.patch_of_triangle, facade.texels, facade.table, facade.texel_of_patch, 1 / 184.0, cast,
    )  # fmt: skip
    difference = np.abs(light - cast).max(axis=2)
    assert np.quantile(difference, 0.98) < 0.002
    assert difference.mean() < 0.001


def test_photos_of_one_surface_point_from_two_places_have_the_same_light(facade):
    grid = ray_grid(CAMERA)
    centres = list(facade.focus + np.array([[-2.0, -9.0, 0.0], [1.5, -9.0, 1.5]]))
    views = [look_at(c, facade.focus) for c in centres]
    (light_a, depth_a), (light_b, depth_b) = (
        render(facade, grid, r, c) for r, c in zip(views, centres, strict=True)
    )
    y, x = (v.ravel()[::7] for v in np.mgrid[5:235, 5:315])
    local = grid.centre[y, x] * depth_a[y, x, None]
    there = (local @ views[0] + centres[0] - centres[1]) @ views[1].T
    pixels = np.rint(pixel_from_ray(CAMERA, there))
    ok = np.isfinite(pixels).all(axis=1) & (pixels >= 5).all(axis=1) & (pixels < [315, 235]).all(axis=1)
    column, row = pixels[ok].astype(int).T
    visible = np.abs(depth_b[row, column] - there[ok, 2]) < 0.02
    a, b = light_a[y, x][ok][visible].mean(axis=1), light_b[row, column][visible].mean(axis=1)
    assert visible.sum() > 2000
    assert np.corrcoef(a, b)[0, 1] > 0.9


def test_sensor_noise_has_the_documented_standard_deviation():
    sensor = SensorParams(read_noise=1.0, shot_noise=2.0, vignetting=0.0)
    grid = ray_grid(CAMERA)
    for value in (0.05, 0.2, 0.6):
        light = np.full((240, 320, 3), value, np.float32)
        clean = expose(light, grid, sensor.replace(read_noise=0.0, shot_noise=0.0), np.random.default_rng(1))
        noisy = expose(light, grid, sensor, np.random.default_rng(1)).astype(float)
        grey = float(clean.mean())
        expected = np.sqrt(sensor.sigma(grey) ** 2 + 1 / 12)  # and the rounding
        assert noisy.std() == pytest.approx(expected, rel=0.02)
        assert noisy.mean() == pytest.approx(grey, abs=0.6)


def test_photos_carry_make_model_focal_length_and_orientation():
    photo = np.zeros((240, 320, 3), np.uint8)
    camera = replace(CAMERA, pixel_pitch_mm=0.05)
    with Image.open(io.BytesIO(jpeg_bytes(photo, camera, 95))) as image:
        assert image.size == (320, 240)
        exif = image.getexif()
        sub = exif.get_ifd(0x8769)
    assert (exif[0x010F], exif[0x0110], exif[0x0112]) == ("GRAPHOS", "Test camera", 1)
    assert float(sub[0x920A]) == pytest.approx(400 * 0.05)
    assert sub[0xA405] == round(400 * np.hypot(36, 24) / np.hypot(320, 240))


def test_a_distortion_that_folds_over_is_refused():
    folded = replace(CAMERA, values=np.array([150.0, 160.0, 120.0, -0.9, 0.0]))
    with pytest.raises(UserError, match="folds over"):
        ray_grid(folded)


def test_ring_codes_differ_in_every_rotation():
    seen = set()
    for code in ring_codes():
        turned = {((code << k) | (code >> (BITS - k))) & ((1 << BITS) - 1) for k in range(BITS)}
        assert len(turned) == BITS and not turned & seen
        seen |= turned


@pytest.mark.parametrize("lens", ["fisheye-equisolid", "fisheye-equidistant"])
def test_a_fisheye_photo_shows_the_wall_through_its_own_projection_and_nothing_beyond_the_circle(wall, lens):
    camera = lens_camera(lens, 160, 160)
    grid = ray_grid(camera, 1)
    light, depth = render(wall, grid, VIEW, CENTRE)
    photo = expose(light, grid, SensorParams(read_noise=0.0, shot_noise=0.0), np.random.default_rng(0))
    y, x = np.indices((160, 160))
    radius = np.hypot(x - camera.values[1], y - camera.values[2])
    edge = pixel_from_ray(camera, np.array([[np.cos(np.radians(2.5)), 0.0, -np.sin(np.radians(2.5))]]))[0, 0]
    outside = radius > edge - camera.values[1] + 1.0
    assert not grid.lit[outside].any() and grid.lit[radius < edge - camera.values[1] - 1.0].all()
    assert (photo[outside] == 0).all() and (photo[grid.lit].max(axis=-1) > 0).all()
    y, x = np.nonzero(np.isfinite(depth))
    points = grid.centre[y, x] * depth[y, x, None].astype(np.float64)
    assert np.abs(points @ VIEW + CENTRE)[:, 1].max() < 1e-4
    assert np.abs(pixel_from_ray(camera, points) - np.column_stack([x, y])).max() < 1e-6
