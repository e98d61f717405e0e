"""Orientation that goes on from a given one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from graphos_core.adjustment.orientation.given import GivenParams, orient_from_given
from graphos_core.data import Block, Camera
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_core.simulation.model import NoiseParams, TheoreticalModel, theoretical_model
from graphos_core.simulation.objects import ObjectParams, terrain
from graphos_core.simulation.templates import GridParams, place
from graphos_core.simulation.tie_points import simulated_tie_points as case

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]))

FIXED = GivenParams(self_calibration=False)


def exact_model(sigma_px: float = 0.0) -> TheoreticalModel:
    ground = terrain(ObjectParams(size=40.0, count=1500, relief=4.0))
    return theoretical_model(
        place("grid", GridParams()), CAMERA, ground, NoiseParams(sigma_px=sigma_px), seed=1
    )


def given(model: TheoreticalModel, photos: int, sigma_rad: float = 0.0, sigma_m: float = 0.0) -> Block:
    """The true orientation of the first photos in metres, with errors, under other folder names."""
    rng = np.random.default_rng(1)
    n = len(model.stations.names)
    block = model.as_block()
    turns = [matrix_from_vector(v) for v in rng.normal(0, sigma_rad, (n, 3))]
    return replace(
        block,
        names=tuple(f"images/{name}.jpg" for name in model.stations.names),
        oriented=np.arange(n) < photos,
        rotations=np.einsum("nij,njk->nik", turns, model.stations.rotations),
        centres=model.stations.centres + rng.normal(0, sigma_m, (n, 3)),
        unit="m",
    )


def test_a_rough_orientation_is_improved_and_the_other_photos_are_added_in_its_frame() -> None:
    model = exact_model()
    start = given(model, photos=6, sigma_rad=5e-4, sigma_m=0.005)
    block = orient_from_given(*case(model), FIXED, run=Run(threads=1), given=start)
    assert block.oriented.all() and block.unit == "m"
    assert np.abs(block.centres - model.stations.centres).max() < 0.05
    assert np.abs(block.points - model.points[block.point_track]).max() < 0.1
    assert block.tree is not None and block.tree.method[:6] == ("given",) * 6
    assert len(block.points) > 0.9 * len(model.points)


def test_only_the_given_photos_where_that_is_asked_for() -> None:
    model = exact_model()
    block = orient_from_given(
        *case(model), FIXED.replace(add_photos=False), run=Run(threads=1), given=given(model, 6)
    )
    assert np.flatnonzero(block.oriented).tolist() == list(range(6))
    assert len(block.failures) == len(block.names) - 6


def test_its_calibration_is_taken_or_not() -> None:
    model = exact_model(sigma_px=0.3)
    guess = replace(CAMERA, values=np.array([1510.0, 799.5, 599.5, 0.0, 0.0]))
    photos, tracks, pairs = case(model, guess)
    taken = orient_from_given(photos, tracks, pairs, FIXED, run=Run(threads=1), given=given(model, 12))
    assert taken.cameras[0].values.tolist() == CAMERA.values.tolist()
    own = FIXED.replace(given_calibration=False, reprojection_px=30.0)
    block = orient_from_given(photos, tracks, pairs, own, run=Run(threads=1), given=given(model, 12))
    assert block.cameras[0].focal_px == 1510.0


def test_what_cannot_start_is_said() -> None:
    model = exact_model()
    photos, tracks, pairs = case(model)
    wrong = given(model, 12)
    swapped = given(model, 12, sigma_rad=0.3)
    stranger = replace(wrong, names=tuple(f"x{i}.jpg" for i in range(12)))
    for block, said in (
        (None, "no given orientation"),
        (swapped, "does not fit"),
        (stranger, "0 of the 12 photos"),
    ):
        with pytest.raises(UserError, match=said) as refused:
            orient_from_given(photos, tracks, pairs, FIXED, run=Run(threads=1), given=block)
        assert refused.value.why and refused.value.todo


def test_a_project_keeps_a_given_orientation_and_its_pipeline_hands_it_over(
    small_simulation: Path, tmp_path: Path
) -> None:
    project = Project.create(tmp_path / "model", small_simulation / "photos")
    start = given(exact_model(), 12)
    assert project.given_orientation() is None
    kept = project.with_orientation(start, "another program")
    back = Project.open(tmp_path / "model").given_orientation()
    assert back is not None and np.array_equal(back.centres, start.centres) and back.names == start.names
    recipe = Recipe.default()
    chosen = recipe.set("adjustment.orientation=given")
    keys = {Pipeline(p, r).key("orientation") for p in (project, kept) for r in (recipe, chosen)}
    assert len(keys) == 3  # the incremental one does not care what is kept, the other one does
    other = kept.with_orientation(replace(start, centres=start.centres + 1.0), "another run")
    assert other.settings.orientation != kept.settings.orientation
