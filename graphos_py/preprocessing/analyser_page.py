"""The image analyser: its verdict on the set and on the selected photo, with the numbers and the reason."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from graphos_core.data import PhotoSet
from graphos_core.number_format import format_value
from graphos_core.preprocessing.analyser import AnalyserParams, PhotoVerdict, SetVerdict
from graphos_core.run import Run
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.table_view import Column, TableView

WORDS = {"good": "✓ good", "weak": "! little texture", "bad": "✕ fault"}


@dataclass(frozen=True)
class Analysis:
    """The verdict on a set, and the names of its photos in order."""

    names: tuple[str, ...]
    verdict: SetVerdict

    def of(self, name: str) -> PhotoVerdict | None:
        """Return the verdict on a photo."""
        return self.verdict.photos[self.names.index(name)] if name in self.names else None


def analysed(photos: PhotoSet, params: AnalyserParams, run: Run) -> Analysis:
    """Measure and judge all photos of a set."""
    from graphos_core.analyse_command import analyse_photos

    return Analysis(tuple(p.name for p in photos.photos), analyse_photos(photos, params, run))


class AnalyserPage(QWidget):
    """Verdict of the set on top, then that of the selected photo, then all figures as a table."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self._job: Job | None = None
        self.head, self.photo = QLabel(), QLabel()
        for label in (self.head, self.photo):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.RichText)
        self.button = QPushButton(tr("Analyse the photos"))
        bind_icon(self.button, "run", "text")
        self.button.clicked.connect(self.analyse)
        self.enhance = QPushButton(tr("Enhance"))
        bind_icon(self.enhance, "preprocessing", "text")
        self.enhance.clicked.connect(self.apply)
        self.table = TableView()
        self.table.set_empty_text(
            tr("Here you will see texture, colour, sharpness, exposure and noise of each photo"),
            tr("Analyse the photos to fill the table."),
        )
        self.table.row_selected.connect(self._selected)
        row = QHBoxLayout()
        row.addWidget(self.button)
        row.addWidget(self.enhance)
        row.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 8, 12, 8)
        column.setSpacing(8)
        column.addLayout(row)
        column.addWidget(self.head)
        column.addWidget(self.photo)
        column.addWidget(self.table, 1)
        session.analysis_changed.connect(self.show_analysis)
        session.photo_selected.connect(lambda _: self._show_photo())
        session.recipe_changed.connect(lambda stage: self._show_set())
        session.project_changed.connect(self._buttons)
        self.show_analysis()

    def analyse(self) -> None:
        """Measure all photos in the background."""
        project, recipe = self.session.project, self.session.recipe
        if project is None or recipe is None or self._job is not None:
            return
        _, params = recipe.algorithm("preprocessing", "analysis")
        photos = project.photo_set
        job = Job(lambda run: analysed(photos, params, run), name="analyser")  # type: ignore[arg-type]
        job.progressed.connect(self._progress)
        job.succeeded.connect(self.session.set_analysis)
        job.failed.connect(self.session.tell)
        job.finished.connect(self._over)
        self._job = self.session.jobs.start(job)
        self._buttons()

    def apply(self) -> None:
        """Put the recommended filters into the recipe, after those that are there."""
        recipe, missing = self.session.recipe, self._missing()
        if recipe is not None and missing:
            self.session.choose(
                "preprocessing", "filter", (*recipe.chosen("preprocessing", "filter"), *missing)
            )

    def show_analysis(self) -> None:
        """Show the verdict that the session has."""
        self._show_set()
        self._show_photo()
        analysis = self.session.analysis
        self.table.set_table(_columns(analysis) if analysis is not None else [])

    def _missing(self) -> tuple[str, ...]:
        analysis, recipe = self.session.analysis, self.session.recipe
        if analysis is None or recipe is None:
            return ()
        chosen = recipe.chosen("preprocessing", "filter")
        return tuple(name for name in analysis.verdict.filters if name not in chosen)

    def _show_set(self) -> None:
        analysis = self.session.analysis
        self._buttons()
        if analysis is None:
            self.head.setText(
                tr(
                    "The analyser measures each photo and says whether enhancing the set would bring more matches."
                )
            )
            return
        verdict = analysis.verdict
        title = tr("Enhance the photos") if verdict.enhance else tr("Leave the photos as they are")
        lines = [f"<b>{escape(title)}.</b> {escape(tr(verdict.reason))}"]
        if verdict.enhance and not self._missing():
            lines.append(escape(tr("The recommended filter is in the recipe.")))
        for a, b, likeness in verdict.duplicates[:5]:
            text = tr(
                "{a} and {b} show the same from the same place (correlation {r}).",
                a=analysis.names[a], b=analysis.names[b], r=f"{likeness:.4f}",
            )  # fmt: skip
            lines.append("⚠ " + escape(text))
        if len(verdict.duplicates) > 5:
            lines.append(escape(tr("… and {n} more such pairs.", n=len(verdict.duplicates) - 5)))
        self.head.setText("<br>".join(lines))

    def _show_photo(self) -> None:
        project, analysis = self.session.project, self.session.analysis
        photos = project.photo_set.photos if project is not None else ()
        name = photos[self.session.photo].name if self.session.photo < len(photos) else ""
        found = analysis.of(name) if analysis is not None else None
        self.photo.setVisible(found is not None)
        if found is None or analysis is None:
            return
        verdict = analysis.verdict
        score = format_value(found.score if math.isfinite(found.score) else None, unit=verdict.unit)
        limit = format_value(verdict.threshold, unit=verdict.unit)
        text = tr("score {score}, threshold {limit}", score=score, limit=limit)
        remarks = " ".join(tr(r) for r in found.remarks) or tr("Nothing to remark.")
        self.photo.setText(
            f"<b>{escape(name)}: {escape(tr(WORDS[found.verdict]))}</b> · {escape(text)}<br>{escape(remarks)}"
        )
        self.table.select_rows([analysis.names.index(name)])

    def _selected(self, row: int) -> None:
        project, analysis = self.session.project, self.session.analysis
        if project is None or analysis is None or row < 0:
            return
        names = [photo.name for photo in project.photo_set.photos]
        if analysis.names[row] in names:
            self.session.select_photo(names.index(analysis.names[row]))

    def _progress(self, done: float, total: float, what: str) -> None:
        self.button.setText(tr("{done} of {total} photos", done=f"{done:.0f}", total=f"{total:.0f}"))

    def _over(self) -> None:
        self._job = None
        self.button.setText(tr("Analyse the photos"))
        self._buttons()

    def _buttons(self) -> None:
        self.button.setEnabled(self.session.project is not None and self._job is None)
        missing = self._missing()
        self.enhance.setEnabled(bool(missing))
        if missing:
            from graphos_core.registry import find

            labels = ", ".join(tr(find("preprocessing", name).label) for name in missing)
            self.enhance.setText(tr("Enhance: add {filters}", filters=labels))
            self.enhance.setToolTip("")
            return
        self.enhance.setText(tr("Enhance"))
        analysis = self.session.analysis
        if analysis is None:
            why = tr("Analyse the photos first.")
        elif analysis.verdict.enhance:
            why = tr("The recommended filter is in the recipe.")
        else:
            why = tr("Enhancing is not recommended for these photos.")
        self.enhance.setToolTip(why)


