"""The 3D view: what is clicked is what is meant, measuring, cameras, and it never waits for a picture."""

import threading
import time

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from graphos_core.data import Camera
from graphos_core.rendering import ViewCamera
from graphos_py.views.cloud_scene import CloudScene
from graphos_py.views.cloud_view import CloudView
from graphos_py.views.measurement import Measurement

CAMERA = Camera(model="pinhole", width=400, height=300, values=np.array([400.0, 199.5, 149.5]))


@pytest.fixture
def view(qtbot: QtBot) -> CloudView:
    made = CloudView()
    qtbot.addWidget(made)
    made.resize(640, 520)
    made.show()
    qtbot.waitExposed(made)
    points = np.array([[0.0, 0, 0], [3.0, 0, 0], [3.0, 0, 4.0], [0.0, 2.0, 0]])
    with qtbot.waitSignal(made.canvas.drawn, timeout=60_000):
        made.set_cloud(points, np.full((4, 3), 90, np.uint8), unit="m")
    return made


def place(view: CloudView, point: np.ndarray) -> QPoint:
    canvas = view.canvas
    x, y, _ = canvas.camera.project(point, *canvas.size_px())[0]
    return QPoint(round(float(x)), round(float(y)))


def test_a_click_picks_the_point_under_it(view: CloudView, qtbot: QtBot) -> None:
    for index, point in enumerate(view.scene.points):
        with qtbot.waitSignal(view.point_picked) as caught:
            QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=place(view, point))
        assert caught.args == [index]
        assert view.picked == index


def test_two_clicks_measure_a_distance_and_three_an_angle(view: CloudView) -> None:
    QTest.keyClick(view, Qt.Key.Key_M)
    for index in (0, 1, 2):
        QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=place(view, view.scene.points[index]))
        if index == 1:
            assert view.measurement.distance().value == pytest.approx(3.0)
    assert view.measurement.angle().value == pytest.approx(90.0)
    assert "90.00°" in view.measurement.text()
    QTest.keyClick(view, Qt.Key.Key_Escape)
    assert view.measurement.points == []


def test_the_unit_is_metres_only_when_the_cloud_is_in_metres() -> None:
    scene = CloudScene()
    scene.set_points(np.array([[0.0, 0, 0], [0, 0, 2.5]]), None)
    measurement = Measurement(scene)
    measurement.points = [0, 1]
    assert measurement.text().endswith("model units")
    scene.unit = "m"
    assert measurement.text().endswith("\u2009m")


def test_a_measured_distance_has_its_standard_deviation_or_the_reason_why_not() -> None:
    scene = CloudScene()
    scene.set_points(np.array([[0.0, 0, 0], [3.0, 0, 0], [3.0, 1, 0]]), None)
    measurement = Measurement(scene)
    measurement.points = [0, 1]
    assert "dense cloud" in measurement.reason()
    scene.sigmas = np.array([[0.003, 1, 1], [0.004, 1, 1], [np.inf, 1, 1]])
    assert measurement.reason() == ""
    assert "3.0000 ± 0.0050" in measurement.text()
    measurement.points = [0, 2]
    assert measurement.distance().sigma is None


def test_the_wheel_keeps_the_point_under_the_cursor(view: CloudView, qtbot: QtBot) -> None:
    point = view.scene.points[2]
    at = place(view, point)
    canvas = view.canvas
    canvas.set_camera(canvas.camera.zoomed(1.5, canvas.object_point(at.x(), at.y())))
    x, y, _ = canvas.camera.project(point, *canvas.size_px())[0]
    assert (x, y) == pytest.approx((at.x(), at.y()), abs=1.5)


