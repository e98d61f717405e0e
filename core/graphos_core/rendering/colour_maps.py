"""Perceptually uniform colour maps: viridis and cividis, and a diverging blue–white–red for signed values."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np

from graphos_core.data.record import Array

NEUTRAL = (128, 128, 128)
"""Grey of a missing value."""


@cache
def colour_table(name: str = "viridis") -> Array:
    """Return a colour map as uint8 (256, 3) RGB.

    ``viridis`` and ``cividis`` (van der Walt and Smith 2015; Nuñez, Anderton, Renslow 2018) come from OpenCV;
    ``bright viridis`` is its upper part, for marks on dark photos; ``diverging`` runs from blue over white to red with equal steps of lightness on both sides, in CIELAB, as
    Moreland (2009, Diverging color maps for scientific visualization) asks.

    Raises
    ------
    ValueError
        For another name.
    """
    if name == "diverging":
        return _diverging()
    maps = {"viridis": cv2.COLORMAP_VIRIDIS, "cividis": cv2.COLORMAP_CIVIDIS}
    if name == "bright viridis":
        upper = colour_table("viridis")[np.linspace(104, 255, 256).round().astype(int)]
        return _frozen(upper)
    if name not in maps:
        raise ValueError(f"colour map {name!r}: there are viridis, bright viridis, cividis and diverging")
    table = cv2.applyColorMap(np.arange(256, dtype=np.uint8)[:, None], maps[name])[:, 0, ::-1]
    return _frozen(table)


def colours_of_values(
    values: Array,
    low: float,
    high: float,
    name: str = "viridis",
    missing: tuple[int, int, int] = NEUTRAL,
) -> Array:
    """Return RGB uint8 (…, 3) of values (…); `low` and `high` get the ends of the map, NaN gets `missing`."""
    values = np.asarray(values, dtype=np.float32)
    span = high - low
    unit = (values - np.float32(low)) * np.float32(255.0 / span if span > 0 else 0.0)
    finite = np.isfinite(unit)
    index = np.clip(np.where(finite, unit, 0.0) + 0.5, 0, 255).astype(np.uint8)
    colours = colour_table(name)[index]
    colours[~finite] = missing
    return colours


def _diverging() -> Array:
    lab_ends = cv2.cvtColor(
        np.array([[[0.13, 0.30, 0.66], [0.97, 0.97, 0.97], [0.70, 0.09, 0.15]]], np.float32),
        cv2.COLOR_RGB2Lab,
    )[0]
    lab_ends[0, 0] = lab_ends[2, 0] = 0.5 * (lab_ends[0, 0] + lab_ends[2, 0])
    positions = np.linspace(0.0, 2.0, 256)
    lab = np.stack([np.interp(positions, [0, 1, 2], lab_ends[:, i]) for i in range(3)], axis=1)
    rgb = cv2.cvtColor(lab.astype(np.float32)[None], cv2.COLOR_Lab2RGB)[0]
    return _frozen((np.clip(rgb, 0, 1) * 255 + 0.5).astype(np.uint8))


def _frozen(table: Array) -> Array:
    table = np.ascontiguousarray(table)
    table.flags.writeable = False
    return table
