"""What the adjustment found out: problems first, each with a remedy; then the figures and the groups of observations."""

from __future__ import annotations

import math
from html import escape

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QScrollArea, QVBoxLayout, QWidget

from graphos_core.data import Adjustment, CheckPoints, Finding, GlobalTest
from graphos_core.number_format import format_value
from graphos_core.params import Level
from graphos_py.adjustment.tables import endings, summary
from graphos_py.icons import icon
from graphos_py.result_page import ResultPage
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.table_view import Column, TableView

MOST_ITEMS = 8


class FindingsPage(ResultPage):
    """Cards of findings, figures at a glance, precision against accuracy, groups.

    Signals
    -------
    item_wanted(name)
        A photo or point named by a finding was clicked.
    """

    label = "Findings"
    item_wanted = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self._level: Level = "student"
        self.cards = QVBoxLayout()
        self.cards.setSpacing(8)
        self.figures, self.accuracy, self.test = QLabel(), QLabel(), QLabel()
        for label in (self.figures, self.accuracy, self.test):
            label.setTextFormat(Qt.TextFormat.RichText)
            label.setWordWrap(True)
        self.groups_title = _heading(tr("Groups of observations"))
        self.groups = TableView()
        self.groups.setMinimumHeight(theme().px(150))
        inside = QWidget()
        inside.setProperty("role", "paper")
        column = QVBoxLayout(inside)
        column.setContentsMargins(12, 12, 12, 12)
        column.setSpacing(12)
        column.addWidget(self.figures)
        column.addLayout(self.cards)
        for widget in (self.accuracy, self.test, self.groups_title, self.groups):
            column.addWidget(widget)
        column.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setWidget(inside)
        self.column.addWidget(scroll)

    def set_level(self, level: Level) -> None:
        """Hide the groups from novices."""
        self._level = level
        for widget in (self.test, self.groups_title, self.groups):
            widget.setVisible(level != "novice" and self.result is not None)

    def fill(self) -> None:
        """Show the findings of the result."""
        while (item := self.cards.takeAt(0)) is not None:
            card = item.widget()
            if card is not None:
                card.deleteLater()
        if self.result is None:
            self.figures.setText(
                tr("What the adjustment finds out appears here: problems first, each with what to do.")
            )
            self.accuracy.setText("")
            self.set_level(self._level)
            return
        adjustment: Adjustment = self.result.adjustment
        self.figures.setText(cells_html(summary(adjustment, self.result.georeference), endings(adjustment)))
        for finding in ordered(adjustment.findings):
            self.cards.addWidget(self._card(finding))
        if not adjustment.findings:
            self.cards.addWidget(_quiet(tr("Nothing conspicuous was found.")))
        self.accuracy.setText("" if adjustment.check is None else check_html(adjustment.check))
        self.test.setText(
            "" if adjustment.global_test is None else test_html(adjustment.global_test, adjustment)
        )
        self.groups.set_table(group_columns(adjustment))
        self.set_level(self._level)

    def _card(self, finding: Finding) -> QFrame:
        card = QFrame()
        card.setProperty("role", "card")
        row = QHBoxLayout(card)
        row.setContentsMargins(12, 8, 12, 8)
        colour = {"error": "bad", "warning": "warn"}.get(finding.severity, "accent")
        picture = QLabel()
        size = theme().px(22)
        name = finding.severity if finding.severity in ("error", "warning") else "info"
        picture.setPixmap(icon(name, colour).pixmap(size, size))
        row.addWidget(picture, 0, Qt.AlignmentFlag.AlignTop)
        column = QVBoxLayout()
        column.setSpacing(3)
        what = QLabel(tr(finding.what))
        what.setStyleSheet("font-weight: 600")
        texts = [what, *(QLabel(tr(text)) for text in (finding.why, finding.todo) if text)]
        for label in texts:
            label.setWordWrap(True)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            column.addWidget(label)
        if finding.items or finding.learn:
            column.addWidget(self._links(finding))
        row.addLayout(column, 1)
        return card

    def _links(self, finding: Finding) -> QLabel:
        """Return the names a finding gives and its lesson, as links that wrap."""
        names = finding.items[:MOST_ITEMS]
        parts = [f"<a href='item:{number}'>{escape(name)}</a>" for number, name in enumerate(names)]
        if len(finding.items) > MOST_ITEMS:
            parts.append(escape(tr("and {n} more", n=len(finding.items) - MOST_ITEMS)))
        if finding.learn:
            parts.append(f"<a href='lesson:'>{escape(tr('Read the lesson'))}</a>")
        colour = theme().colour("accent").name()
        label = QLabel(
            f"<style>a {{ color: {colour}; text-decoration: none; }}</style>" + " &nbsp;·&nbsp; ".join(parts)
        )
        label.setTextFormat(Qt.TextFormat.RichText)
        label.setWordWrap(True)
        label.setTextInteractionFlags(Qt.TextInteractionFlag.LinksAccessibleByMouse
                                      | Qt.TextInteractionFlag.LinksAccessibleByKeyboard)  # fmt: skip
        label.linkActivated.connect(lambda link, f=finding: self._follow(link, f))
        return label

    def _follow(self, link: str, finding: Finding) -> None:
        kind, _, number = link.partition(":")
        if kind == "item":
            self.item_wanted.emit(finding.items[int(number)])
        else:
            self.lesson.emit(finding.learn)


