"""``graphos report`` prints the stored page of a run through whatever printer is plugged in."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from graphos_core import adjustment_commands
from graphos_core.cli import main


class Printer:
    """Stands for the entry point of an application that prints."""

    def load(self) -> Any:
        return lambda page, path: path.write_text("printed " + page, "utf-8")


@pytest.fixture
def run(tmp_path: Path) -> Path:
    folder = tmp_path / "model" / "runs" / "0001"
    folder.mkdir(parents=True)
    (folder / "report.html").write_text("<h1>page</h1>", "utf-8")
    (folder / "report.json").write_text("{}", "utf-8")
    return folder


def test_report_prints_the_page_of_the_run(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(adjustment_commands, "entry_points", lambda **_: [Printer()])
    assert main(["report", str(run), "--pdf", str(tmp_path / "r.pdf")]) == 0
    assert (tmp_path / "r.pdf").read_text("utf-8") == "printed <h1>page</h1>"
    assert main(["report", str(run), "--out", str(tmp_path / "out")]) == 0
    assert {p.name for p in (tmp_path / "out").iterdir()} == {"report.html", "report.json", "report.pdf"}
    assert main(["report", str(run)]) == 0
    assert (run / "report.pdf").is_file()


def test_without_a_printer_a_way_out_is_named(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(adjustment_commands, "entry_points", lambda **_: [])
    assert main(["report", str(run)]) == 1
    assert "browser" in capsys.readouterr().err


def test_a_folder_without_report_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(tmp_path)]) == 1
    assert "has no report" in capsys.readouterr().err
