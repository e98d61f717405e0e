"""A session, a window, and a small project of simulated photos, all released at the end of each test."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QEvent, QSettings
from PySide6.QtWidgets import QApplication

from graphos_core.project import Project
from graphos_py.app import make_application
from graphos_py.jobs import Jobs
from graphos_py.loading import load_engine
from graphos_py.main_window import MainWindow
from graphos_py.session import Session
from graphos_py.settings import Settings
from graphos_py.theme import theme


@pytest.fixture(scope="session")
def qapp() -> QApplication:
    app = make_application()
    theme().apply("light")
    load_engine()
    return app


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(QSettings(str(tmp_path / "settings.ini"), QSettings.Format.IniFormat))


@pytest.fixture
def jobs(qapp: QApplication) -> Iterator[Jobs]:
    made = Jobs()
    yield made
    assert made.stop_all(), "a thread did not end"


@pytest.fixture
def session(jobs: Jobs) -> Session:
    return Session(jobs)


@pytest.fixture
def photo_folder(tmp_path: Path) -> Path:
    """Three noise photos of 160 × 120."""
    folder = tmp_path / "photos"
    folder.mkdir()
    rng = np.random.default_rng(0)
    for i in range(3):
        small = rng.integers(0, 255, (12, 16, 3), dtype=np.uint8)
        cv2.imwrite(str(folder / f"p{i}.png"), cv2.resize(small, (160, 120), interpolation=cv2.INTER_CUBIC))
    return folder


@pytest.fixture
def project_folder(tmp_path: Path, photo_folder: Path) -> Path:
    return Project.create(tmp_path / "project", photo_folder, name="Noise").folder


@pytest.fixture
def window(qapp: QApplication, settings: Settings, monkeypatch: pytest.MonkeyPatch) -> Iterator[MainWindow]:
    made = MainWindow(settings)
    made.show()
    yield made
    monkeypatch.setattr("graphos_py.main_window.ask_to_close", lambda *_: True)
    made.close()
    assert not made.jobs.running, "a thread outlived the window"
    made.deleteLater()
    qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)
