"""Thousands of keypoints on a photo: drawn into a mask once per view, tinted when painted."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import cv2
import numpy as np
from PySide6.QtCore import QPointF
from PySide6.QtGui import QColor, QImage, QPainter, QPalette, QPen

from graphos_core.data.features import Features
from graphos_core.data.record import Array
from graphos_core.number_format import THIN_SPACE
from graphos_py.views.pixel_canvas import PixelCanvas

INK = (255, 221, 51)
HALO_SHARE = 0.75
DOT_BELOW = 2.0
SHIFT = 4


class KeypointLayer:
    """Circles of the scale and lines of the orientation of keypoints, with a dark edge that any photo bears."""

    def __init__(self, canvas: PixelCanvas) -> None:
        self.canvas = canvas
        self.selected = -1
        self.drawn = 0
        self._features: Features | None = None
        self._picture: QImage | None = None
        self._key: tuple[float, ...] = ()

    @property
    def count(self) -> int:
        """Number of keypoints."""
        return 0 if self._features is None else len(self._features.xy)

    def set_features(self, features: Features | None) -> None:
        """Show other keypoints; None shows none."""
        self._features = features
        self.selected = -1
        self.drawn = 0
        self._key = ()
        self.canvas.update()

    def nearest(self, x: float, y: float) -> int:
        """Return the keypoint within 12 screen px of an image position, −1 if there is none."""
        if self._features is None or not self.count:
            return -1
        distance = np.hypot(*(np.asarray(self._features.xy, np.float64) - [x, y]).T) * self.canvas.zoom
        best = int(np.argmin(distance))
        return best if distance[best] <= 12.0 else -1

    def describe(self, index: int) -> str:
        """Return position, scale and orientation of a keypoint for people."""
        f = self._features
        assert f is not None
        return (
            f"#{index}   x {f.xy[index, 0]:.2f}  y {f.xy[index, 1]:.2f}{THIN_SPACE}px   "
            f"⌀ {f.scale[index]:.1f}{THIN_SPACE}px   ∠ {math.degrees(f.angle[index]):.0f}°"
        )

    def table(self) -> tuple[Sequence[str], Iterable[Sequence[object]]]:
        """Return header and rows for CSV."""
        f = self._features
        assert f is not None
        header = ("x [px]", "y [px]", "scale diameter [px]", "angle [deg]", "response")
        rows = np.column_stack([f.xy, f.scale, np.degrees(f.angle), f.response]).tolist()
        return header, rows

    def paint(self, painter: QPainter) -> None:
        """Paint the keypoints that are in sight."""
        if self._features is None or not self.count:
            return
        canvas = self.canvas
        ratio = canvas.devicePixelRatioF()
        key = (canvas.zoom, canvas.left, canvas.top, canvas.width(), canvas.height(), ratio)
        if key != self._key or self._picture is None:
            mask, self.drawn = self.mask(ratio)
            self._picture = _tinted(mask)
            self._picture.setDevicePixelRatio(ratio)
            self._key = key
        painter.drawImage(QPointF(0, 0), self._picture)
        if 0 <= self.selected < self.count:
            self._paint_selected(painter)

    def mask(self, ratio: float = 1.0) -> tuple[Array, int]:
        """Return uint8 (h, w), 255 where there is ink, in device px, and the number of keypoints drawn."""
        f = self._features
        assert f is not None
        canvas = self.canvas
        mask = np.zeros(
            (max(round(canvas.height() * ratio), 1), max(round(canvas.width() * ratio), 1)), np.uint8
        )
        centre = canvas.to_screen(f.xy) * ratio - 0.5
        radius = 0.5 * np.asarray(f.scale, np.float64) * canvas.zoom * ratio
        inside = ((centre > -radius[:, None]) & (centre < np.array(mask.shape[::-1]) + radius[:, None])).all(
            axis=1
        )
        angle = np.asarray(f.angle, np.float64)[inside]
        centre, radius = centre[inside], radius[inside]
        dots = radius < DOT_BELOW * ratio
        for x, y in np.round(centre[dots]).astype(int).tolist():
            cv2.rectangle(mask, (x, y), (x + 1, y + 1), 255, -1)
        one = 1 << SHIFT
        fixed = np.round(np.column_stack([centre, radius])[~dots] * one).astype(int)
        tips = (
            centre[~dots] + (radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])[:, :])[~dots]
            if len(centre)
            else centre
        )
        ends = np.round(tips * one).astype(int)
        for (x, y, r), (ex, ey) in zip(fixed.tolist(), ends.tolist()):
            cv2.circle(mask, (x, y), r, 255, 1, cv2.LINE_AA, SHIFT)
            cv2.line(mask, (x, y), (ex, ey), 255, 1, cv2.LINE_AA, SHIFT)
        return mask, len(centre)

    def _paint_selected(self, painter: QPainter) -> None:
        f = self._features
        assert f is not None
        x, y = self.canvas.to_screen(f.xy[self.selected])[0]
        radius = max(0.5 * float(f.scale[self.selected]) * self.canvas.zoom, 5.0)
        angle = float(f.angle[self.selected])
        tip = QPointF(x + radius * math.cos(angle), y + radius * math.sin(angle))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        accent = self.canvas.palette().color(QPalette.ColorRole.Highlight)
        for colour, width in ((QColor(255, 255, 255), 5.0), (accent, 2.5)):
            painter.setPen(QPen(colour, width))
            painter.drawEllipse(QPointF(x, y), radius, radius)
            painter.drawLine(QPointF(x, y), tip)


def _tinted(mask: Array) -> QImage:
    """Return yellow ink with a dark edge, premultiplied, from a mask."""
    halo = cv2.dilate(mask, np.ones((3, 3), np.uint8))
    alpha = cv2.max(mask, cv2.LUT(halo, (np.arange(256) * HALO_SHARE).astype(np.uint8)))
    picture = np.empty((*mask.shape, 4), np.uint8)
    for channel, value in enumerate(INK[::-1]):
        picture[:, :, channel] = cv2.LUT(mask, (np.arange(256) * value // 255).astype(np.uint8))
    picture[:, :, 3] = alpha
    height, width = mask.shape
    return QImage(picture.data, width, height, 4 * width, QImage.Format.Format_ARGB32_Premultiplied).copy()
