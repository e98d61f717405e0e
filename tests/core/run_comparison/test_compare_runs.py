"""Comparing two adjustments: what was injected is what is found, and nothing else."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.cli import main
from graphos_core.compare_runs import calibration_difference, compare, information, load_compared_run
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.geometry.similarity import Similarity
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run_comparison.loading import LAST_STEP, ComparedRun
from graphos_core.run_comparison.recipes import recipe_difference
from graphos_core.run_comparison.records import CheckDifference
from graphos_core.run_comparison.statement import _accuracy


@pytest.fixture(scope="module")
def folders(small_project: Project, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Two runs of the small block in a project of its own: as it is, and with other parameters."""
    home = tmp_path_factory.mktemp("compared") / "model"
    base = ["adjust", str(small_project.folder), "--out", str(home)]
    other = ["--set", "adjustment.schur.parameters=k2=fixed", "--set", "adjustment.schur.robust=none"]
    found = []
    for words in ([], other):
        assert main([*base, *words]) == 0
        found.append(sorted((home / "runs").iterdir())[-1])
    return found[0], found[1]


def moved(run: ComparedRun, b_from_a: Similarity, order: np.ndarray) -> ComparedRun:
    """The same adjustment in another frame with its points in another order."""
    a = run.adjustment
    rank = np.argsort(order)
    block = replace(
        a.block, rotations=b_from_a.rotate_camera(a.block.rotations), centres=b_from_a.apply(a.block.centres),
        points=b_from_a.apply(a.block.points)[order], obs_point=rank[a.block.obs_point].astype(np.int32),
        point_track=np.full(len(order), -1, np.int32), unit="model units",
    )  # fmt: skip
    sigmas = b_from_a.scale * a.sigma_points[order]
    return ComparedRun("moved", replace(a, block=block, sigma_points=sigmas), run.georeference, run.recipe)


def test_another_datum_and_another_order_of_points_make_no_difference(folders: tuple[Path, Path]) -> None:
    one = load_compared_run(folders[0])
    rng = np.random.default_rng(0)
    b_from_a = Similarity(0.37, matrix_from_vector([0.4, -1.0, 0.3]), np.array([5.0, -2.0, 9.0]))
    found = compare(one, moved(one, b_from_a, rng.permutation(len(one.adjustment.block.points))))
    assert found.frame.moved
    assert found.frame.scale == pytest.approx(1 / 0.37)
    assert found.points.common == len(one.adjustment.block.points)
    assert found.points.only_a == found.points.only_b == 0
    assert found.points.largest < 1e-8
    assert max(abs(v) for p in found.photos for v in p.centre) < 1e-8
    assert max(p.rotation_deg for p in found.photos) < 1e-5
    assert found.points.sigma_a == pytest.approx(found.points.sigma_b)


def test_an_injected_shift_of_one_photo_is_found_in_that_photo_alone(folders: tuple[Path, Path]) -> None:
    one = load_compared_run(folders[0])
    centres = one.adjustment.block.centres.copy()
    centres[2] += [0.01, -0.02, 0.03]
    other = replace(
        one, adjustment=replace(one.adjustment, block=replace(one.adjustment.block, centres=centres))
    )
    found = compare(one, other)
    assert not found.frame.moved, "both are placed by control points"
    assert found.photos[2].centre == pytest.approx((0.01, -0.02, 0.03))
    assert all(p.centre == (0.0, 0.0, 0.0) for i, p in enumerate(found.photos) if i != 2)
    assert [n.b for n in found.numbers if n.key == "photos"] == [5]


def test_significance_uses_the_sigma_of_both(folders: tuple[Path, Path]) -> None:
    one = load_compared_run(folders[0])
    camera = one.adjustment.block.cameras[0]
    assert camera.sigmas is not None
    for factor, significant in ((2.7, False), (2.9, True)):  # 1.96 √2 = 2.77
        values = camera.values.copy()
        values[0] += factor * camera.sigmas[0]
        block = replace(one.adjustment.block, cameras=(replace(camera, values=values),))
        found = compare(one, replace(one, adjustment=replace(one.adjustment, block=block)))
        assert found.cameras[0].significant is significant
        assert found.cameras[1].significant in (False, None)


