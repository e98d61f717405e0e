"""Blocks of fish-eye photos and panoramas, oriented and self-calibrated from tie points alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.orientation.incremental import IncrementalParams, orient_incrementally
from graphos_core.cameras import camera_model, pixel_from_ray
from graphos_core.cameras.lens import CIRCLE, with_lens
from graphos_core.data import Array, Camera, Candidates, Exif, Features, PairMatches, Photo, PhotoSet, Tracks
from graphos_core.errors import ParamError
from graphos_core.features.verification import UsacParams, usac
from graphos_core.geometry.epipolar import epipolar_circle, essential_from_relative
from graphos_core.geometry.epipolar import relative_orientation as relative
from graphos_core.geometry.rays import rays_of
from graphos_core.geometry.relative_orientation import RayPairs
from graphos_core.geometry.rotation import angle_between, look_at, matrix_from_vector
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.project_file import Settings, check_settings, read_settings, write_settings
from graphos_core.run import Run

PHOTOS, SIDE = 10, 1200
NOMINAL = Camera(model="basic", width=SIDE, height=SIDE, values=np.array([420.0, 599.5, 599.5, 0.0, 0.0]))


def true_camera(lens: str) -> Camera:
    """A lens of 180° that differs from its nominal figures: f by 2 %, principal point by 4 px, a polynomial."""
    start = with_lens(NOMINAL, lens)
    values = start.values.copy()
    if lens != "spherical":
        names = camera_model(start.model).names
        values[:3] = 430.0, 603.0, 596.5
        values[names.index("k1")], values[names.index("k2")] = 0.02, -0.008
    return replace(start, values=values)


def room(
    camera: Camera, noise_px: float, seed: int = 0
) -> tuple[PhotoSet, Tracks, Array, Array, list[PairMatches]]:
    """Photos from inside a room whose walls, floor and ceiling carry points; true centres and rotations."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1, 1, (1500, 3))
    axis = rng.integers(0, 3, len(points))
    points[np.arange(len(points)), axis] = np.sign(points[np.arange(len(points)), axis])
    points *= [3.0, 2.5, 1.5]
    centres = rng.uniform(-1, 1, (PHOTOS, 3)) * [1.5, 1.2, 0.6]
    aims = centres + rng.normal(size=(PHOTOS, 3)) * [1.0, 1.0, 0.4]
    rotations = np.stack([
        matrix_from_vector(np.array([0.0, 0.0, rng.uniform(-3, 3)])) @ look_at(c, t) for c, t in zip(centres, aims, strict=True)
    ])  # fmt: skip
    photo, point, xy = [], [], []
    for i in range(PHOTOS):
        seen = (points - centres[i]) @ rotations[i].T
        pixels = pixel_from_ray(camera, seen)
        inside = np.isfinite(pixels).all(axis=1) & (np.abs(pixels - [599.5, 599.5]) < 599).all(axis=1)
        inside &= (seen[:, 2] > -0.09 * np.linalg.norm(seen, axis=1)) | (camera.model == "spherical")
        inside &= rng.random(len(points)) < 0.6
        photo += [i] * int(inside.sum())
        point += list(np.flatnonzero(inside))
        xy.append(pixels[inside] + rng.normal(0, noise_px, (int(inside.sum()), 2)))
    order = np.lexsort((photo, point))
    photos = PhotoSet(
        photos=tuple(
            Photo(name=f"{i}.jpg", path="", width=SIDE, height=SIDE, bits=8, channels=3, camera=0, digest=str(i), exif=Exif())
            for i in range(PHOTOS)
        ),
        cameras=(camera,),
    )  # fmt: skip
    tracks = Tracks(
        photo=np.array(photo, np.int32)[order], feature=np.zeros(len(order), np.int32),
        track=np.array(point, np.int32)[order], xy=np.concatenate(xy)[order],
        colour=np.zeros((len(points), 3), np.uint8), count=len(points),
    )  # fmt: skip
    pairs = [
        PairMatches(a=a, b=b, matches=np.zeros((20, 2), np.int32), candidates=20, kind="essential", matrix=np.zeros((3, 3)))
        for a in range(PHOTOS) for b in range(a + 1, PHOTOS)
    ]  # fmt: skip
    return photos, tracks, centres, rotations, pairs


