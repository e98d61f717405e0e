"""What cannot be oriented is said in sentences; what is only difficult is oriented."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from graphos_core.adjustment.orientation.hierarchical import HierarchicalParams, orient_hierarchically
from graphos_core.adjustment.orientation.incremental import IncrementalParams, orient_incrementally
from graphos_core.data import Array, Block, Camera, PairMatches, PhotoSet, Tracks
from graphos_core.errors import UserError
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.run import Run
from graphos_core.simulation.model import NoiseParams, TheoreticalModel, theoretical_model
from graphos_core.simulation.objects import ObjectParams, ObjectPoints, terrain
from graphos_core.simulation.templates import GridParams, Stations, place
from graphos_core.simulation.tie_points import simulated_tie_points

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]))
Case = tuple[PhotoSet, Tracks, list[PairMatches]]
Orienting = Callable[..., Block]
WAYS: list[tuple[Orienting, Any]] = [
    (orient_incrementally, IncrementalParams(self_calibration=False)),
    (orient_hierarchically, HierarchicalParams(self_calibration=False)),
]
both = pytest.mark.parametrize(("orient", "params"), WAYS, ids=["incremental", "hierarchical"])


def stations(strips: int = 2, per_strip: int = 3) -> Stations:
    return place("grid", GridParams(strips=strips, per_strip=per_strip))


def photographed(where: Stations, points: ObjectPoints, **noise: float) -> TheoreticalModel:
    return theoretical_model(where, CAMERA, points, NoiseParams(**noise), seed=1)


def ground(relief: float = 4.0) -> ObjectPoints:
    return terrain(ObjectParams(size=40.0, count=1500, relief=relief))


def centre_errors(block: Block, model: TheoreticalModel) -> Array:
    world = estimate_similarity(block.centres, model.stations.centres)
    return np.asarray(world.apply(block.centres) - model.stations.centres)


def refused(orient: Orienting, params: Any, case: Case) -> UserError:
    with pytest.raises(UserError) as said:
        orient(*case, params, run=Run(threads=1))
    assert said.value.what and said.value.why and said.value.todo
    return said.value


@both
def test_photos_without_common_points(orient: Orienting, params: Any) -> None:
    photos, tracks, _ = simulated_tie_points(photographed(stations(), ground()))
    alone = replace(tracks, track=np.arange(len(tracks.track), dtype=np.int32), count=len(tracks.track),
                    colour=np.zeros((len(tracks.track), 3), np.uint8))  # fmt: skip
    assert "verified matches" in str(refused(orient, params, (photos, alone, [])))


@both
def test_photos_that_only_turn_about_one_place_have_no_base(orient: Orienting, params: Any) -> None:
    where = place("grid", GridParams(strips=2, per_strip=3, oblique=20.0))
    still = Stations(
        names=where.names, rotations=where.rotations, centres=np.repeat(where.centres[:1], 6, axis=0)
    )
    model = photographed(still, ground(), sigma_px=0.3)
    error = refused(orient, params, simulated_tie_points(model))
    assert "one place" in error.why and "base" in error.todo


@both
def test_a_plane_is_oriented(orient: Orienting, params: Any) -> None:
    model = photographed(stations(), ground(relief=0.0), sigma_px=0.2)
    block = orient(*simulated_tie_points(model), params, run=Run(threads=1))
    assert block.oriented.all()
    assert np.abs(centre_errors(block, model)).max() < 0.1


@both
def test_ten_percent_of_wrong_matches_hardly_matter(orient: Orienting, params: Any) -> None:
    model = photographed(stations(), ground(), sigma_px=0.3, outlier_share=0.10)
    block = orient(*simulated_tie_points(model), params, run=Run(threads=1))
    assert block.oriented.all()
    assert np.abs(centre_errors(block, model)).max() < 0.05
    kept = np.zeros((len(model.stations.names), len(model.points)), dtype=bool)
    kept[block.obs_photo, block.point_track[block.obs_point]] = True
    rays = np.bincount(model.obs_point)[model.obs_point]
    assert kept[model.obs_photo, model.obs_point][model.outlier & (rays >= 4)].mean() < 0.02


@both
def test_senseless_matches_are_refused(orient: Orienting, params: Any) -> None:
    photos, tracks, pairs = simulated_tie_points(photographed(stations(), ground()))
    xy = np.random.default_rng(0).uniform(0, 1200, tracks.xy.shape)
    assert "start the block" in refused(orient, params, (photos, replace(tracks, xy=xy), pairs)).what


def test_positions_that_are_no_numbers_are_left_out() -> None:
    model = photographed(stations(), ground())
    photos, tracks, pairs = simulated_tie_points(model)
    xy = np.array(tracks.xy)
    xy[::50] = np.nan
    block = orient_incrementally(photos, replace(tracks, xy=xy), pairs, WAYS[0][1], run=Run(threads=1))
    assert block.oriented.all() and np.isfinite(block.obs_xy).all() and np.isfinite(block.points).all()
