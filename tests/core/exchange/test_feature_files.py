"""Keypoints, descriptors and matches out and in again, and as pycolmap reads them."""

from __future__ import annotations

import dataclasses
import sqlite3
from pathlib import Path

import numpy as np
import pytest

from graphos_core.data import Camera, Features, PairMatches
from graphos_core.errors import UserError
from graphos_core.exchange.feature_records import FeatureFiles, PhotoFeatures
from graphos_core.exchange.features_formats import FEATURE_FORMATS, photo_file, read_features, write_features
from graphos_core.features.detectors.imported import ImportedParams, imported
from graphos_core.features.matchers.imported import ImportedMatchesParams, imported_matches
from graphos_core.run import Run

RUN = Run()
NAMES = ("strip 1/ä_01.JPG", "strip 1/ä_02.JPG", "b.png")
CAMERA = Camera(model="basic", width=800, height=600, values=np.array([700.0, 399.5, 299.5, -0.02, 0.003]))
FUNDAMENTAL = np.array([[0.0, -1e-6, 2e-3], [1.2e-6, 0.0, -3e-3], [-2.5e-3, 2.8e-3, 0.9]])


def features(seed: int, count: int = 40) -> Features:
    rng = np.random.default_rng(seed)
    return Features(
        xy=rng.uniform((0, 0), (799, 599), (count, 2)).astype(np.float32), scale=rng.uniform(2, 30, count).astype(np.float32),
        angle=rng.uniform(-3.1, 3.1, count).astype(np.float32), response=rng.uniform(0, 1, count).astype(np.float32),
        descriptors=rng.integers(0, 256, (count, 128), dtype=np.uint8), colour=np.zeros((count, 3), np.uint8),
        width=800, height=600,
    )  # fmt: skip


def pair(a: int, b: int, kind: str, matrix: np.ndarray) -> PairMatches:
    rng = np.random.default_rng(a + 10 * b)
    matches = np.stack([np.sort(rng.permutation(40)[:25]), rng.permutation(40)[:25]], axis=1).astype(np.int32)
    return PairMatches(a=a, b=b, matches=matches, candidates=30, kind=kind, matrix=matrix, threshold_px=4.0)


OWN = tuple(features(seed) for seed in range(3))
FILES = FeatureFiles(
    photos=NAMES, features=tuple(PhotoFeatures.of(own) for own in OWN), cameras=(CAMERA,) * 3,
    pairs=(pair(0, 1, "fundamental", FUNDAMENTAL), pair(1, 2, "homography", np.diag([1.1, 0.9, 1.0]))),
)  # fmt: skip


@pytest.mark.parametrize("name", list(FEATURE_FORMATS))
def test_what_is_written_is_read_again(name: str, tmp_path: Path) -> None:
    write_features(FILES, tmp_path / "out", name)
    found = read_features(tmp_path / "out", NAMES)
    order = [found.photos.index(photo) for photo in NAMES]
    for index, own in zip(order, FILES.features, strict=True):
        got = found.features[index]
        assert got.xy == pytest.approx(own.xy, abs=1e-4)
        assert got.scale == pytest.approx(own.scale, abs=1e-3) and got.angle == pytest.approx(
            own.angle, abs=1e-4
        )
        assert np.array_equal(got.descriptors, own.descriptors) and got.descriptors.dtype == np.uint8
    wanted = {(p.a, p.b): {tuple(m) for m in p.matches.tolist()} for p in FILES.pairs}
    place = dict(zip(order, range(3), strict=True))
    read = {}
    for p in found.pairs:
        a, b = place[p.a], place[p.b]
        read[min(a, b), max(a, b)] = {tuple(m) if a < b else tuple(m[::-1]) for m in p.matches.tolist()}
    assert read == wanted


def test_pycolmap_reads_the_database_with_half_a_pixel_and_the_right_geometry(tmp_path: Path) -> None:
    pycolmap = pytest.importorskip("pycolmap")
    (path,) = write_features(FILES, tmp_path, "colmap")
    database = pycolmap.Database.open(str(path))
    try:
        images = {image.name: image.image_id for image in database.read_all_images()}
        assert set(images) == set(NAMES) and database.num_cameras() == 1
        ids = [images[name] for name in NAMES]
        camera = database.read_all_cameras()[0]
        assert camera.model.name == "RADIAL"
        assert list(camera.params) == pytest.approx([700.0, 400.0, 300.0, -0.02, 0.003])
        keypoints = np.asarray(database.read_keypoints(ids[1]))
        assert keypoints[:, :2] == pytest.approx(FILES.features[1].xy + 0.5, abs=1e-4)
        geometry = database.read_two_view_geometry(ids[0], ids[1])
        first, second = FILES.pairs[0].matches.T
        points = [np.column_stack([FILES.features[i].xy, np.ones(40)]) for i in (0, 1)]
        expected = np.einsum("ni,ij,nj->n", points[1][second], FUNDAMENTAL, points[0][first])
        moved = [p + np.array([0.5, 0.5, 0.0]) for p in points]
        assert np.einsum("ni,ij,nj->n", moved[1][second], geometry.F, moved[0][first]) == pytest.approx(
            expected
        )
        assert np.array_equal(geometry.inlier_matches, FILES.pairs[0].matches)
        assert np.array_equal(database.read_matches(ids[1], ids[2]), FILES.pairs[1].matches)
    finally:
        database.close()


