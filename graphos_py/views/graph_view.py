"""The image graph: photos as nodes that can be dragged, verified pairs as edges, nothing deleted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QEvent, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QHelpEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QSizePolicy, QToolTip, QWidget

from graphos_core.data.record import Array
from graphos_core.number_format import format_value
from graphos_core.rendering.colour_maps import colours_of_values
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.colour_legend import paint_legend
from graphos_py.views.export import Writer, export_menu, image_from_array, write_csv, write_png, write_svg
from graphos_py.views.graph_marks import Edge, bend_of, bowed, paint_edge, paint_node
from graphos_py.views.painting import is_dark, paint_empty_state

DRAG_STARTS = 4.0
REACH = 7.0
"""How far from an edge a click still meets it, screen px."""
MARGIN = 60.0
SMALLEST_NODE = 26.0


class GraphView(QWidget):
    """A graph of photos.

    Signals
    -------
    photo_clicked(index)
    pair_clicked(index)
        Row of the pair, of `Edge.pair`.
    """

    photo_clicked = Signal(int)
    pair_clicked = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("graph")
        self.names: Sequence[str] = ()
        self.edges: tuple[Edge, ...] = ()
        self.cut_photos: frozenset[int] = frozenset()
        self.places: Array = np.zeros((0, 2))
        self._bend = 0.0
        self.least = 0
        self.selected = -1
        self.hovered: Edge | None = None
        self._pictures: list[QImage] = []
        self._zoom, self._shift, self._fitted = 1.0, np.zeros(2), True
        self._held, self._panning, self._moved = -1, False, False
        self._last = QPointF()
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(200, 160)

    # what is shown

    def set_graph(self, names: Sequence[str], edges: Sequence[Edge], places: Array) -> None:
        """Show photos at places (n, 2) of any unit, and their pairs."""
        self.names, self.edges, self.cut_photos = names, tuple(edges), frozenset()
        self.hovered = None
        self.setAccessibleName(
            tr("Image graph of {n} photos and {m} pairs", n=len(self.names), m=len(self.edges))
        )
        self.set_places(places)

    def mark_weak(self, bridges: Sequence[tuple[int, int]], photos: Sequence[int]) -> None:
        """Mark pairs (a, b) without which the graph would fall apart, and photos of which the same is true."""
        weak = set(bridges)
        self.edges = tuple(replace(edge, weak=(edge.a, edge.b) in weak) for edge in self.edges)
        self.cut_photos = frozenset(photos)
        self.update()

    def set_places(self, places: Array) -> None:
        """Put the photos at other places and show them all."""
        self.places = np.array(places, np.float64).reshape(-1, 2)
        self._bend = bend_of(self.places)
        self.fit()

    def set_pictures(self, arrays: Sequence[Array] | None) -> None:
        """Show small pictures uint8 (h, w, 3) on the nodes; None for numbers only."""
        self._pictures = [] if arrays is None else [image_from_array(array) for array in arrays]
        self.update()

    def set_least(self, least: int) -> None:
        """Hide pairs with fewer matches; they stay in the result."""
        self.least = least
        self.update()

    def select(self, photo: int) -> None:
        """Mark a photo; −1 for none. Emits nothing."""
        self.selected = photo
        self.update()

    @property
    def shown(self) -> list[Edge]:
        """The edges that are not hidden."""
        return [edge for edge in self.edges if edge.matches >= self.least]

    # coordinates

    def fit(self) -> None:
        """Show the whole graph."""
        self._fitted = True
        if len(self.places):
            low, high = self.places.min(axis=0), self.places.max(axis=0)
            wide, tall = (float(v) for v in np.maximum(high - low, 1e-9))
            node = self._largest_node()
            room = (self.width() - node - MARGIN, self.height() - node - MARGIN - self.fontMetrics().height())
            self._zoom = max(min(room[0] / wide, room[1] / tall), 1e-9)
            if max(wide, tall) <= 1e-9:
                self._zoom = 1.0
            middle = np.array([0.5 * self.width(), 0.5 * self.height()])
            self._shift = middle - 0.5 * (low + high) * self._zoom
        self.update()

    def to_screen(self) -> Array:
        """Return the places of all nodes on the screen, px (n, 2)."""
        return np.asarray(self.places * self._zoom + self._shift)

    def bow(self, edge: Edge) -> Array:
        """Return the points (k, 2) of an edge on the screen, px."""
        at = self.to_screen()
        return bowed(at[edge.a], at[edge.b], self._bend)

    def node_size(self) -> float:
        """Return the longer side of a node, px: smaller the more there are and the closer they lie."""
        if len(self.places) < 2:
            return self._largest_node()
        at = self.to_screen()
        apart = np.linalg.norm(at[:, None] - at[None], axis=2)
        np.fill_diagonal(apart, np.inf)
        return float(np.clip(0.95 * np.median(apart.min(axis=1)), SMALLEST_NODE, self._largest_node()))

    def _largest_node(self) -> float:
        room = np.sqrt(max(self.width() * self.height(), 1) / max(len(self.names), 1))
        return float(np.clip(0.42 * room, SMALLEST_NODE, theme().px(76)))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the whole graph in sight."""
        super().resizeEvent(event)
        if self._fitted:
            self.fit()

    # painting

    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint edges, then nodes, then the legend."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), self.palette().color(QPalette.ColorRole.Base))
        if not len(self.names):
            title = tr("Which photos hang together")
            paint_empty_state(
                painter, self.rect(), self.palette(), title, tr("Run this step to see the graph.")
            )
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        at = self.to_screen()
        most = self.most

        def colour_of(edge: Edge) -> tuple[QColor, float]:
            share = edge.matches / most
            rgb = colours_of_values(np.array([share]), 0.0, 1.0, self._table)[0]
            return QColor(*rgb.tolist()), share

        for edge in sorted(self.shown, key=lambda edge: edge.matches):
            paint_edge(painter, edge, self.bow(edge), colour_of(edge))
        if self.hovered is not None and self.hovered.matches >= self.least:
            paint_edge(painter, self.hovered, self.bow(self.hovered), colour_of(self.hovered), marked=True)
        order = [i for i in range(len(self.names)) if i != self.selected]
        for i in [*order, *([self.selected] if 0 <= self.selected < len(self.names) else [])]:
            picture = self._pictures[i] if i < len(self._pictures) else None
            chosen, cut = i == self.selected, i in self.cut_photos
            paint_node(painter, self._node_box(i, at[i]), i, picture, self.palette(), chosen=chosen, cut=cut)
        if self.edges:
            area = QRectF(0, 0, self.width(), self.height())
            paint_legend(
                painter, area, self.palette(), 0.0, float(most), tr("verified matches"), "", self._table
            )

    @property
    def most(self) -> int:
        """Matches of the strongest pair."""
        return max((edge.matches for edge in self.edges), default=1) or 1

    @property
    def _table(self) -> str:
        return "bright viridis" if is_dark(self.palette()) else "viridis"

    def _node_box(self, index: int, at: Array) -> QRectF:
        size = self.node_size()
        wide, tall = size, 0.75 * size
        if index < len(self._pictures):
            picture = self._pictures[index]
            longer = max(picture.width(), picture.height(), 1)
            wide, tall = size * picture.width() / longer, size * picture.height() / longer
        return QRectF(float(at[0]) - wide / 2, float(at[1]) - tall / 2, wide, tall)

    # people

    def node_at(self, x: float, y: float) -> int:
        """Return the photo at a screen position, the selected and later ones first; −1 for none."""
        at = self.to_screen()
        order = sorted(range(len(self.names)), key=lambda i: (i != self.selected, -i))
        return next((i for i in order if self._node_box(i, at[i]).contains(QPointF(x, y))), -1)

    def edge_at(self, x: float, y: float) -> Edge | None:
        """Return the shown edge nearest to a screen position, if it is near."""
        shown = self.shown
        if not shown:
            return None
        at = self.to_screen()
        start, end = at[[e.a for e in shown]], at[[e.b for e in shown]]
        bows = bowed(start, end, self._bend)
        first, along = bows[:, :-1], np.diff(bows, axis=1)
        square = np.maximum((along**2).sum(axis=2), 1e-9)
        share = np.clip((([x, y] - first) * along).sum(axis=2) / square, 0.0, 1.0)
        distance = np.linalg.norm(first + share[..., None] * along - [x, y], axis=2).min(axis=1)
        best = int(np.argmin(distance))
        return shown[best] if distance[best] <= REACH else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take a node, or the whole graph."""
        self._last, self._moved = event.position(), False
        self._held = self.node_at(event.position().x(), event.position().y())
        self._panning = self._held < 0

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag what was taken, or mark the edge under the cursor."""
        position = event.position()
        if event.buttons() == Qt.MouseButton.NoButton:
            node = self.node_at(position.x(), position.y())
            edge = None if node >= 0 else self.edge_at(position.x(), position.y())
            if edge is not self.hovered:
                self.hovered = edge
                self.update()
            hand = Qt.CursorShape.PointingHandCursor if node >= 0 or edge else Qt.CursorShape.ArrowCursor
            self.setCursor(hand)
            return
        step = position - self._last
        if not self._moved and step.manhattanLength() <= DRAG_STARTS:
            return
        self._moved, self._last, self._fitted = True, position, False
        shift = np.array([step.x(), step.y()])
        if self._held >= 0:
            self.places[self._held] += shift / self._zoom
        elif self._panning:
            self._shift = self._shift + shift
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Choose a photo or a pair, unless something was dragged."""
        if not self._moved and event.button() == Qt.MouseButton.LeftButton:
            if self._held >= 0:
                self.select(self._held)
                self.photo_clicked.emit(self._held)
            else:
                edge = self.edge_at(event.position().x(), event.position().y())
                if edge is not None:
                    self.pair_clicked.emit(edge.pair)
        self._held, self._panning = -1, False

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Show the whole graph."""
        if self.node_at(event.position().x(), event.position().y()) < 0:
            self.fit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom at the cursor."""
        self._zoom_at(event.position().x(), event.position().y(), 1.0015 ** event.angleDelta().y())
        event.accept()

    def _zoom_at(self, x: float, y: float, factor: float) -> None:
        at = np.array([x, y])
        self._shift = at - (at - self._shift) * factor
        self._zoom *= factor
        self._fitted = False
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows go through the photos, N and P through the pairs of one, Return opens; F fits, + and − zoom."""
        key = Qt.Key(event.key())
        steps = {Qt.Key.Key_Right: 1, Qt.Key.Key_Down: 1, Qt.Key.Key_Left: -1, Qt.Key.Key_Up: -1}
        middle = (0.5 * self.width(), 0.5 * self.height())
        if key in steps and len(self.names):
            self.select((self.selected + steps[key]) % len(self.names))
            self.photo_clicked.emit(self.selected)
        elif key in (Qt.Key.Key_N, Qt.Key.Key_P):
            self._next_edge(1 if key == Qt.Key.Key_N else -1)
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self.hovered is not None:
            self.pair_clicked.emit(self.hovered.pair)
        elif key == Qt.Key.Key_F:
            self.fit()
        elif key in (Qt.Key.Key_Plus, Qt.Key.Key_Equal, Qt.Key.Key_Minus):
            self._zoom_at(*middle, 0.8 if key == Qt.Key.Key_Minus else 1.25)
        else:
            super().keyPressEvent(event)

    def _next_edge(self, step: int) -> None:
        mine = [e for e in self.shown if self.selected < 0 or self.selected in (e.a, e.b)]
        if mine:
            now = mine.index(self.hovered) if self.hovered in mine else (-1 if step > 0 else 0)
            self.hovered = mine[(now + step) % len(mine)]
            self.update()

    def event(self, event: QEvent) -> bool:
        """Tell what is under the cursor."""
        if isinstance(event, QHelpEvent):
            QToolTip.showText(event.globalPos(), self.tip(event.pos().x(), event.pos().y()), self)
            return True
        return super().event(event)

    def tip(self, x: float, y: float) -> str:
        """Return what stands at a screen position, in words."""
        node = self.node_at(x, y)
        if node >= 0:
            mine = [e for e in self.edges if node in (e.a, e.b)]
            said = tr("{name}: {n} pairs, {m} verified matches", name=self.names[node], n=len(mine),
                      m=format_value(sum(e.matches for e in mine)))  # fmt: skip
            return said + (
                "\n" + tr("Without it the photos would fall apart.") if node in self.cut_photos else ""
            )
        edge = self.edge_at(x, y)
        if edge is None:
            return ""
        said = tr("{a} – {b}: {n} verified matches", a=self.names[edge.a], b=self.names[edge.b],
                  n=format_value(edge.matches))  # fmt: skip
        return said + ("\n" + tr("The only link between two parts of the block.") if edge.weak else "")

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer exports."""
        if len(self.names):
            export_menu(self, self.exports()).exec(event.globalPos())

    def exports(self) -> dict[str, Writer]:
        """Return writers by file ending; the table has one row per pair."""
        rows = [(self.names[e.a], self.names[e.b], e.matches, e.weak) for e in self.edges]
        return {
            "png": lambda path: write_png(self, path),
            "svg": lambda path: write_svg(self, path),
            "csv": lambda path: write_csv(
                path, ("photo a", "photo b", "verified matches", "weak link"), rows
            ),
        }
