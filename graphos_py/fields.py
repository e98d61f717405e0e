"""Fields of a form: one widget per kind of parameter, all with the same four members.

``text()`` is what stands there, ``value()`` its checked value (raises `ParamError`), ``show_value()`` puts a value in,
``edited`` tells that the person changed it. A number field accepts any text, so a wrong value can stay visible, red,
while the person corrects it.
"""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QFocusEvent, QValidator, QWheelEvent
from PySide6.QtWidgets import (
    QAbstractSpinBox,
    QCheckBox,
    QComboBox,
    QFileDialog,
    QHBoxLayout,
    QLineEdit,
    QToolButton,
    QWidget,
)

from graphos_core.params import Declaration
from graphos_py.icons import bind_icon
from graphos_py.translation import tr

AUTOMATIC = "automatic"


def number_text(value: Any) -> str:
    """Write a number as short as it reads back exactly."""
    return "" if value is None else repr(value) if isinstance(value, int) else f"{value:.12g}"


class NumberBox(QAbstractSpinBox):
    """A number with arrows; free text, so that the declaration judges it, not the widget."""

    edited = Signal()

    def __init__(self, declaration: Declaration, part: int | None = None) -> None:
        super().__init__()
        self._declaration = declaration
        self._part = part
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.setMinimumWidth(78)
        self.lineEdit().textEdited.connect(self.edited)
        if declaration.optional:
            self.lineEdit().setPlaceholderText(tr(AUTOMATIC))

    def validate(self, text: str, position: int) -> tuple[QValidator.State, str, int]:
        """Accept every text; the form says what is wrong with it."""
        return QValidator.State.Acceptable, text, position

    def stepBy(self, steps: int) -> None:
        """Step by the declared step, a whole one, or a tenth of the value."""
        about = self._declaration.about
        try:
            now = float(self.text().replace(",", "."))
        except ValueError:
            now = float(self._start())
        whole = self._declaration.kind == "int"
        step = about.step or (1.0 if whole else abs(now) / 10 or 0.1)
        value = now + steps * step
        if about.low is not None and not about.low_open:
            value = max(value, about.low)
        if about.high is not None and not about.high_open:
            value = min(value, about.high)
        self.lineEdit().setText(number_text(round(value) if whole else value))
        self.edited.emit()

    def _start(self) -> float:
        default = self._declaration.default
        if isinstance(default, tuple):
            default = default[self._part or 0]
        return default if default is not None else self._declaration.about.low or 0.0

    def stepEnabled(self) -> QAbstractSpinBox.StepEnabledFlag:
        """Allow both directions; `stepBy` keeps to the declared interval."""
        return (
            QAbstractSpinBox.StepEnabledFlag.StepUpEnabled | QAbstractSpinBox.StepEnabledFlag.StepDownEnabled
        )

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Let the form scroll unless the field has the focus."""
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class QuietCombo(QComboBox):
    """A chooser that does not change when the form is scrolled over it, and is no wider than it must be."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(8)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Leave the wheel to the form."""
        event.ignore()


