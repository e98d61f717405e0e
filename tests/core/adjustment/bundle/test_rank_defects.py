"""What the observations leave free is said by name, with a remedy, and no promised number is NaN."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.known.points import Coordinates, Distances
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.bundle.rank import with_names
from graphos_core.adjustment.bundle.schur import adjust
from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.cameras import camera_model, pixel_from_ray
from graphos_core.data import Adjustment, Block, Camera, Finding, Known
from graphos_core.run import Run

RANK = "adjustment/rank-defects"


def rank_findings(found: Adjustment) -> list[Finding]:
    return [finding for finding in found.findings if finding.learn == RANK]


def assert_numbers(found: Adjustment) -> None:
    """Nothing is NaN where a number is promised."""
    assert found.covariance is not None and found.reliability is not None
    r = found.reliability
    arrays = [found.residuals, found.weights, found.sigma_rotations, found.sigma_centres, found.sigma_points,
              found.covariance.photos, found.covariance.points, *found.covariance.cameras, r.redundancy,
              r.standardised, r.studentised, r.mdb_px, r.effect, np.array([found.sigma0, found.rms_px])]  # fmt: skip
    assert not any(np.isnan(array).any() for array in arrays)


def without(block: Block, drop: np.ndarray) -> Block:
    keep = ~drop
    return replace(
        block, obs_photo=block.obs_photo[keep], obs_point=block.obs_point[keep], obs_xy=block.obs_xy[keep]
    )


def seen_once(block: Block, points: Iterable[int]) -> Block:
    """Leave the points only the first of their rays."""
    drop = np.zeros(len(block.obs_point), dtype=bool)
    for point in points:
        drop[np.flatnonzero(block.obs_point == point)[1:]] = True
    return without(block, drop)


@pytest.mark.parametrize("line", [True, False], ids=["on one line", "two points"])
def test_a_photo_that_hangs_on_too_little_is_named(make_block, line: bool) -> None:
    truth: Block = make_block(points=60).truth
    points, tied = np.array(truth.points), np.arange(12 if line else 2) + 20
    if line:
        points[tied] = np.linspace([-0.6, -0.4, 0.2], [0.5, 0.7, -0.3], len(tied))
    xy, photo = np.array(truth.obs_xy), 3
    for n in range(len(truth.names)):
        mine = (truth.obs_photo == n) & np.isin(truth.obs_point, tied)
        seen = points[truth.obs_point[mine]] - truth.centres[n]
        xy[mine] = pixel_from_ray(truth.cameras[0], seen @ truth.rotations[n].T)
    block = replace(truth, points=points, obs_xy=xy)
    block = without(block, (block.obs_photo == photo) & ~np.isin(block.obs_point, tied))
    noise = np.random.default_rng(1).normal(0.0, 0.3, block.obs_xy.shape)
    fixed = np.arange(len(points)) < 10
    others = block.obs_photo != photo  # the line itself stays exact: noise would make it a thin band
    block = replace(
        block, obs_xy=block.obs_xy + noise * others[:, None] * ~np.isin(block.obs_point, tied)[:, None]
    )
    found = adjust_block(block, Freedom(fixed_points=fixed), Options(reliability=True, tolerance=1e-14))
    said = rank_findings(found)
    assert said and all(finding.severity == "error" for finding in said)
    assert {item for finding in said for item in finding.items} == {"photo 3"}
    assert "Add tie points" in said[0].todo and "photo 3: " in said[0].why
    assert found.sigma_centres[photo].max() > 1e3 * np.delete(found.sigma_centres, photo, axis=0).max()
    assert_numbers(found)


def flat_block(noise_px: float) -> Block:
    """Nine parallel photos straight down on a plane: the principal distance goes with the flying height."""
    camera = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, 0.0, 0.0]))
    grid = np.stack(np.meshgrid(np.linspace(-4, 4, 9), np.linspace(-4, 4, 9)), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid, np.zeros(len(grid))])
    down = np.diag([1.0, -1.0, -1.0])
    centres = np.array([[x, y, 6.0] for x in (-2.0, 0.0, 2.0) for y in (-2.0, 0.0, 2.0)])
    rows = []
    for n, centre in enumerate(centres):
        pixel = pixel_from_ray(camera, (points - centre) @ down.T)
        inside = (pixel > 0).all(axis=1) & (pixel < [1599, 1199]).all(axis=1)
        rows += [(p, n, *pixel[p]) for p in np.flatnonzero(inside)]
    table = np.array(sorted(rows))
    noise = np.random.default_rng(5).normal(0.0, 1.0, (len(table), 2)) * noise_px
    return Block(
        cameras=(camera,), names=tuple(f"down {n}" for n in range(9)), camera_of_photo=np.zeros(9, np.int32),
        oriented=np.ones(9, dtype=bool), rotations=np.stack([down] * 9), centres=centres, points=points,
        colours=np.zeros((len(points), 3), dtype=np.uint8), point_track=np.arange(len(points), dtype=np.int32),
        obs_photo=table[:, 1].astype(np.int32), obs_point=table[:, 0].astype(np.int32), obs_xy=table[:, 2:] + noise,
    )  # fmt: skip


def test_the_principal_distance_of_parallel_photos_of_a_plane_is_frozen_with_a_reason() -> None:
    heard = Run(threads=1)
    found = adjust(flat_block(0.3), Known(), BundleParams(), run=heard)
    frozen = [finding for finding in rank_findings(found) if "Principal distance" in finding.what]
    assert len(frozen) == 1 and "held at its start value" in frozen[0].what
    camera = found.block.cameras[0]
    assert camera.values[0] == 1500.0 and camera.sigmas is not None and camera.sigmas[0] == 0.0
    assert any("Principal distance" in warning for warning in heard.warnings)
    assert_numbers(found)


def test_the_precision_of_an_exactly_undetermined_parameter_is_not_feigned(make_block) -> None:
    truth: Block = make_block(points=60).truth
    values = np.array([1500.0, 805.0, 592.0, *np.zeros(len(camera_model("complete").parameters) - 3)])
    camera = Camera(
        model="complete", width=1600, height=1200, values=values
    )  # no distortion: no place of its centre
    found = adjust_block(replace(truth, cameras=(camera,)), Freedom(interior=(("focal_px", "x1"),)),
                         Options(reliability=True, max_iterations=3))  # fmt: skip
    (said,) = rank_findings(found)
    label = camera_model("complete").parameters[camera_model("complete").index("x1")].label
    assert said.items == ("Camera 1",) and label in said.why and "fixed" in said.todo
    sigmas = dict(zip(camera_model("complete").names, found.block.cameras[0].sigmas, strict=True))
    assert sigmas["x1"] > 1e6 and 0.0 < sigmas["focal_px"] < 50.0
    assert_numbers(found)


def test_points_seen_once_whose_coordinates_nothing_gives_are_named(make_block) -> None:
    block = seen_once(make_block(points=60).start, (30, 31))
    fixed = np.arange(60) < 10
    block = replace(block, cameras=make_block(points=60).truth.cameras,
                    points=np.where(fixed[:, None], make_block(points=60).truth.points, block.points))  # fmt: skip
    apart = Distances(np.array([30]), np.array([31]), np.array([1.0]), np.array([0.01]), ["a–b"])
    found = adjust_block(block, Freedom(fixed_points=fixed), Options(reliability=True), (apart,))
    (said,) = rank_findings(found)
    assert set(said.items) == {"point 30", "point 31"} and "Measure the point in another photo" in said.todo
    others = np.delete(found.sigma_points, (30, 31), axis=0)
    assert found.sigma_points[30].max() > 1e3 * others.max()
    assert found.redundancy == found.observations - found.unknowns
    assert_numbers(found)
    (named,) = with_names((said,), {"T1": 30})
    assert set(named.items) == {"T1", "point 31"} and "T1: " in named.why and "point 30" not in named.why


@pytest.mark.parametrize(
    ("known", "free", "remedy"),
    [
        ("nothing", "Scale and position and rotation", "give one distance"),
        ("one point", "Scale and rotation", "give one distance"),
        ("two points", "Rotation", "control points"),
        ("a distance", "Position and rotation", "three coordinates"),
        ("one coordinate", "Scale and position and rotation", "three coordinates"),
    ],
)
def test_what_the_whole_block_may_still_do_is_said_with_a_remedy(make_block, known, free, remedy) -> None:
    made = make_block(points=60)
    fixed = np.arange(60) < {"one point": 1, "two points": 2}.get(known, 0)
    groups = {
        "a distance": (Distances(np.array([1]), np.array([2]), np.array([1.0]), np.array([0.01]), ["a–b"]),),
        "one coordinate": (Coordinates(np.array([1]), np.array([2]), np.array([0.5]), np.array([0.01]), ["a Z"]),),
    }.get(known, ())  # fmt: skip
    found = adjust_block(
        made.truth, Freedom(fixed_points=fixed), Options(reliability=True, max_iterations=5), groups
    )
    (said,) = [finding for finding in found.findings if finding.learn == "adjustment/datum"]
    assert said.what.startswith(f"{free} of the whole block") and remedy in said.todo
    assert said.severity == "info" and not rank_findings(found)
