"""Jobs that end with each test."""

from collections.abc import Iterator

import pytest
from PySide6.QtWidgets import QApplication

from graphos_py.app import make_application
from graphos_py.jobs import Jobs
from graphos_py.theme import theme


@pytest.fixture(scope="session")
def qapp() -> QApplication:
    app = make_application()
    theme().apply("light")
    return app


@pytest.fixture
def jobs(qapp: QApplication) -> Iterator[Jobs]:
    made = Jobs()
    yield made
    assert made.stop_all(), "a thread did not end"
