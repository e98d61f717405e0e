"""Pictures of a calibration: correlations, radial distortion with its confidence band, uncertainty over the format."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.number_format import MINUS, format_number, format_value
from graphos_core.rendering.colour_maps import colour_table
from graphos_core.report.page import Picture
from graphos_core.report.plot import BLUE, ORANGE, Axis, Plot, fitted
from graphos_core.text import Text

CONFIDENCE = 1.959964
"""Half width of a confidence band in standard deviations: 95 %."""


def symbol(tex: str) -> str:
    """Return a symbol of mathtext as plain text: ``x_0`` becomes ``x0``."""
    return tex.replace("_", "").replace("{", "").replace("}", "").replace("\\", "")


def correlation_picture(found: dict[str, Any], label: str) -> Picture:
    """Correlation matrix: colour and number in per cent in every cell."""
    matrix = np.array(found["matrix"], dtype=np.float64)
    n = len(matrix)
    colours = colour_table("diverging")[np.clip(np.round((matrix + 1.0) * 127.5), 0, 255).astype(int)]
    texts = [[f"{round(100 * v)}".replace("-", MINUS) for v in row] for row in matrix]
    cell = 44 if n <= 12 else 34
    alt = Text("Correlations of the parameters of {label} in per cent", label=label)
    plot = Plot(Axis(0, n, ticks=False), Axis(0, n, ticks=False), alt, width=cell * n + 60, height=cell * n + 40,
                downwards=True, margins=(48, 28, 12, 12))  # fmt: skip
    edges = np.arange(n + 1, dtype=np.float64)
    plot.cells(edges, edges, colours, texts)
    for i, name in enumerate(found["symbols"]):
        plot.text(-8.0 / cell, i + 0.6, symbol(name), "end")
        plot.text(i + 0.5, -8.0 / cell, symbol(name), "middle")
    caption = Text(
        "Correlations in per cent: red +100, white 0, blue −100. Two unknowns with nearly ±100 cannot be told apart."
    )
    return Picture(alt, svg=plot.svg(), caption=caption)


def profile_picture(profile: dict[str, Any], label: str) -> Picture:
    """Radial distortion over the radius, Gaussian and balanced, each with its 95 % band."""
    radius = np.array(profile["radius_px"], dtype=np.float64)
    curves = []
    for key, title, colour in (("gaussian", Text("Gaussian"), BLUE), ("balanced", Text("balanced"), ORANGE)):
        shift = np.array(profile[key]["shift_px"], dtype=np.float64)
        known = profile[key]["sigma_px"]
        sigma = np.zeros(len(shift)) if known is None else np.array(known, dtype=np.float64)
        focal = format_number(profile[key]["focal_px"], digits=6)
        label_of = Text("{title}, f = {f} px", title=title, f=focal)
        if known is not None:
            label_of = Text("{label} with 95 % band", label=label_of)
        curves.append((shift, CONFIDENCE * np.nan_to_num(sigma), label_of, colour))
    low = min(float(np.nanmin(s - half)) for s, half, _, _ in curves)
    high = max(float(np.nanmax(s + half)) for s, half, _, _ in curves)
    room = 0.08 * (high - low) or 1.0
    alt = Text("Radial distortion of {label} over the radius", label=label)
    plot = Plot(Axis(0.0, float(radius[-1]), Text("radius [px]")),
                Axis(low - room, high + room, Text("Δr [px]")), alt, height=320)  # fmt: skip
    for shift, half, title, colour in curves:
        plot.band(radius, shift - half, shift + half, "", colour)
        plot.line(radius, shift, title, colour, weight=2)
    caption = profile["note"]
    if profile["gaussian"]["sigma_px"] is not None:
        at_end = [format_value(curves[k][1][-1] / CONFIDENCE, unit="px", digits=2) for k in (0, 1)]
        caption = Text("{note} σ at the farthest corner: {a} Gaussian, {b} balanced.", note=caption, a=at_end[0],
                       b=at_end[1])  # fmt: skip
    return Picture(alt, svg=plot.svg(), caption=caption)


def uncertainty_picture(found: dict[str, Any], width: int, height: int, label: str) -> Picture:
    """Projection uncertainty over the format: colour and number in px in every cell."""
    values = np.array(
        [[np.nan if v is None else v for v in row] for row in found["sigma_px"]], dtype=np.float64
    )
    rows, columns = values.shape
    good = values[np.isfinite(values)]
    top = float(good.max()) if len(good) else 1.0
    colours = colour_table("viridis")[np.clip(np.nan_to_num(values) / (top or 1.0) * 255, 0, 255).astype(int)]
    texts = [[format_number(v, digits=2) for v in row] for row in values]
    alt = Text("Projection uncertainty of {label} over the format", label=label)
    wide, high = fitted(width, height, 620, 460)
    plot = Plot(Axis(0, columns, ticks=False), Axis(0, rows, ticks=False), alt, width=wide + 16, height=high + 16,
                downwards=True, margins=(8, 8, 8, 8))  # fmt: skip
    plot.cells(np.arange(columns + 1.0), np.arange(rows + 1.0), colours, texts)
    return Picture(alt, svg=plot.svg(), caption=found["note"])
