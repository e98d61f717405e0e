"""The window appears before the engine is imported, and every way in starts."""

import subprocess
import sys

FIRST_PAINT = """
import sys
from PySide6.QtCore import QSettings
from graphos_py.app import Application, make_application
from graphos_py.settings import Settings
app = make_application()
window = Application(Settings(QSettings(sys.argv[1], QSettings.Format.IniFormat))).window
window.show()
window.grab()
heavy = [m for m in ("numba", "scipy", "open3d", "matplotlib", "pyqtgraph") if m in sys.modules]
assert not heavy, heavy
"""


def test_nothing_heavy_is_imported_before_the_first_paint(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", FIRST_PAINT, str(tmp_path / "settings.ini")],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr


def test_the_application_loads_the_engine_and_opens_the_project(qtbot, qapp, settings, project_folder):
    from graphos_py.app import Application

    application = Application(settings)
    application.show(project_folder)
    window = application.window
    qtbot.waitUntil(lambda: window.session.project is not None, timeout=20000)
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=30000)
    window.show_tab("features")
    assert "sift" in window.stage_tab("features").panel.boxes
    window.close()
    application._warming.waitForFinished(5000)


def test_without_a_display_a_sentence_says_so(monkeypatch):
    import pytest

    from graphos_core.errors import UserError
    from graphos_py.app import run_gui

    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    if sys.platform.startswith("linux"):
        with pytest.raises(UserError, match="no display"):
            run_gui(None)
