"""Residual vectors of control and check points on the two axes in which the block is widest."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data import Array, Block
from graphos_core.number_format import format_number
from graphos_core.report.page import Picture
from graphos_core.report.plot import BLUE, GREY, RED, Axis, Plot
from graphos_core.text import Text

MOST_NAMES = 40


def plan_picture(
    block: Block, positions: dict[str, Array], found: list[tuple[str, list[Any], bool]]
) -> Picture | None:
    """Draw where control (blue) and check points (red, with a ring) lie and how far they are missed.

    Parameters
    ----------
    block : Block
    positions : dict of str to float64 (3,)
        Where each point is, in the block's frame.
    found : list of (name, residual (3,) in m, check)
    """
    rows = [
        (positions[n], np.array(r, dtype=np.float64), n, check) for n, r, check in found if n in positions
    ]
    if len(rows) < 2:
        return None
    places = np.array([r[0] for r in rows])
    residuals = np.nan_to_num(np.array([r[1] for r in rows]))
    cloud = np.vstack([places, block.centres[block.oriented]])
    one, two = sorted(np.argsort(-np.ptp(places, axis=0), kind="stable")[:2])
    low, high = cloud[:, (one, two)].min(axis=0), cloud[:, (one, two)].max(axis=0)
    low, high = low - 0.08 * (high - low).max(), high + 0.08 * (high - low).max()
    lengths = np.hypot(residuals[:, one], residuals[:, two])
    scale = 0.1 * float((high - low).max()) / (float(np.quantile(lengths, 0.9)) or 1e-12)
    axes = ("X", "Y", "Z")
    alt = Text("Residuals of control and check points in {a} and {b}", a=axes[one], b=axes[two])
    width = 680
    height = int(np.clip((width - 80) * (high - low)[1] / (high - low)[0], 180, 560)) + 60
    plot = Plot(Axis(low[0], high[0], f"{axes[one]} [m]"), Axis(low[1], high[1], f"{axes[two]} [m]"), alt, width=width,
                height=height)  # fmt: skip
    centres = block.centres[block.oriented]
    plot.dots(centres[:, one], centres[:, two], Text("projection centre"), GREY, 3.0)
    for check, colour, label in ((False, BLUE, Text("control point")), (True, RED, Text("check point"))):
        mine = np.array([r[3] == check for r in rows])
        if mine.any():
            x, y, v = places[mine, one], places[mine, two], scale * residuals[mine]
            plot.arrows(x, y, v[:, one], v[:, two], colour, 2.0)
            plot.dots(x, y, label, colour, 4.0 if check else 2.5)
    if len(rows) <= MOST_NAMES:
        for place, _, name, _ in rows:
            plot.text(place[one] + 0.008 * (high - low)[0], place[two] + 0.012 * (high - low)[1], name)
    times = format_number(float(f"{scale:.1e}"), digits=2)
    return Picture(
        alt, svg=plot.svg(), caption=Text("Residuals computed − given, {times} times enlarged.", times=times)
    )
