"""The pages of the adjustment tab show what is in the result, and say what will be there without one."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtWidgets import QLabel, QPushButton

from graphos_core.recipe import Recipe
from graphos_py.adjustment.calibration_page import CalibrationPage
from graphos_py.adjustment.camera_tiles import bundle_sheet
from graphos_py.adjustment.findings_page import FindingsPage, group_columns
from graphos_py.adjustment.iterations_page import IterationsPage
from graphos_py.adjustment.parameter_table import TEST, VALUE
from graphos_py.adjustment.photos_page import PhotosPage
from graphos_py.adjustment.residuals_page import ResidualsPage
from graphos_py.adjustment.space_page import SpacePage
from graphos_py.loading import load_engine
from graphos_py.session import Session


@pytest.fixture
def session(jobs) -> Session:
    load_engine()
    made = Session(jobs)
    made.engine_ready()
    return made


def shown(qtbot, page):
    qtbot.addWidget(page)
    page.resize(900, 700)
    page.show()
    return page


def test_every_page_can_be_seen_without_a_result(qtbot, session) -> None:
    pages = (FindingsPage(), CalibrationPage(session), PhotosPage(), ResidualsPage(session), IterationsPage())
    for page in pages:
        shown(qtbot, page).show_result(None)
        for level in ("novice", "student", "expert"):
            page.set_level(level)
            page.grab()


def test_findings_stand_problems_first_and_lead_to_what_they_name(qtbot, result) -> None:
    page = shown(qtbot, FindingsPage())
    page.show_result(result)
    cards = [page.cards.itemAt(i).widget() for i in range(page.cards.count())]
    assert "A blunder." in cards[0].findChildren(QLabel)[1].text()
    assert "All is known." in cards[1].findChildren(QLabel)[1].text()
    item, lesson = cards[0].findChildren(QPushButton)
    with qtbot.waitSignal(page.item_wanted) as heard:
        item.click()
    assert heard.args == [result.adjustment.block.names[1]]
    with qtbot.waitSignal(page.lesson) as heard:
        lesson.click()
    assert heard.args == ["x/y"]
    assert "3.00" in page.accuracy.text() and "1.00" in page.accuracy.text()
    assert page.groups.model.rowCount() == len(result.adjustment.groups) > 0
    assert "not passed" in page.test.text()  # the blunder
    column = next(c for c in group_columns(result.adjustment) if c.title == "r")
    assert np.isclose(sum(column.values), result.adjustment.redundancy, atol=1e-3)


def test_calibration_shows_values_tests_and_correlations(qtbot, session, result) -> None:
    page = shown(qtbot, CalibrationPage(session))
    page.set_level("expert")
    page.show_result(result)
    assert page.table.rowCount() == 5 and "±" in page.table.item(0, VALUE).text()
    assert "not significant" in page.table.item(4, TEST).text()
    matrix = page.correlations.matrix
    covariance = result.adjustment.covariance.cameras[0]
    assert np.isclose(matrix[3, 4], covariance[3, 4] / np.sqrt(covariance[3, 3] * covariance[4, 4]))
    assert np.allclose(np.diag(matrix), 1.0)
    area, side = page.correlations._area()
    place = area.topLeft() + QPointF(4.5 * side, 3.5 * side)
    assert page.correlations._cell_at(place) == (3, 4)


def test_a_tile_sets_the_calibration(session, qtbot) -> None:
    page = shown(qtbot, CalibrationPage(session))
    assert not any(tile.isChecked() for tile in page.tiles.tiles.values())
    before = bundle_sheet(session)[1]
    page.tiles.tiles["reflex"].click()
    after = bundle_sheet(session)[1]
    assert after != before and after.principal_point == "free"
    session.use_recipe(Recipe.default())
    assert bundle_sheet(session)[1] == before


def test_the_player_steps_plays_and_ends(qtbot, result) -> None:
    page = shown(qtbot, IterationsPage())
    page.show_result(result)
    page.set_records(list(result.adjustment.iterations)[:6])
    count = len(page.records)
    assert page.now == count - 1 and page.table.model.rowCount() == count
    qtbot.keyClick(page, Qt.Key.Key_Home)
    assert page.now == 0 and "Start" in page.said.text()
    qtbot.keyClick(page, Qt.Key.Key_Right)
    assert page.now == 1 and page.table.selected_rows() == [1]
    qtbot.keyClick(page, Qt.Key.Key_Left)
    page._timer.setInterval(5)
    page.play()
    qtbot.waitUntil(lambda: page.now == count - 1 and not page._timer.isActive(), timeout=3000)
    shown_now = page._column("cost", page.now)
    assert np.nanmax(np.diff(shown_now[np.isfinite(shown_now)])) <= 0


def test_records_that_come_while_it_runs_begin_anew_with_the_first(qtbot, result) -> None:
    page = shown(qtbot, IterationsPage())
    records = list(result.adjustment.iterations)
    page.add_records(records)
    page.add_records(records[:2])
    assert page.records == records[:2]


def test_space_draws_ellipsoids_residuals_and_rays(qtbot, result) -> None:
    page = shown(qtbot, SpacePage("expert"))
    given = {"C1": np.zeros(3), "C2": np.ones(3)}
    page.show_result(result, given)
    assert page.lines() == []
    page.ellipsoids.slider.setValue(5)
    points, photos = page.lines()
    assert len(points.starts) and len(photos.starts) % len(result.adjustment.block.names) == 0
    page.ellipsoids.slider.setValue(0)
    page.residuals.slider.setValue(3)
    (arrows,) = page.lines()
    assert np.allclose(arrows.ends - arrows.starts, 0.003 * page.residuals.factor)
    page.residuals.slider.setValue(0)
    page.cloud.select_point(7)
    (rays,) = page.lines()
    assert len(rays.starts) == int((np.asarray(result.adjustment.block.obs_point) == 7).sum())
    for kind in ("precision", "rays", "angle", "residual"):
        page.figures.setCurrentIndex(page.figures.findData(kind))
        page.figures.activated.emit(0)
        assert page.cloud.scene.value_legend.low < page.cloud.scene.value_legend.high
    with qtbot.waitSignal(page.distance_wanted) as heard:
        page.cloud.add_measure_point(3)
        page.cloud.add_measure_point(9)
        page.take.click()
    assert heard.args == [3, 9]