def _columns(analysis: Analysis) -> list[Column]:
    photos = analysis.verdict.photos
    figures = [photo.figures for photo in photos]
    return [
        Column(tr("photo"), list(analysis.names)),
        Column(tr("verdict"), [tr(WORDS[p.verdict]) for p in photos]),
        Column(tr("strong spots"), [f.spots for f in figures],
               help=tr("Local extrema of differences of Gaussians above SIFT's contrast threshold.")),
        Column(tr("local contrast"), [f.contrast for f in figures], tr("grey level"), decimals=1),
        Column(tr("hue dispersion"), [f.hue_dispersion for f in figures], decimals=3,
               help=tr("Circular variance, 0 (one hue) to 1.")),
        Column(tr("saturation dispersion"), [f.saturation_dispersion for f in figures], decimals=2,
               help=tr("Standard deviation divided by mean.")),
        Column(tr("blur"), [f.blur for f in figures], decimals=2, help=tr("0 sharp, 1 blurred.")),
        Column(tr("motion"), [f.motion for f in figures], decimals=2,
               help=tr("How much more one direction is blurred than the one across it.")),
        Column(tr("black"), [100.0 * f.black for f in figures], "%", decimals=1),
        Column(tr("white"), [100.0 * f.white for f in figures], "%", decimals=1),
        Column(tr("mean"), [f.mean for f in figures], tr("grey level"), decimals=0),
        Column(tr("noise"), [f.noise for f in figures], tr("grey level"), decimals=1),
        Column(tr("remarks"), [" ".join(tr(r) for r in p.remarks) or "–" for p in photos]),
    ]  # fmt: skip
