"""The page that compares algorithms: rows as they come, figures, stop, export, and why it cannot."""

import json
from pathlib import Path

import numpy as np
from PySide6.QtCore import Qt

from graphos_py.features.compare_page import ComparePage
from graphos_py.theme import theme


def choose(page: ComparePage, *names: str) -> None:
    for i in range(page.choices.list.count()):
        item = page.choices.list.item(i)
        chosen = item.data(Qt.ItemDataRole.UserRole) in names
        item.setCheckState(Qt.CheckState.Checked if chosen else Qt.CheckState.Unchecked)


def titles(page: ComparePage) -> list[str]:
    return [column.title for column in page.table.model.columns]


def test_two_algorithms_are_compared_and_exported(qtbot, show, session, tmp_path: Path) -> None:
    page = show(ComparePage(session))
    choose(page, "orb", "brisk")
    page.compare()
    assert page.stop_button.isVisibleTo(page) and not page.button.isVisibleTo(page)
    qtbot.waitUntil(lambda: page.comparison is not None and page.button.isVisibleTo(page), timeout=60000)
    assert [row.algorithm for row in page.comparison.rows] == ["brisk", "orb"]
    assert page.comparison.photos == ("p0.png", "p1.png")
    assert page.table.model.rowCount() == 2 and "correct" not in titles(page)
    assert "homography" in page.said.text()
    qtbot.waitUntil(lambda: not page.bars.image.isNull(), timeout=30000)
    light = page.bars.image
    theme().apply("dark")
    try:
        qtbot.waitUntil(
            lambda: page.bars.image is not light and page.bars.image.pixelColor(3, 3).lightness() < 60,
            timeout=30000,
        )
    finally:
        theme().apply("light")
    page.write(tmp_path / "out")
    qtbot.waitUntil(lambda: (tmp_path / "out" / "comparison.png").is_file(), timeout=30000)
    assert len(json.loads((tmp_path / "out" / "comparison.json").read_text("utf-8"))["rows"]) == 2


def test_with_a_homography_the_table_says_what_is_right(qtbot, show, session, tmp_path: Path) -> None:
    np.savetxt(tmp_path / "h.txt", [[1, 0, -30], [0, 1, -12], [0, 0, 1]])
    page = show(ComparePage(session))
    choose(page, "orb")
    page.choices.set_homography(tmp_path / "h.txt")
    page.choices.values.setText("mutual.ratio=0.7,0.8")
    page.compare()
    qtbot.waitUntil(lambda: page.comparison is not None, timeout=60000)
    assert [row.algorithm for row in page.comparison.rows] == ["orb ratio=0.7", "orb ratio=0.8"]
    assert all(row.precision > 0.9 for row in page.comparison.rows)
    assert "correct" in titles(page)
    page.choices.photos.setCurrentIndex(1)  # all photos: the homography does not fit any more
    assert page.choices.wanted().homography is None


def test_a_comparison_can_be_stopped_and_another_started(qtbot, show, session) -> None:
    page = show(ComparePage(session))
    choose(page, "sift", "harris", "moravec")
    page.choices.disturbed.setChecked(True)
    page.compare()
    page.stop()
    qtbot.waitUntil(lambda: page.button.isVisibleTo(page), timeout=60000)
    assert page.comparison is None and page.button.isEnabled()


def test_the_button_is_grey_for_a_stated_reason(show, session) -> None:
    page = show(ComparePage(session))
    choose(page)
    assert not page.button.isEnabled() and "detector" in page.state.text()
    page.compare()  # nothing happens
    assert page.comparison is None
    choose(page, "orb")
    assert page.button.isEnabled() and page.state.text() == ""


def test_a_wrong_value_becomes_a_message_and_the_page_goes_on(qtbot, show, session) -> None:
    said = []
    session.message.connect(lambda severity, problem: said.append(str(problem)))
    page = show(ComparePage(session))
    choose(page, "orb")
    page.choices.values.setText("orb.levels=99")
    page.compare()
    qtbot.waitUntil(lambda: page.button.isVisibleTo(page) and bool(said), timeout=30000)
    assert "Levels" in said[0]
    assert page.button.isEnabled()
