"""What the simulator of affine simulation shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import Setting, drag, find_simulator
from graphos_didactic.simulators.features.affine_model import Simulated
from graphos_didactic.simulators.features.affine_params import AffineParams
from graphos_didactic.simulators.pictured_pair import WIDTH


def seen(**changes: object) -> Simulated:
    return Simulated(AffineParams().replace(**changes), Setting())


@pytest.mark.parametrize("swing", [0.0, 40.0, 110.0, -70.0])
def test_the_change_of_the_photo_has_the_tilt_and_direction_of_the_camera(swing: float) -> None:
    """The cameras' own map against t = 1/cos θ, and the direction of its compression against the swing."""
    pair = seen(tilt=60.0, swing=swing)
    _, (large, small), directions = np.linalg.svd(pair.local_map)
    assert large / small == pytest.approx(2.0, rel=1e-3)
    compressed = directions[1]
    along = np.array([np.cos(np.radians(swing)), -np.sin(np.radians(swing))])
    assert abs(compressed @ along) == pytest.approx(1.0, abs=1e-3)


def test_a_simulated_view_with_the_true_angles_leaves_no_tilt() -> None:
    """t = √2 at longitude 0 is what a camera sees at 45° to the right, and 45° to the left."""
    for swing in (0.0, 180.0):
        pair = seen(tilt=45.0, swing=swing, tilts=1)
        assert pair.remaining[pair.nearest] == pytest.approx(1.0, abs=2e-3)
        assert pair.angles[pair.nearest] == pytest.approx((np.sqrt(2.0), 0.0))


def test_the_photo_itself_is_the_first_view_and_leaves_the_whole_tilt() -> None:
    pair = seen()
    assert pair.angles[0] == (1.0, 0.0)
    assert pair.remaining[0] == pytest.approx(pair.true_tilt, rel=1e-3)


def test_simulation_multiplies_the_true_matches_of_steep_views() -> None:
    for swing in (25.0, 95.0):
        pair = seen(swing=swing, tilt=62.0)
        assert pair.together.right >= 3 * pair.alone.right
        assert pair.together.right > pair.together.wrong


def test_views_far_from_the_true_one_match_nothing() -> None:
    pair = seen(tilts=4)
    right = np.array([found.right for found in pair.matched])
    far = pair.remaining > 3.5
    assert far.sum() >= 4
    assert right[far].mean() < 0.15 * right[~far & (pair.remaining < 2.0)].mean()


def test_a_place_counts_once() -> None:
    pair = seen()
    assert pair.together.right < sum(found.right for found in pair.matched)
    cells = np.floor(pair.together.a / 2.0)
    assert len(np.unique(cells, axis=0)) == len(cells)


def test_mapped_back_places_show_the_same_texture() -> None:
    """Features of a simulated view, mapped back, lie where photo A has the same grey value."""
    pair = seen(tilts=2)
    grey = pair.photo_a.astype(float) @ [0.299, 0.587, 0.114]
    view = pair.views[3]
    there = np.rint(view.features.xy).astype(int)
    here = np.rint(view.in_photo).astype(int)
    assert (here[:, 0] < WIDTH).all()
    a = grey[here[:, 1], here[:, 0]]
    b = view.simulation.image[there[:, 1], there[:, 0]].astype(float)
    assert np.corrcoef(a, b)[0, 1] > 0.7


def test_camera_b_follows_the_pointer_on_the_hemisphere() -> None:
    simulator = find_simulator("features/affine")
    params = AffineParams(tilt=40.0, swing=-60.0)
    goal = next(
        h for h in simulator.scene(AffineParams(tilt=55.0, swing=-20.0)).handles if h.name == "camera"
    )
    handle = next(h for h in simulator.scene(params).handles if h.name == "camera")
    moved = drag(params, handle, *goal.at)
    assert isinstance(moved, AffineParams)
    assert moved.tilt == pytest.approx(55.0, abs=0.5)
    assert moved.swing == pytest.approx(-20.0, abs=0.5)
