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
OTHER_INK = (255, 120, 190)
"""Keypoints that are told from the marked ones."""
HALO_SHARE = 0.75
DOT_BELOW = 2.0
SHIFT = 4
MOST_INK, INK_WIDTH = 0.5, 3.0
"""Circles, of this width with their edge, may cover this share of the photo in sight; where there are more, most
keypoints become dots until one zooms in."""


class KeypointLayer:
    """Circles of the scale and lines of the orientation of keypoints, with a dark edge that any photo bears."""

    def __init__(self, canvas: PixelCanvas) -> None:
        self.canvas = canvas
        self.selected = -1
        self.drawn = 0
        self._features: Features | None = None
        self._shown: Array | None = None
        self._marked: Array | None = None
        self._pictures: list[QImage] = []
        self._key: tuple[float, ...] = ()

    @property
    def count(self) -> int:
        """Number of keypoints that are shown."""
        if self._features is None:
            return 0
        return len(self._features.xy) if self._shown is None else int(self._shown.sum())

    def set_features(
        self, features: Features | None, shown: Array | None = None, marked: Array | None = None
    ) -> None:
        """Show other keypoints; None shows none. `shown` and `marked` as in `filter`."""
        self._features = features
        self.selected = -1
        self.filter(shown, marked)

    def filter(self, shown: Array | None, marked: Array | None = None) -> None:
        """Show some of the keypoints; the selected one stays selected.

        Parameters
        ----------
        shown : bool (n,) or None
            None shows all.
        marked : bool (n,) or None
            Marked ones are drawn in the usual yellow with their orientation, others as rose circles; None marks all.
        """
        self._shown, self._marked = shown, marked
        self.drawn = 0
        self._key = ()
        self.canvas.update()

    def nearest(self, x: float, y: float) -> int:
        """Return the shown keypoint within 12 screen px of an image position, −1 if there is none."""
        if self._features is None or not self.count:
            return -1
        distance = np.hypot(*(np.asarray(self._features.xy, np.float64) - [x, y]).T) * self.canvas.zoom
        if self._shown is not None:
            distance[~self._shown] = np.inf
        best = int(np.argmin(distance))
        return best if distance[best] <= 12.0 else -1

    def place(self, index: int) -> tuple[float, float] | None:
        """Return the position of a keypoint, px of the image; None where there is none."""
        if self._features is None or not 0 <= index < len(self._features.xy):
            return None
        return float(self._features.xy[index, 0]), float(self._features.xy[index, 1])

    def describe(self, index: int) -> str:
        """Return position, scale and orientation of a keypoint for people."""
        f = self._features
        assert f is not None
        return (
            f"#{index}   x {f.xy[index, 0]:.2f}  y {f.xy[index, 1]:.2f}{THIN_SPACE}px   "
            f"⌀ {f.scale[index]:.1f}{THIN_SPACE}px   ∠ {math.degrees(f.angle[index]):.0f}°"
        )

    def table(self) -> tuple[Sequence[str], Iterable[Sequence[object]]]:
        """Return header and rows of the shown keypoints for CSV."""
        f = self._features
        assert f is not None
        header = ("x [px]", "y [px]", "scale diameter [px]", "angle [deg]", "response")
        rows = np.column_stack([f.xy, f.scale, np.degrees(f.angle), f.response])
        return header, (rows if self._shown is None else rows[self._shown]).tolist()

    def paint(self, painter: QPainter) -> None:
        """Paint the keypoints that are in sight."""
        if self._features is None or not self.count:
            return
        canvas = self.canvas
        ratio = canvas.devicePixelRatioF()
        key = (canvas.zoom, canvas.left, canvas.top, canvas.width(), canvas.height(), ratio)
        if key != self._key or not self._pictures:
            self._pictures = self._draw(ratio)
            self._key = key
        for picture in self._pictures:
            painter.drawImage(QPointF(0, 0), picture)
        if 0 <= self.selected < len(self._features.xy):
            self._paint_selected(painter)

    def _draw(self, ratio: float) -> list[QImage]:
        """Return the pictures of the keypoints, those that are not marked below the others."""
        f = self._features
        assert f is not None
        shown = np.ones(len(f.xy), bool) if self._shown is None else self._shown
        marked = shown if self._marked is None else shown & self._marked
        groups = [(shown & ~marked, OTHER_INK, False), (marked, INK, True)]
        pictures, self.drawn = [], 0
        for rows, ink, oriented in groups:
            if rows.any():
                mask, drawn = self.mask(ratio, rows, oriented)
                picture = _tinted(mask, ink)
                picture.setDevicePixelRatio(ratio)
                pictures.append(picture)
                self.drawn += drawn
        return pictures

    def mask(self, ratio: float = 1.0, rows: Array | None = None, oriented: bool = True) -> tuple[Array, int]:
        """Return uint8 (h, w), 255 where there is ink, in device px, and the number of keypoints drawn.

        Parameters
        ----------
        ratio : float
            Device px per logical px.
        rows : bool (n,) or None
            Which keypoints; None for all.
        oriented : bool
            Whether lines of the orientation are drawn too.
        """
        f = self._features
        assert f is not None
        canvas = self.canvas
        mask = np.zeros(
            (max(round(canvas.height() * ratio), 1), max(round(canvas.width() * ratio), 1)), np.uint8
        )
        centre = canvas.to_screen(f.xy) * ratio - 0.5
        radius = 0.5 * np.asarray(f.scale, np.float64) * canvas.zoom * ratio
        reach = radius[:, None]
        inside = ((centre > -reach) & (centre < np.array(mask.shape[::-1]) + reach)).all(axis=1)
        if rows is not None:
            inside &= rows
        angle = np.asarray(f.angle, np.float64)[inside]
        centre, radius = centre[inside], radius[inside]
        seen = canvas.visible()
        room = MOST_INK * seen.width() * seen.height() * (canvas.zoom * ratio) ** 2
        dots = _as_dots(radius, DOT_BELOW * ratio, room / INK_WIDTH)
        for x, y in np.round(centre[dots]).astype(int).tolist():
            cv2.rectangle(mask, (x, y), (x + 1, y + 1), 255, -1)
        one = 1 << SHIFT
        fixed = np.round(np.column_stack([centre, radius])[~dots] * one).astype(int)
        tips = centre + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        ends = np.round(tips[~dots] * one).astype(int)
        for (x, y, r), (ex, ey) in zip(fixed.tolist(), ends.tolist()):
            cv2.circle(mask, (x, y), r, 255, 1, cv2.LINE_AA, SHIFT)
            if oriented:
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