def test_drags_orbit_and_pan(view: CloudView) -> None:
    canvas = view.canvas
    before = canvas.camera
    QTest.mousePress(canvas, Qt.MouseButton.LeftButton, pos=QPoint(300, 200))
    QTest.mouseMove(canvas, QPoint(340, 200))
    QTest.mouseRelease(canvas, Qt.MouseButton.LeftButton, pos=QPoint(340, 200))
    turned = canvas.camera
    assert not np.allclose(turned.rotation, before.rotation)
    assert turned.distance == pytest.approx(before.distance)
    QTest.mousePress(canvas, Qt.MouseButton.RightButton, pos=QPoint(300, 200))
    QTest.mouseMove(canvas, QPoint(340, 230))
    QTest.mouseRelease(canvas, Qt.MouseButton.RightButton, pos=QPoint(340, 230))
    assert np.allclose(canvas.camera.rotation, turned.rotation)
    assert not np.allclose(canvas.camera.target, turned.target)


def test_clicks_on_a_camera_tell_which(view: CloudView, qtbot: QtBot) -> None:
    rotations = np.stack([ViewCamera.looking([0.0, 1.0, 0.0]).rotation] * 2)
    centres = np.array([[-6.0, -8.0, 0.0], [6.0, -8.0, 0.0]])
    thumbnail = np.full((30, 40, 3), 120, np.uint8)
    view.set_cameras(rotations, centres, [CAMERA] * 2, ["a.jpg", "b.jpg"], [thumbnail] * 2)
    view.canvas.fit()
    view.canvas.draw_now()
    _, _, corners = view.scene.pyramids()
    middle = corners[1, 0] + 0.5 * corners[1, 1] + 0.5 * corners[1, 2]
    with qtbot.waitSignal(view.camera_clicked) as caught:
        QTest.mouseClick(view.canvas, Qt.MouseButton.LeftButton, pos=place(view, middle))
    assert caught.args == [1]
    with qtbot.waitSignal(view.camera_double_clicked) as caught:
        QTest.mouseDClick(view.canvas, Qt.MouseButton.LeftButton, pos=place(view, middle))
    assert caught.args == [1]
    view.look_through(1)
    assert np.allclose(view.canvas.camera.centre, centres[1])
    assert np.allclose(view.canvas.camera.rotation, rotations[1])


def test_a_new_cloud_keeps_the_camera_that_the_person_chose(view: CloudView) -> None:
    view.canvas.set_camera(view.canvas.camera.orbited(0.4, 0.1))
    chosen = view.canvas.camera
    view.set_cloud(np.random.default_rng(0).normal(size=(500, 3)), unit="m")
    assert view.canvas.camera is chosen


def test_colour_modes_are_offered_only_with_data() -> None:
    scene = CloudScene()
    scene.set_points(np.random.default_rng(0).normal(size=(100, 3)), None)
    assert scene.modes() == ["rgb", "height"]
    scene.views = np.arange(100, dtype=np.uint8)
    assert scene.modes() == ["rgb", "height", "views"]
    legend = scene.legend("views")
    assert legend is not None
    assert (legend.low, legend.high) == (0, 99)
    lightness = scene.colours_in("height").sum(axis=1)[np.argsort(scene.points[:, 2])]
    assert lightness[-10:].mean() > lightness[:10].mean()


def test_up_is_where_the_photographers_held_it_until_there_is_a_datum() -> None:
    rotation = ViewCamera.looking([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).rotation
    scene = CloudScene()
    scene.set_cameras(rotation[None], np.zeros((1, 3)), [CAMERA], ["a"], None)
    assert np.allclose(scene.up, [0, 1, 0])
    measured = CloudScene(unit="m")
    measured.set_cameras(rotation[None], np.zeros((1, 3)), [CAMERA], ["a"], None)
    assert np.allclose(measured.up, [0, 0, 1])


def test_asking_for_pictures_never_blocks_and_the_last_wish_is_drawn(view: CloudView, qtbot: QtBot) -> None:
    rng = np.random.default_rng(0)
    view.set_cloud(rng.normal(size=(300_000, 3)), unit="m")
    began = time.perf_counter()
    for _ in range(30):
        view.canvas.set_camera(view.canvas.camera.orbited(0.02, 0.0))
    assert time.perf_counter() - began < 0.3
    wanted = view.canvas.camera
    qtbot.waitUntil(
        lambda: view.canvas.shown is not None and view.canvas.shown.picture.camera is wanted, timeout=20_000
    )
    assert threading.active_count() < 12
