"""Georeferencing against a block whose place is known: control points, a distance, and what cannot work."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.georeferencing.similarity import (
    SimilarityParams,
    place_by_similarity,
)
from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Array, Block, Camera, Control, ControlObservations, Known, KnownDistance
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.geometry.similarity import Similarity
from graphos_core.run import Run
from graphos_core.simulation.model import NoiseParams, TheoreticalModel, theoretical_model
from graphos_core.simulation.objects import ObjectParams, cube
from graphos_core.simulation.templates import OrbitalParams, place

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]))
PARAMS = SimilarityParams()
MODEL_FROM_WORLD = Similarity(0.2, matrix_from_vector(np.array([0.4, -1.0, 0.7])), np.array([3.0, -1.0, 5.0]))
ORIGIN = np.array([500200.0, 5812400.0, 0.0])


class Heard(Run):
    def __init__(self) -> None:
        super().__init__(threads=1)
        self.warnings: list[str] = []

    def warn(self, text: str) -> None:
        self.warnings.append(text)


@pytest.fixture(scope="module")
def model() -> TheoreticalModel:
    stations = place("orbital", OrbitalParams(axis_x=9, axis_y=9, axis_z=6, equators=1, per_equator=8))
    return theoretical_model(
        stations, CAMERA, cube(ObjectParams(count=400)), NoiseParams(sigma_px=0.3), seed=2
    )


@pytest.fixture(scope="module")
def adjusted(model: TheoreticalModel) -> Block:
    """The block adjusted in a frame of its own, in model units."""
    block = model.as_block()
    block = replace(
        block, unit="model units", points=MODEL_FROM_WORLD.apply(block.points),
        centres=MODEL_FROM_WORLD.apply(block.centres), rotations=MODEL_FROM_WORLD.rotate_camera(block.rotations),
    )  # fmt: skip
    return adjust_block(block).block


def targets(
    model: TheoreticalModel, count: int = 8, noise_px: float = 0.0
) -> tuple[Control, ControlObservations]:
    """Signalised points round the object, measured in every photo; every fourth is a check point."""
    rng = np.random.default_rng(6)
    xyz = rng.uniform(-1.5, 1.5, (count, 3))
    point, photo, xy = [], [], []
    for i, name in enumerate(model.stations.names):
        pixels = pixel_from_ray(CAMERA, (xyz - model.stations.centres[i]) @ model.stations.rotations[i].T)
        for k in range(count):
            point.append(k)
            photo.append(name)
            xy.append(pixels[k] + rng.normal(0, noise_px, 2) if noise_px else pixels[k])
    control = Control(
        names=tuple(f"T{k}" for k in range(count)), xyz=xyz, check=np.arange(count) % 4 == 3, origin=ORIGIN
    )
    return control, ControlObservations(point=np.array(point, np.int32), photo=tuple(photo), xy=np.array(xy))


def some(measured: ControlObservations, keep: Array) -> ControlObservations:
    photo = tuple(name for name, kept in zip(measured.photo, keep, strict=True) if kept)
    return ControlObservations(point=measured.point[keep], photo=photo, xy=measured.xy[keep])


def placed(
    block: Block,
    control: Any,
    measured: Any,
    distance: Any,
    params: SimilarityParams = PARAMS,
    run: Run | None = None,
) -> Any:
    known = Known(control=control, measured=measured, distances=() if distance is None else (distance,))
    return place_by_similarity(block, known, params, run=run or Run(threads=1))


def test_control_points_bring_everything_to_its_place(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model)
    result, reference = placed(adjusted, control, measured, None)
    assert (reference.method, result.unit) == ("control points", "m")
    assert reference.scale == pytest.approx(1 / MODEL_FROM_WORLD.scale, rel=1e-3)
    np.testing.assert_allclose(result.centres, model.stations.centres, atol=0.01)
    np.testing.assert_allclose(result.rotations, model.stations.rotations, atol=2e-3)
    assert reference.names == control.names and reference.check.tolist() == control.check.tolist()
    assert np.array_equal(reference.origin, ORIGIN)
    assert 0 < reference.rms_m < 0.003 and 0 < reference.check_rms_m < 0.003


def test_the_projection_of_every_point_stays_where_it_was(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model)
    result, _ = placed(adjusted, control, measured, None)
    before, after = adjusted, result
    for i in range(len(after.names)):
        seen = after.obs_point[after.obs_photo == i]
        old = pixel_from_ray(CAMERA, (before.points[seen] - before.centres[i]) @ before.rotations[i].T)
        new = pixel_from_ray(CAMERA, (after.points[seen] - after.centres[i]) @ after.rotations[i].T)
        np.testing.assert_allclose(new, old, atol=1e-8)


def test_check_points_do_not_take_part(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model)
    moved = replace(control, xyz=control.xyz + np.where(control.check[:, None], [0.0, 0.0, 1.0], 0.0))
    _, reference = placed(adjusted, control, measured, None)
    _, other = placed(adjusted, moved, measured, None)
    assert np.array_equal(reference.translation, other.translation)
    assert other.rms_m == reference.rms_m
    assert other.residuals[other.check, 2].mean() == pytest.approx(-1.0, abs=0.01)
    assert other.check_rms_m == pytest.approx(np.sqrt(1 / 3), rel=0.01)


def test_noise_of_the_measurements_appears_in_the_residuals(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model, count=40, noise_px=1.0)
    _, reference = placed(adjusted, control, measured, None)
    sigma_point = (
        1.0 / 1500.0 * 8.0 / np.sqrt(4.0)
    )  # 8 photos at about 8 m all round: half of them carry each axis
    assert reference.rms_m == pytest.approx(sigma_point, rel=0.5)
    assert reference.check_rms_m == pytest.approx(reference.rms_m, rel=0.5)


def test_a_known_distance_scales_and_moves_nothing_else(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model)
    length = float(np.linalg.norm(control.xyz[0] - control.xyz[1]))
    result, reference = placed(
        adjusted,
        replace(control, check=np.ones(8, dtype=bool)),
        measured,
        KnownDistance(a="T0", b="T1", metres=length),
    )
    assert (reference.method, result.unit) == ("known distance", "m")
    assert reference.scale == pytest.approx(5.0, rel=1e-3)
    np.testing.assert_allclose(result.centres, reference.scale * adjusted.centres)
    base = float(np.linalg.norm(model.stations.centres[0] - model.stations.centres[2]))
    names = model.stations.names
    by_photos, of_photos = placed(adjusted, None, None, KnownDistance(a=names[0], b=names[2], metres=base))
    assert of_photos.scale == pytest.approx(5.0, rel=1e-3) and by_photos.unit == "m"


def test_without_anything_known_the_block_stays_in_model_units(adjusted: Block) -> None:
    result, reference = placed(adjusted, None, None, None)
    assert result is adjusted and result.unit == "model units"
    assert reference.method == "none" and np.isnan(reference.rms_m) and reference.scale == 1.0


def test_too_few_control_points_say_how_many_were_found_where(
    adjusted: Block, model: TheoreticalModel
) -> None:
    control, measured = targets(model)
    first = model.stations.names[0]
    keep = np.array(
        [p in (0, 1) or (p == 2 and n == first) for p, n in zip(measured.point, measured.photo, strict=True)]
    )
    with pytest.raises(UserError, match="2 control points could be computed, 3 are needed") as refused:
        placed(adjusted, control, some(measured, keep), None)
    assert "T0 in 8" in refused.value.why and "T2 in 1" in refused.value.why and refused.value.todo
    with pytest.raises(UserError, match="0 control points"):
        placed(adjusted, control, None, None)


def test_control_points_on_one_line_are_refused(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model, count=3)
    line = np.linspace([-1, 0, 0], [1, 0.5, 0.2], 3)
    rows = []
    for k, name in zip(measured.point, measured.photo, strict=True):
        i = model.stations.names.index(name)
        rows.append(
            pixel_from_ray(
                CAMERA, (line[k] - model.stations.centres[i])[None] @ model.stations.rotations[i].T
            )[0]
        )
    on_line = replace(measured, xy=np.array(rows))
    with pytest.raises(UserError, match="one line"):
        placed(adjusted, replace(control, xyz=line), on_line, None)


def test_a_wrong_measurement_is_left_out_and_told(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model)
    xy = measured.xy.copy()
    xy[3] += 60.0
    run = Heard()
    _, reference = placed(adjusted, control, replace(measured, xy=xy), None, run=run)
    _, clean = placed(adjusted, control, measured, None)
    assert run.warnings == [
        f"The measurement of T3 in {measured.photo[3]} does not fit the others and was left out."
    ]
    assert reference.rms_m == pytest.approx(clean.rms_m, rel=0.2)


def test_a_wrong_coordinate_and_an_unknown_photo_are_told(adjusted: Block, model: TheoreticalModel) -> None:
    control, measured = targets(model)
    xyz = control.xyz.copy()
    xyz[5] += [2.0, 0.0, 0.0]
    names = ("absent.jpg", *measured.photo[1:])
    run = Heard()
    placed(adjusted, replace(control, xyz=xyz), replace(measured, photo=names), None, run=run)
    assert "not in the project: absent.jpg" in run.warnings[0]
    assert "Control points: T5 misses by" in run.warnings[1] and len(run.warnings) == 2


def test_a_distance_between_unknown_ends_is_refused(adjusted: Block) -> None:
    with pytest.raises(UserError, match="nowhere is neither a point") as refused:
        placed(adjusted, None, None, KnownDistance(a="nowhere", b="there", metres=1.0))
    assert refused.value.todo
