"""Every parameter of every camera: value and σ, its test, and for experts what becomes of it in the next adjustment."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QHeaderView, QTableWidget, QTableWidgetItem

from graphos_core.adjustment.calibration_choices import settings_text, single_settings
from graphos_core.cameras.model import Parameter, camera_model
from graphos_core.data import Camera, Significance
from graphos_core.number_format import MINUS, UNKNOWN, format_value
from graphos_core.params import Level
from graphos_py.adjustment.camera_tiles import bundle_sheet
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.translation import tr

TITLES = ("parameter", "value", "next time", "t", "correlated with")
NAME, VALUE, NEXT, TEST, CORRELATED = range(5)
WARNED = int(Qt.ItemDataRole.UserRole)
"""Role of an item that is to be noticed."""
CHOICES = {"": "as the model says", "free": "free", "fixed": "fixed", "prior": "free with σ …"}


class ParameterTable(QTableWidget):
    """One row per parameter of one camera.

    Signals
    -------
    sigma_wanted(name)
        The person wants a parameter free with a standard deviation of its start value.
    """

    sigma_wanted = Signal(str)

    def __init__(self, session: Session) -> None:
        super().__init__(0, len(TITLES))
        self.session = session
        self.camera = 0
        self.count = 1
        self.combos: dict[str, QComboBox] = {}
        self.setObjectName("camera parameters")
        self.setHorizontalHeaderLabels([tr(title) for title in TITLES])
        helps = {TEST: "|value| / σ of the parameter; below the limit it could as well be left out.",
                 CORRELATED: "Largest correlation with another parameter of this camera.",
                 NEXT: "What becomes of it in the next adjustment."}  # fmt: skip
        for column, text in helps.items():
            header = self.horizontalHeaderItem(column)
            if header is not None:
                header.setToolTip(tr(text))
        self.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.verticalHeader().setVisible(False)
        self.horizontalHeader().setHighlightSections(False)
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        theme().changed.connect(self._recolour)

    def set_level(self, level: Level) -> None:
        """Show the tests to students, the choices to experts."""
        for column in (TEST, CORRELATED):
            self.setColumnHidden(column, level == "novice")
        sheet = bundle_sheet(self.session)
        known = sheet is not None and hasattr(sheet[1], "parameters")
        self.setColumnHidden(NEXT, level != "expert" or not known)

    def show_camera(self, camera: Camera, index: int, count: int, tests: dict[str, Significance]) -> None:
        """Show a camera; `tests` by name of the parameter."""
        self.camera, self.count, self.combos = index, count, {}
        parameters = camera_model(camera.model).parameters
        symbols = {p.name: p.symbol.replace("_", "") for p in parameters}
        self.setRowCount(len(parameters))
        for row, parameter in enumerate(parameters):
            sigma = math.nan if camera.sigmas is None else float(camera.sigmas[row])
            texts = _texts(parameter, float(camera.values[row]), sigma, tests.get(parameter.name), symbols)
            for column, text in enumerate(texts):
                self.setItem(row, column, _item(text, column, tests.get(parameter.name)))
            combo = self.combos[parameter.name] = QComboBox()
            for key, label in CHOICES.items():
                combo.addItem(tr(label), key)
            combo.activated.connect(lambda _, n=parameter.name: self._chosen(n))
            self.setCellWidget(row, NEXT, combo)
        self.show_choices()
        self._recolour()
        self.resizeColumnsToContents()

    def _recolour(self) -> None:
        """Colour what is to be noticed, in the theme of the moment."""
        for row in range(self.rowCount()):
            for column in range(self.columnCount()):
                item = self.item(row, column)
                if item is not None and item.data(WARNED):
                    item.setForeground(theme().colour("warn"))

    def show_choices(self) -> None:
        """Show what the recipe says of single parameters."""
        found = bundle_sheet(self.session)
        said = single_settings(getattr(found[1], "parameters", "")) if found is not None else {}
        for name, combo in self.combos.items():
            value = said.get((self.camera + 1, name), said.get((0, name), ""))
            prior = value not in CHOICES
            combo.setItemText(combo.findData("prior"), f"σ = {value}" if prior else tr(CHOICES["prior"]))
            combo.setCurrentIndex(combo.findData("prior" if prior else value))

    def choose(self, name: str, value: str) -> None:
        """Set what becomes of a parameter: ``""``, ``"free"``, ``"fixed"`` or a standard deviation."""
        found = bundle_sheet(self.session)
        if found is None or not hasattr(found[1], "parameters"):
            return
        settings = single_settings(found[1].parameters)
        for camera in (0, self.camera + 1):
            settings.pop((camera, name), None)
        if value:
            settings[self.camera + 1 if self.count > 1 else 0, name] = value
        self.session.set_params("adjustment", found[0], found[1].replace(parameters=settings_text(settings)))
        self.show_choices()

    def _chosen(self, name: str) -> None:
        key = str(self.combos[name].currentData())
        if key == "prior":
            self.sigma_wanted.emit(name)
        else:
            self.choose(name, key)


def _texts(
    parameter: Parameter, value: float, sigma: float, test: Significance | None, symbols: dict[str, str]
) -> list[str]:
    estimated = sigma > 0
    name = f"{tr(parameter.label)}  {parameter.symbol.replace('_', '')}"
    shown = format_value(value, sigma if estimated else None, parameter.unit, 6)
    shown = shown if estimated else tr("{value}, fixed", value=shown)
    if test is None:
        return [name, shown, "", UNKNOWN, ""]
    other = (
        f"{test.correlated_with} {test.correlation:+.2f}".replace("-", MINUS) if test.correlated_with else ""
    )
    if parameter.group == "interior":  # a camera has a principal distance and point whatever their values
        return [name, shown, "", UNKNOWN, other]
    mark = "" if test.significant else " < " + format_value(test.limit, digits=2)
    return [name, shown, "", f"{format_value(float(np.clip(test.t, 0, 1e6)), digits=3)}{mark}", other]


def _item(text: str, column: int, test: Significance | None) -> QTableWidgetItem:
    item = QTableWidgetItem(text)
    right = column in (VALUE, TEST)
    item.setTextAlignment(
        Qt.AlignmentFlag.AlignVCenter | (Qt.AlignmentFlag.AlignRight if right else Qt.AlignmentFlag.AlignLeft)
    )
    if test is not None and column == TEST:
        limit = format_value(test.limit, digits=3)
        item.setToolTip(
            tr("Significant: |value| / σ exceeds {limit}.", limit=limit)
            if test.significant
            else tr(
                "Not significant: |value| / σ is below {limit}; it could as well be left out.", limit=limit
            )
        )
        if not test.significant:
            item.setData(WARNED, True)
    if test is not None and column == CORRELATED and abs(test.correlation) > 0.9:
        item.setData(WARNED, True)
    return item
