"""The pages of the adjustment tab show what is in the result, and say what will be there without one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt, QUrl
from PySide6.QtWidgets import QLabel

from graphos_core.cameras.profile import radial_profile
from graphos_core.compare_runs import ComparedRun, compare
from graphos_core.recipe import Recipe
from graphos_py.adjustment.calibration_page import CalibrationPage
from graphos_py.adjustment.camera_tiles import bundle_sheet
from graphos_py.adjustment.comparison_page import ComparisonPage
from graphos_py.adjustment.findings_page import FindingsPage, group_columns
from graphos_py.adjustment.iterations_page import IterationsPage
from graphos_py.adjustment.parameter_table import TEST, VALUE
from graphos_py.adjustment.photos_page import PhotosPage
from graphos_py.adjustment.reliability_page import ReliabilityPage
from graphos_py.adjustment.residuals_page import ResidualsPage
from graphos_py.adjustment.space_page import TITLES, SpacePage
from graphos_py.adjustment.special_plots import QuantilePlot
from graphos_py.loading import load_engine
from graphos_py.project_tree import PastRun
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
    pages = (
        FindingsPage(),
        CalibrationPage(session),
        PhotosPage(),
        ResidualsPage(session),
        ReliabilityPage(session),
        IterationsPage(),
        ComparisonPage(session),
    )
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
    links = cards[0].findChildren(QLabel)[-1]
    with qtbot.waitSignal(page.item_wanted) as heard:
        links.linkActivated.emit("item:0")
    assert heard.args == [result.adjustment.block.names[1]]
    with qtbot.waitSignal(page.lesson) as heard:
        links.linkActivated.emit("lesson:")
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
    assert "<" in page.table.item(4, TEST).text() and "Not significant" in page.table.item(4, TEST).toolTip()
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
        title = TITLES[kind]
        qtbot.waitUntil(
            lambda t=title: (found := page.cloud.scene.value_legend) is not None and found.title == t
        )
        assert page.cloud.scene.value_legend.low < page.cloud.scene.value_legend.high
    with qtbot.waitSignal(page.distance_wanted) as heard:
        page.cloud.add_measure_point(3)
        page.cloud.add_measure_point(9)
        page.take.click()
    assert heard.args == [3, 9]


def test_suspects_stand_in_order_and_the_blunder_leads(qtbot, session, result) -> None:
    page = shown(qtbot, ReliabilityPage(session))
    page.show_result(result)
    block = result.adjustment.block
    w = np.abs([row["w"] for row in page.rows])
    assert np.all(np.diff(w) <= 1e-9) and w[0] > 10
    assert page.rows[0]["photo"] == block.names[block.obs_photo[40]]
    assert page._observation(page.rows[0]) == 40
    found = result.adjustment.reliability
    assert f"{int((np.abs(found.standardised) > found.critical).sum())} of " in page.said.text()


def test_profile_and_quantile_plots_show_what_the_engine_computes(qtbot, session, result) -> None:
    page = shown(qtbot, CalibrationPage(session))
    page.set_level("expert")
    page.show_result(result)
    page.pictures.setCurrentWidget(page.profile)
    qtbot.waitUntil(lambda: page.profile._drawing is not None, timeout=20000)
    page.profile.draw_now()
    rows = np.array(page.profile.rows(), dtype=float)
    camera, covariance = result.adjustment.block.cameras[0], result.adjustment.covariance.cameras[0]
    expected = radial_profile(camera, covariance)
    assert np.allclose(rows[:, 1], expected.displacement_px) and np.allclose(rows[:, 2], expected.sigma_px)
    plot = shown(qtbot, QuantilePlot())
    values = np.random.default_rng(0).standard_normal(20000)
    plot.show_quantiles(values, "τ")
    plot.draw_now()
    shown_rows = np.array(plot.rows(), dtype=float)
    assert len(shown_rows) <= 4000 and np.isclose(shown_rows[-1, 1], values.max())
    middle = np.abs(shown_rows[:, 0]) < 2
    assert np.abs(shown_rows[middle, 0] - shown_rows[middle, 1]).max() < 0.1


def test_two_stored_results_are_compared(qtbot, session, result, tmp_path, monkeypatch) -> None:
    page = shown(qtbot, ComparisonPage(session))
    other = replace(result, adjustment=replace(result.adjustment, rms_px=2 * result.adjustment.rms_px))
    runs = [
        PastRun("adjustment", "georeference", key, f"2026-01-0{i}T10:00", f"run {key}", 1.0, 1, i == 2)
        for i, key in ((2, "new"), (1, "old"))
    ]
    page._listed(runs[:1])
    assert not page.button.isEnabled() and "one result" in page.text.toPlainText()
    page._listed(runs)
    assert "run old" in page.choices[0].currentText() and "run new" in page.choices[1].currentText()
    sides = [
        ComparedRun(label, found.adjustment, found.georeference, recipe)
        for label, found, recipe in (
            ("first", result, Recipe.default()),
            ("second", other, Recipe.default().set("adjustment.schur.robust=cauchy")),
        )
    ]
    page._compared(compare(*sides))
    text = page.text.toPlainText()
    assert "AIC" in text and "BIC" in text and "cauchy" in text and "second" in text
    with qtbot.waitSignal(page.lesson) as heard:
        page._link(QUrl("lesson:adjustment/comparing-runs"))
    assert heard.args == ["adjustment/comparing-runs"]
