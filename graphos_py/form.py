"""A form made from a parameter sheet's declarations; no algorithm needs code here."""

from __future__ import annotations

from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QSizePolicy, QToolButton, QWidget

from graphos_core.errors import ParamError
from graphos_core.params import Declaration, Level, Params
from graphos_py.fields import Field, make_field, number_text
from graphos_py.icons import bind_icon
from graphos_py.settings import LEVELS
from graphos_py.theme import theme
from graphos_py.translation import tr


@dataclass
class Row:
    """The widgets of one parameter."""

    declaration: Declaration
    dot: QToolButton
    label: QLabel
    field: Field
    unit: QLabel
    problem: QLabel

    def widgets(self) -> tuple[QWidget, ...]:
        """Return everything but the problem line, which has its own visibility."""
        shown = (self.dot, self.label, self.field.widget)
        return (*shown, self.unit) if self.declaration.about.unit else shown


def default_text(declaration: Declaration) -> str:
    """Return the default of a parameter in words."""
    value, about = declaration.default, declaration.about
    if value is None:
        return tr("automatic")
    if isinstance(value, bool):
        return tr("yes") if value else tr("no")
    if isinstance(value, tuple):
        text = " × ".join(number_text(part) for part in value)
    elif isinstance(value, (int, float)):
        text = number_text(value)
    else:
        text = tr(about.choices.get(value, value))
    return f"{text} {tr(about.unit)}" if about.unit else text


