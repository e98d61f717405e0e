"""The Explain panel: what the algorithm or the parameter at hand does, in both directions, with its source.

Every range, unit and default comes from the declaration, so the text cannot disagree with the program.
"""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QImage, QPixmap
from PySide6.QtWidgets import QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from graphos_core.registry import Algorithm
from graphos_core.run import Run
from graphos_py.explanations import Paragraph, about_algorithm, about_parameter
from graphos_py.formula import formula_image
from graphos_py.jobs import Job, Jobs
from graphos_py.theme import theme
from graphos_py.translation import tr


class ExplainPanel(QScrollArea):
    """Shows an explanation; follows the focus of the form.

    Signals
    -------
    lesson : str
        The person wants to read a lesson.
    simulator : str
        The person wants to open a simulator.
    tried : str, dict
        "Try this": parameter values to set, with the name of the algorithm.
    """

    lesson = Signal(str)
    simulator = Signal(str)
    tried = Signal(str, object)

    def __init__(self, jobs: Jobs, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._jobs = jobs
        self._subject: tuple[Algorithm, str] | None = None
        self._formulas: list[tuple[QLabel, str]] = []
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._later = QTimer(self, singleShot=True, interval=60)
        self._later.timeout.connect(self._fill)
        theme().changed.connect(self._later.start)
        self._fill()

    def explain(self, algorithm: Algorithm, parameter: str = "") -> None:
        """Show an algorithm, or one of its parameters."""
        if self._subject is None or self._subject != (algorithm, parameter):
            self._subject = (algorithm, parameter)
            self._later.start()

    @property
    def subject(self) -> tuple[Algorithm, str] | None:
        """The algorithm and parameter that are explained; None when nothing is."""
        return self._subject

    def clear(self) -> None:
        """Forget the subject."""
        self._subject = None
        self._later.start()

    def _fill(self) -> None:
        page = QWidget()
        page.setProperty("role", "paper")
        column = QVBoxLayout(page)
        column.setContentsMargins(12, 8, 12, 12)
        column.setSpacing(6)
        self._formulas = []
        if self._subject is None:
            column.addWidget(
                _label(tr("Click a field of a form: what it does is explained here."), "caption")
            )
        else:
            algorithm, name = self._subject
            paragraphs = about_parameter(algorithm, name) if name else about_algorithm(algorithm)
            for paragraph in paragraphs:
                self._add(column, paragraph)
        column.addStretch(1)
        self.setWidget(page)
        if self._formulas:
            self._draw_formulas()

    def _add(self, column: QVBoxLayout, paragraph: Paragraph) -> None:
        if paragraph.kind == "formula":
            label = QLabel()
            label.setMinimumWidth(1)
            label.setAccessibleName(paragraph.text)
            self._formulas.append((label, paragraph.text))
            column.addWidget(label)
        elif paragraph.kind == "picture" and paragraph.picture is not None:
            column.addWidget(_picture(paragraph.picture, theme().px(260)))
        elif paragraph.kind in ("lesson", "simulator"):
            lesson = paragraph.kind == "lesson"
            button = QPushButton(tr("Read the lesson") if lesson else tr("Open the simulator"))
            button.setProperty("role", "link")
            told = self.lesson if lesson else self.simulator
            button.clicked.connect(lambda: told.emit(paragraph.text))
            column.addWidget(button)
        elif paragraph.kind == "try":
            column.addWidget(_label(tr(paragraph.text)))
            button = QPushButton(tr("Try this"))
            algorithm = self._subject[0].name if self._subject else ""
            button.clicked.connect(lambda: self.tried.emit(algorithm, dict(paragraph.values)))
            column.addWidget(button, 0, Qt.AlignmentFlag.AlignLeft)
        else:
            if paragraph.kind == "heading" and column.count():
                column.addSpacing(6)
            role = {"heading": "heading", "group": "group", "caption": "caption"}.get(paragraph.kind, "")
            column.addWidget(_label(paragraph.text, role))

    def _draw_formulas(self) -> None:
        """Set the formulas outside the window's thread: matplotlib is slow to import."""
        wanted = [text for _, text in self._formulas]
        colour, points = theme().colour("text").name(), theme().points("heading")
        ratio = self.devicePixelRatioF()

        def work(run: Run) -> list[tuple[str, QImage]]:
            return [(text, formula_image(text, colour, points, ratio)) for text in wanted]

        job = Job(work, name="formulas", engine=False)
        job.succeeded.connect(self._formulas_drawn)
        self._jobs.start(job)

    def _formulas_drawn(self, images: list[tuple[str, QImage]]) -> None:
        drawn = dict(images)
        for label, text in self._formulas:
            if text in drawn:
                pixmap = QPixmap.fromImage(drawn[text])
                room = max(160, self.viewport().width() - 28)
                if pixmap.width() / pixmap.devicePixelRatio() > room:
                    pixmap = pixmap.scaledToWidth(
                        round(room * pixmap.devicePixelRatio()), Qt.TransformationMode.SmoothTransformation
                    )
                label.setPixmap(pixmap)


def _label(text: str, role: str = "") -> QLabel:
    label = QLabel(text)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    label.setProperty("role", role)
    return label


def _picture(pixels: Any, width: int) -> QLabel:
    from graphos_py.pixels import to_qimage

    label = QLabel()
    pixmap = QPixmap.fromImage(to_qimage(pixels))
    label.setPixmap(pixmap.scaledToWidth(width, Qt.TransformationMode.SmoothTransformation))
    return label
