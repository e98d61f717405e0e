"""The quality step with and without a reference."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from graphos_core.data import Adjustment, Block, Camera, Cloud, Georeference, Mesh
from graphos_core.exchange.ply import write_ply_mesh
from graphos_core.quality.stage import assess
from graphos_core.registry import find
from graphos_core.results import AdjustmentResult
from graphos_core.run import Run

ORIGIN = np.array([1000.0, 2000.0, 50.0])


def made(tmp_path: Path, *, method: str, with_reference: bool) -> Any:
    """A stand-in for a pipeline whose cloud lies 0.02 m above a flat reference."""
    camera = Camera(model="pinhole", width=100, height=80, values=np.array([100.0, 49.5, 39.5]))
    empty = np.empty((0, 3))
    block = Block(
        cameras=(camera,), names=("a",), camera_of_photo=np.zeros(1, np.int32), oriented=np.ones(1, bool),
        rotations=np.eye(3)[None], centres=np.zeros((1, 3)), points=empty, colours=np.empty((0, 3), np.uint8),
        point_track=np.empty(0, np.int32), obs_photo=np.empty(0, np.int32), obs_point=np.empty(0, np.int32),
        obs_xy=np.empty((0, 2)), unit="m",
    )  # fmt: skip
    adjustment = Adjustment(
        block=block, sigma0_px=0.5, redundancy=1, observations=2, unknowns=1, datum="", rms_px=0.4,
        residuals=np.empty((0, 2)), weights=np.empty(0), sigma_rotations=np.zeros((1, 3)),
        sigma_centres=np.zeros((1, 3)), sigma_points=empty, iterations=(), converged=True, stop_reason="",
    )  # fmt: skip
    placed = Georeference(
        method=method, scale=1.0, rotation=np.eye(3), translation=np.zeros(3), names=(), check=np.empty(0, bool),
        residuals=empty, rms_m=0.0, check_rms_m=float("nan"), origin=ORIGIN,
    )  # fmt: skip
    xy = np.random.default_rng(1).uniform(-1, 1, (500, 2))
    cloud = Cloud(
        points=np.column_stack([xy, np.full(500, 0.02)]), colours=np.zeros((500, 3), np.uint8),
        normals=np.tile(np.float32([0, 0, 1]), (500, 1)), views=np.full(500, 3, np.uint8), unit="m",
    )  # fmt: skip
    corners = np.array([[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]]) + ORIGIN
    path = tmp_path / "reference.ply"
    write_ply_mesh(
        path, Mesh(vertices=corners, triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32), unit="m")
    )
    values = {
        "adjustment": AdjustmentResult(adjustment=adjustment, georeference=placed),
        "cloud": cloud,
        "matches": SimpleNamespace(pairs=()),
    }
    chosen = {"registration": "placed", "comparison": "nearest"}

    def algorithm(stage: str, role: str) -> tuple[Any, Any]:
        found = find(stage, chosen[role])
        return found, found.params()

    return SimpleNamespace(
        value=values.__getitem__,
        project=SimpleNamespace(reference_path=lambda: path if with_reference else None),
        recipe=SimpleNamespace(algorithm=algorithm),
    )


def test_a_shift_from_the_reference_in_the_control_frame_is_measured(tmp_path: Path) -> None:
    found = assess(made(tmp_path, method="control points", with_reference=True), Run())
    assert found.comparison is not None
    assert found.comparison.statistics["mean"] == pytest.approx(0.02, abs=1e-5)
    assert found.comparison.statistics["std"] < 1e-5
    assert len(found.comparison.distances) == 500
    assert "placed by control" in found.comparison.definition


@pytest.mark.parametrize("method", ["none", "known distance"])
def test_a_model_that_is_not_where_the_reference_is_is_not_compared_and_the_reason_is_said(
    tmp_path: Path, method: str
) -> None:
    found = assess(made(tmp_path, method=method, with_reference=True), Run())
    assert found.comparison is None
    assert any("not compared" in sentence for sentence in found.advice)


def test_without_a_reference_there_are_figures_with_values_or_reasons(tmp_path: Path) -> None:
    found = assess(made(tmp_path, method="control points", with_reference=False), Run())
    assert found.comparison is None
    assert found.figures["sigma0"]["value"] == 0.5
    assert found.figures["gsd"]["value"] is None
    assert found.figures["gsd"]["reason"]
    assert replace(found).advice
