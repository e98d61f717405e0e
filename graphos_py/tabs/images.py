"""Photos and cameras: the selected photo with its mask, what its file says, and the cameras of the project."""

from __future__ import annotations

from html import escape
from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QLabel, QSplitter, QStackedWidget, QVBoxLayout, QWidget

from graphos_core.data import Camera, Photo, PhotoSet
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_core.run import Run
from graphos_py.empty_state import EmptyState
from graphos_py.jobs import Job
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.translation import tr

KINDS = "preprocessing/kinds-of-images"

EMPTY = (
    "No photos yet",
    "Here you will see your photos, what their files say about the camera, and where the principal distance "
    "comes from. Drop a folder of photos into the window, or choose one.",
)


def photo_facts(photo: Photo, camera: Camera) -> list[tuple[str, str]]:
    """Return what is known about a photo, as names and values with units."""
    exif = photo.exif
    focal = format_value(camera.focal_px, unit="px", digits=5)
    if camera.pixel_pitch_mm:
        focal += f" = {format_value(camera.focal_px * camera.pixel_pitch_mm, unit='mm', digits=4)}"
    facts = [
        ("Size", f"{photo.width} × {photo.height}{THIN_SPACE}px"),
        (
            "Depth",
            tr("{bits} bit, {kind}", bits=photo.bits, kind=_kind(photo.channels)),
        ),
        ("Camera", tr(camera.label)),
        ("Principal distance", focal + (" · " + tr("estimated") if camera.focal_estimated else "")),
        ("Its source", tr(camera.focal_source)),
    ]
    if exif.focal_mm:
        facts.append(("Focal length (EXIF)", format_value(exif.focal_mm, unit="mm")))
    if exif.focal_35mm:
        facts.append(("35 mm equivalent", format_value(exif.focal_35mm, unit="mm")))
    if exif.taken:
        facts.append(("Taken", exif.taken))
    if exif.latitude_deg is not None and exif.longitude_deg is not None:
        facts.append(("GNSS", f"{exif.latitude_deg:.6f}°, {exif.longitude_deg:.6f}°"))
    if exif.altitude_m is not None:
        facts.append(("Altitude", format_value(exif.altitude_m, unit="m")))
    facts += [("Note", tr(remark)) for remark in photo.remarks]
    return facts


def _kind(channels: int) -> str:
    if channels in (1, 3):
        return tr("grey") if channels == 1 else tr("colour")
    return tr("{count} bands", count=channels)


