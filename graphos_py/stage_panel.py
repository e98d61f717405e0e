"""The left column of a stage's tab: for every role its algorithm and the form of its parameters."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QMenu,
    QScrollArea,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.params import Level, Params
from graphos_core.registry import Algorithm, Stage
from graphos_py.fields import QuietCombo
from graphos_py.form import Form
from graphos_py.icons import bind_icon
from graphos_py.theme import theme
from graphos_py.translation import tr

ROLE_LABELS = {
    "analysis": "Analysis",
    "filter": "Filters",
    "detector": "Detector",
    "pairs": "Pairs",
    "matcher": "Matching",
    "verification": "Verification",
    "thinning": "Thinning",
    "tracks": "Tracks",
    "orientation": "Orientation",
    "bundle": "Bundle adjustment",
    "georeferencing": "Georeferencing",
    "depth": "Depth maps",
    "fusion": "Fusion",
    "registration": "Registration",
    "comparison": "Comparison",
}


class AlgorithmBox(QFrame):
    """One algorithm: chooser or name, and its form; in a chain also up, down and remove."""

    chosen = Signal(str)
    edited = Signal(str, object)
    focused = Signal(object, str)
    judged = Signal()
    moved = Signal(int)
    removed = Signal()

    def __init__(
        self, algorithm: Algorithm, sheet: Params, others: Sequence[Algorithm], level: Level, *, chain: bool
    ) -> None:
        super().__init__()
        self.setProperty("role", "card")
        self.algorithm = algorithm
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(8)
        head = QHBoxLayout()
        head.setSpacing(2)
        if len(others) > 1 and not chain:
            self.chooser = QuietCombo()
            for other in others:
                self.chooser.addItem(tr(other.label), other.name)
                self.chooser.setItemData(
                    self.chooser.count() - 1, tr(other.summary), Qt.ItemDataRole.ToolTipRole
                )
            self.chooser.setCurrentIndex(self.chooser.findData(algorithm.name))
            self.chooser.setAccessibleName(tr("Algorithm"))
            self.chooser.activated.connect(self._picked)
            head.addWidget(self.chooser, 1)
        else:
            name = QLabel(tr(algorithm.label))
            name.setStyleSheet("font-weight: 600")
            name.setWordWrap(True)
            name.setToolTip(tr(algorithm.summary))
            head.addWidget(name, 1)
        self._button(head, "explain", tr("Explain this algorithm")).clicked.connect(self._explain)
        if chain:
            self._button(head, "up", tr("Earlier")).clicked.connect(lambda: self.moved.emit(-1))
            self._button(head, "down", tr("Later")).clicked.connect(lambda: self.moved.emit(1))
            self._button(head, "remove", tr("Remove")).clicked.connect(lambda: self.removed.emit())
        column.addLayout(head)
        self.form = Form(sheet, level)
        self.form.changed.connect(self._changed)
        self.form.focused.connect(self._focused)
        self.form.judged.connect(self.judged)
        if algorithm.params.declarations():
            column.addWidget(self.form)

    def _button(self, row: QHBoxLayout, symbol: str, tip: str) -> QToolButton:
        button = QToolButton()
        button.setProperty("role", "flat")
        button.setToolTip(tip)
        button.setAccessibleName(tip)
        bind_icon(button, symbol, "muted")
        row.addWidget(button)
        return button

    def _picked(self, index: int) -> None:
        self.chosen.emit(str(self.chooser.itemData(index)))

    def _explain(self) -> None:
        self.focused.emit(self.algorithm, "")

    def _changed(self, sheet: Params) -> None:
        self.edited.emit(self.algorithm.name, sheet)

    def _focused(self, name: str) -> None:
        self.focused.emit(self.algorithm, name)


class StagePanel(QScrollArea):
    """All roles of one stage, rebuilt when the choice of algorithms changes, else only given new values."""

    chosen = Signal(str, object)
    edited = Signal(str, object)
    focused = Signal(object, str)
    judged = Signal()

    def __init__(self, stage: Stage, level: Level = "student") -> None:
        super().__init__()
        self.stage = stage
        self._level: Level = level
        self._shape: object = None
        self._chosen: dict[str, tuple[str, ...]] = {}
        self.boxes: dict[str, AlgorithmBox] = {}
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        theme().changed.connect(self._widen)

    @property
    def level(self) -> Level:
        """What is shown: novice, student or expert."""
        return self._level

    def set_level(self, level: Level) -> None:
        """Fold or show parameters."""
        self._level = level
        for box in self.boxes.values():
            box.form.set_level(level)

    def show_recipe(self, recipe: object) -> None:
        """Show the choices and parameters of a `Recipe`."""
        from graphos_core import registry
        from graphos_core.recipe import DEFAULTS, Recipe

        if not isinstance(recipe, Recipe):
            return
        roles = list(DEFAULTS[self.stage])
        self._chosen = {role: recipe.chosen(self.stage, role) for role in roles}
        available = {role: registry.algorithms(self.stage, role) for role in roles}
        if self._shape == self._chosen:
            for name, box in self.boxes.items():
                if box.form.sheet() != recipe.params(self.stage, name):
                    box.form.set_sheet(recipe.params(self.stage, name))
            return
        self._shape = dict(self._chosen)
        self._build(recipe, available)

    def problems(self) -> dict[str, str]:
        """Return the sentences of all wrong fields."""
        return {f"{n}.{k}": v for n, box in self.boxes.items() for k, v in box.form.problems().items()}

    def _build(self, recipe: object, available: dict[str, list[Algorithm]]) -> None:
        from graphos_core.recipe import CHAINS

        page = QWidget()
        page.setProperty("role", "paper")
        column = QVBoxLayout(page)
        column.setContentsMargins(8, 8, 8, 8)
        column.setSpacing(8)
        self.boxes = {}
        for role, algorithms in available.items():
            column.addLayout(self._heading(role, algorithms, role in CHAINS))
            by_name = {a.name: a for a in algorithms}
            if not self._chosen[role]:
                empty = QLabel(tr("None: the photos are used as they are. Add a filter with +."))
                empty.setProperty("role", "caption")
                empty.setWordWrap(True)
                column.addWidget(empty)
            for position, name in enumerate(self._chosen[role]):
                if name in by_name:
                    box = self._box(recipe, by_name[name], algorithms, role, position, role in CHAINS)
                    self.boxes[name] = box
                    column.addWidget(box)
                else:
                    column.addWidget(QLabel(tr("{name} is not installed.", name=name)))
        column.addStretch(1)
        self.setWidget(page)
        self._widen()

    def _widen(self) -> None:
        """Make the column as wide as its widest field, so that nothing has to be scrolled sideways."""
        page = self.widget()
        needed = page.minimumSizeHint().width() if page is not None else 0
        self.setMinimumWidth(max(theme().px(345), needed + self.verticalScrollBar().sizeHint().width()))

    def _heading(self, role: str, algorithms: list[Algorithm], chain: bool) -> QHBoxLayout:
        row = QHBoxLayout()
        heading = QLabel(tr(ROLE_LABELS.get(role, role.capitalize())))
        heading.setProperty("role", "heading")
        row.addWidget(heading, 1)
        rest = [a for a in algorithms if a.name not in self._chosen[role]]
        if chain and rest:
            add = QToolButton()
            add.setToolTip(tr("Add a filter"))
            add.setAccessibleName(add.toolTip())
            add.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
            bind_icon(add, "add", "text")
            menu = QMenu(add)
            for algorithm in rest:
                action = menu.addAction(tr(algorithm.label))
                action.setToolTip(tr(algorithm.summary))
                action.triggered.connect(
                    lambda _=False, name=algorithm.name: self.chosen.emit(role, (*self._chosen[role], name))
                )
            menu.setToolTipsVisible(True)
            add.setMenu(menu)
            row.addWidget(add)
        return row

    def _box(
        self,
        recipe: object,
        algorithm: Algorithm,
        others: list[Algorithm],
        role: str,
        position: int,
        chain: bool,
    ) -> AlgorithmBox:
        from graphos_core.recipe import Recipe

        assert isinstance(recipe, Recipe)
        box = AlgorithmBox(
            algorithm, recipe.params(self.stage, algorithm.name), others, self._level, chain=chain
        )
        box.edited.connect(self.edited)
        box.focused.connect(self.focused)
        box.judged.connect(self.judged)
        box.chosen.connect(lambda name: self.chosen.emit(role, (name,)))
        box.removed.connect(lambda: self.chosen.emit(role, _without(self._chosen[role], position)))
        box.moved.connect(lambda by: self.chosen.emit(role, _moved(self._chosen[role], position, by)))
        return box


def _without(names: tuple[str, ...], position: int) -> tuple[str, ...]:
    return names[:position] + names[position + 1 :]


def _moved(names: tuple[str, ...], position: int, by: int) -> tuple[str, ...]:
    target = min(max(position + by, 0), len(names) - 1)
    rest = list(_without(names, position))
    rest.insert(target, names[position])
    return tuple(rest)
