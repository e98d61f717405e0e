"""Shapes that cannot turn a block are told and passed over; nothing becomes NaN."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.adjustment.georeferencing.level import levelled
from graphos_core.adjustment.georeferencing.measured_points import MeasuredPoints
from graphos_core.data import Control, Known, KnownShape
from graphos_core.run import Run
from graphos_core.simulation.consistency import simulate

PLACES = {"A": (0, 0, 0), "B": (0, 0, 1), "C": (0, 0, 3), "D": (2, 0, 0), "E": (0, 2, 0)}


def shape(kind: str, points: str) -> KnownShape:
    return KnownShape(kind=kind, points=tuple(points), sigma=0.01)


@pytest.mark.parametrize(
    ("shapes", "turns", "said"),
    [
        ([("z axis", "AB"), ("x axis", "BC")], True, "stand above each other"),
        ([("z axis", "AA")], False, "one and the same"),
        ([("horizontal plane", "ABC")], False, "on one line"),
        ([("horizontal plane", "ADE"), ("x axis", "AD")], True, ""),
    ],
)
def test_shapes_that_cannot_turn_the_block_are_passed_over(shapes, turns: bool, said: str) -> None:
    xyz = np.array(list(PLACES.values()), dtype=np.float64)
    count = len(xyz)
    control = Control(names=tuple(PLACES), xyz=np.full((count, 3), np.nan), check=np.zeros(count, dtype=bool),
                      origin=np.zeros(3))  # fmt: skip
    points = MeasuredPoints(xyz, np.ones(count, dtype=bool), np.full(count, 3), np.zeros(0, dtype=bool))
    known, heard = Known(control=control, shapes=tuple(shape(*s) for s in shapes)), Run()
    found = levelled(simulate("basic", (), 1).truth, known, points, heard)
    assert [said in warning for warning in heard.warnings] == [True] * bool(said)
    assert (found is not None) == turns
    if found is not None:
        np.testing.assert_allclose(found.rotation @ found.rotation.T, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(np.abs(found.apply(np.array([0.0, 0.0, 1.0]))), [0, 0, 1], atol=1e-12)
