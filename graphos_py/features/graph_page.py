"""The image graph: which photos hang together by verified matches, and where the block could break."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QSlider, QVBoxLayout

from graphos_core.data import Array, PairMatches
from graphos_core.features.graph import ImageGraph, image_graph
from graphos_core.number_format import format_value
from graphos_py.features.graph_facts import (
    GNSS,
    ORIENTATION,
    STRENGTH,
    edges_of,
    positions_by_gnss,
    positions_by_orientation,
    positions_by_strength,
)
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.thumbnail_pixels import thumbnail_arrays
from graphos_py.translation import tr
from graphos_py.views.background import Background
from graphos_py.views.graph_view import GraphView

LAYOUTS = {STRENGTH: "Places: by common points", GNSS: "Places: by GNSS", ORIENTATION: "Places: as oriented"}
STEPS = 100
"""Steps of the threshold slider from none to the strongest pair, on a root scale."""

MOST_SAID = 5
"""Sentences on weak places at most; the picture marks all."""


class GraphPage(ResultPage):
    """The graph, its threshold and what it says.

    Signals
    -------
    pair_chosen(index)
        Row of `FeaturesResult.pairs`.
    """

    label = "Image graph"
    pair_chosen = Signal(int)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self._background = Background(self)
        self._layouts: dict[str, Array] = {}
        self.view = GraphView()
        self.view.photo_clicked.connect(self.photo_wanted)
        self.view.pair_clicked.connect(self.pair_chosen)
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setContentsMargins(12, 6, 12, 6)
        self.column.addLayout(self._bar())
        self.column.addWidget(self.view, 1)
        self.column.addWidget(self.said)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 4, 8, 4)
        bar.setSpacing(8)
        self.layouts = QComboBox()
        self.layouts.setAccessibleName(tr("Where the photos are drawn"))
        self.layouts.activated.connect(self._place)
        bar.addWidget(self.layouts, 0, Qt.AlignmentFlag.AlignTop)
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setRange(0, STEPS)
        self.slider.setAccessibleName(tr("Hide pairs with fewer matches"))
        self.slider.setToolTip(tr("Hides weak pairs in this picture only; nothing is deleted."))
        self.slider.valueChanged.connect(self._hide)
        self.threshold = QLabel()
        self.threshold.setProperty("role", "caption")
        column = QVBoxLayout()
        column.setSpacing(0)
        column.addWidget(self.slider)
        column.addWidget(self.threshold, 0, Qt.AlignmentFlag.AlignRight)
        bar.addLayout(column, 1)
        bar.addWidget(self.lesson_button("features/image-graph"), 0, Qt.AlignmentFlag.AlignTop)
        return bar

    # ------------------------------------------------------------------------------------------------ public

    def fill(self) -> None:
        """Show the graph of the result."""
        project, result = self.session.project, self.result
        if result is None or project is None:
            self._layouts = {}
            self.layouts.clear()
            self.view.set_graph((), (), np.zeros((0, 2)))
            self.said.setText("")
            self._hide()
            return
        names = [photo.name for photo in project.photo_set.photos]
        pairs = result.pairs
        self._find_layouts(names, pairs)
        self._find_weak_places(names, pairs)
        places = self._layouts.get(self._layout, np.zeros((len(names), 2)))
        self.view.set_graph(names, edges_of(pairs), places)
        self.view.set_pictures(thumbnail_arrays(names))
        self.view.select(self.session.photo)
        self._hide()
        if self._layout == STRENGTH:
            self._place()

    def show_live(self, pairs: list[PairMatches], names: list[str]) -> None:
        """Let the graph grow while pairs are matched, photos on a circle."""
        turn = np.linspace(0.0, 2 * np.pi, len(names), endpoint=False)
        circle = np.column_stack([np.sin(turn), -np.cos(turn)])
        self.view.set_graph(names, edges_of(pairs), circle)
        self.view.set_pictures(thumbnail_arrays(names))

    def show_photo(self, index: int) -> None:
        """Mark another photo."""
        self.view.select(index)

    # --------------------------------------------------------------------------------------------- reacting

    @property
    def _layout(self) -> str:
        return str(self.layouts.currentData() or STRENGTH)

    def _find_layouts(self, names: list[str], pairs: list[PairMatches]) -> None:
        """Offer the layouts there are, the one of real places first."""
        project = self.session.project
        assert project is not None
        before = self.layouts.currentData()
        known = {
            ORIENTATION: positions_by_orientation(self.session.results.get("adjustment"), names),
            GNSS: positions_by_gnss(project.photo_set.photos),
        }
        self._layouts = {key: places for key, places in known.items() if places is not None}
        self.layouts.clear()
        for key in (*self._layouts, STRENGTH):
            self.layouts.addItem(tr(LAYOUTS[key]), key)
        self.layouts.setCurrentIndex(max(self.layouts.findData(before), 0))

    def _place(self) -> None:
        """Put the photos where the chosen layout wants them; the one by strength is computed aside."""
        key, result = self._layout, self.result
        if key in self._layouts:
            self.view.set_places(self._layouts[key])
            return
        if result is None:
            return

        def take(places: object) -> None:
            if isinstance(places, np.ndarray) and result is self.result:
                self._layouts[STRENGTH] = places
                if self._layout == STRENGTH:
                    self.view.set_places(places)

        self._background.run(lambda: positions_by_strength(len(result.features), result.pairs), take)

    def _find_weak_places(self, names: list[str], pairs: tuple[PairMatches, ...]) -> None:
        """Mark bridges and photos on which the block hangs, and say what they mean."""
        result = self.result
        self.said.setText("")

        def take(graph: object) -> None:
            if result is not self.result or not isinstance(graph, ImageGraph):
                return
            self.view.mark_weak(graph.bridges, graph.articulations)
            self.said.setText(_sentences(graph, len(names)))

        self._background.run(lambda: image_graph(names, pairs), take)

    def _hide(self) -> None:
        """Hide pairs below the threshold of the slider."""
        least = round(self.view.most * (self.slider.value() / STEPS) ** 2)
        self.view.set_least(least)
        shown, total = len(self.view.shown), len(self.view.edges)
        self.threshold.setText(
            tr("from {n} matches: {shown} of {all} pairs", n=format_value(least), shown=shown, all=total)
        )


def _sentences(graph: ImageGraph, count: int) -> str:
    """Return what the graph says, problems first; that all is well where there are none."""
    if graph.sentences:
        said = [f"⚠ {tr(sentence)}" for sentence in graph.sentences[:MOST_SAID]]
        more = len(graph.sentences) - MOST_SAID
        return "\n".join([*said, *([tr("… and {n} more", n=more)] if more > 0 else [])])
    return tr("All {n} photos hang together, and no single pair or photo holds them. The weakest cut: {cut} verified "
              "matches.", n=count, cut=format_value(graph.cut))  # fmt: skip
