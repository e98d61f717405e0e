"""Undistortion as a step: undistorted photos and ideal cameras belong together everywhere."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.cameras.undistortion import ideal_camera
from graphos_core.cli import main
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.exchange.calibration_file import read_calibration, write_calibration
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.images import read_pixels, read_shown
from graphos_core.masks import PhotoMask, Polygon, write_masks
from graphos_core.outputs import write_outputs
from graphos_core.pipeline import Pipeline
from graphos_core.preprocessing.undistortion import Resampling
from graphos_core.project import Project
from graphos_core.project_file import relative_path
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_core.seen_photos import SeenMasks, block_as_taken, filter_input
from graphos_core.simulation.photo_block import demo_camera, simulate_photos
from graphos_core.simulation.truth import load_truth

STRONG = np.array([736.0, 325.0, 236.0, -0.22, 0.06])
"""Moves the corners of the photo by 30 px."""


def strong_camera() -> Camera:
    return replace(demo_camera(640, 480), values=STRONG)


@pytest.fixture(scope="module")
def distorted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("distorted")
    simulate_photos("facade", folder, camera=strong_camera(), photos=5, seed=3, run=Run(threads=2))
    write_calibration(folder / "calibration.toml", [strong_camera()])
    return folder


@pytest.fixture(scope="module")
def undistorted(distorted: Path, tmp_path_factory: pytest.TempPathFactory) -> Pipeline:
    """The block adjusted with the basic camera held without distortion, from undistorted photos."""
    project = Project.create(tmp_path_factory.mktemp("undistorted") / "model", distorted / "photos",
                             control=distorted / "control.csv")  # fmt: skip
    recipe = Recipe.default().set("preprocessing.undistortion=calibrated")
    relative = relative_path(distorted / "calibration.toml", project.folder)
    recipe = recipe.set(f"preprocessing.calibrated.calibration={relative}")
    recipe = recipe.set("adjustment.schur.calibration=fixed")
    pipeline = Pipeline(project, recipe.set("adjustment.incremental.self_calibration=false"))
    pipeline.run("adjustment", Run(threads=2))
    return pipeline


@pytest.mark.parametrize("lanczos", [False, True])
def test_a_distorted_pattern_becomes_the_ideal_one(lanczos: bool) -> None:
    camera = strong_camera()
    ideal = ideal_camera(camera)
    assert ideal.model == "basic" and np.array_equal(ideal.values, [736.0, 325.0, 236.0, 0.0, 0.0])

    def pattern(of: Camera) -> np.ndarray:
        x, y = np.meshgrid(np.arange(640.0), np.arange(480.0))
        rays = ray_from_pixel(of, np.stack([x, y], -1).reshape(-1, 2)).reshape(480, 640, 3)
        u, v = rays[..., 0] / rays[..., 2], rays[..., 1] / rays[..., 2]
        return 128.0 + 60.0 * np.sin(90.0 * u) + 60.0 * np.cos(90.0 * v)

    way = Resampling(camera, ideal, lanczos)
    positions = way.positions()
    photo = np.rint(pattern(camera)).astype(np.uint8)
    made, shown = way.apply(photo, positions), way.shown(None, positions)
    assert np.abs(made.astype(float) - pattern(ideal))[shown].max() < 2.5
    assert (made[~shown] == 0).all() and shown.mean() > 0.9


def test_what_a_pincushion_lens_did_not_see_is_transparent_and_masked(
    distorted: Path, tmp_path: Path
) -> None:
    camera = replace(strong_camera(), values=np.array([736.0, 325.0, 236.0, 0.2, 0.0]))
    write_calibration(tmp_path / "c.toml", [camera])
    project = Project.create(tmp_path / "p", distorted / "photos", calibration=tmp_path / "c.toml")
    pipeline = Pipeline(project, Recipe.default().set("preprocessing.undistortion=calibrated"))
    pipeline.run("preprocessing", Run(threads=2))
    way = Resampling(camera, ideal_camera(camera))
    shown = way.shown(None, way.positions())
    photo = pipeline.photos.photos[0]
    assert 0.02 < 1 - shown.mean() < 0.3 and photo.hidden == (~shown).sum()
    assert np.array_equal(read_shown(photo), shown) and np.array_equal(SeenMasks(pipeline)(0), shown)


def test_every_kind_of_pixel_and_mask_is_carried_over() -> None:
    camera = strong_camera()
    way = Resampling(camera, ideal_camera(camera))
    positions = way.positions()
    deep = np.random.default_rng(0).integers(0, 65536, (480, 640, 5)).astype(np.uint16)
    made = way.apply(deep, positions)
    assert made.shape == deep.shape and made.dtype == np.uint16
    assert np.array_equal(made[:, :, 3], way.apply(deep[:, :, 3], positions))
    mask = np.zeros((480, 640), bool)
    mask[100:300, 200:500] = True
    seen = way.nearest(mask, positions)
    x, y = np.meshgrid(np.arange(640.0), np.arange(480.0))
    source = pixel_from_ray(camera, ray_from_pixel(way.ideal, np.stack([x, y], -1).reshape(-1, 2)))
    column, row = np.rint(source).T
    expected = (row >= 100) & (row < 300) & (column >= 200) & (column < 500)
    assert (seen.ravel() != expected).sum() <= 2  # float32 positions on the half pixel


def test_the_undistorted_block_has_the_true_exterior_orientation(
    undistorted: Pipeline, distorted: Path
) -> None:
    truth = load_truth(distorted)
    found = undistorted.value("adjustment")
    block = found.adjustment.block
    assert block.oriented.all() and found.adjustment.sigma0_px < 0.6
    assert np.array_equal(block.cameras[0].values, [736.0, 325.0, 236.0, 0.0, 0.0])
    back = estimate_similarity(block.centres, truth.centres)
    assert np.linalg.norm(back.apply(block.centres) - truth.centres, axis=1).max() < 2.0 * truth.gsd_m
    placed = block.centres + found.georeference.origin  # by control points measured in the photos as taken
    assert np.linalg.norm(placed - truth.centres, axis=1).max() < 4.0 * truth.gsd_m
    relative = np.einsum("nij,nkj->nik", back.rotate_camera(block.rotations), truth.rotations)
    angle = np.arccos(np.clip((np.trace(relative, axis1=1, axis2=2) - 1) / 2, -1, 1))
    assert np.degrees(angle).max() < 0.1


def test_photos_cameras_and_colours_fit_together(undistorted: Pipeline, distorted: Path) -> None:
    raw, seen = undistorted.project.photo_set, undistorted.photos
    assert [p.name for p in raw.photos] == [p.name for p in seen.photos]
    assert seen.cameras[0].values[3] == 0.0 and raw.photos[0].path != seen.photos[0].path
    way = Resampling(strong_camera(), ideal_camera(strong_camera()))
    positions = way.positions()
    assert np.array_equal(read_pixels(seen.photos[1]), way.apply(read_pixels(raw.photos[1]), positions))
    assert (
        way.shown(None, positions).all() and read_shown(seen.photos[1]) is None
    )  # barrel: nothing is missing


def test_masks_drawn_in_the_photo_as_taken_lie_at_the_same_place(undistorted: Pipeline) -> None:
    name = undistorted.project.photo_set.photos[0].name
    corner = np.array([(20, 20), (120, 20), (120, 120), (20, 120)], float)
    write_masks(undistorted.project.folder, {name: PhotoMask((Polygon(tuple(map(tuple, corner))),))})
    try:
        free = SeenMasks(undistorted)(0)
    finally:
        write_masks(undistorted.project.folder, {})
    camera = strong_camera()
    middle = pixel_from_ray(ideal_camera(camera), ray_from_pixel(camera, np.array([[70.0, 70.0]])))[0]
    assert np.hypot(*(middle - 70.0)) > 8.0
    x, y = np.rint(middle).astype(int)
    assert free is not None and not free[y - 40 : y + 40, x - 40 : x + 40].any() and free[240, 320]


def test_the_result_is_a_calibration_of_the_photos_as_taken(undistorted: Pipeline, tmp_path: Path) -> None:
    folder = write_outputs(undistorted, "2026-01-01")
    (camera,) = read_calibration(folder / "cameras.toml")
    assert len(camera.before) == 1
    grid = np.stack(np.meshgrid(np.linspace(30, 610, 9), np.linspace(30, 450, 9)), -1).reshape(-1, 2)
    rays, true = ray_from_pixel(camera, grid), ray_from_pixel(strong_camera(), grid)
    assert np.abs(rays - true).max() * 736.0 < 1e-6
    recipe = undistorted.recipe.set("preprocessing.calibrated.calibration=runs/0001/cameras.toml")
    again = Pipeline(undistorted.project, recipe)
    assert np.array_equal(again.photos.cameras[0].values, [736.0, 325.0, 236.0, 0.0, 0.0])
    block = undistorted.value("adjustment").adjustment.block
    raw = block_as_taken(undistorted, block)
    rays = ray_from_pixel(raw.cameras[0], raw.obs_xy)
    assert np.abs(rays - ray_from_pixel(block.cameras[0], block.obs_xy)).max() < 1e-9
    assert np.abs(raw.obs_xy - block.obs_xy).max() > 5.0


def test_a_project_elsewhere_takes_over_the_undistorted_photos(undistorted: Pipeline, tmp_path: Path) -> None:
    write_outputs(undistorted, "2026-01-01")
    out = tmp_path / "deeper" / "adjusted"
    assert main(["adjust", str(undistorted.project.folder), "--out", str(out), "--set",
                 "adjustment.schur.calibration=basic"]) == 0  # fmt: skip
    again = Pipeline(Project.open(out), Recipe.load(out / "recipe.toml"))
    assert again.key("images") == undistorted.key("images") and again.has("images")
    focal, _, _, k1, k2 = again.value("adjustment").adjustment.block.cameras[0].values
    r = np.linspace(0.0, 0.4, 20)  # to the edge of the points
    assert np.abs(focal * r * (k1 * r**2 + k2 * r**4)).max() < 0.5  # the true calibration left nothing
    assert np.abs(736.0 * r * (STRONG[3] * r**2 + STRONG[4] * r**4)).max() > 9.0


def test_keys_depend_on_the_calibration_and_originals_stay(
    undistorted: Pipeline, distorted: Path, tmp_path: Path
) -> None:
    key = undistorted.key("keypoints")
    plain = Pipeline(undistorted.project, Recipe.default())
    assert plain.photos is undistorted.project.photo_set and plain.key("keypoints") != key
    other = tmp_path / "calibration.toml"
    write_calibration(other, [replace(strong_camera(), values=STRONG + np.array([0, 0, 0, 0.001, 0]))])
    assert Pipeline(undistorted.project, undistorted.recipe.set(
        f"preprocessing.calibrated.calibration={other}")).key("images") != undistorted.key("images")  # fmt: skip
    assert cv2.imread(str(next((distorted / "photos").iterdir()))).shape == (480, 640, 3)


def test_filters_see_undistorted_photos_and_threads_change_nothing(distorted: Path, tmp_path: Path) -> None:
    results = []
    for threads in (1, 2):
        project = Project.create(
            tmp_path / str(threads), distorted / "photos", calibration=distorted / "calibration.toml"
        )
        recipe = (
            Recipe.default().set("preprocessing.undistortion=calibrated").set("preprocessing.filter=grey")
        )
        pipeline = Pipeline(project, recipe)
        before = filter_input(pipeline, 0)
        result = pipeline.run("preprocessing", Run(threads=threads))
        assert np.array_equal(filter_input(pipeline, 0), before)
        results.append([Path(name).read_bytes() for name in result.files])
        first = cv2.imread(result.files[0], cv2.IMREAD_GRAYSCALE)
        colour = read_pixels(pipeline.photos.photos[0])
        assert np.abs(first.astype(int) - cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY)).max() <= 1
    assert results[0] == results[1]


def test_what_is_missing_or_does_not_fit_is_said(distorted: Path, tmp_path: Path) -> None:
    project = Project.create(tmp_path / "p", distorted / "photos")
    recipe = Recipe.default().set("preprocessing.undistortion=calibrated")
    with pytest.raises(UserError, match="without a calibration"):
        Pipeline(project, recipe).run("preprocessing", Run())
    assert Pipeline(project, recipe).state("preprocessing").status == "failed"
    write_calibration(tmp_path / "c.toml", [demo_camera(800, 600)])
    with pytest.raises(UserError, match="800 × 600"):
        Pipeline(project, recipe.set(f"preprocessing.calibrated.calibration={tmp_path / 'c.toml'}")).key(
            "images"
        )
    with pytest.raises(UserError, match="cannot be read"):
        Pipeline(project, recipe.set("preprocessing.calibrated.calibration=none.toml")).key("images")