def test_calibration_difference_is_what_the_best_rotation_leaves() -> None:
    a = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 805.0, 592.0, -0.12, 0.05]))
    b = replace(a, values=np.array([1503.0, 809.0, 590.0, -0.118, 0.049]))
    x, y = np.linspace(0, 1599, 24), np.linspace(0, 1199, 18)
    pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    rays = ray_from_pixel(a, pixels)

    def misfit(turn: np.ndarray) -> np.ndarray:
        return (pixel_from_ray(b, rays @ matrix_from_vector(turn).T) - pixels).ravel()

    best = np.hypot(*misfit(least_squares(misfit, np.zeros(3)).x).reshape(-1, 2).T)
    found = calibration_difference(a, b)
    assert np.sqrt((found**2).mean()) == pytest.approx(np.sqrt((best**2).mean()), rel=0.02)
    shifted = replace(a, values=a.values + np.array([0.0, 4.0, 0.0, 0.0, 0.0]))
    assert calibration_difference(a, shifted).max() < 2.5, (
        "a rotation takes most of a shift of the principal point"
    )
    assert calibration_difference(a, a).max() < 1e-6


def test_information_criteria_follow_their_formula(folders: tuple[Path, Path]) -> None:
    adjustment = replace(
        load_compared_run(folders[0]).adjustment,
        groups=(),
        observations=1000,
        redundancy=900,
        sigma0=0.5,
        prior_px=1.0,
    )
    aic, bic = information(adjustment)
    fit = 1000 * math.log(0.25 * 900 / 1000)
    assert aic == pytest.approx(fit + 2 * 101)
    assert bic == pytest.approx(fit + 101 * math.log(1000))
    other = replace(adjustment, sigma0=2.0, prior_px=0.25)
    assert information(other) == pytest.approx((aic, bic)), "a common factor on all weights does not matter"


def test_recipe_difference_names_what_differs_and_nothing_else() -> None:
    a = Recipe.default()
    b = a.with_seed(3).set("adjustment.schur.rejection=5").set("preprocessing.filter=wallis")
    found = {(d.where, d.parameter): (d.a, d.b) for d in recipe_difference(a, b)}
    assert found == {
        ("recipe", "seed"): (0, 3), ("preprocessing", "filter"): ("", "wallis"),
        ("adjustment.schur", "rejection"): (4.0, 5.0),
    }  # fmt: skip
    assert recipe_difference(a, a) == ()


def test_runs_of_other_photos_are_refused(folders: tuple[Path, Path]) -> None:
    one = load_compared_run(folders[0])
    names = tuple(f"other {i}" for i in range(len(one.adjustment.block.names)))
    other = replace(one, adjustment=replace(one.adjustment, block=replace(one.adjustment.block, names=names)))
    with pytest.raises(UserError, match="not adjustments of one block"):
        compare(one, other)


def test_the_command_prints_a_table_and_writes_both_files(
    folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", "runs", *map(str, folders), "--out", str(tmp_path / "c")]) == 0
    printed = capsys.readouterr().out
    assert "Robust function" in printed
    assert "AIC" in printed
    found = json.loads((tmp_path / "c" / "comparison.json").read_text("utf-8"))
    assert {d["parameter"] for d in found["recipe"]} == {"parameters", "robust"}
    assert found["statement"]
    assert {"numbers", "cameras", "photos", "points", "check", "frame"} <= set(found)
    page = (tmp_path / "c" / "comparison.html").read_text("utf-8")
    assert "Single parameters" in page


def test_a_project_and_a_stored_result_can_be_compared(folders: tuple[Path, Path]) -> None:
    home = folders[0].parents[1]
    newest = load_compared_run(home)
    again = load_compared_run(folders[1])
    key = json.loads((folders[1] / "report.json").read_text("utf-8"))["results"][LAST_STEP]
    stored = load_compared_run(home / "results" / LAST_STEP / key)
    assert newest.label == again.label
    assert stored.recipe is None
    assert np.array_equal(stored.adjustment.block.points, newest.adjustment.block.points)


@pytest.mark.parametrize("name", ["nothing here", "."])
def test_what_is_no_run_is_refused_in_words(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", "runs", str(tmp_path / name), str(tmp_path)]) == 1
    assert "run" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("factor", "told"),
    [
        (1.0, "no more than chance"),
        (1.2, "no more than chance"),
        (4.0, "A is nearer to the truth by a factor of 4.0"),
    ],
)
def test_check_points_decide_only_beyond_chance(factor: float, told: str) -> None:
    rms = (0.001, 0.002, 0.003)
    check = CheckDifference(6, 6, rms, tuple(factor * v for v in rms))  # type: ignore[arg-type]
    assert told in _accuracy(check)


def test_without_check_points_nobody_is_called_nearer_to_the_truth() -> None:
    assert "nothing independent" in _accuracy(CheckDifference(0, 6, None, (1.0, 1.0, 1.0)))
