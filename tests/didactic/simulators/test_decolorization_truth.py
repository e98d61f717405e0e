"""What the simulator of decolourisation shows is true."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from graphos_didactic.simulator import Setting, find_simulator
from graphos_didactic.simulators.preprocessing.decolorization_model import (
    METHODS,
    Decolorized,
    colours_at,
    luma_of,
    same_luma,
)
from graphos_didactic.simulators.preprocessing.decolorization_params import DecolorizationParams
from graphos_didactic.simulators.preprocessing.decolorization_tasks import PREDICTION, decolorization_task


def seen(**values: object) -> Decolorized:
    return Decolorized(DecolorizationParams(**values), Setting())  # type: ignore[arg-type]


def test_luma_loses_the_first_picture_and_contrast_preserving_grey_keeps_it() -> None:
    first = seen()
    (name, delta), (luma,), (new,) = first.pairs[0], first.kept("luma"), first.kept("decolor")
    assert name == "AB"
    assert delta == pytest.approx(
        2 * 40 * np.sin(np.radians(60)), abs=2.0
    )  # chord of the circle of chroma 40
    assert luma < 1.0
    assert new > 0.9 * delta
    assert first.ccpr("luma") < 0.1
    assert first.best in ("decolor", "principal")
    assert first.ccpr("decolor") > 0.9


def test_only_contrast_preserving_grey_keeps_three_colours_apart() -> None:
    three = seen(picture="three")
    deltas = np.array([delta for _, delta in three.pairs])
    assert [name for name, _ in three.pairs] == ["AB", "AC", "BC"]
    shares = {method: float((np.array(three.kept(method)) / deltas).min()) for method in METHODS}
    assert shares["decolor"] > 0.6
    assert max(share for method, share in shares.items() if method != "decolor") < 0.3
    assert three.best == "decolor"


def test_all_hues_are_more_than_one_axis_can_hold() -> None:
    wheel = seen(picture="wheel")
    assert len(wheel.pairs) == 66
    for method in METHODS:
        assert wheel.lost(method) > 10


def test_the_curve_is_where_luma_is_the_same() -> None:
    level = luma_of(30.0, 55.0, 40.0)
    hues = np.array([0.0, 90.0, 150.0, 300.0])
    for hue, light in zip(hues, same_luma(hues, level, 40.0), strict=True):
        assert luma_of(float(hue), float(light), 40.0) == pytest.approx(level, abs=0.5)
    assert np.isnan(same_luma(hues, 254.0, 5.0)).all()


def test_the_plane_has_the_hue_and_lightness_it_says() -> None:
    for hue, light in ((20.0, 50.0), (120.0, 70.0), (300.0, 40.0)):
        colour = colours_at(np.array([hue]), np.array([light]), 30.0)
        lab = cv2.cvtColor(colour.reshape(1, 1, 3), cv2.COLOR_RGB2LAB)[0, 0]
        assert lab[0] == pytest.approx(light, abs=0.5)
        assert np.degrees(np.arctan2(lab[2], lab[1])) % 360 == pytest.approx(hue, abs=1.5)


def test_the_iterations_end_at_the_weights_of_the_result() -> None:
    three = seen(picture="three", iterations=8)
    turns, greys = three.history
    assert turns[0] == 0.0
    assert turns[-1] == 8.0
    np.testing.assert_allclose(greys[0], 100 * three.colours.mean(axis=1) / 255.0, atol=0.5)
    polynomial = three.polynomial(8)
    result = three.grey("decolor").astype(float)
    low, high = np.percentile(polynomial, (0.1, 99.9))
    np.testing.assert_allclose(result, np.clip(255 * (polynomial - low) / (high - low), 0, 255), atol=1.0)


def test_colours_of_a_photo_are_those_under_the_handles() -> None:
    photo = np.zeros((120, 160, 3), np.uint8)
    photo[:, :80], photo[:, 80:] = (200, 40, 40), (40, 160, 60)
    params = DecolorizationParams(picture="photo", a_x=20.0, a_y=50.0, b_x=80.0, b_y=50.0, c_x=21.0, c_y=20.0)
    mine = Decolorized(params, Setting(photo, "mine"))
    np.testing.assert_allclose(mine.colours[:2], [(200, 40, 40), (40, 160, 60)], atol=1)


def test_the_prediction_names_the_channel_of_the_hue() -> None:
    blue = DecolorizationParams(a_hue=90.0, a_light=60.0, b_hue=170.0, b_light=60.0)  # yellow, then blue
    assert PREDICTION.answer(blue, Setting()) == 2
    red = DecolorizationParams(a_hue=200.0, a_light=60.0, b_hue=270.0, b_light=60.0)  # cyan, then red
    assert PREDICTION.answer(red, Setting()) == 0


def test_the_challenge_wants_luma_and_not_lightness() -> None:
    task = decolorization_task(3)
    assert isinstance(task.solution, DecolorizationParams)
    mine = Decolorized(task.solution, Setting())
    assert mine.kept("luma")[0] < 1.0
    assert mine.pairs[0][1] > 25.0


def test_a_grey_photo_has_nothing_to_keep() -> None:
    simulator = find_simulator("preprocessing/decolorization")
    flat = np.full((90, 120, 3), 128, np.uint8)
    assert simulator.scene(simulator.preset("photo"), Setting(flat, "flat")).says
