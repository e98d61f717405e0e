"""What the simulator of the descriptor shows is true."""

from __future__ import annotations

import math

import numpy as np
import pytest

from graphos_didactic.simulator import Setting, find_simulator
from graphos_didactic.simulators.features.descriptor_model import Compared
from graphos_didactic.simulators.features.descriptor_params import DescriptorParams
from graphos_didactic.simulators.features.descriptor_tasks import PREDICTION, descriptor_task


def compared(**values: object) -> Compared:
    return Compared(DescriptorParams(noise=0.0, **values), Setting())  # type: ignore[arg-type]


@pytest.mark.parametrize("turn", [-150.0, -37.0, 0.0, 64.0, 90.0, 178.0])
def test_the_turn_is_found_and_the_numbers_stay(turn: float) -> None:
    seen = compared(turn=turn)
    assert abs(seen.turn_error) < 8.0  # the place is rounded to a pixel of its octave
    assert seen.distance < 0.25
    upright = compared(turn=turn, orientation="upright").distance
    assert upright < 0.05 if turn == 0.0 else upright > 0.6


def test_contrast_and_brightness_alone_change_nothing() -> None:
    assert compared(turn=0.0, gain=0.5, offset=60.0).distance < 1e-4
    assert compared(turn=0.0, gain=1.8, offset=60.0).distance > 0.02  # white is reached


def test_the_same_place_is_looked_at_in_both_pictures() -> None:
    seen = compared(turn=90.0, gain=1.0, offset=0.0)
    (x, y), (u, v) = seen.at_first, seen.at_second
    assert (u - 119.5, v - 119.5) == pytest.approx((-(y - 119.5), x - 119.5))
    a, b = seen.first[round(y), round(x)], seen.second[round(v), round(u)]
    assert a == pytest.approx(b, abs=6.0)


def test_a_round_blob_has_no_direction_of_its_own() -> None:
    simulator = find_simulator("features/descriptor")
    params = simulator.preset("round")
    assert isinstance(params, DescriptorParams)

    def errors(picture: str) -> list[float]:
        turns = (-170.0, -120.0, -70.0, 50.0, 90.0, 140.0)
        return [abs(Compared(params.replace(turn=t, picture=picture), Setting()).turn_error) for t in turns]

    assert np.mean(errors("round")) > 15.0
    assert np.mean(errors("letter")) < 6.0


def test_the_shares_of_a_pixel_inside_are_all_of_it() -> None:
    shares = compared(u=0.2, v=-0.9).shares
    assert sum(row[3] for row in shares.table()) == pytest.approx(1.0)
    assert len(shares.table()) == 8
    at_the_edge = compared(u=1.9, v=-1.9).shares
    assert sum(row[3] for row in at_the_edge.table()) == pytest.approx(0.6**2)


def test_a_pixel_goes_to_the_cell_it_lies_in() -> None:
    for u, v, row, column in ((-1.5, -1.5, 0, 0), (1.5, -0.5, 1, 3)):
        table = compared(u=u, v=v).shares.table()
        assert table[0][:2] == (row, column)
        assert sum(share for *_, share in table) == pytest.approx(1.0)


def test_the_direction_of_the_pixel_is_counter_clockwise() -> None:
    seen = compared(u=0.5, v=0.5)
    side = seen.a.patch.shape[0]
    index = int((0.5 / 4 + 0.5) * side)
    right = float(seen.a.patch[index, index + 1] - seen.a.patch[index, index - 1])
    up = float(seen.a.patch[index - 1, index] - seen.a.patch[index + 1, index])
    assert seen.shares.direction == pytest.approx(math.atan2(up, right) % (2 * math.pi), abs=1e-4)


def test_the_prediction_depends_on_the_orientation() -> None:
    assert PREDICTION.answer(DescriptorParams(), Setting()) == 0
    assert PREDICTION.answer(DescriptorParams(orientation="upright", turn=0.0), Setting()) == 1


@pytest.mark.parametrize("seed", range(4))
def test_the_challenge_asks_about_the_pixel_that_is_marked(seed: int) -> None:
    task = descriptor_task(seed)
    assert isinstance(task.start, DescriptorParams)
    seen = Compared(task.start, Setting())
    largest = seen.shares.table()[0]
    assert isinstance(task.solution, float)
    assert task.solution == pytest.approx(seen.shares.size * largest[3], rel=0.02)