def _as_dots(radius: Array, smallest: float, room: float) -> Array:
    """Return which keypoints are drawn as dots: small ones, and so many others that the circles' ink fits `room`."""
    dots = radius < smallest
    large = np.flatnonzero(~dots)
    ink = 2 * math.pi * float(radius[large].sum())
    if ink > room:
        keep = max(int(len(large) * room / ink), 1)
        kept = large[np.linspace(0, len(large) - 1, keep).astype(int)]
        dots[:] = True
        dots[kept] = False
    return np.asarray(dots)


def _tinted(mask: Array, ink: tuple[int, int, int]) -> QImage:
    """Return coloured ink with a dark edge, premultiplied, from a mask."""
    halo = cv2.dilate(mask, np.ones((3, 3), np.uint8))
    alpha = cv2.max(mask, cv2.LUT(halo, (np.arange(256) * HALO_SHARE).astype(np.uint8)))
    picture = np.empty((*mask.shape, 4), np.uint8)
    for channel, value in enumerate(ink[::-1]):
        picture[:, :, channel] = cv2.LUT(mask, (np.arange(256) * value // 255).astype(np.uint8))
    picture[:, :, 3] = alpha
    height, width = mask.shape
    return QImage(picture.data, width, height, 4 * width, QImage.Format.Format_ARGB32_Premultiplied).copy()
