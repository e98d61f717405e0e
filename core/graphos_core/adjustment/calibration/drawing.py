"""The drawing of a test field: dark and light rectangles and discs in mm; for printing and for simulated photos."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.adjustment.calibration.markers import CodedBoard, dictionaries, needed_markers
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.data.record import Array
from graphos_core.errors import ParamError, UserError
from graphos_core.text import Text

CIRCLE_SHARE, MARKER_SHARE = 0.6, 0.75
"""Usual diameter over the distance of neighbours, and usual side of a marker over that of a square."""
USUAL_DICTIONARIES = ("DICT_5X5_50", "DICT_5X5_100", "DICT_5X5_250", "DICT_5X5_1000")


@dataclass(frozen=True)
class Drawing:
    """A test field drawn in mm in the frame of the board: x right, y down, the board's first point at (0, 0).

    Attributes
    ----------
    frame : tuple of float
        x and y of the upper left and of the lower right corner of the sheet, mm.
    dark : float64 (k, 4)
        Dark rectangles: x and y of two corners, mm.
    light : float64 (l, 4)
        Light rectangles over them.
    discs : float64 (n, 3)
        Dark discs: centre and radius, mm.
    target : TargetParams
        With everything that was chosen for it.
    """

    frame: tuple[float, float, float, float]
    dark: Array
    light: Array
    discs: Array
    target: TargetParams


def draw_target(target: TargetParams) -> Drawing:
    """Draw a test field; what is not given (diameter, marker, dictionary) is chosen.

    Raises
    ------
    ParamError, UserError
        When circles or markers overlap, or no dictionary has enough markers.
    """
    none = np.zeros((0, 4))
    s, columns, rows = target.square_mm, target.columns, target.rows
    if target.target == "chessboard":
        return Drawing(
            _frame(-s, -s, columns * s, rows * s, s), _squares(target), none, np.zeros((0, 3)), target
        )
    if target.target == "circles":
        target = _with_circles(target)
        centres = 1000.0 * target.points()[:, :2]
        assert target.circle_mm is not None
        radius = 0.5 * target.circle_mm
        discs = np.column_stack([centres, np.full(len(centres), radius)])
        low, high = centres.min(axis=0) - radius, centres.max(axis=0) + radius
        return Drawing(_frame(low[0], low[1], high[0], high[1], s), none, none, discs, target)
    target = _with_markers(target)
    assert target.marker_mm is not None
    coded = CodedBoard(target.dictionary, target.markers_only, target.marker_mm)
    dark, light = _markers(target, coded)
    if target.markers_only:
        half = 0.5 * target.marker_mm
        reach = (columns - 1) * s + half, (rows - 1) * s + half
        return Drawing(_frame(-half, -half, *reach, s), dark, light, np.zeros((0, 3)), target)
    dark = np.concatenate([_squares(target), dark])
    return Drawing(_frame(-s, -s, columns * s, rows * s, s), dark, light, np.zeros((0, 3)), target)


def _frame(x0: float, y0: float, x1: float, y1: float, margin: float) -> tuple[float, float, float, float]:
    return float(x0 - margin), float(y0 - margin), float(x1 + margin), float(y1 + margin)


def _squares(target: TargetParams) -> Array:
    """Return the dark squares of a chessboard, the first of them up and left of the first corner."""
    row, column = (a.ravel() for a in np.mgrid[: target.rows + 1, : target.columns + 1])
    dark = (row + column) % 2 == 0
    x, y = (column[dark] - 1.0) * target.square_mm, (row[dark] - 1.0) * target.square_mm
    return np.column_stack([x, y, x + target.square_mm, y + target.square_mm])


def _with_circles(target: TargetParams) -> TargetParams:
    nearest = target.square_mm * (np.sqrt(2.0) if target.layout == "asymmetric" else 1.0)
    diameter = target.circle_mm if target.circle_mm is not None else round(CIRCLE_SHARE * float(nearest), 3)
    if diameter >= 0.95 * nearest:
        raise ParamError("circle_mm", Text("Diameter of a circle: {d:g} mm, needs less than {most:g} mm: the circles "
                                           "would touch", d=diameter, most=0.95 * float(nearest)))  # fmt: skip
    return target.replace(circle_mm=diameter)


def _with_markers(target: TargetParams) -> TargetParams:
    side = target.marker_mm if target.marker_mm is not None else round(MARKER_SHARE * target.square_mm, 3)
    if side > 0.9 * target.square_mm:
        raise ParamError("marker_mm", Text("Side of a marker: {d:g} mm, needs at most {most:g} mm: corners need some "
                                           "white round them", d=side, most=0.9 * target.square_mm))  # fmt: skip
    known, needed = dictionaries(), needed_markers(target)
    names = [target.dictionary.upper()] if target.dictionary else list(USUAL_DICTIONARIES)
    for name in names:
        if name in known and len(cv2.aruco.getPredefinedDictionary(known[name]).bytesList) >= needed:
            return target.replace(marker_mm=side, dictionary=name)
    raise UserError(
        Text("The board needs {n} markers.", n=needed),
        Text("{name} does not have so many, or does not exist.", name=target.dictionary) if target.dictionary
        else Text("No usual dictionary has so many."),
        Text("Take fewer columns and rows, or another of: {names}.", names=", ".join(known)),
    )  # fmt: skip


def _markers(target: TargetParams, coded: CodedBoard) -> tuple[Array, Array]:
    """Return the dark squares of all markers and the light cells in them."""
    board = coded.grid(target) if coded.markers_only else coded.charuco(target)
    dictionary = cv2.aruco.getPredefinedDictionary(dictionaries()[coded.dictionary])
    # OpenCV counts from the corner of the first marker or square, the board from its first point
    shift = 0.5 * coded.marker_mm if coded.markers_only else target.square_mm
    cells = dictionary.markerSize + 2
    dark, light = [], []
    for number, corners in zip(np.asarray(board.getIds()).ravel(), board.getObjPoints(), strict=True):
        x, y = np.asarray(corners)[:, :2].min(axis=0) - shift
        dark.append([x, y, x + coded.marker_mm, y + coded.marker_mm])
        picture = cv2.aruco.generateImageMarker(dictionary, int(number), cells)
        step = coded.marker_mm / cells
        for i, j in np.argwhere(picture > 127):
            light.append([x + j * step, y + i * step, x + (j + 1) * step, y + (i + 1) * step])
    return np.array(dark), np.array(light)


def paint(drawing: Drawing, texel_mm: float) -> Array:
    """Return the sheet as reflectance float32 (h, w), 0 dark to 1 light, every texel the exact mean over its area.

    The upper left corner of the first texel is the sheet's corner. Discs are averaged over 8 × 8 places of a texel.
    """
    x0, y0, x1, y1 = drawing.frame
    width, height = int(np.ceil((x1 - x0) / texel_mm)), int(np.ceil((y1 - y0) / texel_mm))
    sheet = np.ones((height, width), np.float32)
    for rectangles, ink in ((drawing.dark, 0.0), (drawing.light, 1.0)):
        for a, b, c, d in rectangles:
            across = _covered(width, (a - x0) / texel_mm, (c - x0) / texel_mm)
            down = _covered(height, (b - y0) / texel_mm, (d - y0) / texel_mm)
            columns, rows = np.flatnonzero(across), np.flatnonzero(down)
            part = sheet[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
            share = down[rows][:, None] * across[columns]
            part += (share * (ink - part)).astype(np.float32)
    fine = (np.arange(8) + 0.5) / 8
    for x, y, radius in drawing.discs:
        cx, cy, r = (x - x0) / texel_mm, (y - y0) / texel_mm, radius / texel_mm
        j0, j1, i0, i1 = int(cx - r) - 1, int(cx + r) + 2, int(cy - r) - 1, int(cy + r) + 2
        u = (np.arange(j0, j1)[:, None] + fine).ravel() - cx
        v = (np.arange(i0, i1)[:, None] + fine).ravel() - cy
        inside = (u[None, :] ** 2 + v[:, None] ** 2 <= r * r).reshape(i1 - i0, 8, j1 - j0, 8)
        sheet[i0:i1, j0:j1] *= 1.0 - inside.mean(axis=(1, 3), dtype=np.float32)
    return sheet


def _covered(count: int, low: float, high: float) -> Array:
    """Return how much of each of `count` unit cells lies between two places."""
    edges = np.arange(count + 1)
    result: Array = np.clip(np.minimum(edges[1:], high) - np.maximum(edges[:-1], low), 0.0, 1.0)
    return result


def target_svg(drawing: Drawing) -> str:
    """Return the sheet as SVG in true scale, with what is on it and a line of 100 mm to check the print."""
    x0, y0, x1, y1 = drawing.frame
    foot = 14.0
    width, height = x1 - x0, y1 - y0 + foot
    t = drawing.target
    words = {"chessboard": "chessboard", "circles": f"{t.layout} circles, diameter {t.circle_mm or 0:g} mm",
             "aruco": f"{t.dictionary}, marker {t.marker_mm or 0:g} mm"}[t.target]  # fmt: skip
    line = f"{words}; --columns {t.columns} --rows {t.rows} --square-mm {t.square_mm:g}"
    bar = 100.0 if width >= 130.0 else 50.0
    low = y1 + 5.0
    inks = (("#000", drawing.dark), ("#fff", drawing.light))
    shapes = [f'<path fill="{ink}" d="{_path(some)}"/>' for ink, some in inks if len(some)]
    shapes += [f'<circle cx="{x:.4f}" cy="{y:.4f}" r="{r:.4f}" fill="#000"/>' for x, y, r in drawing.discs]
    return "\n".join([
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.3f}mm" height="{height:.3f}mm" '
        f'viewBox="{x0:.3f} {y0:.3f} {width:.3f} {height:.3f}">',
        f'<rect x="{x0:.3f}" y="{y0:.3f}" width="{width:.3f}" height="{height:.3f}" fill="#fff"/>', *shapes,
        f'<path stroke="#000" stroke-width="0.25" fill="none" d="M{x0 + 8:.3f} {low:.3f}h{bar:.3f}m0 -1.5v3m-{bar:.3f} -3v3"/>',
        f'<text x="{x0 + 8:.3f}" y="{low + 5:.3f}" font-family="sans-serif" font-size="3">{bar:g} mm: print at 100 %, then '
        'measure this line</text>',
        f'<text x="{x0 + bar + 12:.3f}" y="{low + 1:.3f}" font-family="sans-serif" font-size="3">{line}</text>',
        "</svg>", "",
    ])  # fmt: skip


def _path(rectangles: Array) -> str:
    return "".join(f"M{a:.4f} {b:.4f}H{c:.4f}V{d:.4f}H{a:.4f}Z" for a, b, c, d in rectangles)
