"""Two stored adjustments of the project side by side: recipes, figures with AIC and BIC, cameras, photos, points."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QUrl
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QPushButton, QTextBrowser

from graphos_core.errors import GraphosError
from graphos_core.params import Level
from graphos_core.run import Run
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.project_actions import recipe_of_run
from graphos_py.project_tree import PastRun, past_runs
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.translation import tr

if TYPE_CHECKING:
    from graphos_core.run_comparison.records import Comparison

LESSON = "lesson"


class ComparisonPage(ResultPage):
    """Choose two results; their differences follow."""

    label = "Compare"
    level: Level = "student"

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.runs: list[PastRun] = []
        self.comparison: Comparison | None = None
        self.choices = (QComboBox(), QComboBox())
        self.button = QPushButton(tr("Compare"))
        bind_icon(self.button, "compare", "text")
        self.button.clicked.connect(self.compare)
        bar = QHBoxLayout()
        bar.setContentsMargins(12, 8, 12, 8)
        bar.setSpacing(8)
        for name, combo in zip("AB", self.choices, strict=True):
            label = QLabel(f"<b>{name}</b>")
            label.setBuddy(combo)
            combo.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            combo.setMinimumContentsLength(12)
            bar.addWidget(label)
            bar.addWidget(combo, 1)
        bar.addWidget(self.button)
        self.text = QTextBrowser()
        self.text.setOpenLinks(False)
        self.text.anchorClicked.connect(self._link)
        self.column.addLayout(bar)
        self.column.addWidget(self.text, 1)
        theme().changed.connect(self._show)

    def fill(self) -> None:
        """List the stored adjustments of the project, the newest first."""
        pipeline = self.session.pipeline
        if pipeline is None:
            return
        job = Job(lambda run: past_runs(pipeline), name="runs", engine=False)
        job.succeeded.connect(self._listed)
        job.failed.connect(self.session.tell)
        self.session.jobs.start(job)

    def _listed(self, runs: list[PastRun]) -> None:
        self.runs = [run for run in runs if run.stage == "adjustment"]
        for place, combo in enumerate(self.choices):
            combo.clear()
            for number, run in enumerate(self.runs):
                combo.addItem(run_label(run, len(self.runs) - number), run.key)
            combo.setCurrentIndex(min(1 - place, len(self.runs) - 1))  # A is the one before, B the newest
            combo.setEnabled(len(self.runs) > 1)
        self.button.setEnabled(len(self.runs) > 1)
        if len(self.runs) < 2:
            self.comparison = None
            title = tr("Two adjustments of this project side by side")
            hint = tr("There is one result so far. Change a parameter on the left, or a control point, and run again: "
                      "nothing is overwritten.")  # fmt: skip
            self.text.setHtml(f"<h3>{escape(title)}</h3><p>{escape(hint)}</p>")
        elif self.comparison is None:
            self.text.setHtml(f"<p>{escape(tr('Choose two results and press Compare.'))}</p>")

    def compare(self) -> None:
        """Compare the two chosen results in the background."""
        chosen = [self.runs[combo.currentIndex()] for combo in self.choices if combo.currentIndex() >= 0]
        pipeline, recipe = self.session.pipeline, self.session.recipe
        if len(chosen) < 2 or pipeline is None or recipe is None:
            return
        labels = [combo.currentText() for combo in self.choices]

        def work(run: Run) -> Comparison:
            from graphos_core.compare_runs import compare

            sides = [
                _side(pipeline.project, recipe, past, label)
                for past, label in zip(chosen, labels, strict=True)
            ]
            return compare(*sides)

        job = Job(work, name="comparison")
        job.succeeded.connect(self._compared)
        job.failed.connect(self.session.tell)
        self.session.jobs.start(job)

    def _compared(self, comparison: Comparison) -> None:
        self.comparison = comparison
        self._show()

    def _show(self) -> None:
        if self.comparison is not None:
            self.text.setHtml(comparison_html(self.comparison))

    def _link(self, url: QUrl) -> None:
        if url.scheme() == LESSON:
            self.lesson.emit(url.path())


def run_label(run: PastRun, number: int) -> str:
    """Return a short name of a stored result: its number, when it was made, its line."""
    made = run.made.replace("T", " ")[:16]
    return f"{number} · {made} · {tr(run.line)}" + (" · " + tr("present") if run.current else "")


def _side(project: Any, recipe: Any, past: PastRun, label: str) -> Any:
    from graphos_core.run_comparison.loading import ComparedRun

    found = project.store.load(past.step, past.key)
    try:
        own = recipe_of_run(project, recipe, past)
    except GraphosError:  # made by another version: the recipe is not known any more
        own = None
    return ComparedRun(label, found.adjustment, found.georeference, own)


def comparison_html(comparison: Comparison) -> str:
    """Return a comparison as rich text in the colours of the theme."""
    from graphos_core.run_comparison.page import comparison_sections

    muted = theme().colour("muted").name()
    out = [
        f"<p><b>A</b> {escape(comparison.a)}<br><b>B</b> {escape(comparison.b)}<br>"
        f"<span style='color:{muted}'>{escape(tr('Differences are B − A.'))}</span></p>"
    ]
    out += [f"<p>{escape(tr(note))}</p>" for note in comparison.notes]
    for section in comparison_sections(comparison):
        read = (
            f" &nbsp; <a href='{LESSON}:{escape(section.learn)}'>{escape(tr('lesson'))}</a>"
            if section.learn
            else ""
        )
        out.append(f"<h3>{escape(tr(section.title))}{read}</h3>")
        for part in section.parts:
            out.append(_part_html(part, muted))
    link = theme().colour("accent").name()
    return f"<style>a {{ color: {link}; text-decoration: none; }}</style>" + "".join(out)


def _part_html(part: Any, muted: str) -> str:
    if part.kind == "paragraph":
        return (
            f"<p style='color:{muted}'>{escape(tr(part.text))}</p>"
            if part.soft
            else f"<p>{escape(tr(part.text))}</p>"
        )
    if part.kind != "table":
        return ""
    line = theme().colour("border").name()
    rows = []
    if any(part.heads):
        cells = "".join(_cell("th", tr(head), part.is_text(i), line) for i, head in enumerate(part.heads))
        rows.append(f"<tr>{cells}</tr>")
    for row in part.rows:
        rows.append(
            "<tr>" + "".join(_cell("td", tr(c), part.is_text(i), line) for i, c in enumerate(row)) + "</tr>"
        )
    title = f"<p><b>{escape(tr(part.title))}</b></p>" if part.title else ""
    note = f"<p style='color:{muted}'>{escape(tr(part.note))}</p>" if part.note else ""
    return f"{title}<table cellspacing='0' cellpadding='4'>{''.join(rows)}</table>{note}"


def _cell(tag: str, text: str, left: bool, line: str) -> str:
    side = "left" if left else "right"
    return f"<{tag} align='{side}' style='border-bottom:1px solid {line}; padding-right:14px'>{escape(text)}</{tag}>"
