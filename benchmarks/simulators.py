"""Time from a change of a control to the painted picture, for every simulator: median and 95th percentile.

    python benchmarks/simulators.py [--frames N] [--size WIDTHxHEIGHT]

Drawn offscreen at the size of a full window, every preset, moving the first handle along a line. The first frame of
each simulator (compiled code and typesetter are loaded) is listed apart. Both wall time and processor time are given:
on a busy machine only the second says what the program costs.
"""

from __future__ import annotations

import argparse
import os
import time

import numpy as np

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtCore import QSize
from PySide6.QtWidgets import QApplication

from graphos_didactic.simulator import Simulator, drag, simulators
from graphos_py.views.scene_view import SceneView


def one_frame(
    view: SceneView, simulator: Simulator, preset: str, part: float, size: QSize
) -> tuple[float, float]:
    """Return wall and processor seconds from the changed parameter to the painted picture."""
    params = simulator.preset(preset)
    handle = simulator.scene(params).handles[0]
    x, y = handle.at[0] + 30 * part * handle.nudge[0], handle.at[1] + 10 * part * handle.nudge[1]
    wall, cpu = time.perf_counter(), time.process_time()
    view.show_scene(simulator.scene(drag(params, handle, x, y)))
    view.image(size, 1.0, clean=False)
    return time.perf_counter() - wall, time.process_time() - cpu


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--size", default="1200x760")
    options = parser.parse_args()
    width, height = (int(part) for part in options.size.split("x"))
    app = QApplication.instance() or QApplication([])
    view = SceneView()
    print(f"{'simulator':30} {'first':>8} {'median':>8} {'p95':>8} {'cpu p95':>8}   ms, {width}x{height}")
    for simulator in simulators():
        first = one_frame(view, simulator, simulator.presets[0].name, 0.0, QSize(width, height))[0]
        times = np.array([
            one_frame(view, simulator, preset.name, float(part), QSize(width, height))
            for preset in simulator.presets
            for part in np.linspace(0, 1, max(2, options.frames // len(simulator.presets)))
        ])  # fmt: skip
        wall, cpu = 1e3 * times.T
        print(
            f"{simulator.key:30} {1e3 * first:8.0f} {np.median(wall):8.1f} {np.percentile(wall, 95):8.1f} {np.percentile(cpu, 95):8.1f}"
        )
    app.quit()


if __name__ == "__main__":
    main()
