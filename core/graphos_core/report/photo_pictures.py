"""Residual vectors: averaged over the sensor, where a camera model that lacks a term shows, and photo by photo."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Adjustment, Array, Camera
from graphos_core.number_format import format_number
from graphos_core.report.page import Picture
from graphos_core.report.plot import BLUE, RED, Axis, Plot, fitted
from graphos_core.text import Text

CELLS = 16
"""Cells along the longer side of the sensor."""

FEWEST = 5
"""A cell with fewer observations has no mean that means anything."""

MOST_ARROWS = 250
"""So many residual vectors are drawn in one photo: evenly chosen."""


def sensor_picture(adjustment: Adjustment, camera: int) -> Picture | None:
    """Mean residual vectors over the sensor of a camera; None without observations."""
    block = adjustment.block
    mine = np.asarray(block.camera_of_photo)[block.obs_photo] == camera
    if not mine.any():
        return None
    body = block.cameras[camera]
    centres, means, errors = cell_means(body, block.obs_xy[mine], adjustment.residuals[mine])
    if not len(means):
        return None
    length = float(np.quantile(np.hypot(means[:, 0], means[:, 1]), 0.95)) or 1e-9
    scale = 0.9 * max(body.width, body.height) / CELLS / length
    alt = Text(
        "Mean residual vectors over the sensor of {label}",
        label=body.label or Text("camera {n}", n=camera + 1),
    )
    plot = _sensor(body, alt, (600, 460), 34)
    plot.arrows(centres[:, 0], centres[:, 1], scale * means[:, 0], scale * means[:, 1], BLUE, 1.6)
    _scale_arrow(plot, body, _round(length), scale)
    chance = float(np.median(errors))
    return Picture(alt, svg=plot.svg(), caption=Text(
        "Mean residual vectors (projected − measured) in {n} cells with at least {few} observations; chance alone makes "
        "vectors of about {chance} px. A ring, a swirl or a common direction shows what the camera model lacks.",
        n=len(means), few=FEWEST, chance=format_number(chance, digits=2)))  # fmt: skip


def cell_means(camera: Camera, xy: Array, residuals: Array) -> tuple[Array, Array, Array]:
    """Return centres (k, 2), mean residuals (k, 2) and expected length (k,) of a mean by chance, of cells with enough."""
    side = max(camera.width, camera.height) / CELLS
    columns, rows = max(1, round(camera.width / side)), max(1, round(camera.height / side))
    column = np.clip((xy[:, 0] + 0.5) / camera.width * columns, 0, columns - 1).astype(int)
    row = np.clip((xy[:, 1] + 0.5) / camera.height * rows, 0, rows - 1).astype(int)
    cell = row * columns + column
    count = np.bincount(cell, minlength=rows * columns)
    sums = np.stack([np.bincount(cell, residuals[:, k], rows * columns) for k in (0, 1)], axis=1)
    kept = np.flatnonzero(count >= FEWEST)
    centres = np.stack([(kept % columns + 0.5) * camera.width / columns,
                        (kept // columns + 0.5) * camera.height / rows], axis=1)  # fmt: skip
    spread = float(np.sqrt((residuals**2).sum(axis=1).mean()))
    return centres, sums[kept] / count[kept, None], spread / np.sqrt(count[kept])


def photo_picture(adjustment: Adjustment, photo: int, length: float, longest: float) -> Picture:
    """Residual vectors of one photo, `length` px drawn as one twelfth of the width; those over `longest` px are red."""
    block = adjustment.block
    camera = block.cameras[int(block.camera_of_photo[photo])]
    mine = np.flatnonzero(block.obs_photo == photo)
    lengths = np.hypot(*adjustment.residuals[mine].T)
    step = max(1, len(mine) // MOST_ARROWS)
    chosen = np.union1d(np.arange(0, len(mine), step), np.argsort(-lengths, kind="stable")[:10])
    mine, lengths = mine[chosen], lengths[chosen]
    scale = max(camera.width, camera.height) / 12.0 / (length or 1e-9)
    xy, v = block.obs_xy[mine], scale * adjustment.residuals[mine]
    alt = Text("Residual vectors of {name}", name=block.names[photo])
    plot = _sensor(camera, alt, (314, 300), 8)
    long = lengths > longest
    for kept, colour in ((~long, BLUE), (long, RED)):
        plot.arrows(xy[kept, 0], xy[kept, 1], v[kept, 0], v[kept, 1], colour)
    rms = float(np.sqrt(np.mean(adjustment.residuals[block.obs_photo == photo] ** 2)))
    return Picture(alt, svg=plot.svg(), caption=Text(
        "{name}: RMS {rms} px", name=block.names[photo], rms=format_number(rms, digits=3)))  # fmt: skip


def _sensor(camera: Camera, alt: str, box: tuple[int, int], below: int) -> Plot:
    margin = 8
    width, height = fitted(camera.width, camera.height, *box)
    x, y = Axis(-0.5, camera.width - 0.5, ticks=False), Axis(-0.5, camera.height - 0.5, ticks=False)
    return Plot(
        x, y, alt, width=width + 2 * margin, height=height + margin + below, downwards=True,
        margins=(margin, margin, margin, below),
    )  # fmt: skip


def _scale_arrow(plot: Plot, camera: Camera, length: float, scale: float) -> None:
    y = camera.height * (1.0 + 20.0 / (plot.height - 42.0))
    plot.arrows(np.array([0.0]), np.array([y]), np.array([scale * length]), np.array([0.0]), RED, 2.0)
    plot.text(
        scale * length + 0.02 * camera.width,
        y + 0.008 * camera.height,
        f"{format_number(length, digits=2)}\u2009px",
    )


def _round(value: float) -> float:
    """Return `value` with one significant digit."""
    return float(f"{value:.0e}")