@pytest.mark.parametrize("lens", ["fisheye-equisolid", "fisheye-equidistant"])
def test_a_fisheye_block_is_self_calibrated_from_its_nominal_principal_distance(lens: str) -> None:
    truth = true_camera(lens)
    photos, tracks, centres, _, pairs = room(truth, noise_px=0.3)
    start = replace(photos, cameras=(with_lens(NOMINAL, lens),))
    assert not start.cameras[0].values[3:].any()
    block = orient_incrementally(start, tracks, pairs, IncrementalParams(), run=Run(threads=1))
    assert block.oriented.all() and len(block.obs_xy) > 0.93 * len(tracks.xy)
    adjusted = adjust_block(block, Freedom(interior=(("focal_px", "x0", "y0", "k1", "k2"),)))
    assert adjusted.sigma0_px == pytest.approx(0.3, rel=0.05)
    camera = adjusted.block.cameras[0]
    assert camera.sigmas is not None
    errors = ((camera.values - truth.values) / np.where(camera.sigmas > 0, camera.sigmas, 1.0))[:5]
    assert float((errors**2).sum()) < 3.0 * chi2.ppf(0.999, 5)  # they are correlated: not quite χ²
    assert np.abs(errors).max() < 4.0
    world = estimate_similarity(adjusted.block.centres, centres)
    misfit = (world.apply(adjusted.block.centres) - centres) / (world.scale * adjusted.sigma_centres)
    assert 0.5 < np.sqrt((misfit**2).mean()) < 2.0


def test_a_block_of_panoramas_is_oriented_exactly() -> None:
    photos, tracks, centres, rotations, pairs = room(true_camera("spherical"), noise_px=0.0)
    block = orient_incrementally(photos, tracks, pairs, IncrementalParams(), run=Run(threads=1))
    assert block.oriented.all()
    world = estimate_similarity(block.centres, centres)
    np.testing.assert_allclose(world.apply(block.centres), centres, atol=1e-5)
    turns = [
        angle_between(world.rotate_camera(r), t) for r, t in zip(block.rotations, rotations, strict=True)
    ]
    assert max(turns) < 1e-5


def test_the_same_bits_with_one_and_two_threads() -> None:
    photos, tracks, _, _, pairs = room(true_camera("fisheye-equisolid"), noise_px=0.3)
    one, two = (
        orient_incrementally(photos, tracks, pairs, IncrementalParams(), run=Run(threads=t)) for t in (1, 2)
    )
    assert np.array_equal(one.points, two.points) and np.array_equal(one.rotations, two.rotations)


def test_wrong_matches_between_fisheye_photos_are_found_and_right_ones_kept() -> None:
    camera = true_camera("fisheye-equisolid")
    photos, tracks, _, _, _ = room(camera, noise_px=0.3)
    a, b = (np.flatnonzero(tracks.photo == i) for i in (1, 7))
    common, in_a, in_b = np.intersect1d(tracks.track[a], tracks.track[b], return_indices=True)
    xy_a, xy_b = tracks.xy[a[in_a]], tracks.xy[b[in_b]]
    wrong = len(common) // 4
    xy_b[:wrong] = xy_b[:wrong][::-1] + 7.0
    features = tuple(
        Features(xy=xy.astype(np.float32), scale=np.ones(len(xy), np.float32), angle=np.zeros(len(xy), np.float32),
                 response=np.ones(len(xy), np.float32), descriptors=np.zeros((len(xy), 2), np.uint8),
                 colour=np.zeros((len(xy), 3), np.uint8), width=SIDE, height=SIDE)
        for xy in (xy_a, xy_b)
    )  # fmt: skip
    every = np.repeat(np.arange(len(common), dtype=np.int32)[:, None], 2, axis=1)
    found = usac((1, 7), *features, Candidates.of(every), (photos.cameras[0],) * 2, UsacParams(), run=Run())
    kept = np.isin(np.arange(len(common)), found.matches[:, 0])
    assert found.kind == "essential" and kept[wrong:].mean() > 0.97 and kept[:wrong].mean() < 0.15


