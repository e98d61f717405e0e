"""What the simulator of the datum shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import drag, find_simulator
from graphos_didactic.simulators.adjustment.datum_drawing import largest_change, moved
from graphos_didactic.simulators.adjustment.datum_model import Held
from graphos_didactic.simulators.adjustment.datum_params import DatumParams

NOTHING = DatumParams(p1="none", p3="none", p7="none", p9="none", amount=1.0)


@pytest.mark.parametrize(
    ("params", "defect"),
    [
        (NOTHING, 7),
        (NOTHING.replace(distance=True), 6),
        (NOTHING.replace(p1="full"), 4),
        (NOTHING.replace(p1="full", p9="full"), 1),
        (NOTHING.replace(p1="full", p9="full", p3="height"), 0),
        (NOTHING.replace(p1="height", p3="height", p7="height"), 4),
    ],
)
def test_free_motions_are_as_many_as_counting_says_and_change_no_photo(
    params: DatumParams, defect: int
) -> None:
    held = Held(params)
    assert held.defect == len(held.motions) == defect
    assert (held.spectrum < 1e-12).sum() == defect
    for number in range(1, defect + 1):
        one = Held(params.replace(motion=number))
        assert largest_change(one) < 1e-9
        there = moved(one)
        assert there is not None
        shift = there[0] - np.asarray(one.adjustment.block.points)
        assert np.abs(shift).max() > 0.5


def test_a_turn_about_two_points_leaves_them_where_they_are() -> None:
    held = Held(DatumParams(amount=1.0))
    there = moved(held)
    assert there is not None
    shift = np.linalg.norm(there[0] - np.asarray(held.adjustment.block.points), axis=1)
    assert shift[[0, 8]].max() < 1e-9
    assert shift[2] > 1.0


def test_another_datum_changes_ellipses_and_not_the_shape() -> None:
    inner, minimal = Held(NOTHING), Held(NOTHING.replace(kind="minimal"))
    assert minimal.sigmas.mean() > 1.2 * inner.sigmas.mean()
    assert minimal.adjustment.sigma0 == pytest.approx(inner.adjustment.sigma0)
    np.testing.assert_allclose(minimal.adjustment.block.points, inner.adjustment.block.points, atol=1e-9)


def test_just_seven_numbers_bend_nothing_however_wrong_and_more_do() -> None:
    seven = Held(DatumParams(p3="height", wrong_x=400.0))
    assert seven.bending < 1e-6
    assert seven.adjustment.sigma0 == pytest.approx(Held(NOTHING).adjustment.sigma0, rel=1e-6)
    more = Held(DatumParams(p3="full", p7="full", wrong_x=400.0))
    assert more.bending > 3e-3
    assert more.adjustment.sigma0 > 2 * seven.adjustment.sigma0


def test_the_moved_block_follows_the_pointer_along_its_way() -> None:
    simulator = find_simulator("adjustment/datum")
    params = DatumParams(amount=0.0)
    handle = next(h for h in simulator.scene(params).handles if h.name == "amount")
    after = drag(params, handle, handle.at[0] + 4 * handle.nudge[0], handle.at[1] + 4 * handle.nudge[1])
    assert isinstance(after, DatumParams)
    assert after.amount == pytest.approx(0.32, abs=0.06)