def ordered(findings: tuple[Finding, ...]) -> list[Finding]:
    """Return errors before warnings before information, otherwise in the order they came."""
    rank = {"error": 0, "warning": 1}
    return sorted(findings, key=lambda finding: rank.get(finding.severity, 2))


def group_columns(adjustment: Adjustment) -> list[Column]:
    """Return one row per group of observations: how many, how controlled, and whether their σ was right."""
    groups = adjustment.groups
    if not groups:
        return []
    redundancy = [group.redundancy for group in groups]
    return [
        Column(tr("group"), [tr(group.kind) for group in groups]),
        Column(tr("observations"), [group.count for group in groups]),
        Column("r", redundancy, digits=5, help=tr("Sum of the redundancy numbers: what of these observations is left "
                                                  "to check the others.")),
        Column("r̄", [r / g.count if g.count else math.nan for r, g in zip(redundancy, groups)], decimals=2,
               help=tr("Mean redundancy number: 0 is not checked at all, 1 is checked completely.")),
        Column("σ0", [group.sigma0 for group in groups], decimals=2,
               help=tr("sqrt(vᵀPv / r) of the group: 1 when its a priori standard deviations are right; larger when "
                       "they are too small.")),
        Column("RMS", [group.rms for group in groups], digits=3, help=tr("Of the residuals, per scalar.")),
        Column(tr("unit"), [tr(group.unit) for group in groups]),
        Column(tr("factor"), [group.factor for group in groups], decimals=2,
               help=tr("By how much variance component estimation multiplied the a priori standard deviations.")),
    ]  # fmt: skip


def check_html(check: CheckPoints) -> str:
    """Return precision against accuracy at the check points."""
    if not check.names:
        return ""
    rms = 1000 * np.sqrt((np.asarray(check.residuals) ** 2).mean(axis=0))
    sigma = 1000 * np.sqrt((np.asarray(check.sigmas) ** 2).mean(axis=0))
    rows = "".join(
        f"<tr><td style='padding-right:24px'>{axis}</td><td align='right' style='padding-right:24px'>"
        f"{format_value(float(r), unit='mm', digits=3)}</td><td align='right'>"
        f"{format_value(float(s), unit='mm', digits=3)}</td></tr>"
        for axis, r, s in zip("XYZ", rms, sigma)
    )
    title = tr("Accuracy against precision at {n} check points", n=len(check.names))
    heads = (tr("accuracy: RMS of computed − given"), tr("precision: σ of the computed points"))
    head = "".join(f"<th align='right' style='padding-right:24px'>{escape(h)}</th>" for h in heads)
    return f"<p><b>{escape(title)}</b></p><table><tr><th></th>{head}</tr>{rows}</table>"


def test_html(test: GlobalTest, adjustment: Adjustment) -> str:
    """Return the global test in a sentence."""
    figures = {
        "statistic": format_value(test.statistic, digits=6), "lower": format_value(test.lower, digits=6),
        "upper": format_value(test.upper, digits=6), "percent": format_value(100 * test.alpha, digits=2),
        "r": format_value(adjustment.redundancy),
    }  # fmt: skip
    if test.passed:
        said = tr("Global test passed: vᵀPv = {statistic} lies between {lower} and {upper} (r = {r}, error probability "
                  "{percent} %). The a priori standard deviations agree with the residuals.", **figures)  # fmt: skip
    elif test.statistic > test.upper:
        said = tr("Global test not passed: vᵀPv = {statistic} exceeds {upper} (r = {r}, error probability {percent} %). "
                  "Either the a priori standard deviations are too small, or there are blunders, or the camera model "
                  "lacks something.", **figures)  # fmt: skip
    else:
        said = tr("Global test not passed: vᵀPv = {statistic} lies below {lower} (r = {r}, error probability "
                  "{percent} %). The observations are better than their a priori standard deviations say.",
                  **figures)  # fmt: skip
    return escape(said)


def cells_html(facts: list[tuple[str, str]], sentences: list[tuple[str, str]]) -> str:
    """Return figures in rows of five, and sentences below."""
    cells = [f"<td style='padding:2px 28px 2px 0'><b>{escape(v)}</b><br>{escape(k)}</td>" for k, v in facts]
    rows = [cells[i : i + 5] for i in range(0, len(cells), 5)]
    said = "".join(f"<br>{escape(k)}: {escape(v)}" for k, v in sentences)
    return "<table>" + "".join(f"<tr>{''.join(row)}</tr>" for row in rows) + "</table>" + said


def _heading(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", "heading")
    return label


def _quiet(text: str) -> QLabel:
    label = QLabel(text)
    label.setProperty("role", "caption")
    label.setWordWrap(True)
    return label
