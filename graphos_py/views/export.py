"""Taking what a view shows home: PNG and SVG of the picture, CSV of the numbers; the context menu for it."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from PySide6.QtCore import QPoint, QSize
from PySide6.QtGui import QAction, QImage, QPainter
from PySide6.QtWidgets import QApplication, QFileDialog, QMenu, QMessageBox, QWidget

from graphos_core.data.record import Array
from graphos_py.translation import tr
from graphos_py.views.background import Background

Writer = Callable[[Path], None]


def image_from_array(array: Array) -> QImage:
    """Return a QImage with its own copy of uint8 (h, w) or (h, w, 3) RGB, ready to be painted fast."""
    array = np.ascontiguousarray(array)
    height, width = array.shape[:2]
    if array.ndim == 2:
        return QImage(array.data, width, height, width, QImage.Format.Format_Grayscale8).copy()
    image = QImage(array.data, width, height, 3 * width, QImage.Format.Format_RGB888)
    return image.convertToFormat(QImage.Format.Format_RGB32)


def array_from_image(image: QImage) -> Array:
    """Return uint8 (h, w, 3) RGB of a QImage."""
    image = image.convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).copy()


def write_png(widget: QWidget, path: Path, scale: float = 2.0) -> None:
    """Write the widget as it is seen, `scale` times as fine, as PNG."""
    size = widget.size() * scale
    image = QImage(size, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(scale)
    widget.render(image)
    if not image.save(str(path)):
        raise OSError(tr("The file {path} could not be written.", path=path))


def write_svg(widget: QWidget, path: Path, title: str = "") -> None:
    """Write the widget as SVG: lines and text stay lines and text, photos are embedded."""
    from PySide6.QtSvg import QSvgGenerator

    generator = QSvgGenerator()
    generator.setFileName(str(path))
    generator.setSize(QSize(widget.width(), widget.height()))
    generator.setViewBox(widget.rect())
    generator.setTitle(title)
    painter = QPainter()
    if not painter.begin(generator):
        raise OSError(tr("The file {path} could not be written.", path=path))
    widget.render(painter, QPoint(0, 0))
    painter.end()


def csv_text(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return comma-separated text with full precision, decimal point and one header line."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(header)
    for row in rows:
        writer.writerow(["" if cell is None else _plain(cell) for cell in row])
    return out.getvalue()


def write_csv(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write `csv_text` as UTF-8."""
    path.write_text(csv_text(header, rows), encoding="utf-8")


def export_menu(view: QWidget, writers: dict[str, Writer], extra: Sequence[QAction] = ()) -> QMenu:
    """Return the context menu of a view: copy the picture, export it, and the view's own actions first."""
    menu = QMenu(view)
    for action in extra:
        menu.addAction(action)
    if extra:
        menu.addSeparator()
    copy = menu.addAction(tr("Copy picture"))
    copy.triggered.connect(lambda: QApplication.clipboard().setPixmap(view.grab()))
    for ending, write in writers.items():
        action = menu.addAction(tr("Export {ending}…", ending=ending.upper()))
        action.triggered.connect(lambda _=False, e=ending, w=write: ask_and_write(view, e, w))
    return menu


def ask_and_write(view: QWidget, ending: str, write: Writer) -> None:
    """Ask for a file name and write; a failure is said in a sentence."""
    start = str(Path.home() / f"{view.objectName() or 'view'}.{ending}")
    name, _ = QFileDialog.getSaveFileName(view, tr("Export"), start, f"{ending.upper()} (*.{ending})")
    if not name:
        return
    path = Path(name) if Path(name).suffix else Path(f"{name}.{ending}")
    if ending == "csv":  # figures can be many; pictures have to be painted in this thread
        Background(view).run(partial(write, path), partial(_tell_failure, view), lane="export")
        return
    try:
        write(path)
    except OSError as problem:
        _tell_failure(view, problem)


def _tell_failure(view: QWidget, result: object) -> None:
    if isinstance(result, Exception):
        QMessageBox.warning(view, tr("Export"), tr("Nothing was written: {why}", why=result))


def _plain(cell: object) -> object:
    if isinstance(cell, float | np.floating):
        return f"{float(cell):.12g}" if np.isfinite(cell) else ""
    if isinstance(cell, str) and cell[:1] in "=+-@\t\r" and cell[:1]:
        return "'" + cell  # a spreadsheet must not take a name for a formula
    return cell
