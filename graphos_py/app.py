"""Starts the application: the window first, the engine behind it.

Before the first paint only PySide6, numpy and OpenCV are imported; the registry with its numba kernels, the plotting
libraries and the kernels' cache follow in the background.
"""

from __future__ import annotations

import signal
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import TracebackType

from PySide6.QtCore import QObject, QProcess, QTimer
from PySide6.QtWidgets import QApplication

from graphos_core.errors import UserError
from graphos_core.run import Run
from graphos_py.icons import icon
from graphos_py.jobs import Job
from graphos_py.loading import load_engine
from graphos_py.main_window import MainWindow
from graphos_py.settings import Settings
from graphos_py.theme import theme
from graphos_py.translation import CatalogueTranslator, use_language
from graphos_py.warm_up import is_warm


def make_application() -> QApplication:
    """Return the application object, dressed as the person likes it.

    Raises
    ------
    UserError
        When there is no display to open a window on.
    """
    existing = QApplication.instance()
    app = existing if isinstance(existing, QApplication) else QApplication(sys.argv[:1])
    app.setApplicationName("GRAPHOS-Py")
    app.setOrganizationName("GRAPHOS")
    app.setStyle("Fusion")
    return app


def prepare(run: Run) -> tuple[list[str], bool]:
    """Import what the tabs need.

    Returns sentences about add-ons that could not be loaded, and whether the kernels are compiled.
    """
    load_engine()
    from graphos_core import registry

    for view in ("image_view", "match_view", "cloud_view", "plot_view", "table_view"):
        run.check()
        with suppress(ModuleNotFoundError):
            import_module(f"graphos_py.views.{view}")
    import_module("matplotlib.figure")  # for the formulas of the Explain panel
    return registry.problems(), is_warm()


class Application(QObject):
    """The window and what happens behind it."""

    def __init__(self, settings: Settings | None = None) -> None:
        super().__init__()
        self.settings = settings or Settings()
        use_language(self.settings.language)
        self._translator = CatalogueTranslator()
        if self.settings.language != "en":
            QApplication.installTranslator(self._translator)
        theme().apply(self.settings.theme, self.settings.scale)
        self.window = MainWindow(self.settings)
        self.window.setWindowIcon(icon("adjustment", "accent"))
        self._start: Path | None = None
        self._warming = QProcess(self.window)
        self._warming.setStandardOutputFile(QProcess.nullDevice())
        self._warming.setStandardErrorFile(QProcess.nullDevice())
        self.window.closed.connect(self._stop_warming)

    def _stop_warming(self) -> None:
        self._warming.kill()
        self._warming.waitForFinished(2000)

    def show(self, project: Path | None = None) -> None:
        """Show the window; afterwards load the engine and open the project."""
        self._start = project
        self.window.show()
        QTimer.singleShot(0, self.window, self._behind)

    def _behind(self) -> None:
        job = Job(prepare, name="loading", engine=False)
        job.succeeded.connect(self._loaded)
        job.failed.connect(self.window.session.tell)
        self.window.jobs.start(job)
        if self._start is not None:
            self.window.actions_of_project.open_folder(self._start)

    def _loaded(self, loaded: tuple[list[str], bool]) -> None:
        problems, warm = loaded
        self.window.engine_loaded(problems)
        if not warm:
            self._warming.start(sys.executable, ["-m", "graphos_py.warm_up"])


def run_gui(project: Path | None = None) -> int:
    """Open the window, on a project if one is given, and return the exit code when it closes."""
    import os

    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        platform = os.environ.get("QT_QPA_PLATFORM", "")
        if platform in ("", "xcb", "wayland"):
            raise UserError(
                "There is no display to open a window on.",
                "Neither DISPLAY nor WAYLAND_DISPLAY is set.",
                "Start it in a desktop session, or use graphos run on the command line.",
            )
    app = make_application()
    application = Application()

    def on_bug(kind: type[BaseException], problem: BaseException, trace: TracebackType | None) -> None:
        sys.__excepthook__(kind, problem, trace)
        if isinstance(problem, Exception):
            application.window.session.tell(problem)

    sys.excepthook = on_bug
    signal.signal(signal.SIGINT, lambda *_: application.window.close())
    application.show(project)
    return app.exec()
