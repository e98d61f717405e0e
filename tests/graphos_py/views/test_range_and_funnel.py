"""Handles of a histogram let values through; a crowd of keypoints does not hide the photo."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from graphos_core.data import Features
from graphos_py.views.funnel_view import FunnelView
from graphos_py.views.image_view import ImageView
from graphos_py.views.range_filter import RangeFilter

VALUES = np.concatenate([np.linspace(1.0, 10.0, 91), np.linspace(20.0, 100.0, 9)])


@pytest.fixture
def strip(qtbot) -> RangeFilter:
    made = RangeFilter("diameter", "px")
    qtbot.addWidget(made)
    made.resize(400, 120)
    made.show()
    made.set_values(VALUES)
    return made


def test_all_values_pass_at_first_and_bars_count_them(strip: RangeFilter) -> None:
    assert strip.is_open and strip.passing.all()
    assert strip.strip.counts.sum() == len(VALUES)


def test_dragging_a_handle_lets_through_what_lies_inside(strip: RangeFilter, qtbot) -> None:
    bar = strip.strip
    with qtbot.waitSignal(strip.changed):
        QTest.mousePress(bar, Qt.MouseButton.LeftButton, pos=QPoint(bar.width() // 2, 10))
    QTest.mouseRelease(bar, Qt.MouseButton.LeftButton, pos=QPoint(bar.width() // 2, 10))
    middle = 10.0  # of 1 to 100 on the logarithmic axis
    edge = strip.high if strip.high < 100 else strip.low
    assert edge == pytest.approx(middle, rel=0.05)
    assert np.array_equal(strip.passing, (strip.low <= VALUES) & (strip.high >= VALUES))
    assert 0 < strip.passing.sum() < len(VALUES)


def test_typed_limits_never_cross_and_the_ends_lose_nothing(strip: RangeFilter) -> None:
    strip.boxes[1].setValue(5.0)
    strip.boxes[0].setValue(50.0)
    assert strip.low <= strip.high
    strip.boxes[0].setValue(strip.boxes[0].minimum())
    strip.boxes[1].setValue(strip.boxes[1].maximum())
    assert strip.passing.all()
    strip.reset()
    assert strip.is_open


def test_both_typed_limits_cut_off_their_side(strip: RangeFilter) -> None:
    strip.boxes[0].setValue(2.0)
    strip.boxes[1].setValue(5.0)
    assert VALUES[strip.passing].min() == pytest.approx(2.0, abs=0.1)
    assert VALUES[strip.passing].max() == pytest.approx(5.0, abs=0.1)


@pytest.mark.parametrize("values", [[], [3.0], [2.0, 2.0, 2.0], [-1e-4, 0.0, 2e-3]])
def test_few_equal_and_negative_values_are_shown(strip: RangeFilter, values: list[float]) -> None:
    strip.set_values(np.array(values))
    assert strip.passing.all()
    strip.grab()


def test_a_crowd_of_large_keypoints_leaves_most_of_the_photo_in_sight(qtbot) -> None:
    rng = np.random.default_rng(4)
    n = 4000
    features = Features(
        xy=rng.uniform(100, 900, (n, 2)).astype(np.float32), scale=np.full(n, 150, np.float32),
        angle=np.zeros(n, np.float32), response=np.ones(n, np.float32), descriptors=np.zeros((n, 8), np.uint8),
        colour=np.zeros((n, 3), np.uint8), width=1000, height=1000,
    )  # fmt: skip
    view = ImageView()
    qtbot.addWidget(view)
    view.resize(500, 520)
    view.show()
    view.set_image(np.full((1000, 1000), 90, np.uint8))
    view.set_keypoints(features)
    mask, drawn = view.keypoints.mask()
    assert drawn == n
    assert (mask > 0).mean() < 0.6
    view.canvas.zoom_at(250.0, 250.0, 16.0)
    close, seen = view.keypoints.mask()
    assert 0 < seen < n
    near = np.hypot(*(view.canvas.to_screen(features.xy) - 250.0).T).argmin()
    view.filter_keypoints(np.arange(n) == near)
    assert view.keypoints.count == 1 and view.keypoints.nearest(*features.xy[near]) == near
    assert view.keypoints.nearest(*features.xy[(near + 1) % n] + 300.0) == -1
    assert close.any()


def test_a_funnel_is_as_tall_as_its_steps_and_exports_them(qtbot, tmp_path) -> None:
    view = FunnelView()
    qtbot.addWidget(view)
    empty = view.sizeHint().height()
    view.set_steps([("keypoints", 8192), ("ratio test", 2711), ("verified", 2000)])
    view.resize(200, view.sizeHint().height())
    view.show()
    view.grab()
    assert view.sizeHint().height() > empty
    view.exports()["csv"](tmp_path / "f.csv")
    assert "ratio test,2711" in (tmp_path / "f.csv").read_text("utf-8")
    assert "verified 2000" in view.accessibleName()
