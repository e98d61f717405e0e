"""The workflow on top: one step per tab, each with icon, name and a line of state; never by colour alone."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QAbstractButton, QButtonGroup, QHBoxLayout, QSizePolicy, QWidget

from graphos_py.icons import icon
from graphos_py.theme import theme
from graphos_py.translation import tr

COLOURS = {
    "not yet": "disabled",
    "next": "good",
    "done": "accent",
    "stale": "warn",
    "failed": "bad",
    "running": "accent",
    "plain": "muted",
}
SHORT = {
    "preprocessing": "Preprocess",
    "adjustment": "Adjustment",
    "dense": "Dense",
    "quality": "Quality",
}
"""Names for narrow windows and large text."""

WORDS = {
    "not yet": "not yet",
    "next": "next",
    "done": "done",
    "stale": "stale: parameters changed since",
    "failed": "failed",
    "running": "running",
    "plain": "",
}


@dataclass(frozen=True)
class StepState:
    """What a step of the ribbon says.

    Attributes
    ----------
    status : str
        A key of `COLOURS`.
    line : str
        One line of state: ``"σ0 0.43 px"``.
    reason : str
        Why it is so, for the tooltip and the screen reader.
    share : float
        Finished part while it runs, 0 to 1.
    """

    status: str = "not yet"
    line: str = ""
    reason: str = ""
    share: float = 0.0


class Step(QAbstractButton):
    """One step: number, icon of its state, name, line of state, and progress while it runs."""

    def __init__(self, number: int, key: str, label: str) -> None:
        super().__init__()
        self.setCheckable(True)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.number, self.key, self.label = number, key, label
        self.state = StepState()
        self.show_state(StepState("plain" if key in ("images", "learn") else "not yet"))

    def show_state(self, state: StepState) -> None:
        """Show a state."""
        self.state = state
        self.line = tr(state.line) or tr(WORDS[state.status])
        word = tr(WORDS[state.status])
        tip = f"{tr(self.label)}: {word or self.line}"
        for more in (self.line, tr(state.reason)):
            if more and more not in tip:
                tip += f"\n{more}"
        self.setToolTip(f"{tip}\nCtrl+{self.number}")
        self.setAccessibleName(tip.replace("\n", ". "))
        self.update()

    def sizeHint(self) -> QSize:
        """Return room for the two lines at the present font scale."""
        return QSize(theme().px(168), theme().px(60))

    def minimumSizeHint(self) -> QSize:
        """Return the width below which the lines are cut with dots."""
        return QSize(theme().px(96), theme().px(60))

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the step."""
        look = theme()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        box = QRectF(self.rect())
        if self.isChecked() or self.underMouse():
            painter.fillRect(box, look.colour("selected" if self.isChecked() else "hover"))
        self._draw_chevron(painter, box)
        colour = look.colour(COLOURS[self.state.status])
        size = look.px(22)
        name = self.state.status if self.state.status != "plain" else self.key
        pixmap = icon(name, COLOURS[self.state.status]).pixmap(QSize(size, size))
        left = look.px(10)
        painter.drawPixmap(left, round((box.height() - size) / 2) - 1, pixmap)
        self._draw_lines(painter, box.adjusted(left + size + look.px(8), 0, -look.px(14), 0), colour)
        if self.state.status == "running":
            painter.fillRect(QRectF(0, box.height() - 4, box.width(), 4), look.colour("hover"))
            painter.fillRect(QRectF(0, box.height() - 4, box.width() * self.state.share, 4), colour)
        elif self.isChecked():
            painter.fillRect(QRectF(0, box.height() - 3, box.width(), 3), look.colour("accent"))
        if self.hasFocus():
            painter.setPen(QPen(look.colour("accent"), 1, Qt.PenStyle.DotLine))
            painter.drawRect(box.adjusted(2, 2, -3, -5))

    def _draw_lines(self, painter: QPainter, box: QRectF, colour: QColor) -> None:
        look = theme()
        name_font = QFont(self.font())
        name_font.setPointSizeF(look.points("body"))
        name_font.setWeight(QFont.Weight.DemiBold)
        line_font = QFont(self.font())
        line_font.setPointSizeF(look.points("caption"))
        names, lines = QFontMetricsF(name_font), QFontMetricsF(line_font)
        top = (box.height() - names.height() - lines.height()) / 2
        painter.setFont(name_font)
        painter.setPen(look.colour("text"))
        text = f"{self.number}  {tr(self.label)}"
        if names.horizontalAdvance(text) > box.width():
            text = f"{self.number}  {tr(SHORT.get(self.key, self.label))}"
        painter.drawText(
            QRectF(box.left(), top, box.width(), names.height()),
            Qt.AlignmentFlag.AlignVCenter,
            names.elidedText(text, Qt.TextElideMode.ElideRight, box.width()),
        )
        painter.setFont(line_font)
        painter.setPen(colour if self.state.status != "plain" else look.colour("muted"))
        painter.drawText(
            QRectF(box.left(), top + names.height(), box.width(), lines.height()),
            Qt.AlignmentFlag.AlignVCenter,
            lines.elidedText(self.line, Qt.TextElideMode.ElideRight, box.width()),
        )

    def _draw_chevron(self, painter: QPainter, box: QRectF) -> None:
        if self.key in ("quality", "learn"):
            return
        painter.setPen(QPen(theme().colour("border"), 1.5))
        right, middle, reach = box.right() - 2, box.center().y(), box.height() / 5
        painter.drawPolyline(
            [QPointF(right - 7, middle - reach), QPointF(right, middle), QPointF(right - 7, middle + reach)]
        )


class Ribbon(QWidget):
    """The steps in a row; a click always goes to the tab."""

    chosen = Signal(str)

    def __init__(self, steps: list[tuple[str, str]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setProperty("role", "bar")
        self.setAttribute(Qt.WidgetAttribute.WA_StyledBackground)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(0, 0, 0, 0)
        self._row.setSpacing(0)
        self._group = QButtonGroup(self)
        self._steps: dict[str, Step] = {}
        for number, (key, label) in enumerate(steps, 1):
            step = Step(number, key, label)
            self._steps[key] = step
            self._group.addButton(step)
            self._row.addWidget(step)
            step.clicked.connect(lambda _=False, key=key: self.chosen.emit(key))

    def add_at_end(self, widget: QWidget) -> None:
        """Put a widget behind the last step."""
        self._row.addSpacing(8)
        self._row.addWidget(widget)
        self._row.addSpacing(8)

    def step(self, key: str) -> Step:
        """Return one step."""
        return self._steps[key]

    def select(self, key: str) -> None:
        """Mark the tab that is shown; an unknown key (the start page) marks none."""
        if key in self._steps:
            self._steps[key].setChecked(True)
            return
        checked = self._group.checkedButton()
        if checked is not None:
            self._group.setExclusive(False)
            checked.setChecked(False)
            self._group.setExclusive(True)

    def changeEvent(self, event: QEvent) -> None:
        """Follow the font scale."""
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.PaletteChange):
            for step in self._steps.values():
                step.updateGeometry()
                step.update()
        super().changeEvent(event)
