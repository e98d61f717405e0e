"""The editable table of control points: typing, pasting from a spreadsheet, files with a preview, undo."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QModelIndex, QPersistentModelIndex, QSize, Qt
from PySide6.QtGui import QAction, QKeySequence, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QApplication,
    QComboBox,
    QFileDialog,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QSizePolicy,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.exchange.control_sheet import ROLES, SheetPoint
from graphos_core.exchange.table_preview import guess, read_points, strange_units
from graphos_core.params import Level
from graphos_py.control.desk import ControlDesk
from graphos_py.control.table_model import COLUMNS, ROLE_LABELS, ControlModel
from graphos_py.dialogs import documents
from graphos_py.icons import bind_icon
from graphos_py.translation import tr
from graphos_py.views.painting import paint_empty_state

NAME, ROLE = 0, 1


class ControlTable(QWidget):
    """All points of the desk; the selected one is the point that is measured."""

    def __init__(self, desk: ControlDesk, level: Level = "student") -> None:
        super().__init__()
        self.desk = desk
        self.model = ControlModel(desk)
        self.table = _Table(self.model)
        self.problem = QLabel()
        self.problem.setProperty("role", "error")
        self.problem.setWordWrap(True)
        self.problem.hide()
        self._choosing = False
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        column.addLayout(self._bar())
        column.addWidget(self.table, 1)
        column.addWidget(self.problem)
        self.model.refused.connect(self.say)
        self.table.selectionModel().selectionChanged.connect(self._selected)
        desk.point_chosen.connect(self._show_point)
        desk.changed.connect(self._changed)
        self.set_level(level)
        self._changed()

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 6, 8, 0)
        bar.setSpacing(4)
        undo, redo = self.desk.undo.createUndoAction(self), self.desk.undo.createRedoAction(self)
        self.history_actions = (undo, redo)
        undo.setShortcut(QKeySequence(QKeySequence.StandardKey.Undo))
        redo.setShortcut(QKeySequence(QKeySequence.StandardKey.Redo))
        for action in (undo, redo):
            action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        self.add_action = self._action("add", tr("New point"), self.add)
        self.remove_action = self._action("trash", tr("Remove the selected points"), self.remove)
        self.remove_action.setShortcut(QKeySequence(Qt.Key.Key_Delete))
        self.remove_action.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
        self.table.addAction(self.remove_action)
        paste = self._action("paste", tr("Paste rows from a spreadsheet"), self.paste)
        paste.setShortcut(QKeySequence(QKeySequence.StandardKey.Paste))
        copy = self._action("copy", tr("Copy rows for a spreadsheet"), self.copy)
        copy.setShortcut(QKeySequence(QKeySequence.StandardKey.Copy))
        for action in (paste, copy):
            action.setShortcutContext(Qt.ShortcutContext.WidgetShortcut)
            self.table.addAction(action)
        opened = self._action("import", tr("Open a table of points, with a preview …"), self.open)
        for action, symbol in ((undo, "undo"), (redo, "redo")):
            bind_icon(action, symbol, "text")
        for action in (self.add_action, opened, paste, copy, self.remove_action, undo, redo):
            button = QToolButton()
            button.setProperty("role", "flat")
            button.setDefaultAction(action)
            button.setAccessibleName(action.toolTip())
            if action in (self.add_action, opened):
                button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
            bar.addWidget(button)
        self.state = QLabel()
        self.state.setProperty("role", "caption")
        self.state.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.state.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        bar.addWidget(self.state, 1)
        return bar

    def _action(self, symbol: str, tip: str, then: object) -> QAction:
        action = QAction(tip, self)
        action.setIconText(tr("Open table …") if symbol == "import" else tip)
        action.setToolTip(tip)
        bind_icon(action, symbol, "text")
        action.triggered.connect(lambda: then())  # type: ignore[operator]
        return action

    # ------------------------------------------------------------------------------------------------ public

    def set_level(self, level: Level) -> None:
        """Show the columns of a level."""
        for index, column in enumerate(COLUMNS):
            hidden = level not in column.levels or (column.key == "r" and level != "novice")
            self.table.setColumnHidden(index, hidden)
        self.table.resizeColumnsToContents()

    def say(self, sentence: str) -> None:
        """Say what is wrong below the table; nothing for an empty sentence."""
        self.problem.setText(sentence)
        self.problem.setVisible(bool(sentence))

    def add(self) -> None:
        """Add a point and choose it."""
        name = self.desk.sheet.free_name()
        self.desk.edit(self.desk.sheet.with_points([SheetPoint(name)]), tr("New point {name}", name=name))
        self.desk.choose(name)

    def remove(self) -> None:
        """Remove the selected points with their measurements."""
        names = self.selected_names()
        if names:
            text = names[0] if len(names) == 1 else tr("{n} points", n=len(names))
            self.desk.edit(self.desk.sheet.without(names), tr("Remove {what}", what=text))

    def paste(self) -> None:
        """Add the rows of the clipboard; lines that are no points are named."""
        self.take_text(QApplication.clipboard().text())

    def take_text(self, text: str) -> None:
        """Add the rows of a text, its format guessed."""
        form = guess(text)
        points, bad = read_points(text, form)
        if points:
            self.desk.edit(self.desk.sheet.with_points(points), tr("Paste {n} points", n=len(points)))
        lines = [tr("Line {line}: {why}.", line=b.line, why=tr(b.why)) for b in bad[:5]]
        if units := strange_units(text, form):
            lines.insert(
                0, tr("The header says {units}, but all are taken in {unit}.", units=units, unit=form.unit)
            )
        if not points and not bad:
            lines = [tr("Nothing to paste: rows with name, x, y, z are needed.")]
        self.say("\n".join(lines))

    def copy(self) -> None:
        """Copy the selected rows, or all, with a header, separated by tabs."""
        names = self.selected_names() or [p.name for p in self.desk.sheet.points]
        keys = [c.key for c in COLUMNS if c.editable]
        titles = ["name", "role", "x [m]", "y [m]", "z [m]", "sx [mm]", "sy [mm]", "sz [mm]"]
        rows = [[self.model.plain(p, k) for k in keys] for p in self.desk.sheet.points if p.name in names]
        QApplication.clipboard().setText("\n".join("\t".join(row) for row in [titles, *rows]) + "\n")

    def open(self) -> None:
        """Ask for a file and show its preview."""
        from graphos_py.control.import_dialog import ImportDialog

        pattern = tr("Tables") + " (*.csv *.txt *.tsv *.xyz);;" + tr("All files") + " (*)"
        name, _ = QFileDialog.getOpenFileName(self, tr("Control points"), str(documents()), pattern)
        if name:
            dialog = ImportDialog(Path(name), self)
            if dialog.exec():
                self.take_points(dialog.points(), dialog.crs(), Path(name).name)

    def take_points(self, points: list[SheetPoint], crs: str, source: str) -> None:
        """Add points from a file."""
        from dataclasses import replace

        sheet = self.desk.sheet.with_points(points)
        self.desk.edit(replace(sheet, crs=crs or sheet.crs), tr("Read {file}", file=source))
        self.say("")

    def selected_names(self) -> list[str]:
        """Return the names of the selected rows."""
        rows = sorted({index.row() for index in self.table.selectionModel().selectedIndexes()})
        return [self.desk.sheet.points[row].name for row in rows if row < len(self.desk.sheet.points)]

    # ---------------------------------------------------------------------------------------------- reacting

    def _selected(self) -> None:
        row = self.table.currentIndex().row()
        if not self._choosing and 0 <= row < len(self.desk.sheet.points):
            self.desk.choose(self.desk.sheet.points[row].name)

    def _show_point(self, name: str) -> None:
        row = self.desk.sheet.index(name)
        if row != self.table.currentIndex().row() and row >= 0:
            self._choosing = True
            self.table.setCurrentIndex(self.model.index(row, NAME))
            self._choosing = False
        elif row < 0:
            self.table.clearSelection()

    def _changed(self) -> None:
        sheet = self.desk.sheet
        roles = [p.role if p.known else "" for p in sheet.points]
        parts = [tr("{n} control", n=roles.count("control")), tr("{n} check", n=roles.count("check"))]
        off, tie = roles.count("off"), roles.count("")
        parts += [tr("{n} off", n=off)] if off else []
        parts += [tr("{n} without coordinates", n=tie)] if tie else []
        parts += [tr("{n} measurements", n=len(sheet.marks))]
        self.state.setText(" · ".join([*parts, sheet.crs] if sheet.crs else parts) if sheet.points else "")
        self.state.setToolTip(self.state.text())
        self.remove_action.setEnabled(bool(sheet.points))
        if self.desk.problem is not None:
            self.say(tr(str(self.desk.problem)))
        if self.desk.point:
            self._show_point(self.desk.point)
        self.table.resizeColumnsToContents()


class _RoleDelegate(QStyledItemDelegate):
    """Lets the role be chosen from a list."""

    def createEditor(
        self, parent: QWidget, option: QStyleOptionViewItem, index: QModelIndex | QPersistentModelIndex
    ) -> QWidget:
        combo = QComboBox(parent)
        for role in ROLES:
            combo.addItem(tr(ROLE_LABELS[role]), role)
        combo.activated.connect(lambda _: self._chosen(combo))
        return combo

    def _chosen(self, combo: QComboBox) -> None:
        self.commitData.emit(combo)
        self.closeEditor.emit(combo)

    def setEditorData(self, editor: QWidget, index: QModelIndex | QPersistentModelIndex) -> None:
        assert isinstance(editor, QComboBox)
        editor.setCurrentIndex(editor.findData(index.data(Qt.ItemDataRole.EditRole)))

    def setModelData(
        self, editor: QWidget, model: object, index: QModelIndex | QPersistentModelIndex
    ) -> None:
        assert isinstance(editor, QComboBox) and isinstance(model, ControlModel)
        model.setData(index, editor.currentData())


class _Table(QTableView):
    def __init__(self, model: ControlModel) -> None:
        super().__init__()
        self.setObjectName("control points")
        self.setModel(model)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
            | QAbstractItemView.EditTrigger.AnyKeyPressed
        )
        self.setItemDelegateForColumn(ROLE, _RoleDelegate(self))
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setCornerButtonEnabled(False)
        self.setTabKeyNavigation(False)
        self.verticalHeader().setVisible(False)
        self.verticalHeader().setDefaultSectionSize(self.fontMetrics().height() + 8)
        self.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Interactive)
        self.horizontalHeader().setHighlightSections(False)

    def sizeHint(self) -> QSize:
        """Ask for some rows."""
        return QSize(640, 200)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the table, or what will be here."""
        super().paintEvent(event)
        if not self.model().rowCount():
            title = tr("Control points tie the model to the ground")
            hint = tr("Paste rows (name, x, y, z) from a spreadsheet, open a table, or make a new point; then mark "
                      "it in the photos below.")  # fmt: skip
            paint_empty_state(QPainter(self.viewport()), self.viewport().rect(), self.palette(), title, hint)
