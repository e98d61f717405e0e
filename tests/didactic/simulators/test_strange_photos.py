"""Photos of strange shapes in simulators that make a small picture of them."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import Setting, find_simulator


@pytest.mark.parametrize(
    "key",
    [
        "features/scale_space",
        "features/descriptor",
        "features/self_dissimilarity",
        "features/ratio_test",
        "features/affine",
        "features/sampling",
        "features/coverage",
        "preprocessing/decolorization",
    ],
)
@pytest.mark.parametrize("shape", [(900, 1, 3), (1, 900), (2, 2, 3)])
def test_photos_of_strange_shapes_are_shown(key: str, shape: tuple[int, ...]) -> None:
    simulator = find_simulator(key)
    name = next(preset.name for preset in simulator.presets if preset.kind == "photo")
    photo = np.random.default_rng(0).integers(0, 255, shape).astype(np.uint8)
    assert simulator.scene(simulator.preset(name), Setting(photo, "strange")).says
