"""What the simulator of coplanarity shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import drag, find_simulator
from graphos_didactic.simulators.adjustment.coplanarity_model import TwoPhotos, errors_of_folds
from graphos_didactic.simulators.adjustment.coplanarity_params import CoplanarityParams


def test_without_errors_both_solutions_are_the_truth_and_the_volume_is_zero() -> None:
    pair = TwoPhotos(CoplanarityParams(sigma_px=0.0))
    for found in (pair.by_eight, pair.by_five):
        assert max(pair.errors(found)) < 1e-4
    assert pair.volume == pytest.approx(0.0, abs=1e-12)
    nearest = pair.nearest()
    assert nearest is not None
    np.testing.assert_allclose(nearest, [pair.points[0]] * 2, atol=1e-9)


def test_a_point_that_slides_along_its_line_stays_coplanar_and_beside_it_does_not() -> None:
    clean = CoplanarityParams(sigma_px=0.0)
    line = TwoPhotos(clean).line
    assert line is not None
    for way, coplanar in ((np.array([-line[1], line[0]]), True), (line[:2], False)):
        moved = TwoPhotos(clean.replace(off_x=float(60 * way[0]), off_y=float(60 * way[1])))
        assert (abs(moved.volume) < 1e-9) == coplanar
        nearest = moved.nearest()
        assert nearest is not None
        assert (float(np.linalg.norm(nearest[1] - nearest[0])) < 1e-6) == coplanar


def test_a_flat_object_breaks_eight_points_but_not_five() -> None:
    pair = TwoPhotos(CoplanarityParams(fold=0.0))
    assert pair.by_eight is None
    assert pair.errors(pair.by_five)[0] < 5.0
    assert np.isnan(errors_of_folds(CoplanarityParams())[0, 0])


def test_only_one_of_the_four_solutions_has_all_points_before_both_cameras() -> None:
    pair = TwoPhotos(CoplanarityParams())
    counts = [int(pair.before_both(choice).sum()) for choice in pair.four]
    assert sorted(counts)[-2:] == [0, int(pair.used.sum())]
    assert pair.errors(pair.four[pair.right_one])[0] < 2.0


def test_the_measured_point_follows_the_pointer_without_its_noise_jumping() -> None:
    simulator = find_simulator("adjustment/coplanarity")
    params = simulator.params()
    handle = next(h for h in simulator.scene(params).handles if h.name == "point")
    moved = drag(params, handle, handle.at[0] + 17.0, handle.at[1] - 9.0)
    before, after = TwoPhotos(params), TwoPhotos(moved)  # type: ignore[arg-type]
    np.testing.assert_allclose(after.pixels[1, 0] - before.pixels[1, 0], [17.0, -9.0], atol=1e-9)
    np.testing.assert_array_equal(after.pixels[:, 1:], before.pixels[:, 1:])
