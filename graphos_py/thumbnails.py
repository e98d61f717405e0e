"""The photos below: small pictures with a verdict dot, checked when used; the selection is that of every view."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt, QTimer
from PySide6.QtGui import QColor, QIcon, QImage, QPainter, QPen, QPixmap, QResizeEvent
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QWidget

from graphos_core.data import Adjustment
from graphos_core.run import Run
from graphos_py.jobs import Job
from graphos_py.pixels import read_thumbnail
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.thumbnail_pixels import forget, remember
from graphos_py.translation import tr

NAME = Qt.ItemDataRole.UserRole
SIZE = 112
VERDICTS = {
    "unknown": ("muted", "○", "Not oriented yet."),
    "oriented": ("good", "✓", "Oriented."),
    "left out": ("bad", "✕", "Not oriented."),
    "unused": ("muted", "–", "Not used."),
    "good": ("good", "✓", "Analyser: nothing to remark."),
    "weak": ("warn", "!", "Analyser: little texture."),
    "bad": ("bad", "✕", "Analyser: a fault of the photo."),
}


class Thumbnails(QListWidget):
    """All photos of the project, also those that are switched off."""

    def __init__(self, session: Session, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._session = session
        self._pictures: dict[str, QImage] = {}
        self._small: dict[str, tuple[QSize, QImage]] = {}
        self._reading: Job | None = None
        self._filling = False
        self._folder: Path | None = None
        self.setViewMode(QListWidget.ViewMode.IconMode)
        self.setMovement(QListWidget.Movement.Static)
        self.setResizeMode(QListWidget.ResizeMode.Adjust)
        self.setUniformItemSizes(True)
        self.setWrapping(False)
        self.setSpacing(4)
        self.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.setAccessibleName(tr("Photos"))
        self._switching = QTimer(self, singleShot=True, interval=700)
        self._switching.timeout.connect(self._switch)
        self.itemChanged.connect(self._changed)
        self.currentItemChanged.connect(self._chosen)
        session.project_changed.connect(self.rebuild)
        session.photo_selected.connect(self._show_photo)
        session.results_changed.connect(self._judge)
        session.analysis_changed.connect(self._draw_all)
        theme().changed.connect(self._rescale)
        self._rescale()

    def rebuild(self) -> None:
        """List the photos anew and read the pictures that are missing."""
        project = self._session.project
        if project is not None and project.folder != self._folder:
            self._folder = project.folder
            self._pictures.clear()
            self._small.clear()
            forget()
        self._filling = True
        self.clear()
        if project is not None:
            excluded = set(project.settings.excluded)
            names = project.settings.files or tuple(p.name for p in project.photo_set.photos)
            used = {photo.name for photo in project.photo_set.photos}
            for name in names:
                if name not in used and name not in excluded:
                    continue  # unreadable files are in the tree with their reason
                item = QListWidgetItem(name)
                item.setData(NAME, name)
                item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
                item.setCheckState(Qt.CheckState.Unchecked if name in excluded else Qt.CheckState.Checked)
                self.addItem(item)
        self._filling = False
        self._draw_all()
        self._read()

    # --------------------------------------------------------------------------------------------- pictures

    def _read(self) -> None:
        project = self._session.project
        if project is None or self._reading is not None:
            return
        folder = project.photos_folder
        names = [self.item(i).data(NAME) for i in range(self.count())]
        missing = [name for name in names if name not in self._pictures]
        if not missing:
            return

        def work(run: Run) -> None:
            for name in missing:
                run.check()
                run.show("thumbnail", (name, read_thumbnail(folder / name, 2 * SIZE)))

        self._reading = Job(work, name="thumbnails", engine=False)
        self._reading.shown.connect(self._arrived)
        self._reading.finished.connect(self._read_all)
        self._session.jobs.start(self._reading)

    def _arrived(self, _: str, values: list[tuple[str, QImage]]) -> None:
        self._pictures.update(values)
        for name, image in values:
            remember(name, image)
        names = {name for name, _image in values}
        for i in range(self.count()):
            if self.item(i).data(NAME) in names:
                self._draw(self.item(i))

    def _read_all(self) -> None:
        self._reading = None

    def _draw_all(self) -> None:
        for i in range(self.count()):
            self._draw(self.item(i))

    def _draw(self, item: QListWidgetItem) -> None:
        look, size = theme(), theme().px(SIZE)
        name = item.data(NAME)
        verdict, reason = self._verdict(name)
        colour, sign, sentence = VERDICTS[verdict]
        pixmap = QPixmap(size, round(size * 0.75))
        pixmap.fill(look.colour("canvas"))
        painter = QPainter(pixmap)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        image = self._pictures.get(name)
        if image is not None and not image.isNull():
            small = self._scaled(name, image, pixmap.size())
            painter.setOpacity(0.35 if verdict == "unused" else 1.0)
            painter.drawImage(
                (pixmap.width() - small.width()) // 2, (pixmap.height() - small.height()) // 2, small
            )
            painter.setOpacity(1.0)
        dot = look.px(18)
        painter.setPen(QPen(QColor("#ffffff"), 1.5))
        painter.setBrush(look.colour(colour))
        painter.drawEllipse(pixmap.width() - dot - 4, 4, dot, dot)
        font = painter.font()
        font.setPixelSize(round(dot * 0.7))
        font.setBold(True)
        painter.setFont(font)
        painter.setPen(look.colour("on_accent"))
        painter.drawText(pixmap.width() - dot - 4, 4, dot, dot, Qt.AlignmentFlag.AlignCenter, sign)
        painter.end()
        self._filling = True
        item.setIcon(QIcon(pixmap))
        item.setToolTip(f"{name}\n{tr(sentence)} {tr(reason)}".strip())
        self._filling = False

    def _scaled(self, name: str, image: QImage, size: QSize) -> QImage:
        """Return a photo at the size of its place; scaled once."""
        known = self._small.get(name)
        if known is None or known[0] != size:
            how = Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
            known = self._small[name] = (size, image.scaled(size, *how))
        return known[1]

    def _verdict(self, name: str) -> tuple[str, str]:
        project = self._session.project
        if project is not None and name in project.settings.excluded:
            return "unused", ""
        result = self._session.results.get("adjustment")
        adjustment = getattr(result, "adjustment", None)
        if not isinstance(adjustment, Adjustment) or name not in adjustment.block.names:
            return self._analysed(name)
        block = adjustment.block
        if block.oriented[block.names.index(name)]:
            return "oriented", ""
        return "left out", next((tr(f.reason) for f in block.failures if f.item == name), "")

    def _analysed(self, name: str) -> tuple[str, str]:
        """Return the verdict of the image analyser while there is none of the adjustment."""
        analysis = self._session.analysis
        found = analysis.of(name) if analysis is not None else None
        return ("unknown", "") if found is None else (found.verdict, " ".join(tr(r) for r in found.remarks))

    # --------------------------------------------------------------------------------------------- reacting

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Show one row to scroll sideways, or as many whole rows as there is room for."""
        super().resizeEvent(event)
        self.setWrapping(event.size().height() >= 2 * self.gridSize().height())

    def _judge(self, stage: str) -> None:
        if stage == "adjustment":
            self._draw_all()

    def _rescale(self) -> None:
        size = theme().px(SIZE)
        self.setIconSize(QSize(size, round(size * 0.75)))
        self.setGridSize(QSize(size + 20, round(size * 0.75) + theme().px(34)))
        self._draw_all()

    def _changed(self, item: QListWidgetItem) -> None:
        if not self._filling:
            self._switching.start()

    def _switch(self) -> None:
        off = tuple(
            str(self.item(i).data(NAME))
            for i in range(self.count())
            if self.item(i).checkState() == Qt.CheckState.Unchecked
        )
        project = self._session.project
        if project is not None and off != tuple(project.settings.excluded):
            self._session.change_project(excluded=off)

    def _chosen(self, item: QListWidgetItem | None) -> None:
        project = self._session.project
        if item is not None and project is not None and not self._filling:
            names = [photo.name for photo in project.photo_set.photos]
            if item.data(NAME) in names:
                self._session.select_photo(names.index(item.data(NAME)))

    def _show_photo(self, index: int) -> None:
        project = self._session.project
        if project is None or index >= len(project.photo_set.photos):
            return
        name = project.photo_set.photos[index].name
        for i in range(self.count()):
            if self.item(i).data(NAME) == name:
                self.setCurrentRow(i)
