"""The preprocessing tab: live preview of what is seen, wipe and side by side, ways to grey, image analyser."""

import time
from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.preprocessing.chain import apply_filters
from graphos_core.project import Project
from graphos_core.run import Run
from graphos_py.main_window import MainWindow


@pytest.fixture
def large_project(tmp_path: Path) -> Path:
    """Two photos of 1500 × 1000 that look alike but are not the same."""
    folder = tmp_path / "large"
    folder.mkdir()
    rng = np.random.default_rng(0)
    small = rng.integers(0, 255, (100, 150, 3), dtype=np.uint8)
    for i in range(2):
        image = cv2.resize(small, (1500, 1000), interpolation=cv2.INTER_CUBIC)
        image = np.clip(image + rng.normal(0, 4, image.shape), 0, 255).astype(np.uint8)
        cv2.imwrite(str(folder / f"p{i}.png"), image)
    return Project.create(tmp_path / "project2", folder, name="Large").folder


def shown(qtbot, window: MainWindow, folder: Path):
    with qtbot.waitSignal(window.session.project_changed, timeout=10000):
        window.actions_of_project.open_folder(folder)
    window.show_tab("preprocessing")
    tab = window.stage_tab("preprocessing")
    qtbot.waitUntil(lambda: tab.image.canvas.array is not None, timeout=10000)
    settled(qtbot, tab)
    return tab


def settled(qtbot, tab) -> None:
    qtbot.waitUntil(lambda: not tab.live.busy and not tab.session.jobs.running, timeout=20000)


def test_the_preview_follows_the_form_and_at_full_size_equals_a_run(qtbot, window, large_project):
    tab = shown(qtbot, window, large_project)
    session = window.session
    session.choose("preprocessing", "filter", ("decolor", "wallis"))
    settled(qtbot, tab)
    whole = tab.image.piece_seen()
    assert not whole.exact and "approximate" in tab.image.honest.text()
    tab.image.canvas.focus_on(700, 500, 1.0)
    settled(qtbot, tab)
    piece = tab.image.piece_seen()
    assert piece.exact and piece.factor == 1 and "equals" in tab.image.honest.text()
    chain = session.recipe.algorithms("preprocessing", "filter")
    result = apply_filters(tab.live.preview.pixels, chain, Run())
    r = piece.region
    assert np.array_equal(piece.after, result[r.top : r.bottom, r.left : r.right])
    before = piece.after.copy()
    sheet = session.recipe.params("preprocessing", "wallis").replace(target_mean=60.0)
    session.set_params("preprocessing", "wallis", sheet)
    settled(qtbot, tab)
    assert tab.image.piece_seen().after.mean() < before.mean() - 30


def test_both_ways_of_comparing_show_the_same_place(qtbot, window, large_project):
    tab = shown(qtbot, window, large_project)
    window.session.choose("preprocessing", "filter", ("equalize",))
    tab.image.set_side_by_side(True)
    tab.image.canvas.focus_on(400, 300, 2.0)
    settled(qtbot, tab)
    assert tab.image.other.isVisible() and tab.image.other.zoom == 2.0
    x, y = tab.image.other.to_image(tab.image.other.width() / 2, tab.image.other.height() / 2)
    assert abs(x - 400) < 1 and abs(y - 300) < 1
    for look in ("contrast", "false", "photo"):
        tab.image.set_look(look)
        assert not tab.image.grab().isNull()
    tab.image.set_side_by_side(False)
    assert not tab.image.other.isVisible()


def test_without_filters_it_shows_the_photo_and_says_so(qtbot, window, large_project):
    tab = shown(qtbot, window, large_project)
    assert "no filter" in tab.image.honest.text()
    piece = tab.image.piece_seen()
    assert np.array_equal(piece.before, piece.after)


def test_the_histogram_counts_what_is_seen(qtbot, window, large_project):
    tab = shown(qtbot, window, large_project)
    window.session.choose("preprocessing", "filter", ("equalize",))
    settled(qtbot, tab)
    tab.views.setCurrentWidget(tab.histogram)
    qtbot.waitUntil(lambda: len(tab.histogram._columns) == 3, timeout=10000)
    _, before, after = tab.histogram._columns
    assert before.sum() == pytest.approx(100) and after.sum() == pytest.approx(100)


def test_ways_to_grey_are_compared_and_one_is_used(qtbot, window, large_project):
    tab = shown(qtbot, window, large_project)
    tab.views.setCurrentWidget(tab.grey)
    assert not tab.grey.use.isEnabled() and tab.grey.use.toolTip()
    tab.grey.button.click()
    qtbot.waitUntil(lambda: len(tab.grey.rows) == 8, timeout=60000)
    assert all(row.keypoints > 0 and 0 <= row.e_score <= 1 for row in tab.grey.rows)
    place = [(r.algorithm, r.choice) for r in tab.grey.rows].index(("grey", "green"))
    tab.grey.table.select_rows([place])
    tab.grey.apply()
    recipe = window.session.recipe
    assert recipe.chosen("preprocessing", "filter") == ("grey",)
    assert recipe.params("preprocessing", "grey").weights == "green"
    settled(qtbot, tab)


def test_the_analyser_judges_and_enhances(qtbot, window, large_project):
    tab = shown(qtbot, window, large_project)
    page = tab.analyser
    tab.views.setCurrentWidget(page)
    assert not page.enhance.isEnabled() and page.enhance.toolTip()
    page.button.click()
    qtbot.waitUntil(lambda: window.session.analysis is not None, timeout=60000)
    verdict = window.session.analysis.verdict
    assert verdict.enhance and verdict.duplicates
    assert "p0.png" in page.photo.text() and "threshold" in page.photo.text()
    assert "same place" in page.head.text()
    assert page.table.model.rowCount() == 2
    assert window.thumbnails._verdict("p0.png")[0] == verdict.photos[0].verdict
    page.enhance.click()
    assert set(verdict.filters) <= set(window.session.recipe.chosen("preprocessing", "filter"))
    assert not page.enhance.isEnabled() and "in the recipe" in page.enhance.toolTip()
    settled(qtbot, tab)


def test_a_filter_that_knows_no_pieces_is_previewed_on_the_whole_photo(
    qtbot, window, large_project, monkeypatch
):
    from graphos_core.preprocessing import parts

    monkeypatch.setattr(parts, "_PARTS", {})
    tab = shown(qtbot, window, large_project)
    window.session.choose("preprocessing", "filter", ("gamma",))
    settled(qtbot, tab)
    piece = tab.image.piece_seen()
    assert piece.exact and piece.after.shape[:2] == (1000, 1500)


def test_changing_while_it_computes_ends_with_the_last_wish(qtbot, window, large_project):
    tab = shown(qtbot, window, large_project)
    session = window.session
    session.choose("preprocessing", "filter", ("gamma",))
    for value in np.linspace(1.0, 4.0, 15):
        session.set_params(
            "preprocessing",
            "gamma",
            session.recipe.params("preprocessing", "gamma").replace(gamma=float(value)),
        )
        end = time.monotonic() + 0.02
        qtbot.waitUntil(lambda end=end: time.monotonic() > end)
    settled(qtbot, tab)
    chain = session.recipe.algorithms("preprocessing", "filter")
    piece = tab.image.piece_seen()
    assert np.array_equal(piece.after, apply_filters(piece.before, chain, Run()))
