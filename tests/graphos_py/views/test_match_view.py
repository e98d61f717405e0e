"""The match view: linked photos, selection in both, epipolar lines of both kinds of matrix."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera, PairMatches
from graphos_core.geometry.epipolar import (
    essential_from_relative,
    fundamental_from_essential,
    relative_orientation,
)
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_py.views.match_view import MatchView
from graphos_py.views.pair_geometry import PairGeometry

SIZE = (400, 300)


class Truth:
    """Two photos of known points; measured px carry the distortion of the camera."""

    def __init__(self, model: str) -> None:
        values = [500.0, 199.5, 149.5] + ([-0.15, 0.02] if model == "basic" else [])
        self.camera = Camera(model=model, width=400, height=300, values=np.array(values))
        rng = np.random.default_rng(2)
        self.points = rng.uniform([-1, -0.8, 4], [1, 0.8, 6], (40, 3))
        self.pose_b = matrix_from_vector(np.array([0.02, -0.15, 0.03])), np.array([0.8, 0.1, 0.1])
        self.a = pixel_from_ray(self.camera, self.points)
        self.b = pixel_from_ray(self.camera, (self.points - self.pose_b[1]) @ self.pose_b[0].T)
        self.essential = essential_from_relative(*relative_orientation(np.eye(3), np.zeros(3), *self.pose_b))

    def pair(self, kind: str) -> PairMatches:
        cameras = (self.camera, self.camera)
        matrix = (
            self.essential if kind == "essential" else fundamental_from_essential(self.essential, *cameras)
        )
        matches = np.tile(np.arange(40, dtype=np.int32)[:, None], (1, 2))
        return PairMatches(
            a=0, b=1, matches=matches, candidates=50, kind=kind, matrix=matrix, threshold_px=1.0
        )


@pytest.mark.parametrize(("kind", "model"), [("fundamental", "pinhole"), ("essential", "basic")])
def test_matches_lie_on_their_epipolar_curves_in_both_photos(kind: str, model: str) -> None:
    truth = Truth(model)
    geometry = PairGeometry.of_pair(truth.pair(kind), (SIZE, SIZE), (truth.camera, truth.camera))
    assert geometry is not None
    assert geometry.distances(truth.a, truth.b).max() < 1e-6
    for side, from_xy, to_xy in ((0, truth.a, truth.b), (1, truth.b, truth.a)):
        for (x, y), other in list(zip(from_xy, to_xy))[:10]:
            curve = geometry.curve(side, x, y)
            start, step = curve[:-1], np.diff(curve, axis=0)
            share = np.clip(((other - start) * step).sum(axis=1) / (step**2).sum(axis=1), 0, 1)
            assert np.linalg.norm(start + share[:, None] * step - other, axis=1).min() < 0.05


def test_a_displaced_match_has_the_distance_by_which_it_was_displaced() -> None:
    truth = Truth("pinhole")
    geometry = PairGeometry.of_pair(truth.pair("fundamental"), (SIZE, SIZE), None)
    assert geometry is not None
    line = geometry.curve(0, *truth.a[0])
    along = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    moved = truth.b.copy()
    moved[0] += 2.0 * np.array([-along[1], along[0]])
    distance = geometry.distances(truth.a, moved)[0]
    assert distance >= 2.0 - 1e-6
    assert distance < 3.0


@pytest.fixture
def view(qtbot: QtBot, photo: np.ndarray) -> MatchView:
    made = MatchView()
    qtbot.addWidget(made)
    made.resize(900, 420)
    made.show()
    qtbot.waitExposed(made)
    truth = Truth("basic")
    made.set_pair(
        photo, photo, truth.a, truth.b, truth.pair("essential"), ("a.jpg", "b.jpg"),
        cameras=(truth.camera, truth.camera),
    )  # fmt: skip
    qtbot.waitUntil(lambda: made.residuals is not None, timeout=60_000)
    return made


@pytest.mark.parametrize("side", [0, 1])
def test_a_click_selects_the_match_in_either_photo(view: MatchView, qtbot: QtBot, side: int) -> None:
    x, y = view.canvases[side].to_screen(view.xy[side])[7]
    with qtbot.waitSignal(view.match_selected) as caught:
        QTest.mouseClick(view.canvases[side], Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    assert caught.args == [7]
    assert view.selected == 7


def test_hovering_highlights_and_draws_the_epipolar_line(view: MatchView) -> None:
    view.grab()
    before = view.grab().toImage()
    x, y = view.canvases[0].to_screen(view.xy[0])[3]
    QTest.mouseMove(view.canvases[0], QPoint(round(x), round(y)))
    view._on_cursor(0, *view.xy[0][3])
    assert view.hovered == 3
    assert view.grab().toImage() != before


def test_both_photos_zoom_together(view: MatchView) -> None:
    view.canvases[0].zoom_at(100.0, 100.0, 3.0)
    assert view.canvases[1].zoom == pytest.approx(view.canvases[0].zoom)


def test_n_and_p_go_through_the_matches(view: MatchView) -> None:
    QTest.keyClick(view, Qt.Key.Key_N)
    QTest.keyClick(view, Qt.Key.Key_N)
    assert view.selected == 1
    QTest.keyClick(view, Qt.Key.Key_P)
    assert view.selected == 0
    QTest.keyClick(view, Qt.Key.Key_Escape)
    assert view.selected == -1


def test_a_pair_without_matches_is_shown(view: MatchView, photo: np.ndarray) -> None:
    none = PairMatches(
        a=0, b=1, matches=np.zeros((0, 2), np.int32), candidates=9, kind="none", matrix=np.zeros((3, 3)),
        reason="Too few.",
    )  # fmt: skip
    view.set_pair(photo, photo, np.zeros((0, 2)), np.zeros((0, 2)), none)
    view.grab()
    assert view.residuals is None


def test_both_photos_stay_whole_when_the_view_changes_its_size(qtbot: QtBot, photo: np.ndarray) -> None:
    view = MatchView()
    qtbot.addWidget(view)
    view.resize(900, 300)
    view.show()
    view.set_pair(photo, photo, np.array([[10.0, 10.0]] * 5), np.array([[200.0, 150.0]] * 5))
    for size in ((900, 300), (400, 900), (700, 500)):
        view.resize(*size)
        qtbot.wait(20)
        for canvas in view.canvases:
            assert canvas.fitted
            assert (canvas.visible().width(), canvas.visible().height()) == (400, 300)
    assert view.canvases[0].zoom == view.canvases[1].zoom
