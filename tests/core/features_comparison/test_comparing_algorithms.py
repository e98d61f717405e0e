"""The comparison as a whole: rows, sweeps, truth, the command line, and what is refused."""

import csv
import json
from dataclasses import asdict
from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.cli import main
from graphos_core.compare_features_command import photos_in_order
from graphos_core.errors import ParamError, UserError
from graphos_core.features_comparison.compare import compare_features
from graphos_core.features_comparison.records import DEFINITIONS, Row
from graphos_core.features_comparison.variants import variants
from graphos_core.run import Run

H = np.array([[0.9, -0.2, 45.0], [0.2, 0.9, -20.0], [1e-4, 0.0, 1.0]])
CONTRACT = ("algorithm", "keypoints", "time_s", "matches", "verified", "inlier_share", "coverage", "correct_3px",
            "correct_cells_2px", "repeatability")  # fmt: skip


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two photos of a texture, the second warped by `H`, named against the order of the alphabet."""
    folder = tmp_path_factory.mktemp("two photos ä")
    rng = np.random.default_rng(0)
    layers = [
        cv2.GaussianBlur(rng.uniform(-1, 1, (300, 400)).astype(np.float32), (0, 0), s) * s for s in (1.5, 4.0)
    ]
    first = cv2.normalize(sum(layers), None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)
    second = cv2.warpPerspective(first, H, (400, 300))
    cv2.imwrite(str(folder / "b.png"), first)
    cv2.imwrite(str(folder / "a.png"), second)
    np.savetxt(folder / "h.txt", H)
    return folder


def compared(pair: Path, names: str, **more: object):
    photos = photos_in_order([pair / "b.png", pair / "a.png"], Run())
    return compare_features(photos, variants(names.split(",")), run=Run(), **more)


def without_times(row: Row) -> dict[str, object]:
    return {k: v for k, v in asdict(row).items() if k not in ("time_s", "seconds")}


def test_rows_know_what_is_right_and_do_not_depend_on_threads(pair: Path) -> None:
    found = compared(pair, "sift,orb", homography=H)
    assert found.photos == ("b.png", "a.png")  # as named, not by name
    for row in found.rows:
        assert row.precision is not None and row.precision > 0.8
        assert 50 < row.correct_cells_2px <= row.correct_3px <= row.matches
        assert 0.5 < row.repeatability <= 1.0
        assert row.verified > 0.7 * row.matches and row.inlier_share == row.verified / row.matches
        assert row.time_s == pytest.approx(sum(row.seconds.values()))
        assert (
            row.keypoints == sum(row.keypoints_per_photo)
            and row.mean_rays == 2.0
            and row.photos_connected == 2
        )
    photos = photos_in_order([pair / "b.png", pair / "a.png"], Run())
    again = compare_features(photos, variants(["sift", "orb"]), run=Run(threads=1), homography=H)
    assert [without_times(r) for r in again.rows] == [without_times(r) for r in found.rows]


def test_without_truth_its_figures_are_missing_with_the_reason(pair: Path) -> None:
    found = compared(pair, "akaze")
    (row,) = found.rows
    assert row.verified > 50
    assert row.correct_3px is row.correct_cells_2px is row.repeatability is row.precision is None
    assert "homography" in found.no_truth
    assert found.to_dict()["truth"] == {"known": False, "reason": found.no_truth}


def test_a_disturbed_photo_is_matched_worse_the_more_it_is_disturbed(pair: Path) -> None:
    found = compared(pair, "orb", against=("blur", "rotation"))
    blur, turned = found.curves
    assert blur.matching_score[0] > 0.5 > 0.3 > blur.matching_score[-1]
    assert min(turned.matching_score) > 0.2  # ORB turns with the photo
    assert blur.correct[0] > 100


def test_sweeps_give_a_row_per_combination() -> None:
    found = variants(
        ["sift", "orb"],
        [
            "features.sift.contrast=0.02,0.04",
            "features.mutual.ratio=0.7,0.9",
            "features.detector.maximum=500",
        ],
    )
    assert [v.label for v in found] == [
        "sift contrast=0.02 ratio=0.7", "sift contrast=0.02 ratio=0.9", "sift contrast=0.04 ratio=0.7",
        "sift contrast=0.04 ratio=0.9", "orb ratio=0.7", "orb ratio=0.9",
    ]  # fmt: skip
    assert {v.recipe.params("features", v.detector).maximum for v in found} == {500}
    assert found[1].recipe.params("features", "mutual").ratio == 0.9
    assert dict(found[0].changes) == {"sift.contrast": "0.02", "mutual.ratio": "0.7", "sift.maximum": "500"}
    assert [v.label for v in variants(["sift"], ["preprocessing.filter=wallis,grey+wallis"])] == [
        "sift wallis", "sift grey+wallis",
    ]  # fmt: skip


def test_sweeps_of_a_matcher_find_key_points_once(pair: Path) -> None:
    photos = photos_in_order([pair / "b.png", pair / "a.png"], Run())
    rows = compare_features(photos, variants(["orb"], ["features.mutual.ratio=0.6,0.9"]), run=Run()).rows
    assert rows[0].seconds["detection"] == rows[1].seconds["detection"]
    assert rows[0].matches < rows[1].matches


@pytest.mark.parametrize(("names", "assignments", "why"), [
    (["surf"], [], "Unknown detector “surf”"), ([], [], "nothing to compare"),
    (["sift"], ["features.orb.levels=2"], "changes nothing"), (["sift"], ["contrast=1"], "not an assignment"),
    (["sift"], ["features.detector=orb"], "not set, they are compared"),
    (["sift"], ["adjustment.bundle=schur"], "changes nothing"), (["sift"], ["features.sift.contrast="], "not an assignment"),
])  # fmt: skip
def test_what_cannot_be_compared_is_refused_with_the_reason(
    names: list[str], assignments: list[str], why: str
) -> None:
    with pytest.raises(UserError, match=why):
        variants(names, assignments)


def test_a_wrong_parameter_is_refused_with_what_is_possible() -> None:
    with pytest.raises(ParamError, match="Unknown parameter"):
        variants(["sift"], ["features.sift.size=3"])
    with pytest.raises(ParamError, match="needs"):
        variants(["sift"], ["features.sift.contrast=0.02,7"])


def test_one_photo_needs_something_to_be_matched_with(pair: Path) -> None:
    photos = photos_in_order([pair / "a.png"], Run())
    with pytest.raises(UserError, match="One photo cannot be matched"):
        compare_features(photos, variants(["orb"]), run=Run())
    alone = compare_features(photos, variants(["orb"]), run=Run(), against=("noise",))
    assert alone.rows[0].keypoints > 100 and alone.rows[0].matches == 0 and len(alone.curves) == 1
    with pytest.raises(UserError, match="exactly two"):
        compare_features(photos, variants(["orb"]), run=Run(), homography=H, against=("noise",))


def test_the_command_line_keeps_its_contract(
    pair: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    arguments = ["compare", "features", str(pair / "b.png"), str(pair / "a.png"), "--algorithms", "orb,brisk",
                 "--homography", str(pair / "h.txt"), "--against", "light", "--out", str(out), "--threads", "2"]  # fmt: skip
    assert main(arguments) == 0
    data = json.loads((out / "comparison.json").read_text("utf-8"))
    assert [row["algorithm"] for row in data["rows"]] == ["orb", "brisk"]
    for row in data["rows"]:
        assert all(row[key] is not None for key in CONTRACT)
    assert set(data["definitions"]) == set(DEFINITIONS)
    assert [c["disturbance"] for c in data["curves"]] == ["light", "light"]
    table = list(csv.DictReader((out / "comparison.csv").open(encoding="utf-8")))
    assert [int(line["correct_3px"]) for line in table] == [row["correct_3px"] for row in data["rows"]]
    page = (out / "comparison.html").read_text("utf-8")
    assert "orb" in page and "data:image/svg+xml" in page
    for name in (
        "comparison.png",
        "comparison.svg",
        "disturbances.png",
        "disturbances.svg",
        "disturbances.csv",
    ):
        assert (out / name).stat().st_size > 300
    said = capsys.readouterr().out
    assert "correct, per cell" in said and "brisk" in said


@pytest.mark.parametrize(("more", "why"), [
    (["--algorithms", "sifft"], "Did you mean “sift”"), (["--homography", "nowhere.xml"], "cannot be used"),
    (["--against", "rain"], "Unknown disturbance"), (["--preset", "pix4d"], "Unknown preset"),
])  # fmt: skip
def test_the_command_line_says_what_is_wrong(
    pair: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str], why: str
) -> None:
    photos = [str(pair / "b.png"), str(pair / "a.png")]
    assert main(["compare", "features", *photos, "--out", str(tmp_path / "out"), *more]) == 1
    assert why in capsys.readouterr().err


def test_the_preset_compares_number_and_time(pair: Path, tmp_path: Path) -> None:
    photos = [str(pair / "b.png"), str(pair / "a.png")]
    assert main(["compare", "features", *photos, "--preset", "arpenteur", "--out", str(tmp_path)]) == 0
    rows = json.loads((tmp_path / "comparison.json").read_text("utf-8"))["rows"]
    assert [row["algorithm"] for row in rows] == ["sift", "akaze", "fast"]
    assert all(row["keypoints"] > 100 and row["time_s"] > 0 for row in rows)
    assert all(row["parameters"][f"{row['detector']}.reduction"] == "1" for row in rows)
