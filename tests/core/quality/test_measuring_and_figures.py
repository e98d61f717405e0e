"""Measured quantities with propagated standard deviations; internal figures and advice of a small block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Adjustment, Block, Camera, PairMatches
from graphos_core.geometry.rotation import look_at
from graphos_core.quality import measure
from graphos_core.quality.advice import advice
from graphos_core.quality.internal import image_coverage, internal_figures, point_spacing, widest_angles


def picked(xyz: list[float], sigma: float) -> measure.PickedPoint:
    return measure.PickedPoint(xyz=np.array(xyz), sigma=np.full(3, sigma), unit="m")


def small_block(*, base: float = 2.0) -> Adjustment:
    camera = Camera(model="basic", width=400, height=300, values=np.array([400.0, 199.5, 149.5, -0.05, 0.0]))
    rng = np.random.default_rng(1)
    points = np.column_stack([rng.uniform(-3, 3, (300, 2)), rng.uniform(-0.5, 0.5, 300)])
    centres = np.array([[-base, 0.0, 10.0], [0.0, 0.1, 10.0], [base, 0.0, 10.0]])
    rotations = np.array([look_at(c, np.zeros(3), np.array([0.0, 1.0, 0.0])) for c in centres])
    xy = np.stack(
        [pixel_from_ray(camera, (points - c) @ r.T) for r, c in zip(rotations, centres, strict=True)]
    )
    block = Block(
        cameras=(camera,), names=("a", "b", "c"), camera_of_photo=np.zeros(3, np.int32),
        oriented=np.ones(3, bool), rotations=rotations, centres=centres, points=points,
        colours=np.zeros((300, 3), np.uint8), point_track=np.arange(300, dtype=np.int32),
        obs_photo=np.tile(np.arange(3, dtype=np.int32), 300), obs_point=np.repeat(np.arange(300, dtype=np.int32), 3),
        obs_xy=xy.transpose(1, 0, 2).reshape(-1, 2), unit="m",
    )  # fmt: skip
    return Adjustment(
        block=block, sigma0_px=0.5, redundancy=900, observations=1800, unknowns=900, datum="inner", rms_px=0.4,
        residuals=np.zeros((900, 2)), weights=np.ones(900), sigma_rotations=np.zeros((3, 3)),
        sigma_centres=np.zeros((3, 3)), sigma_points=np.full((300, 3), 0.01), iterations=(), converged=True,
        stop_reason="small step",
    )  # fmt: skip


def test_the_standard_deviation_of_a_distance_agrees_with_simulated_errors() -> None:
    a, b = picked([0.0, 0.0, 0.0], 0.01), picked([3.0, 4.0, 0.0], 0.02)
    found = measure.distance(a, b)
    rng = np.random.default_rng(2)
    d = b.xyz - a.xyz + rng.normal(0, 0.01, (100_000, 3)) + rng.normal(0, 0.02, (100_000, 3))
    assert found.value == pytest.approx(5.0)
    assert found.sigma == pytest.approx(np.linalg.norm(d, axis=1).std(), rel=0.02)


def test_the_standard_deviation_of_an_angle_agrees_with_simulated_errors() -> None:
    points = [picked([2.0, 0.0, 0.5], 0.01), picked([0.0, 0.0, 0.0], 0.02), picked([0.3, 1.5, 0.0], 0.03)]
    found = measure.angle(points[0], points[1], points[2])
    rng = np.random.default_rng(3)
    a, c, b = (p.xyz + rng.normal(0, p.sigma, (100_000, 3)) for p in points)
    u, v = a - c, b - c
    angles = np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v), axis=1), (u * v).sum(axis=1)))
    assert found.unit == "°"
    assert found.value == pytest.approx(angles.mean(), abs=0.05)
    assert found.sigma == pytest.approx(angles.std(), rel=0.03)


def test_without_known_precision_there_is_a_reason_instead() -> None:
    found = measure.distance(measure.point_in_cloud(np.zeros(3), "m"), picked([1.0, 0.0, 0.0], 0.1))
    assert found.sigma is None
    assert "No standard deviation" in found.reason


def test_figures_are_those_of_the_geometry_that_was_made() -> None:
    adjustment = small_block()
    pair = PairMatches(a=0, b=1, matches=np.zeros((5, 2), np.int32), candidates=9, kind="essential",
                       matrix=np.zeros((3, 3)))  # fmt: skip
    figures = internal_figures(adjustment, None, [pair, replace(pair, reason="too few")])
    assert figures["mean_rays"]["value"] == pytest.approx(3.0)
    assert figures["pairs_used"]["value"] == pytest.approx(50.0)
    assert figures["overlap"]["value"] == pytest.approx(2.0)
    assert figures["gsd"]["value"] == pytest.approx(10.0 / 400.0, rel=0.05)
    assert figures["intersection_angle"]["value"] == pytest.approx(22.6, abs=2.0)
    assert figures["point_precision"]["value"] == pytest.approx(0.01)
    assert all(f["value"] is not None or f["reason"] for f in figures.values())


def test_coverage_counts_occupied_cells() -> None:
    block = small_block().block
    everywhere = image_coverage(block)
    left = replace(block, obs_xy=np.column_stack([block.obs_xy[:, 0] / 4.0, block.obs_xy[:, 1]]))
    assert (image_coverage(left) < 0.5 * everywhere).all()


def test_advice_names_what_is_weak() -> None:
    weak = small_block(base=0.1)
    block = replace(weak.block, unit="model units", oriented=np.array([True, True, False]))
    weak = replace(weak, block=block, rms_px=2.0)
    said = " ".join(advice(internal_figures(weak, None, []), weak))
    for word in ("not oriented (c)", "2.00 px", "longer bases", "no scale"):
        assert word in said
    good = small_block()
    assert "usual range" in advice(internal_figures(good, None, []), good)[0]


def test_the_spacing_of_a_grid_is_its_step() -> None:
    x, y = np.meshgrid(np.arange(30.0) * 0.2, np.arange(30.0) * 0.2)
    assert point_spacing(np.column_stack([x.ravel(), y.ravel(), np.zeros(900)])) == pytest.approx(0.2)
    assert len(widest_angles(small_block().block)) == 300
