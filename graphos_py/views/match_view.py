"""Two photos side by side, their verified matches, and where the point under the cursor lies in the other photo."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QKeyEvent,
    QResizeEvent,
)
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QLabel, QSizePolicy, QVBoxLayout, QWidget

from graphos_core.data.cameras import Camera
from graphos_core.data.matches import PairMatches
from graphos_core.data.record import Array
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_py.translation import tr
from graphos_py.views.background import Background
from graphos_py.views.export import Writer, export_menu, write_csv, write_png, write_svg
from graphos_py.views.match_colours import RESIDUAL, MatchColours, colours_by, residual_range, residual_title
from graphos_py.views.match_overlay import MatchOverlay
from graphos_py.views.pair_geometry import PairGeometry
from graphos_py.views.pixel_canvas import PixelCanvas

EpipolarCurve = Callable[[int, float, float], Array]
"""(0 or 1: the photo of the point, x, y in px) to points (n, 2) of the curve in the other photo, px."""

GAP = 6


class MatchView(QWidget):
    """Verified matches of one pair.

    Signals
    -------
    match_selected(index)
        Row of the match that was clicked; −1 for none.
    cursor_moved(photo, x, y)
        0 for the left and 1 for the right photo, and the position in it, px.
    """

    match_selected = Signal(int)
    cursor_moved = Signal(int, float, float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("matches")
        self.canvases = (PixelCanvas(self), PixelCanvas(self))
        self.xy = (np.zeros((0, 2)), np.zeros((0, 2)))
        self.selected = -1
        self.hovered = -1
        self.residuals: Array | None = None
        self.colours: list[QColor] = []
        self.kind = RESIDUAL
        self.colouring: MatchColours = colours_by(RESIDUAL, None, None)
        self.kept: Array | None = None
        self.lines = True
        self._pair: PairMatches | None = None
        self._geometry: PairGeometry | None = None
        self._given_curve: EpipolarCurve | None = None
        self._background = Background(self)
        self.names = ("", "")
        self.pointed: tuple[int, float, float] | None = None
        self._linking = False
        self._picture = QWidget(self)
        self._photos = QHBoxLayout(self._picture)
        self._photos.setContentsMargins(0, 0, 0, 0)
        self._photos.setSpacing(GAP)
        for side, canvas in enumerate(self.canvases):
            self._photos.addWidget(canvas, 1)
            canvas.clicked.connect(lambda x, y, s=side: self._on_click(s, x, y))
            canvas.cursor_moved.connect(lambda x, y, s=side: self._on_cursor(s, x, y))
            canvas.view_changed.connect(lambda s=side: self._link(s))
        self.canvases[0].empty = (
            self.tr("Here you will see the same points in two photos"),
            self.tr("Run feature matching, then choose a pair."),
        )
        self._over = MatchOverlay(self, self._picture)
        self._text = QLabel()
        self._text.setContentsMargins(8, 2, 8, 2)
        self._text.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        box = QVBoxLayout(self)
        box.setContentsMargins(0, 0, 0, 0)
        box.setSpacing(0)
        box.addWidget(self._picture, 1)
        box.addWidget(self._text)
        self.setFocusProxy(self.canvases[0])

    # what is shown

    def set_pair(
        self,
        image_a: Array | None,
        image_b: Array | None,
        xy_a: Array,
        xy_b: Array,
        pair: PairMatches | None = None,
        names: tuple[str, str] = ("", ""),
        epipolar_curve: EpipolarCurve | None = None,
        cameras: tuple[Camera, Camera] | None = None,
    ) -> None:
        """Show a pair and its verified matches.

        Parameters
        ----------
        image_a, image_b : uint8 (h, w) or (h, w, 3), or None
        xy_a, xy_b : float (n, 2)
            Positions of the matches in both photos, row by row, px: ``features.xy[pair.matches[:, 0]]`` and so on.
        pair : PairMatches or None
            For the numbers, the distances and the epipolar line.
        names : (str, str)
            Names of the photos.
        epipolar_curve : callable or None
            Draws the epipolar curve in place of the one from `pair`.
        cameras : (Camera, Camera) or None
            Of the two photos; needed for the lines and distances of an essential matrix.
        """
        self.xy = (np.asarray(xy_a, np.float64).reshape(-1, 2), np.asarray(xy_b, np.float64).reshape(-1, 2))
        self._pair = pair
        self.names = names
        self.selected = self.hovered = -1
        self.pointed = self.kept = None
        for canvas, image in zip(self.canvases, (image_a, image_b)):
            canvas.set_array(image)
        self._arrange()
        self._given_curve = epipolar_curve
        self._geometry = PairGeometry.of_pair(pair, (self._size(0), self._size(1)), cameras)
        self._take_residuals(None)
        if self._geometry is not None and len(self.xy[0]):
            geometry, xy = self._geometry, self.xy

            def take(result: object) -> None:
                if self._geometry is geometry and isinstance(result, np.ndarray):
                    self._take_residuals(result)

            self._background.run(lambda: geometry.distances(*xy), take)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Put the photos side by side or one above the other, whichever shows them larger."""
        super().resizeEvent(event)
        self._arrange()

    def _arrange(self) -> None:
        width, height = self._size(0)
        if not width or self.canvases[1].array is None:
            return
        area = self._picture.size()
        beside = min(area.width() / (2 * width), area.height() / height)
        above = min(area.width() / width, area.height() / (2 * height))
        directions = QBoxLayout.Direction
        self._photos.setDirection(directions.LeftToRight if beside >= above else directions.TopToBottom)

    def _take_residuals(self, residuals: Array | None) -> None:
        self.residuals = residuals
        self._colour_matches()
        self._write()
        self._over.update()

    def select_match(self, index: int, focus: bool = False) -> None:
        """Highlight a match in both photos; −1 for none. `focus` brings it to the middle. Emits nothing."""
        self.selected = index
        if focus and index >= 0:
            self._linking = True
            for canvas, (x, y) in zip(self.canvases, (self.xy[0][index], self.xy[1][index])):
                canvas.focus_on(float(x), float(y), max(canvas.zoom, 2.0))
            self._linking = False
        self._write()
        self._over.update()

    @property
    def curve(self) -> EpipolarCurve | None:
        """What draws the epipolar curve; None while it is not known."""
        if self._given_curve is None and self._geometry is not None and self.residuals is not None:
            return self._geometry.curve
        return self._given_curve

    @property
    def pair_geometry(self) -> PairGeometry | None:
        """The geometry of the pair; None where it has none."""
        return self._geometry

    def _size(self, side: int) -> tuple[int, int]:
        return self.canvases[side].image_size

    def colour_by(self, kind: str) -> None:
        """Let the colour of a match say its ``"residual"`` or its ``"ratio"``."""
        self.kind = kind
        self._take_residuals(self.residuals)

    def show_lines(self, lines: bool) -> None:
        """Draw lines between the photos, or only the points in both."""
        self.lines = lines
        self._over.refresh()

    def show_kept(self, kept: Array | None) -> None:
        """Grey out matches that a thinning would leave out, bool (n,); None for none."""
        self.kept = kept
        self._take_residuals(self.residuals)

    def _colour_matches(self) -> None:
        self.colouring = colours_by(self.kind, self._pair, self.residuals)
        table = self.colouring.rgb(self.xy[0], self._size(0)[0], self.kept)
        self.colours = [QColor(*rgb) for rgb in table.tolist()]

    def legend_range(self) -> float:
        """Return the distance that gets the last colour, px: few matches lie beyond it."""
        return residual_range(self._pair, self.residuals)

    # people

    def nearest(self, side: int, x: float, y: float, reach: float = 12.0) -> int:
        """Return the match within `reach` screen px of a position in photo `side`, −1 if there is none."""
        if not len(self.xy[side]):
            return -1
        distance = np.hypot(*(self.xy[side] - [x, y]).T) * self.canvases[side].zoom
        best = int(np.argmin(distance))
        return best if distance[best] <= reach else -1

    def _on_click(self, side: int, x: float, y: float) -> None:
        self.select_match(self.nearest(side, x, y))
        self.match_selected.emit(self.selected)

    def _on_cursor(self, side: int, x: float, y: float) -> None:
        width, height = self._size(side)
        inside = -0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5
        self.pointed = (side, x, y) if inside else None
        self.hovered = self.nearest(side, x, y) if inside else -1
        self.cursor_moved.emit(side, x, y)
        self._write()
        self._over.update()

    def _link(self, side: int) -> None:
        """Give the other photo the same zoom relative to fitting, about the same relative place."""
        first, second = self.canvases[side], self.canvases[1 - side]
        if not self._linking and first.array is not None and second.array is not None:
            self._linking = True
            if first.fitted:  # both whole, also after a change of size
                second.fit()
            ratio = min(first.image_size) / min(second.image_size)
            zoom = first.zoom * ratio
            if not first.fitted and abs(zoom / second.zoom - 1.0) > 1e-6:
                middle = (0.5 * second.width(), 0.5 * second.height())
                x, y = self._counterpart(side)
                second.zoom_at(*middle, zoom / second.zoom) if math.isnan(x) else second.focus_on(x, y, zoom)
            self._linking = False
        self._over.update()

    def _counterpart(self, side: int) -> tuple[float, float]:
        """Return where the middle of photo `side` lies in the other one, by the median shift of nearby matches."""
        first = self.canvases[side]
        if self._geometry is not None and self._geometry.mapped:
            at = first.to_image(0.5 * first.width(), 0.5 * first.height())
            x, y = self._geometry.curve(side, *at)[0].tolist()
            return x, y
        if len(self.xy[side]) < 3:
            return math.nan, math.nan
        middle = np.array(first.to_image(0.5 * first.width(), 0.5 * first.height()))
        near = np.argsort(((self.xy[side] - middle) ** 2).sum(axis=1))[:9]
        shift = np.median(self.xy[1 - side][near] - self.xy[side][near], axis=0)
        x, y = (middle + shift).tolist()
        return x, y

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """N and P go through the matches; Escape selects none."""
        steps = {Qt.Key.Key_N: 1, Qt.Key.Key_P: -1}
        count = len(self.xy[0])
        if event.key() in steps and count:
            self.select_match((self.selected + steps[Qt.Key(event.key())]) % count, focus=True)
            self.match_selected.emit(self.selected)
        elif event.key() == Qt.Key.Key_Escape and self.selected >= 0:
            self.select_match(-1)
            self.match_selected.emit(-1)
        else:
            super().keyPressEvent(event)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending."""
        header = (
            "x_a [px]",
            "y_a [px]",
            "x_b [px]",
            "y_b [px]",
            f"{residual_title(self._pair)} [px]",
            "ratio",
        )
        unknown = np.full(len(self.xy[0]), np.nan)
        ratio = unknown if self._pair is None or len(self._pair.ratio) != len(unknown) else self._pair.ratio
        extra = np.column_stack([unknown if self.residuals is None else self.residuals, ratio])
        return {
            "png": lambda path: write_png(self, path),
            "svg": lambda path: write_svg(self, path),
            "csv": lambda path: write_csv(path, header, np.column_stack([*self.xy, extra]).tolist()),
        }

    # texts and painting

    def _write(self) -> None:
        count, pair = len(self.xy[0]), self._pair
        if pair is None and not count:
            self._text.setText("")
            return
        shown = self.selected if self.selected >= 0 else self.hovered
        self._text.setText("      ".join(self._facts(shown) if 0 <= shown < count else self._counts(count)))

    def _counts(self, count: int) -> list[str]:
        parts = [self.tr("{n} verified matches").format(n=format_value(count))]
        if self._pair is not None:
            parts[0] += self.tr(" of {n} candidates").format(n=format_value(self._pair.candidates))
            if self._pair.reason:
                parts.append(tr(self._pair.reason))
        return parts

    def _facts(self, index: int) -> list[str]:
        (xa, ya), (xb, yb) = self.xy[0][index], self.xy[1][index]
        parts = [f"#{index}"]
        if self.residuals is not None:
            distance = format_value(float(self.residuals[index]), digits=2, unit="px")
            mapped = self._geometry is not None and self._geometry.mapped
            parts.append(tr("{d} from the mapped point" if mapped else "{d} from the line", d=distance))
        if self._pair is not None and len(self._pair.ratio) == len(self.xy[0]):
            parts.append(self.tr("ratio {q}").format(q=f"{float(self._pair.ratio[index]):.2f}"))
        return [*parts, f"{xa:.1f}, {ya:.1f} ↔ {xb:.1f}, {yb:.1f}{THIN_SPACE}px"]

    def screen_positions(self, side: int) -> Array:
        """Return the matches of photo `side` (n, 2) in px of the picture area."""
        corner = self.canvases[side].pos()
        return self.canvases[side].to_screen(self.xy[side]) + np.array([corner.x(), corner.y()])
