"""Masks: drawn, kept, imported, rasterised exactly, and respected by keypoints and depth maps."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from matplotlib.path import Path as Outline
from PIL import Image

from graphos_core.data import Exif, Photo
from graphos_core.errors import UserError
from graphos_core.images import read_photo_set
from graphos_core.mask_import import import_masks, is_mask_picture
from graphos_core.masks import (
    PhotoMask,
    Polygon,
    photo_mask,
    polygon_inside,
    rasterised,
    read_masks,
    write_masks,
)
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run

TRIANGLE = ((10.5, 4.25), (50.25, 12.0), (20.0, 39.5))


def photo(name: str = "a.jpg", size: tuple[int, int] = (64, 48), orientation: int = 1) -> Photo:
    return Photo(name=name, path=name, width=size[0], height=size[1], bits=8, channels=3, camera=0, digest=name,
                 exif=Exif(orientation=orientation))  # fmt: skip


@pytest.mark.parametrize("seed", range(4))
def test_polygons_hold_the_pixel_centres_inside_them(seed: int) -> None:
    corners = np.random.default_rng(seed).uniform(-10, 70, (7, 2))
    order = np.argsort(np.arctan2(*(corners - corners.mean(axis=0)).T))  # star-shaped: does not cross itself
    corners = corners[order]
    x, y = np.meshgrid(np.arange(64), np.arange(48))
    expected = Outline(corners).contains_points(np.stack([x.ravel(), y.ravel()], 1)).reshape(48, 64)
    assert np.array_equal(polygon_inside([tuple(p) for p in corners], 64, 48), expected)


def test_whole_number_corners_count_every_pixel_once() -> None:
    left = polygon_inside([(0, 0), (10, 0), (10, 20), (0, 20)], 30, 30)
    right = polygon_inside([(10, 0), (25, 0), (25, 20), (10, 20)], 30, 30)
    assert left.sum() == 200 and right.sum() == 300 and not (left & right).any()


def test_kept_parts_are_all_that_is_left_and_excluded_ones_go_first() -> None:
    keep = Polygon(((5, 5), (40, 5), (40, 40), (5, 40)), "kept")
    hole = Polygon(((10, 10), (20, 10), (20, 20), (10, 20)))
    for order in ((keep, hole), (hole, keep)):
        assert rasterised(order, 64, 48).sum() == 35 * 35 - 100
    assert rasterised([hole], 64, 48).sum() == 64 * 48 - 100
    assert rasterised([], 64, 48).all()


def test_masks_come_back_from_their_file_and_damaged_files_are_refused(tmp_path: Path) -> None:
    masks = {
        "Straße ß.jpg": PhotoMask((Polygon(TRIANGLE), Polygon(TRIANGLE, "kept"))),
        "none.jpg": PhotoMask(),
    }
    write_masks(tmp_path, masks)
    assert read_masks(tmp_path) == {"Straße ß.jpg": masks["Straße ß.jpg"]}
    assert read_masks(tmp_path / "elsewhere") == {}
    text = (tmp_path / "masks.toml").read_text("utf-8")
    for change, says in ((("kept", "keep"), "not “keep”"), (("schema = 1", "schema = 7"), "schema 7"),
                         (("10.5", "nan"), "numbers in px"), (("name =", "nam ="), "“name” is missing"),
                         (("[[photo]]", "[[photo"), "line")):  # fmt: skip
        assert change[0] in text
        (tmp_path / "masks.toml").write_text(text.replace(*change, 1), "utf-8")
        with pytest.raises(UserError, match=says):
            read_masks(tmp_path)


def test_a_picture_outside_the_project_is_refused(tmp_path: Path) -> None:
    write_masks(tmp_path, {"a.jpg": PhotoMask(picture="x.png")})
    path = tmp_path / "masks.toml"
    path.write_text(path.read_text("utf-8").replace("x.png", "../x.png"), "utf-8")
    with pytest.raises(UserError, match="not the name of a file"):
        read_masks(tmp_path)


def test_pictures_are_found_under_the_usual_names_and_combined_with_polygons(tmp_path: Path) -> None:
    photos = [photo("a.jpg"), photo("b.JPG"), photo("c.png"), photo("d.tif"), photo("e.jpg")]
    source, project = tmp_path / "source", tmp_path / "project"
    (source / "masks").mkdir(parents=True)
    free = np.full((48, 64), 255, np.uint8)
    free[:10] = 0
    for name in ("a_mask.png", "b.JPG.mask.png", "masks/c.png", "masks/d.tif.png"):
        cv2.imwrite(str(source / name), free)
    cv2.imwrite(str(source / "e_mask.png"), free[:40])
    write_masks(project, {"a.jpg": PhotoMask((Polygon(TRIANGLE),))})
    taken, failures = import_masks(source, project, photos)
    assert taken == ["a.jpg", "b.JPG", "c.png", "d.tif"]
    assert failures[0].item == "e_mask.png" and "64 × 40 px" in failures[0].reason
    masks = read_masks(project)
    for item in photos[:4]:
        found = photo_mask(project, masks[item.name], item)
        expected = (free > 0) & (~polygon_inside(TRIANGLE, 64, 48) if item.name == "a.jpg" else True)
        assert np.array_equal(found, expected)


def test_one_picture_is_the_mask_of_all_photos_and_follows_turned_ones(tmp_path: Path) -> None:
    free = np.zeros((64, 48), bool)  # of the photo as stored, lying
    free[:20, :30] = True
    Image.fromarray(free).save(tmp_path / "frame.png")
    lying, upright = photo("a.jpg", (64, 48), orientation=6), photo("b.jpg", (48, 64))
    taken, failures = import_masks(tmp_path / "frame.png", tmp_path / "p", [lying, upright])
    assert taken == ["a.jpg", "b.jpg"] and not failures
    masks = read_masks(tmp_path / "p")
    assert np.array_equal(photo_mask(tmp_path / "p", masks["b.jpg"], upright), free)
    assert np.array_equal(photo_mask(tmp_path / "p", masks["a.jpg"], lying), np.rot90(free, -1))
    with pytest.raises(UserError, match="no mask for any"):
        (tmp_path / "empty").mkdir()
        import_masks(tmp_path / "empty", tmp_path / "p", [lying])


def test_mask_pictures_beside_photos_are_no_photos(tmp_path: Path) -> None:
    assert is_mask_picture("a_mask.png", ["a.jpg", "a_mask.png"])
    assert not is_mask_picture("a_mask.png", ["b.jpg", "a_mask.png"])
    assert not is_mask_picture("carnival_mask.png", ["carnival_mask.png"])
    pixels = np.random.default_rng(0).integers(0, 255, (48, 64, 3), dtype=np.uint8)
    Image.fromarray(pixels).save(tmp_path / "a.jpg")
    Image.fromarray(pixels[:, :, 0]).save(tmp_path / "a.mask.png")
    assert [p.name for p in read_photo_set(tmp_path, run=Run()).photos] == ["a.jpg"]


def test_masked_parts_get_no_keypoints_and_no_depth(small_project: Project, tmp_path: Path) -> None:
    names = [p.name for p in small_project.photo_set.photos]
    project = Project.create(tmp_path / "model", small_project.photos_folder,
                             control=small_project.folder / small_project.settings.control)  # fmt: skip
    recipe = Recipe.default().set("dense.multiview.image_size=320")
    before = Pipeline(project, recipe)
    keys = {step: before.key(step) for step in ("images", "keypoints", "depth")}
    half = Polygon(((-5, -5), (250.0, -5), (250.0, 500), (-5, 500)))
    write_masks(project.folder, {names[0]: PhotoMask((half,)), "gone.jpg": PhotoMask((half,))})
    pipeline = Pipeline(project, recipe)
    assert pipeline.key("images") == keys["images"]
    assert pipeline.key("keypoints") != keys["keypoints"] and pipeline.key("depth") != keys["depth"]
    run = Run(threads=2)
    pipeline.run("dense", run)
    features = pipeline.value("keypoints")
    assert len(features[0].xy) > 100 and features[0].xy[:, 0].min() > 249.4
    assert features[1].xy[:, 0].min() < 100
    maps = {m.photo: m for m in pipeline.value("depth")}
    known = np.isfinite(maps[0].depth)
    assert known[:, 130:].sum() > 1000 and not known[:, : 250 // 2].any()
    assert np.isfinite(maps[1].depth)[:, : 250 // 2].sum() > 1000
    write_masks(project.folder, {})
    assert Pipeline(project, recipe).key("keypoints") == keys["keypoints"]


def test_a_mask_that_covers_everything_is_told_and_the_set_goes_on(
    small_project: Project, tmp_path: Path
) -> None:
    project = Project.create(tmp_path / "model", small_project.photos_folder)
    name = project.photo_set.photos[2].name
    write_masks(project.folder, {name: PhotoMask((Polygon(((-9, -9), (999, -9), (999, 999), (-9, 999))),))})
    run, pipeline = Run(threads=2), Pipeline(project, Recipe.default())
    pipeline.run("adjustment", run)
    assert any(name in warning and "covers the whole photo" in warning for warning in run.warnings)
    oriented = pipeline.value("adjustment").adjustment.block.oriented
    assert oriented.tolist() == [True, True, False, True, True]
    assert pipeline.value("keypoints")[2].descriptors.shape[1] == 128