def test_the_imported_detector_and_matcher_give_back_what_was_exported(tmp_path: Path) -> None:
    write_features(FILES, tmp_path, "npz")
    colour = np.zeros((600, 800, 3), np.uint8)
    found = [
        imported(colour[:, :, 0], colour, ImportedParams(source=str(tmp_path)), run=RUN, name=n)
        for n in NAMES
    ]
    by_place = {tuple(np.round(xy, 2)) for xy in found[0].xy}
    assert by_place == {tuple(np.round(xy, 2)) for xy in OWN[0].xy}
    matched = imported_matches(
        found[0], found[1], ImportedMatchesParams(source=str(tmp_path)), run=RUN, names=NAMES[:2]
    )
    assert dict(matched.steps) == {"in file": 25, "found again": 25}
    lines = {(*found[0].xy[i], *found[1].xy[j]) for i, j in matched.matches}
    assert lines == {(*OWN[0].xy[i], *OWN[1].xy[j]) for i, j in FILES.pairs[0].matches}
    other = imported_matches(
        found[1], found[0], ImportedMatchesParams(source=str(tmp_path)), run=RUN, names=(NAMES[1], NAMES[0])
    )
    assert {(j, i) for i, j in other.matches.tolist()} == {tuple(m) for m in matched.matches.tolist()}


def test_masked_keypoints_and_their_matches_stay_away(tmp_path: Path) -> None:
    write_features(FILES, tmp_path, "csv")
    colour, mask = np.zeros((600, 800, 3), np.uint8), np.zeros((600, 800), bool)
    mask[:, :400] = True
    found = [
        imported(colour[:, :, 0], colour, ImportedParams(source=str(tmp_path)), run=RUN, mask=mask, name=n)
        for n in NAMES
    ]
    assert all((own.xy[:, 0] < 400).all() for own in found)
    steps = dict(
        imported_matches(
            found[0], found[1], ImportedMatchesParams(source=str(tmp_path)), run=RUN, names=NAMES[:2]
        ).steps
    )
    assert steps["found again"] < steps["in file"]


def test_names_with_and_without_ending_find_their_file(tmp_path: Path) -> None:
    for name in ("a_x.JPG.npz", "y.csv"):
        (tmp_path / name).touch()
    assert photo_file(tmp_path, "a/x.JPG") == tmp_path / "a_x.JPG.npz"
    assert photo_file(tmp_path, "y.png") == tmp_path / "y.csv"
    assert photo_file(tmp_path, "z.png") is None


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("p.csv", "x [px],y [px]\n1,2\n3\n", "Line 3"),
        ("p.csv", "column,row\n1,2\n", "no columns x and y"),
        ("p.csv", "x,y\n1,nan\n", "Line 2"),
        ("p.txt", "1 128\n1 2 3 wrong\n", "Line 2"),
        ("p.npz", "not a zip", "file of features"),
    ],
)
def test_broken_files_are_refused_with_the_line(name: str, text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(UserError) as refused:
        read_features(tmp_path, ["p"])
    assert said in str(refused.value)


def test_matches_of_keypoints_that_are_not_there_are_refused(tmp_path: Path) -> None:
    (path,) = write_features(FILES, tmp_path, "colmap")
    with sqlite3.connect(path) as database:
        wrong = np.array([[0, 4000]], "<u4").tobytes()
        database.execute("UPDATE two_view_geometries SET rows = 1, data = ?", (wrong,))
    with pytest.raises(UserError, match="a keypoint that is not there"):
        read_features(path)


def test_nothing_is_overwritten_and_cameras_are_needed(tmp_path: Path) -> None:
    write_features(FILES, tmp_path, "colmap")
    with pytest.raises(UserError, match="exists already"):
        write_features(FILES, tmp_path, "colmap")
    with pytest.raises(UserError, match="cameras"):
        write_features(dataclasses.replace(FILES, cameras=()), tmp_path / "more", "colmap")


def test_without_a_source_or_a_photo_there_is_an_explanation(tmp_path: Path) -> None:
    colour = np.zeros((6, 8, 3), np.uint8)
    with pytest.raises(UserError, match="No source"):
        imported(colour[:, :, 0], colour, ImportedParams(), run=RUN, name="a")
    write_features(FILES, tmp_path, "colmap")
    with pytest.raises(UserError, match="no features of"):
        imported(colour[:, :, 0], colour, ImportedParams(source=str(tmp_path)), run=RUN, name="other.png")
