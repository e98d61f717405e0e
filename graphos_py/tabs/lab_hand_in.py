"""The hand-in of a lab as files: its name, and the PDF made of the page."""

from __future__ import annotations

import re
from pathlib import Path

from PySide6.QtCore import QBuffer, QIODevice, QMarginsF
from PySide6.QtGui import QFont, QPageLayout, QPageSize, QPdfWriter, QTextDocument

REPORT = "hand-in.html"
PDF_DPI = 96


def write_pdf(page: str, path: Path) -> None:
    """Write a hand-in as PDF on A4, without its plots; only in the window's thread.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    writer = QPdfWriter(buffer)
    writer.setPageSize(QPageSize(QPageSize.PageSizeId.A4))
    writer.setPageMargins(QMarginsF(18, 16, 18, 16), QPageLayout.Unit.Millimeter)
    writer.setResolution(PDF_DPI)
    width = round(writer.width() * 96 / PDF_DPI)
    document = QTextDocument()
    document.setDefaultFont(QFont("Noto Sans", 10))
    plain = re.sub(r'<img src="data:image/svg[^>]*>', "", page)  # Qt draws no text in the SVG of the plots
    document.setHtml(plain.replace("<img ", f'<img width="{width - 40}" '))
    document.print_(writer)
    del writer  # ends the file
    path.write_bytes(buffer.data().data())
