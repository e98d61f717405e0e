"""Prints a page of the engine as PDF on A4: the engine finds this by the entry point ``print``.

Qt's text engine lays out headings, paragraphs and tables; pictures in SVG are drawn as vectors, so they stay sharp.
"""

from __future__ import annotations

import base64
import re
import sys
from importlib import resources
from pathlib import Path

from PySide6.QtCore import QBuffer, QByteArray, QIODevice, QMarginsF, QRect, QRectF, QSizeF, Qt
from PySide6.QtGui import (
    QAbstractTextDocumentLayout,
    QFont,
    QGuiApplication,
    QImage,
    QPageLayout,
    QPageSize,
    QPainter,
    QPdfWriter,
    QPyTextObject,
    QTextBlock,
    QTextBlockFormat,
    QTextCharFormat,
    QTextCursor,
    QTextDocument,
    QTextFormat,
)
from PySide6.QtSvg import QSvgRenderer

from graphos_core.store import write_bytes

DPI = 96
"""Resolution of the layout: a px of the page is a px of the screen."""

FOOTER = 34
"""Height of the footer, px."""

PICTURE = QTextFormat.ObjectTypes.UserObject + 1
NUMBER, WIDTH = QTextFormat.Property.UserProperty + 1, QTextFormat.Property.UserProperty + 2
SHRINK = 0.85
"""A picture of the screen is drawn this much smaller, as the text is."""

LAST = 0.84
"""A heading below this share of a page begins the next one, so that it stays with what it heads."""

OBJECT = "\ufffc"


class Pictures(QPyTextObject):
    """Draws the pictures of a page where the text has a placeholder.

    Parameters
    ----------
    drawn : list of QSvgRenderer or QImage
    """

    def __init__(self, drawn: list[QSvgRenderer | QImage]) -> None:
        super().__init__()
        self.drawn = drawn

    def intrinsicSize(self, doc: QTextDocument, posInDocument: int, format: QTextFormat) -> QSizeF:
        """Return the size on the page, px."""
        picture = self.drawn[int(format.property(NUMBER))]
        size = QSizeF(picture.defaultSize() if isinstance(picture, QSvgRenderer) else picture.size())
        most = float(format.property(WIDTH))
        wide = min(most, SHRINK * size.width()) if isinstance(picture, QSvgRenderer) else most
        return QSizeF(wide, size.height() * wide / max(size.width(), 1.0))

    def drawObject(
        self,
        painter: QPainter,
        rect: QRectF | QRect,
        doc: QTextDocument,
        posInDocument: int,
        format: QTextFormat,
    ) -> None:
        """Draw one picture, nothing of it outside its place."""
        painter.save()
        painter.setClipRect(rect, Qt.ClipOperation.IntersectClip)
        picture = self.drawn[int(format.property(NUMBER))]
        if isinstance(picture, QSvgRenderer):
            picture.render(painter, rect)
        else:
            painter.drawImage(rect, picture)
        painter.restore()


def print_page(page: str, path: Path) -> None:
    """Write a page as PDF.

    Parameters
    ----------
    page : str
        HTML of `graphos_core.report.page.Page.html`.
    path : Path

    Raises
    ------
    UserError
        When the file cannot be written.
    """
    _application()
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QPdfWriter(buffer)
    writer.setPageSize(QPageSize(QPageSize.PageSizeId.A4))
    writer.setPageMargins(QMarginsF(16, 14, 16, 12), QPageLayout.Unit.Millimeter)
    writer.setResolution(DPI)
    writer.setTitle(_title(page))
    size = QSizeF(writer.width(), writer.height() - FOOTER)
    document, pictures = _document(page, size)
    _draw(document, writer, size, _title(page))
    del writer, pictures  # ends the file
    write_bytes(path, bytes(buffer.data().data()))


def _application() -> None:
    """Make the application object that Qt needs for fonts, without a screen."""
    if QGuiApplication.instance() is None:
        _application.kept = QGuiApplication([sys.argv[0], "-platform", "offscreen"])  # type: ignore[attr-defined]


def _title(page: str) -> str:
    found = re.search(r"<h1>(.*?)</h1>", page, re.DOTALL)
    return "" if found is None else re.sub(r"&#?\w+;", " ", found[1]).strip()


def _document(page: str, size: QSizeF) -> tuple[QTextDocument, Pictures]:
    """Lay the page out; the pictures are returned because the layout does not keep them alive."""
    text, drawn, widths = _without_pictures(_for_print(page), size.width())
    document = QTextDocument()
    document.setDefaultFont(QFont("Noto Sans", 9))
    style = resources.files("graphos_resources").joinpath("report/print.css").read_text("utf-8")
    document.setDefaultStyleSheet(style)
    document.setDocumentMargin(0)
    document.setHtml(text)
    pictures = Pictures(drawn)
    document.documentLayout().registerHandler(PICTURE, pictures)
    for number, width in enumerate(widths):
        cursor = document.find(f"[[{number}]]")
        form = QTextCharFormat()
        form.setObjectType(PICTURE)
        form.setProperty(NUMBER, number)
        form.setProperty(WIDTH, width)
        cursor.insertText(OBJECT, form)
    document.setPageSize(size)
    _keep_headings(document, size)
    return document, pictures


