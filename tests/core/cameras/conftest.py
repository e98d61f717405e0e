"""Cameras to try a model with, made from its own parameter sheet."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.cameras import camera_model
from graphos_core.data import Camera

STRONG_FOCAL = {"central": 900.0, "equidistant": 520.0, "equisolid": 620.0, "spherical": 800.0 / np.pi}
"""Fields along the diagonal of 96°, 220° and 220°, and 360° over 1600 px."""


def typical_camera(name: str, *, strong: bool = False) -> Camera:
    """Return a camera 1600×1200 with every parameter at its usual size, with alternating signs."""
    model = camera_model(name)
    values = np.array([parameter.usual for parameter in model.parameters])
    moving = [k for k, p in enumerate(model.parameters) if p.group != "interior" and p.default != "constant"]
    values[moving[::2]] *= -1.0
    values[:3] = [STRONG_FOCAL[model.projection] if strong else 1500.0, 805.0, 592.0]
    if model.projection == "spherical":
        values[:3] = STRONG_FOCAL["spherical"], 799.5, 599.5
    return Camera(model=name, width=1600, height=1200, values=values)


@pytest.fixture
def typical():
    return typical_camera