def test_the_epipolar_plane_of_a_fisheye_ray_goes_through_its_partner() -> None:
    camera = true_camera("fisheye-equisolid")
    _, tracks, centres, rotations, _ = room(camera, noise_px=0.0)
    a, b = (np.flatnonzero(tracks.photo == i) for i in (1, 7))
    _, in_a, in_b = np.intersect1d(tracks.track[a], tracks.track[b], return_indices=True)
    pairs = RayPairs(rays_of(camera, tracks.xy[a[in_a]]), rays_of(camera, tracks.xy[b[in_b]]))
    essential = essential_from_relative(*relative(rotations[1], centres[1], rotations[7], centres[7]))
    assert pairs.line_distances(essential).max() < 1e-6
    circle = epipolar_circle(essential, pairs.a.directions[0], 3600)
    assert (circle @ pairs.b.directions[0]).max() > 1.0 - 1e-5
    off = RayPairs(pairs.a, rays_of(camera, tracks.xy[b[in_b]] + np.array([3.0, 4.0])))
    assert 0.5 < np.median(off.line_distances(essential)) <= 5.1


def test_rays_of_a_fisheye_count_in_pixels_of_the_photo() -> None:
    camera = true_camera("fisheye-equisolid")
    pixels = np.array([[603.0, 596.5], [1150.0, 600.0], [300.0, 1000.0]])
    rays, moved = rays_of(camera, pixels), rays_of(camera, pixels + np.array([0.3, -0.4]))
    assert rays.valid.all() and rays.directions[1, 2] < 0.25
    q = np.einsum("nij,nj->ni", rays.frames, moved.directions)
    np.testing.assert_allclose(q[:, :2] / q[:, 2:], np.tile([0.3, -0.4], (3, 1)), atol=2e-3)


def test_an_unknown_principal_distance_comes_from_the_image_circle() -> None:
    guess = replace(NOMINAL, values=np.array([1440.0, 599.5, 599.5, 0, 0]), focal_estimated=True)
    for lens, model in (
        ("fisheye-equidistant", "fisheye_equidistant"),
        ("fisheye-equisolid", "fisheye_equisolid"),
    ):
        camera = with_lens(guess, lens)
        edge = pixel_from_ray(camera, np.array([[1.0, 0.0, 0.0]]))
        assert camera.model == model and camera.focal_estimated and "180°" in camera.focal_source
        assert edge[0, 0] - 599.5 == pytest.approx(600.0)
        assert camera.focal_px == pytest.approx(600.0 / CIRCLE[model])
    assert with_lens(NOMINAL, "fisheye-equisolid").focal_px == 420.0
    assert with_lens(NOMINAL, "perspective") is NOMINAL
    panorama = with_lens(replace(guess, width=2000, height=1000), "spherical")
    assert panorama.focal_px * 2 * np.pi == pytest.approx(2000) and not panorama.focal_estimated


def test_the_declared_lens_is_kept_with_the_project_and_an_unknown_one_refused(tmp_path: Path) -> None:
    settings = Settings(name="hall", photos="photos", lens="fisheye-equisolid")
    write_settings(tmp_path, settings)
    assert read_settings(tmp_path).lens == "fisheye-equisolid"
    check_settings(settings)
    with pytest.raises(ParamError, match="Unknown lens"):
        check_settings(replace(settings, lens="fisheye"))