class Form(QWidget):
    """Two columns, label and field with unit, in groups; shows and edits one sheet.

    ``changed`` carries the new sheet whenever every field is right; ``focused`` names the parameter the person is
    at; ``judged`` comes after every edit, right or wrong. A dot marks a value that differs from its default; a click on it resets. A wrong value is red with its
    sentence below; the others stay usable, and `sheet` stays the last right one.
    """

    changed = Signal(object)
    focused = Signal(str)
    judged = Signal()

    def __init__(self, sheet: Params, level: Level = "student", parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._sheet = sheet
        self._level = level
        self._rows: dict[str, Row] = {}
        self._groups: list[tuple[QLabel, list[str]]] = []
        self._open = False
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(6)
        self._grid.setVerticalSpacing(5)
        self._grid.setColumnMinimumWidth(0, 16)
        self._grid.setColumnStretch(1, 1)
        self._rescale()
        theme().changed.connect(self._rescale)
        self._build()
        self._more = QToolButton()
        self._more.setProperty("role", "flat")
        self._more.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self._more.clicked.connect(self._toggle)
        self._grid.addWidget(self._more, self._grid.rowCount(), 0, 1, 4, Qt.AlignmentFlag.AlignLeft)
        self.set_sheet(sheet)
        self._fold()

    # ------------------------------------------------------------------------------------------------ public

    def sheet(self) -> Params:
        """Return the last sheet in which everything was right."""
        return self._sheet

    def set_sheet(self, sheet: Params) -> None:
        """Show another sheet of the same class."""
        self._sheet = sheet
        for name, row in self._rows.items():
            row.field.show_value(getattr(sheet, name))
            self._say(row, "")
        self._mark()

    def set_level(self, level: Level) -> None:
        """Show what belongs to this level and fold the rest."""
        self._level, self._open = level, False
        self._fold()

    def problems(self) -> dict[str, str]:
        """Return the sentence of every wrong field."""
        return {name: row.problem.text() for name, row in self._rows.items() if row.problem.text()}

    def row(self, name: str) -> Row:
        """Return the widgets of one parameter."""
        return self._rows[name]

    # --------------------------------------------------------------------------------------------- building

    def _rescale(self) -> None:
        self._grid.setColumnMinimumWidth(2, theme().px(92))
        self._grid.setColumnMinimumWidth(3, theme().px(52))

    def _build(self) -> None:
        groups: dict[str, list[Declaration]] = {}
        for declaration in type(self._sheet).declarations().values():
            groups.setdefault(declaration.about.group, []).append(declaration)
        line = 0
        for group, members in groups.items():
            if group:
                heading = QLabel(tr(group))
                heading.setProperty("role", "group")
                self._grid.addWidget(heading, line, 0, 1, 4)
                self._groups.append((heading, [d.name for d in members]))
                line += 1
            for declaration in members:
                self._add(declaration, line)
                line += 2

    def _add(self, declaration: Declaration, line: int) -> None:
        about = declaration.about
        dot = QToolButton()
        dot.setProperty("role", "dot")
        dot.setFixedSize(QSize(16, 16))
        bind_icon(dot, "reset", "accent")
        dot.setToolTip(tr("Changed; click for the default, {value}.", value=default_text(declaration)))
        dot.setAccessibleName(tr("Reset {name}", name=tr(about.label)))
        label = QLabel(tr(about.label))
        label.setWordWrap(True)
        label.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        field = make_field(declaration)
        label.setBuddy(field.widget)
        unit = QLabel(tr(about.unit))
        unit.setProperty("role", "caption")
        unit.setWordWrap(True)
        problem = QLabel()
        problem.setProperty("role", "error")
        problem.setWordWrap(True)
        problem.hide()
        for widget in (label, field.widget, unit):
            widget.setToolTip(_tooltip(declaration))
        row = Row(declaration, dot, label, field, unit, problem)
        self._rows[declaration.name] = row
        for column, widget in enumerate((dot, label, field.widget)):
            text = declaration.kind in ("choice", "str", "pair")
            wide = 2 if column == 2 and text and not about.unit else 1
            self._grid.addWidget(widget, line, column, 1, wide)
        if about.unit:
            self._grid.addWidget(unit, line, 3)
        self._grid.addWidget(problem, line + 1, 1, 1, 3)
        name = declaration.name
        field.edited.connect(lambda: self._edited(name))
        field.focused.connect(lambda: self.focused.emit(name))
        dot.clicked.connect(lambda: self._reset(name))

    # --------------------------------------------------------------------------------------------- reacting

    def _edited(self, name: str) -> None:
        self._take(name)
        self._mark()
        self.focused.emit(name)
        self.judged.emit()

    def _take(self, name: str) -> None:
        """Judge every field; when all are right, take and tell the new sheet."""
        values = {}
        for other, row in self._rows.items():
            try:
                values[other] = row.field.value()
                self._say(row, "")
            except ParamError as problem:
                self._say(row, tr(problem.message))
        if len(values) < len(self._rows):
            return
        try:
            sheet = type(self._sheet)(**values)
        except ParamError as problem:  # a rule between several parameters
            self._say(self._rows.get(problem.name, self._rows[name]), tr(problem.message))
            return
        if sheet != self._sheet:
            self._sheet = sheet
            self.changed.emit(sheet)

    def _reset(self, name: str) -> None:
        row = self._rows[name]
        row.field.show_value(row.declaration.default)
        self._edited(name)

    def _say(self, row: Row, problem: str) -> None:
        if row.problem.text() != problem:
            row.problem.setText(problem)
            row.problem.setVisible(bool(problem) and self._visible(row))
            row.field.mark(bool(problem))

    def _mark(self) -> None:
        for row in self._rows.values():
            try:
                differs = row.field.value() != row.declaration.default
            except ParamError:
                differs = True
            row.dot.setProperty("differs", differs)
            row.dot.setVisible(differs and self._visible(row))
        self._label_more()

    def _visible(self, row: Row) -> bool:
        return self._open or LEVELS.index(row.declaration.about.level) <= LEVELS.index(self._level)

    def _toggle(self) -> None:
        self._open = not self._open
        self._fold()

    def _fold(self) -> None:
        for row in self._rows.values():
            visible = self._visible(row)
            for widget in row.widgets():
                widget.setVisible(visible and (widget is not row.dot or bool(row.dot.property("differs"))))
            row.problem.setVisible(visible and bool(row.problem.text()))
        for heading, names in self._groups:
            heading.setVisible(any(self._visible(self._rows[name]) for name in names))
        self._label_more()

    def _label_more(self) -> None:
        level = LEVELS.index(self._level)
        above = [r for r in self._rows.values() if LEVELS.index(r.declaration.about.level) > level]
        changed = sum(bool(row.dot.property("differs")) for row in above)
        self._more.setVisible(bool(above))
        text = tr("Fewer settings") if self._open else tr("{count} more settings", count=len(above))
        if changed and not self._open:
            text += " · " + tr("{count} changed", count=changed)
        self._more.setText(text)
        bind_icon(self._more, "down" if self._open else "right", "muted")


def _tooltip(declaration: Declaration) -> str:
    about = declaration.about
    parts = [f"<b>{tr(about.label)}</b><br>{tr(about.help)}"]
    if about.effect:
        parts.append(f"<i>{tr(about.effect)}</i>")
    parts.append(
        tr(
            "Possible: {range}. Default: {default}.",
            range=declaration.range_text,
            default=default_text(declaration),
        )
    )
    return "<br>".join(parts)
