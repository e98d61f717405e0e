"""The principal point is free where photos are rolled, and held where roll and tilt could stand for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.schur import adjust
from graphos_core.adjustment.bundle.self_calibration import largest_roll
from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.data import Block, Known
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.run import Run
from graphos_core.simulation.model import NoiseParams, theoretical_model
from graphos_core.simulation.objects import OBJECTS, ObjectParams
from graphos_core.simulation.photo_block import demo_camera
from graphos_core.simulation.templates import place


def block_of(template: str, object_name: str) -> Block:
    model = theoretical_model(
        place(template),
        [demo_camera(1600, 1200)],
        OBJECTS[object_name](ObjectParams(), 1),
        NoiseParams(sigma_px=0.3),
        seed=1,
    )
    return model.as_block(seed=1)


@pytest.mark.parametrize("roll_deg", [0.0, 45.0, 90.0, 180.0])
def test_the_roll_between_photos_is_found_whatever_their_tilt(roll_deg: float) -> None:
    block = block_of("triple", "sphere")
    rotations = np.array(block.rotations)
    rotations[1] = matrix_from_vector(np.array([0.0, 0.0, np.radians(roll_deg)])) @ rotations[1]
    tilted = replace(block, rotations=rotations)
    assert np.degrees(largest_roll(tilted, 0)) == pytest.approx(
        max(roll_deg, np.degrees(largest_roll(block, 0))), abs=12.0
    )


def test_without_roll_the_principal_point_stays_and_with_free_it_moves() -> None:
    block = block_of("triple", "sphere")
    held = adjust(block, Known(), BundleParams(), run=Run()).block.cameras[0]
    moved = adjust(block, Known(), BundleParams(principal_point="free"), run=Run()).block.cameras[0]
    assert held.sigmas is not None
    assert moved.sigmas is not None
    np.testing.assert_array_equal(held.values[1:3], block.cameras[0].values[1:3])
    assert (held.sigmas[1:3] == 0).all()
    assert (moved.sigmas[1:3] > 0).all()
