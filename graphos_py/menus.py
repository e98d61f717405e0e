"""Menus and shortcuts as people expect them, the level switch and the theme button in the corner."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QActionGroup, QKeySequence
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QMenu, QMessageBox, QToolButton, QWidget

from graphos_core import __version__
from graphos_py.icons import bind_icon
from graphos_py.settings import LEVELS
from graphos_py.theme import theme
from graphos_py.translation import languages, tr

if TYPE_CHECKING:
    from graphos_py.main_window import MainWindow

SCALES = (1.0, 1.25, 1.5, 1.75, 2.0)
LEVEL_TIPS = {
    "novice": "Only the parameters one needs at first.",
    "student": "The parameters a course talks about.",
    "expert": "Every parameter.",
}


class Menus:
    """Builds the menu bar of the main window and keeps its actions."""

    def __init__(self, window: MainWindow) -> None:
        self.window = window
        self._hidden: set[str] = set()
        self._file()
        self._project()
        self._run()
        self._view()
        self._help()
        self._corner()

    def hidden_by_person(self, dock: str) -> bool:
        """Say whether the person switched a dock off."""
        return dock in self._hidden

    def update_running(self, running: bool, reason: str) -> None:
        """Follow what can be run or stopped."""
        self.stop.setEnabled(running)
        self.run_all.setEnabled(not reason)
        self.run_all.setToolTip(tr(reason))
        has_project = self.window.session.project is not None
        for action in self._need_project:
            action.setEnabled(has_project and not running)

    # -------------------------------------------------------------------------------------------- the menus

    def _add(
        self, menu: QMenu, text: str, slot: Callable[[], object], keys: object = None, symbol: str = ""
    ) -> QAction:
        action = menu.addAction(tr(text))
        if isinstance(keys, QKeySequence.StandardKey):
            action.setShortcuts(keys)
        elif isinstance(keys, str):
            action.setShortcut(QKeySequence(keys))
        if symbol:
            bind_icon(action, symbol)
        action.triggered.connect(lambda _=False: slot())
        return action

    def _file(self) -> None:
        window, project = self.window, self.window.actions_of_project
        menu = window.menuBar().addMenu(tr("&File"))
        keys = QKeySequence.StandardKey
        self._add(menu, "&New project …", project.new, keys.New, "new")
        self._add(menu, "&Open project …", project.open, keys.Open, "open")
        self._recent = menu.addMenu(tr("Open &recent"))
        bind_icon(self._recent, "recent")
        self._recent.aboutToShow.connect(self._fill_recent)
        self._add(menu, "&Demo project", project.demo, None, "demo")
        menu.addSeparator()
        self._need_project = [
            self._add(menu, "&Load recipe …", project.load_recipe),
            self._add(menu, "&Save recipe as …", project.save_recipe, keys.SaveAs, "save"),
            self._add(menu, "&Write report and models …", project.export, "Ctrl+E"),
        ]
        self._add(menu, "Con&vert cameras and orientations …", self._convert, None, "compare")
        menu.addSeparator()
        self._add(menu, "Start &page", lambda: window.show_tab("start"), "Ctrl+Home")
        quit_action = self._add(menu, "&Quit", window.close, keys.Quit)
        if not quit_action.shortcuts():
            quit_action.setShortcut(QKeySequence("Ctrl+Q"))

    def _convert(self) -> None:
        from graphos_py.convert.dialog import ConvertDialog

        ConvertDialog(self.window).show()

    def _fill_recent(self) -> None:
        self._recent.clear()
        project = self.window.actions_of_project
        for path in self.window.settings.recent():
            action = self._recent.addAction(f"{path.name}    {path.parent}")
            action.triggered.connect(lambda _=False, path=path: project.open_folder(path))
        if self._recent.isEmpty():
            self._recent.addAction(tr("None yet")).setEnabled(False)

    def _project(self) -> None:
        project = self.window.actions_of_project
        menu = self.window.menuBar().addMenu(tr("&Project"))
        self._need_project += [
            self._add(menu, "&Camera …", lambda: project.ask("camera"), None, "camera"),
            self._add(menu, "Control &points …", lambda: project.ask("control"), None, "control"),
            self._add(menu, "Known &distance …", lambda: project.ask("distance"), None, "ruler"),
            self._add(menu, "&Reference surface …", lambda: project.ask("reference"), None, "quality"),
        ]
        menu.addSeparator()
        self._need_project += [
            self._add(menu, "&Seed …", lambda: project.ask("seed")),
            self._add(menu, "Back to &default parameters", project.reset_recipe),
            self._add(menu, "Open the project &folder", project.show_folder, None, "project"),
        ]

    def _run(self) -> None:
        window = self.window
        menu = window.menuBar().addMenu(tr("&Run"))
        menu.setToolTipsVisible(True)
        self._add(menu, "Run this &step", window.run_current, "F5", "run")
        self.run_all = self._add(menu, "Run &all", window.run_everything, "Ctrl+F5", "run all")
        self.stop = self._add(menu, "S&top", window.session.stop, "Esc", "stop")
        menu.addSeparator()
        from graphos_py.main_window import STEPS

        for number, (key, label) in enumerate(STEPS, 1):
            self._add(menu, label, lambda key=key: window.show_tab(key), f"Ctrl+{number}", key)  # type: ignore[misc]

    def _view(self) -> None:
        window = self.window
        menu = window.menuBar().addMenu(tr("&View"))
        for name, dock in window.docks.items():
            action = menu.addAction(dock.windowTitle())
            action.setCheckable(True)
            action.setChecked(True)
            action.triggered.connect(lambda on, name=name: self._toggle_dock(name, on))
        menu.addSeparator()
        self._themes = QActionGroup(window)
        for name, label in (("light", "&Light"), ("dark", "&Dark")):
            action = self._add(menu, label, lambda name=name: self.use_theme(name), None, name)  # type: ignore[misc]
            action.setCheckable(True)
            action.setChecked(theme().name == name)
            action.setData(name)
            self._themes.addAction(action)
        sizes = menu.addMenu(tr("&Text size (projector)"))
        self._sizes = QActionGroup(window)
        for scale in SCALES:
            action = self._add(sizes, f"{scale * 100:.0f} %", lambda scale=scale: self.use_scale(scale))  # type: ignore[misc]
            action.setCheckable(True)
            action.setChecked(abs(theme().scale - scale) < 0.01)
            action.setData(scale)
            self._sizes.addAction(action)
        sizes.addSeparator()
        self._add(sizes, "Larger", lambda: self.use_scale(theme().scale + 0.25), "Ctrl++")
        self._add(sizes, "Smaller", lambda: self.use_scale(theme().scale - 0.25), "Ctrl+-")
        if len(languages()) > 1:
            self._languages(menu)
        menu.addSeparator()
        self._add(menu, "&Full screen", self._full_screen, "F11")

    def _languages(self, menu: QMenu) -> None:
        from PySide6.QtCore import QLocale

        languages_menu = menu.addMenu(tr("L&anguage"))
        group = QActionGroup(self.window)
        for code in languages():
            name = QLocale(code).nativeLanguageName().capitalize() or code
            action = self._add(languages_menu, name, lambda code=code: self._use_language(code))  # type: ignore[misc]
            action.setCheckable(True)
            action.setChecked(self.window.settings.language == code)
            group.addAction(action)

    def _help(self) -> None:
        menu = self.window.menuBar().addMenu(tr("&Help"))
        self._add(menu, "&Lessons and simulators", lambda: self.window.show_tab("learn"), "F1", "learn")
        self._add(menu, "&About GRAPHOS-Py", self._about, None, "info")

    def _corner(self) -> None:
        holder = self._holder = QWidget()
        row = QHBoxLayout(holder)
        row.setContentsMargins(4, 2, 8, 2)
        row.setSpacing(6)
        label = QLabel(tr("Level"))
        label.setProperty("role", "caption")
        self.level = QComboBox()
        for level in LEVELS:
            self.level.addItem(tr(level), level)
            self.level.setItemData(self.level.count() - 1, tr(LEVEL_TIPS[level]), Qt.ItemDataRole.ToolTipRole)
        self.level.setCurrentIndex(LEVELS.index(self.window.settings.level))
        self.level.setToolTip(tr("Who sits here: decides how many parameters are shown."))
        self.level.setAccessibleName(tr("Level"))
        self.level.activated.connect(lambda index: self.window.set_level(LEVELS[index]))
        self.theme_button = QToolButton()
        self.theme_button.setProperty("role", "flat")
        self.theme_button.clicked.connect(
            lambda: self.use_theme("light" if theme().name == "dark" else "dark")
        )
        for widget in (label, self.level, self.theme_button):
            row.addWidget(widget)
        self.window.menuBar().setCornerWidget(holder)
        holder.show()
        self._show_theme()

    # --------------------------------------------------------------------------------------------- reacting

    def use_theme(self, name: str) -> None:
        """Switch to light or dark."""
        self.window.settings.theme = "dark" if name == "dark" else "light"
        theme().apply(self.window.settings.theme, theme().scale)
        self._show_theme()

    def _show_theme(self) -> None:
        other = "light" if theme().name == "dark" else "dark"
        bind_icon(self.theme_button, other)
        self.theme_button.setToolTip(tr("Light colours") if other == "light" else tr("Dark colours"))
        self.theme_button.setAccessibleName(self.theme_button.toolTip())
        for action in self._themes.actions():
            action.setChecked(action.data() == theme().name)

    def use_scale(self, scale: float) -> None:
        """Use another text size, 1 to 2."""
        scale = min(2.0, max(1.0, scale))
        self.window.settings.scale = scale
        theme().apply(theme().name, scale)
        for action in self._sizes.actions():
            action.setChecked(abs(action.data() - scale) < 0.01)

    def _use_language(self, code: str) -> None:
        self.window.settings.language = code
        QMessageBox.information(
            self.window, tr("Language"), tr("The language changes when the program is started again.")
        )

    def _toggle_dock(self, name: str, on: bool) -> None:
        self._hidden.discard(name) if on else self._hidden.add(name)
        self.window.docks[name].setVisible(on)

    def _full_screen(self) -> None:
        window = self.window
        window.showNormal() if window.isFullScreen() else window.showFullScreen()

    def _about(self) -> None:
        text = tr(
            "GRAPHOS-Py {version}\n\nLearning and doing photogrammetry: from photos to a measured 3D model, every "
            "step explained.\n\nFree software under the BSD 3-clause licence.",
            version=__version__,
        )
        QMessageBox.about(self.window, tr("About GRAPHOS-Py"), text)
