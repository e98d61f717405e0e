"""The printed page: every text and picture of the HTML is on the paper, and headings stay with what they head."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from PySide6.QtCore import QBuffer
from PySide6.QtGui import QPainter
from PySide6.QtSvg import QSvgGenerator

from graphos_core.errors import UserError
from graphos_core.report.page import Page, Paragraph, Picture, Pictures, Section, Table
from graphos_core.report.plot import Axis, Plot
from graphos_py import printing


def picture(title: str) -> Picture:
    plot = Plot(Axis(0, 1, title), Axis(0, 1), title, width=500, height=300)
    return Picture(title, svg=plot.svg(), caption=f"caption of {title}")


def page(sections: int = 6) -> str:
    made = [
        Section(f"s{i}", f"Heading {i}", "adjustment/bundle", [
            Paragraph(f"Sentence {i}. " * 40), Table(("A", "B"), [("row", "1 ± 2")] * 12),
            picture(f"picture {i}"), Pictures([picture(f"small {i} {k}") for k in range(3)]),
        ])
        for i in range(sections)
    ]  # fmt: skip
    return Page("Title & more", "subtitle", [], [("1", "tile"), ("2", "other")], made).html()


def test_every_picture_and_every_heading_reaches_the_paper(qapp: object) -> None:
    size = printing.QSizeF(670, 980)
    document, pictures = printing._document(page(), size)
    text = document.toPlainText()
    assert len(pictures.drawn) == 6 * 4
    assert text.count(printing.OBJECT) == 6 * 4
    assert "[[" not in text
    assert all(f"Heading {i}" in text for i in range(6))
    assert "Bundle adjustment" in text


def test_no_heading_stands_alone_at_the_foot_of_a_page(qapp: object) -> None:
    height = 980.0
    document, _ = printing._document(page(9), printing.QSizeF(670, height))
    block, tops = document.begin(), []
    while block.isValid():
        if block.blockFormat().headingLevel() and block.text().startswith("Heading"):
            tops.append(document.documentLayout().blockBoundingRect(block).top() % height)
        block = block.next()
    assert len(tops) == 9
    assert max(tops) <= printing.LAST * height + 1.0


def test_every_text_of_the_page_is_drawn(qapp: object) -> None:
    size = printing.QSizeF(670, 980)
    document, _ = printing._document(page(9), size)
    drawn = ""
    for number in range(document.pageCount()):
        buffer = QBuffer()
        recorder = QSvgGenerator()
        recorder.setOutputDevice(buffer)
        painter = QPainter(recorder)
        printing.draw_page(document, painter, size, number)
        painter.end()
        drawn += buffer.data().data().decode()
    words = re.sub(r"<[^>]+>|\s", "", drawn)  # an anchor cuts a heading into two texts
    for i in range(9):
        for text in (f"Heading {i}", f"picture {i}", f"caption of picture {i}", f"small {i} 2"):
            assert text.replace(" ", "") in words, text
    assert words.count("1±2") == 9 * 12
    assert "Bundleadjustment" in words


def test_print_page_writes_a_pdf_of_several_pages(qapp: object, tmp_path: Path) -> None:
    printing.print_page(page(), tmp_path / "ä b.pdf")
    content = (tmp_path / "ä b.pdf").read_bytes()
    assert content.startswith(b"%PDF")
    assert len(re.findall(rb"/Type\s*/Page\b", content)) >= 3


def test_a_folder_that_cannot_be_written_is_said(qapp: object, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="could not be written"):
        printing.print_page(page(1), tmp_path / "file" / "r.pdf")


def test_the_engine_finds_the_printer_by_its_entry_point() -> None:
    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text("utf-8"))
    points = project["project"]["entry-points"]["graphos.applications"]
    assert points["print"] == f"{printing.__name__}:{printing.print_page.__name__}"
