"""The controls of a simulator: one row per parameter, number and slider, made from the declarations."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QEvent, Qt, Signal
from PySide6.QtGui import QPalette, QWheelEvent
from PySide6.QtWidgets import QGridLayout, QLabel, QSlider, QVBoxLayout, QWidget

from graphos_core.errors import ParamError
from graphos_core.params import Declaration, Level, Params
from graphos_py.fields import make_field
from graphos_py.form import default_text
from graphos_py.settings import LEVELS
from graphos_py.theme import theme
from graphos_py.translation import tr

NOTCHES = 1000


class QuietSlider(QSlider):
    """A slider that leaves the wheel to the scroll area."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setRange(0, NOTCHES)
        self.setMinimumHeight(theme().px(20))

    def changeEvent(self, event: QEvent) -> None:
        """Look locked when it is."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.EnabledChange:
            palette = QPalette()
            if not self.isEnabled():
                palette.setColor(QPalette.ColorRole.Highlight, theme().colour("border"))
            self.setPalette(palette)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Do not change by scrolling."""
        event.ignore()


class Control(QWidget):
    """One parameter: its name, number and unit, below them a slider over its range.

    ``changed(value)`` while it moves, ``settled()`` when a movement is over.
    """

    changed = Signal(object)
    settled = Signal()

    def __init__(self, declaration: Declaration) -> None:
        super().__init__()
        self.declaration = declaration
        about = declaration.about
        self._field = make_field(declaration)
        self._label = QLabel(tr(about.label))
        self._label.setBuddy(self._field.widget)
        self._label.setWordWrap(True)
        unit = QLabel(tr(about.unit))
        unit.setProperty("role", "caption")
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 2, 0, 4)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(1)
        grid.setColumnStretch(0, 1)
        grid.addWidget(self._label, 0, 0)
        grid.addWidget(self._field.widget, 0, 1)
        grid.addWidget(unit, 0, 2)
        self._field.edited.connect(self._typed)
        self._slider: QuietSlider | None = None
        if declaration.kind in ("float", "int") and about.low is not None and about.high is not None:
            self._slider = QuietSlider()
            self._slider.setAccessibleName(tr(about.label))
            self._slider.valueChanged.connect(self._slid)
            self._slider.sliderReleased.connect(self.settled)
            grid.addWidget(self._slider, 1, 0, 1, 3)
        self.setToolTip(
            f"<b>{tr(about.label)}</b><br>{tr(about.help)}<br><i>{tr(about.effect)}</i><br>"
            + tr(
                "Possible: {range}. Default: {default}.",
                range=declaration.range_text,
                default=default_text(declaration),
            )
        )

    def show_value(self, value: Any) -> None:
        """Put a value in without telling anybody."""
        if not self._field.widget.hasFocus() or self._differs(value):
            shown = round(value, 4) if isinstance(value, float) else value
            self._field.show_value(shown)
            self._field.mark(False)
        if self._slider is not None and not self._slider.isSliderDown():
            self._slider.blockSignals(True)
            self._slider.setValue(round(self._part(float(value)) * NOTCHES))
            self._slider.blockSignals(False)

    def _differs(self, value: Any) -> bool:
        try:
            return bool(self._field.value() != value)
        except ParamError:
            return False

    def _part(self, value: float) -> float:
        low, high = self._range()
        return (value - low) / (high - low)

    def _range(self) -> tuple[float, float]:
        about = self.declaration.about
        return float(about.low or 0.0), float(about.high or 1.0)

    def _slid(self, notch: int) -> None:
        low, high = self._range()
        value = low + (high - low) * notch / NOTCHES
        step = self.declaration.about.step
        if step:
            value = min(max(low + round((value - low) / step) * step, low), high)
        whole = self.declaration.kind == "int"
        value = round(value) if whole else round(value, 10)
        self._field.show_value(value)
        self.changed.emit(value)
        if self._slider is not None and not self._slider.isSliderDown():
            self.settled.emit()

    def _typed(self) -> None:
        try:
            value = self._field.value()
        except ParamError as problem:
            self._field.mark(True)
            self._field.widget.setToolTip(tr(problem.message))
            return
        self._field.mark(False)
        self._field.widget.setToolTip("")
        self.changed.emit(value)
        self.settled.emit()


class SimulatorControls(QWidget):
    """All controls of a parameter sheet, in groups.

    ``changed(params)`` carries the new sheet, ``settled()`` says that a movement is over.
    """

    changed = Signal(object)
    settled = Signal()

    def __init__(self, params: Params, level: Level = "student") -> None:
        super().__init__()
        self._params = params
        self.controls: dict[str, Control] = {}
        self._headings: dict[str, QLabel] = {}
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 8, 0)
        column.setSpacing(2)
        for name, declaration in type(params).declarations().items():
            group = declaration.about.group
            if group and group not in self._headings:
                heading = QLabel(tr(group))
                heading.setProperty("role", "group")
                column.addWidget(heading)
                self._headings[group] = heading
            control = Control(declaration)
            control.changed.connect(lambda value, n=name: self._change(n, value))
            control.settled.connect(self.settled)
            self.controls[name] = control
            column.addWidget(control)
        column.addStretch(1)
        self.set_level(level)
        self.show_params(params)

    def show_params(self, params: Params) -> None:
        """Show a sheet without telling anybody."""
        self._params = params
        for name, control in self.controls.items():
            control.show_value(getattr(params, name))

    def set_level(self, level: Level) -> None:
        """Show the parameters of this level."""
        shown = set()
        for control in self.controls.values():
            about = control.declaration.about
            visible = LEVELS.index(about.level) <= LEVELS.index(level)
            control.setVisible(visible)
            if visible:
                shown.add(about.group)
        for group, heading in self._headings.items():
            heading.setVisible(group in shown)

    def set_free(self, names: tuple[str, ...] | None) -> None:
        """Lock all but these parameters, with the reason; None frees all."""
        for name, control in self.controls.items():
            free = names is None or name in names
            control.setEnabled(free)
            control.setStatusTip("" if free else tr("Fixed in this challenge."))

    def _change(self, name: str, value: Any) -> None:
        try:
            self._params = self._params.replace(**{name: value})
        except ParamError:
            return
        self.changed.emit(self._params)
