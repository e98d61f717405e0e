"""Views are tested without a screen."""

import os

import numpy as np
import pytest

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")


@pytest.fixture
def photo() -> np.ndarray:
    """A picture in which every pixel has its own colour: red is x mod 256, green is y mod 256."""
    y, x = np.mgrid[0:300, 0:400]
    return np.stack([x % 256, y % 256, (x // 256) * 100], axis=2).astype(np.uint8)