class ImagesTab(QWidget):
    """The selected photo large; below it the table of photos and the table of cameras."""

    asked = Signal(str)
    lesson = Signal(str)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self._made = False
        self._reading: Job | None = None
        self._shown = ""
        self.empty_state = EmptyState("images", *EMPTY, "Choose photos …")
        self.empty_state.acted.connect(lambda: self.asked.emit("new"))
        self.stack = QStackedWidget()
        self.stack.addWidget(self.empty_state)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.stack)
        session.project_changed.connect(self.refresh)
        session.photo_selected.connect(self._selected)

    def refresh(self) -> None:
        """Show the project's photos."""
        if self.session.project is None:
            self.stack.setCurrentWidget(self.empty_state)
            return
        if not self.isVisible():
            return
        if not self._made:
            self._make()
        self.stack.setCurrentIndex(1)
        photo_set = self.session.project.photo_set
        self._fill_tables(photo_set)
        self._shown = ""
        if self.masks.photo is not None and self.masks.photo not in photo_set.photos:
            self.masks.forget()
        self._selected(self.session.photo)

    def showEvent(self, event: QShowEvent) -> None:
        """Catch up with what happened while hidden."""
        super().showEvent(event)
        self.refresh()

    def _make(self) -> None:
        from graphos_py.masks.editor import MaskEditor
        from graphos_py.views.image_view import ImageView
        from graphos_py.views.table_view import TableView

        self._made = True
        self.image = ImageView()
        self.masks = MaskEditor(self.session, self.image.canvas)
        self.masks.lesson.connect(self.lesson)
        upper = QWidget()
        stacked = QVBoxLayout(upper)
        stacked.setContentsMargins(0, 0, 0, 0)
        stacked.setSpacing(0)
        stacked.addWidget(self.masks)
        stacked.addWidget(self.image, 1)
        self.facts = QLabel()
        self.facts.setTextFormat(Qt.TextFormat.RichText)
        self.facts.setWordWrap(True)
        self.facts.setMargin(12)
        self.facts.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.facts.setTextInteractionFlags(Qt.TextInteractionFlag.TextBrowserInteraction)
        self.facts.linkActivated.connect(self.lesson)
        self.cameras = TableView()
        lower = QWidget()
        side = QVBoxLayout(lower)
        side.setContentsMargins(0, 0, 8, 8)
        heading = QLabel(tr("Cameras"))
        heading.setProperty("role", "heading")
        heading.setContentsMargins(12, 0, 0, 0)
        side.addWidget(self.facts)
        side.addWidget(heading)
        side.addWidget(self.cameras, 1)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(upper)
        splitter.addWidget(lower)
        splitter.setStretchFactor(0, 3)
        splitter.setStretchFactor(1, 2)
        splitter.setSizes([720, 420])
        self.stack.addWidget(splitter)

    def _fill_tables(self, photo_set: PhotoSet) -> None:
        from graphos_py.views.table_view import Column

        cameras = photo_set.cameras
        counts = [sum(p.camera == i for p in photo_set.photos) for i in range(len(cameras))]
        sources = [tr("estimated") if c.focal_estimated else tr(c.focal_source) for c in cameras]
        self.cameras.set_table(
            [
                Column(tr("camera"), [tr(camera.label) for camera in cameras]),
                Column(tr("photos"), counts),
                Column(tr("width"), [camera.width for camera in cameras], "px"),
                Column(tr("height"), [camera.height for camera in cameras], "px"),
                Column("f", [camera.focal_px for camera in cameras], "px", digits=5),
                Column(tr("source of f"), sources),
            ]
        )

    def _selected(self, index: int) -> None:
        project = self.session.project
        if not self._made or not self.isVisible() or project is None:
            return
        photos = project.photo_set.photos
        if index >= len(photos):
            return
        photo = photos[index]
        facts = facts_html(photo.name, photo_facts(photo, project.photo_set.cameras[photo.camera]))
        if photo.remarks or photo.bits > 8 or photo.channels not in (1, 3):
            words = escape(tr("What becomes of this kind of image"))
            facts += f"<p><a href='{KINDS}' style='color:{theme().colour('accent').name()}'>{words}</a></p>"
        self.facts.setText(facts)
        self.masks.show_photo(photo)
        if photo.digest != self._shown:
            self._shown = photo.digest
            read_photo(self.session, photo, self._read, as_taken=True)

    def _read(self, read: tuple[str, Any]) -> None:
        digest, pixels = read
        if digest == self._shown:
            self.image.set_image(pixels)


def facts_html(name: str, facts: list[tuple[str, str]]) -> str:
    """Return a small table as HTML, everything escaped."""
    rows = "".join(
        f"<tr><td style='padding:2px 16px 2px 0'>{escape(tr(label))}</td><td><b>{escape(value)}</b></td></tr>"
        for label, value in facts
    )
    return f"<h3>{escape(name)}</h3><table>{rows}</table>"


def read_photo(session: Session, photo: Photo, then: Any, *, as_taken: bool = False) -> Job:
    """Read a photo's pixels in the background; `then` gets (digest of `photo`, uint8 pixels).

    It is read as results see it, undistorted where it is, so that keypoints and residuals lie at their places; with
    `as_taken` as the camera took it.
    """
    seen = photo if as_taken else session.seen(photo)

    def work(run: Run) -> tuple[str, Any]:
        from graphos_core.bands import visible
        from graphos_core.images import read_pixels
        from graphos_core.preprocessing.grey import eight_bit

        return photo.digest, eight_bit(visible(read_pixels(seen)))

    job = Job(work, name=f"photo {photo.name}", engine=False)
    job.succeeded.connect(then)
    job.failed.connect(session.tell)
    return session.jobs.start(job)
