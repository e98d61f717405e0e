"""Fixtures for all tests."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of the shared real photos, named by GRAPHOS_DATA; without it the test is skipped or, if required, fails."""
    named = os.environ.get("GRAPHOS_DATA", "")
    folder = Path(named) if named else None
    if folder is not None and folder.is_dir():
        return folder
    why = f"GRAPHOS_DATA names no folder ({named!r}): the shared real photos are needed"
    if os.environ.get("GRAPHOS_REQUIRE_DATA") == "1":
        pytest.fail(why)
    pytest.skip(why)
