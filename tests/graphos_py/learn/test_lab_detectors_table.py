"""The table of the lab that compares detectors."""

from __future__ import annotations

import json
from pathlib import Path

from pytestqt.qtbot import QtBot

from graphos_didactic.lab_detectors import NUMBERS, place
from graphos_didactic.lab_session import LabSession
from graphos_didactic.labs import labs
from graphos_py.tabs.lab_detectors import COLUMNS, DetectorTable


def test_the_table_shows_the_detectors_that_were_run_and_no_others(qtbot: QtBot, tmp_path: Path) -> None:
    table = DetectorTable()
    qtbot.addWidget(table)
    student = LabSession(labs()["the-same-wall-five-detectors"], "Anna", tmp_path)
    table.show_lab(student)
    assert table.isHidden()
    file = place(student.simulation, "orb")
    file.parent.mkdir(parents=True)
    numbers = {name: 0.25 + i for i, name in enumerate(NUMBERS)}
    file.write_text(json.dumps(numbers), "utf-8")
    table.show_lab(student)
    assert not table.isHidden()
    assert table.rowCount() == 1
    shown = [table.item(0, column).text() for column in range(table.columnCount())]  # type: ignore[union-attr]
    assert shown[0] == "ORB"
    key, _, _, factor, decimals = COLUMNS[4]
    assert shown[5] == f"{factor * numbers[key]:.{decimals}f}"


def test_a_lab_without_detectors_has_no_table(qtbot: QtBot, tmp_path: Path) -> None:
    table = DetectorTable()
    qtbot.addWidget(table)
    table.show_lab(LabSession(labs()["from-photos-to-a-model"], "Anna", tmp_path))
    assert table.isHidden()
