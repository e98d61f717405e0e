"""Depth maps and clouds of a relief with known depth, see conftest.py."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from graphos_core.data import Cloud, DepthMap
from graphos_core.dense.depth_maps import MultiViewParams, multiview
from graphos_core.dense.fusion import FusionParams, consistent
from graphos_core.dense.neighbours import angle_weight, choose_neighbours
from graphos_core.errors import Stopped, UserError
from graphos_core.run import Run

PARAMS = MultiViewParams(image_size=320, levels=3)


@pytest.fixture(scope="module")
def maps(relief: Any) -> tuple[DepthMap, ...]:
    return multiview(relief.block, relief.read, PARAMS, run=Run(threads=2))


@pytest.fixture(scope="module")
def cloud(relief: Any, maps: tuple[DepthMap, ...]) -> Cloud:
    return consistent(relief.block, maps, relief.read, FusionParams(), run=Run())


def test_depths_agree_with_the_truth_to_half_a_pixel_on_the_object(
    relief: Any, maps: tuple[DepthMap, ...]
) -> None:
    for found in maps:
        truth = relief.depth_of(found)
        known = np.isfinite(found.depth)
        error = np.abs(found.depth - truth)[known] / relief.gsd
        assert known.mean() > 0.75
        assert np.median(error) < 0.5
        assert np.quantile(error, 0.9) < 1.5


def test_ground_that_the_plate_hides_from_the_other_photos_is_removed(
    relief: Any, maps: tuple[DepthMap, ...]
) -> None:
    for found in maps:
        seen = relief.seen_by_others(found)
        known = np.isfinite(found.depth)
        assert known[seen == 0].mean() < 0.25  # only where the surface bridges a few pixels at edges
        assert known[seen >= 4].mean() > 0.85


def test_the_cloud_lies_on_the_surface_with_normals_and_colours(relief: Any, cloud: Cloud) -> None:
    error = np.abs(relief.height_error(cloud.points)) / relief.gsd
    assert np.median(error) < 0.4
    assert np.quantile(error, 0.9) < 1.5
    assert cloud.unit == "m"
    assert cloud.views.min() >= 2
    np.testing.assert_allclose(np.linalg.norm(cloud.normals, axis=1), 1.0, atol=1e-5)
    assert np.median(cloud.normals[:, 2]) > 0.9  # towards the cameras
    assert cloud.colours.std() > 10


def test_each_point_is_made_once(relief: Any, maps: tuple[DepthMap, ...], cloud: Cloud) -> None:
    pixels = sum(int(np.isfinite(m.depth).sum()) for m in maps)
    assert len(cloud.points) < 0.6 * pixels
    assert cloud.views.mean() > 2.5


def test_one_and_two_threads_give_the_same_bits(relief: Any, maps: tuple[DepthMap, ...]) -> None:
    again = multiview(relief.block, relief.read, PARAMS, run=Run(threads=1))
    for first, second in zip(maps, again, strict=True):
        np.testing.assert_array_equal(first.depth, second.depth)
        np.testing.assert_array_equal(first.confidence, second.confidence)


def test_it_stops_when_asked(relief: Any) -> None:
    run = Run()
    run.stop()
    with pytest.raises(Stopped):
        multiview(relief.block, relief.read, PARAMS, run=run)


def test_photos_without_common_points_are_refused_in_plain_words(relief: Any) -> None:
    none = np.empty(0, np.int32)
    lonely = replace(relief.block, obs_photo=none, obs_point=none, obs_xy=np.empty((0, 2)))
    with pytest.raises(UserError, match="neighbour"):
        multiview(lonely, relief.read, PARAMS, run=Run())


def test_good_neighbours_see_the_object_under_ten_to_twenty_degrees(relief: Any) -> None:
    assert angle_weight(np.radians([15.0])) == 1.0
    assert angle_weight(np.radians([1.0])) < 0.05
    assert angle_weight(np.radians([60.0])) < 0.05
    for place in choose_neighbours(relief.block, 3):
        depth = relief.depths[place.photo]
        assert len(place.neighbours) == 3
        assert place.near < np.quantile(depth, 0.02)
        assert place.far > np.quantile(depth, 0.98)