class Field(QObject):
    """The widget of one parameter."""

    edited = Signal()
    focused = Signal()

    def __init__(self, declaration: Declaration) -> None:
        super().__init__()
        self.declaration = declaration
        self.widget = self._make()
        self.widget.setAccessibleName(tr(declaration.about.label))
        for part in (self.widget, *self.widget.findChildren(QWidget)):
            part.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Tell when the field gets the focus."""
        if event.type() == QEvent.Type.FocusIn and isinstance(event, QFocusEvent):
            self.focused.emit()
        return False

    def value(self) -> Any:
        """Return the checked value; raises `ParamError`."""
        return self.declaration.parse(self.text())

    def mark(self, wrong: bool) -> None:
        """Show that the value is wrong, or right again."""
        for part in (self.widget, *self.widget.findChildren(QWidget)):
            part.setProperty("wrong", "true" if wrong else "false")
            part.style().unpolish(part)
            part.style().polish(part)

    def _make(self) -> QWidget:
        raise NotImplementedError

    def text(self) -> str:
        """Return what stands in the field, as it could be typed on the command line."""
        raise NotImplementedError

    def show_value(self, value: Any) -> None:
        """Put a value in without telling `edited`."""
        raise NotImplementedError


class NumberField(Field):
    """A whole or decimal number."""

    def _make(self) -> QWidget:
        self._box = NumberBox(self.declaration)
        self._box.edited.connect(self.edited)
        return self._box

    def text(self) -> str:
        return self._box.text()

    def show_value(self, value: Any) -> None:
        self._box.lineEdit().setText(number_text(value))


class PairField(Field):
    """Two numbers side by side."""

    def _make(self) -> QWidget:
        holder = QWidget()
        row = QHBoxLayout(holder)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        self._boxes = [NumberBox(self.declaration, part) for part in (0, 1)]
        for box in self._boxes:
            box.setMinimumWidth(56)
            box.edited.connect(self.edited)
            row.addWidget(box, 1)
        return holder

    def text(self) -> str:
        parts = [box.text().strip() for box in self._boxes]
        return ",".join(parts) if any(parts) else ""

    def show_value(self, value: Any) -> None:
        for box, part in zip(self._boxes, value or (None, None)):
            box.lineEdit().setText(number_text(part))


class ChoiceField(Field):
    """One of several words, or a yes/no/automatic."""

    def _make(self) -> QWidget:
        self._combo = QuietCombo()
        about, options = self.declaration.about, self.declaration.options
        if self.declaration.kind == "bool":
            options = ("true", "false")
        if self.declaration.optional:
            self._combo.addItem(tr(AUTOMATIC), "")
        words = {"true": tr("yes"), "false": tr("no")} if self.declaration.kind == "bool" else {}
        for option in options:
            label = words.get(option) or tr(about.choices.get(option, option.replace("_", " ")))
            self._combo.addItem(label, option)
        self._combo.activated.connect(self._activated)
        return self._combo

    def _activated(self, _: int) -> None:
        self.edited.emit()

    def text(self) -> str:
        return str(self._combo.currentData())

    def show_value(self, value: Any) -> None:
        word = "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
        self._combo.setCurrentIndex(self._combo.findData(word))


class SwitchField(Field):
    """Yes or no."""

    def _make(self) -> QWidget:
        self._check = QCheckBox()
        self._check.clicked.connect(self._clicked)
        return self._check

    def _clicked(self, _: bool) -> None:
        self.edited.emit()

    def text(self) -> str:
        return "true" if self._check.isChecked() else "false"

    def show_value(self, value: Any) -> None:
        self._check.setChecked(bool(value))


class TextField(Field):
    """A text."""

    def _make(self) -> QWidget:
        self._line = QLineEdit()
        self._line.textEdited.connect(self._typed)
        return self._line

    def _typed(self, _: str) -> None:
        self.edited.emit()

    def text(self) -> str:
        return self._line.text()

    def show_value(self, value: Any) -> None:
        self._line.setText("" if value is None else str(value))


class FileField(TextField):
    """A text that names a file, with a button to choose one."""

    def _make(self) -> QWidget:
        line = super()._make()
        button = QToolButton()
        button.setToolTip(tr("Choose a file"))
        button.setAccessibleName(tr("Choose a file"))
        bind_icon(button, "open", "text")
        button.clicked.connect(self._choose)
        both = QWidget()
        row = QHBoxLayout(both)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(4)
        row.addWidget(line, 1)
        row.addWidget(button)
        both.setFocusProxy(line)
        return both

    def _choose(self) -> None:
        about = self.declaration.about
        found, _ = QFileDialog.getOpenFileName(
            self._line, tr(about.label), self._line.text(), tr(about.files)
        )
        if found:
            self._line.setText(found)
            self.edited.emit()


def make_field(declaration: Declaration) -> Field:
    """Return the field for a declaration."""
    if declaration.kind == "bool":
        return ChoiceField(declaration) if declaration.optional else SwitchField(declaration)
    if declaration.about.files:
        return FileField(declaration)
    kinds = {"int": NumberField, "float": NumberField, "pair": PairField, "choice": ChoiceField}
    return kinds.get(declaration.kind, TextField)(declaration)