def _keep_headings(document: QTextDocument, size: QSizeF) -> None:
    """Begin a new page before a heading whose next two paragraphs, or a picture there, would be on the next page.

    After each change the whole document is laid out again: Qt's own partial layout loses paragraphs of documents with
    pages.
    """
    layout = document.documentLayout()

    def page(block: QTextBlock) -> int:
        return int(layout.blockBoundingRect(block).top() // size.height())

    block = document.begin()
    while block.isValid():
        if block.blockFormat().headingLevel():
            top = layout.blockBoundingRect(block).top()
            after = block.next().next() if block.next().isValid() else block
            apart = after.isValid() and page(after) != page(block)
            if (apart and top % size.height() > 1.0) or top % size.height() > LAST * size.height():
                form = QTextBlockFormat()
                form.setPageBreakPolicy(QTextFormat.PageBreakFlag.PageBreak_AlwaysBefore)
                QTextCursor(block).mergeBlockFormat(form)
                document.setPageSize(QSizeF(size.width(), 2.0 * size.height()))
                document.setPageSize(size)
        block = block.next()


def _for_print(page: str) -> str:
    """Return the page without what only a screen needs, and with the tiles as one table."""
    page = page.replace(" ± ", "\u00a0±\u00a0")
    page = re.sub(r"<style>.*?</style>", "", page, flags=re.DOTALL)
    page = re.sub(r"<!-- screen only -->.*?<!-- end -->", "", page, flags=re.DOTALL)
    return re.sub(r"<!-- tiles -->.*?<!-- end -->", _tiles, page, count=1, flags=re.DOTALL)


def _tiles(found: re.Match[str]) -> str:
    cells = re.findall(r'<div class="tile"><b>(.*?)</b><span>(.*?)</span></div>', found[0], re.DOTALL)
    width = 100 // max(len(cells), 1)
    row = "".join(
        f'<td width="{width}%"><b style="font-size:12pt">{value}</b><br><span class="soft">{label}</span></td>'
        for value, label in cells
    )
    return f'<table class="tiles" width="100%" cellspacing="4"><tr>{row}</tr></table>'


def _without_pictures(page: str, width: float) -> tuple[str, list[QSvgRenderer | QImage], list[float]]:
    """Return the page with numbered placeholders, the pictures, and the width each may take, px."""
    drawn: list[QSvgRenderer | QImage] = []
    widths: list[float] = []

    def replace(found: re.Match[str]) -> str:
        if found["svg"]:
            drawn.append(QSvgRenderer(QByteArray(found["svg"].encode())))
        else:
            image = QImage.fromData(QByteArray(base64.b64decode(found["data"])))
            drawn.append(image)
        row = page.rfind('<td width="', 0, found.start())
        inside = row > page.rfind("</td>", 0, found.start())
        share = int(re.match(r'<td width="(\d+)%', page[row:])[1]) if inside else 100  # type: ignore[index]
        widths.append(width * share / 100.0 - (14 if inside else 0))
        return f"[[{len(drawn) - 1}]]"

    pattern = r'(?P<svg><svg .*?</svg>)|<img [^>]*src="data:image/[a-z]+;base64,(?P<data>[^"]+)"[^>]*>'
    return re.sub(pattern, replace, page, flags=re.DOTALL), drawn, widths


def _draw(document: QTextDocument, writer: QPdfWriter, size: QSizeF, title: str) -> None:
    """Draw page after page with a footer of title and page number."""
    painter = QPainter(writer)
    count = document.pageCount()
    for number in range(count):
        if number:
            writer.newPage()
        draw_page(document, painter, size, number)
        painter.setFont(QFont("Noto Sans", 8))
        painter.setPen(Qt.GlobalColor.darkGray)
        foot = QRectF(0.0, size.height() + 12, size.width(), FOOTER - 12)
        painter.drawText(foot, Qt.AlignmentFlag.AlignLeft, title)
        painter.drawText(foot, Qt.AlignmentFlag.AlignRight, f"{number + 1} / {count}")
    painter.end()


def draw_page(document: QTextDocument, painter: QPainter, size: QSizeF, number: int) -> None:
    """Draw one page of a document; nothing beyond its edges."""
    painter.save()
    painter.translate(0.0, -number * size.height())
    context = QAbstractTextDocumentLayout.PaintContext()
    context.clip = QRectF(0.0, number * size.height(), size.width(), size.height())
    painter.setClipRect(context.clip)
    document.documentLayout().draw(painter, context)
    painter.restore()
