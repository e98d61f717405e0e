"""Matches of a pair: linked photos, the funnel, what its geometry means, and what a thinning would keep."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QLabel,
    QScrollArea,
    QSplitter,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from graphos_core.data import Array, Camera, PairMatches, Photo
from graphos_core.features.funnel import Funnel, funnel
from graphos_core.run import Run
from graphos_py.features.pair_facts import named_steps, pair_sentence
from graphos_py.features.thinning_preview import ThinningPreview
from graphos_py.icons import bind_icon
from graphos_py.jobs import Job
from graphos_py.pair_matrix import PairMatrix
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.translation import tr
from graphos_py.views.background import Background
from graphos_py.views.funnel_view import FunnelView
from graphos_py.views.match_colours import RATIO, RESIDUAL
from graphos_py.views.match_view import MatchView


class MatchingPage(ResultPage):
    """One pair at a time.

    Signals
    -------
    pair_chosen(index)
        Row of `FeaturesResult.pairs`.
    descriptors_wanted(photo, keypoint, other)
        The person wants to see what the selected match was found by.
    """

    label = "Matches"
    pair_chosen = Signal(int)
    descriptors_wanted = Signal(int, int, int)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.pair = -1
        self._shown: PairMatches | None = None
        self._funnel: Funnel | None = None
        self._background = Background(self)
        self._job: Job | None = None
        self._again = False
        self.matrix = PairMatrix()
        self.matrix.pair_chosen.connect(self._choose)
        self.funnel = FunnelView()
        self.said = QLabel()
        self.said.setWordWrap(True)
        self.said.setContentsMargins(8, 6, 8, 6)
        self.thinning = ThinningPreview(session)
        self.matches = MatchView()
        self.thinning.previewed.connect(self.matches.show_kept)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(self._side())
        splitter.addWidget(self.matches)
        splitter.setStretchFactor(0, 0)
        splitter.setStretchFactor(1, 1)
        splitter.setSizes([225, 600])
        self.column.addLayout(self._bar())
        self.column.addWidget(splitter, 1)

    def _side(self) -> QWidget:
        facts = QWidget()
        facts.setProperty("role", "paper")
        column = QVBoxLayout(facts)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(4)
        for widget in (self.said, self.funnel, self.thinning):
            column.addWidget(widget)
        column.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        scroll.setWidget(facts)
        side = QSplitter(Qt.Orientation.Vertical)
        side.addWidget(self.matrix)
        side.addWidget(scroll)
        side.setSizes([260, 360])
        side.setMinimumWidth(theme().px(150))
        return side

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 4, 8, 4)
        bar.setSpacing(6)
        self.pairs = QComboBox()
        self.pairs.setAccessibleName(tr("Pair of photos"))
        self.pairs.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.pairs.setMinimumContentsLength(18)
        self.pairs.activated.connect(lambda row: self._choose(int(self.pairs.itemData(row))))
        for symbol, tip, step in (
            ("previous", tr("Previous pair"), -1),
            ("right", tr("Next pair"), 1),
        ):
            button = QToolButton()
            button.setProperty("role", "flat")
            button.setToolTip(tip)
            button.setAccessibleName(tip)
            bind_icon(button, symbol, "text")
            button.clicked.connect(lambda _=False, s=step: self._step(s))
            bar.addWidget(button)
            if step < 0:
                bar.addWidget(self.pairs, 1)
        self.colours = QComboBox()
        self.colours.setAccessibleName(tr("What the colour of a match says"))
        self.colours.addItem(tr("Colour: residual"), RESIDUAL)
        self.colours.addItem(tr("Colour: ratio"), RATIO)
        self.colours.activated.connect(lambda _: self.matches.colour_by(str(self.colours.currentData())))
        bar.addWidget(self.colours)
        self.lines = QToolButton()
        self.lines.setText(tr("Lines"))
        self.lines.setToolTip(tr("Lines between the photos, or only the points in both"))
        self.lines.setCheckable(True)
        self.lines.setChecked(True)
        self.lines.toggled.connect(self.matches.show_lines)
        bar.addWidget(self.lines)
        self.descriptors = QToolButton()
        self.descriptors.setText(tr("Compare"))
        self.descriptors.setToolTip(
            tr("Compare the descriptors of the selected match (click one; N and P go through)")
        )
        self.descriptors.setEnabled(False)
        self.descriptors.clicked.connect(self._compare)
        self.matches.match_selected.connect(lambda row: self.descriptors.setEnabled(row >= 0))
        bar.addWidget(self.descriptors)
        bar.addWidget(self.lesson_button("features/scenes"))
        return bar

    # ------------------------------------------------------------------------------------------------ public

    def fill(self) -> None:
        """Show the matrix of pairs and a pair of the selected photo."""
        names = [photo.name for photo in self._photos()]
        pairs = self.result.pairs if self.result is not None else ()
        self._list_pairs(pairs, names)
        self.matrix.show_pairs(pairs, names)
        self._shown = self._funnel = None
        if not pairs:
            self._show_nothing()
            return
        self._count()
        if not 0 <= self.pair < len(pairs):
            self.pair = -1
        self.show_photo(self.session.photo)
        if self.pair >= 0:
            self.show_pair(self.pair)
        else:
            self.show_pair(max(range(len(pairs)), key=lambda i: len(pairs[i].matches)))

    def show_photo(self, index: int) -> None:
        """Show the pair of a photo with the most verified matches, unless a pair of it is shown already."""
        if self.result is None:
            return
        if not self.isVisible():
            self._stale = True
            return
        pairs = self.result.pairs
        if 0 <= self.pair < len(pairs) and index in (pairs[self.pair].a, pairs[self.pair].b):
            return
        mine = [i for i, pair in enumerate(pairs) if index in (pair.a, pair.b)]
        if mine:
            self.show_pair(max(mine, key=lambda i: len(pairs[i].matches)))

    def show_pair(self, index: int) -> None:
        """Show a pair; read when the page is seen."""
        self.pair = index
        self.matrix.select(index)
        self.pairs.setCurrentIndex(self.pairs.findData(index))
        if self.result is None or not 0 <= index < len(self.result.pairs):
            return
        if not self.isVisible():
            self._stale = True
            return
        pair = self.result.pairs[index]
        if pair is self._shown:
            return
        self.said.setText(pair_sentence(pair))
        self._write_funnel()
        if self._job is not None:
            self._again = True
            return
        self._read(pair)

    def show_live(self, pairs: list[PairMatches]) -> None:
        """Let the matrix grow while pairs are matched."""
        self.matrix.select(-1)
        self.matrix.show_pairs(pairs, [photo.name for photo in self._photos()])

    # --------------------------------------------------------------------------------------------- reacting

    def _choose(self, index: int) -> None:
        self.show_pair(index)
        self.pair_chosen.emit(index)

    def _compare(self) -> None:
        row, pair = self.matches.selected, self._shown
        if pair is not None and 0 <= row < len(pair.matches):
            self.descriptors_wanted.emit(pair.a, int(pair.matches[row, 0]), pair.b)

    def _step(self, step: int) -> None:
        if self.pairs.count():
            row = (self.pairs.currentIndex() + step) % self.pairs.count()
            self._choose(int(self.pairs.itemData(row)))

    def _list_pairs(self, pairs: Any, names: list[str]) -> None:
        """List the pairs, those with matches first in the order of the photos."""
        self.pairs.clear()
        order = sorted(range(len(pairs)), key=lambda i: (bool(pairs[i].reason), pairs[i].a, pairs[i].b))
        for i in order:
            pair = pairs[i]
            mark = tr("not used") if pair.reason else str(len(pair.matches))
            self.pairs.addItem(f"{names[pair.a]} – {names[pair.b]} ({mark})", i)

    def _count(self) -> None:
        """Count the funnel of all pairs aside."""
        result = self.result

        def take(found: object) -> None:
            if result is self.result and isinstance(found, Funnel):
                self._funnel = found
                self._write_funnel()

        self._background.run(lambda: funnel(result), take)

    def _write_funnel(self) -> None:
        known = self._funnel.pairs if self._funnel is not None else ()
        self.funnel.set_steps(named_steps(known[self.pair].steps) if 0 <= self.pair < len(known) else [])

    def _show_nothing(self) -> None:
        self.pair = -1
        self.said.setText("")
        self.funnel.set_steps([])
        self.thinning.show_pair(None, None, None)
        self.matches.set_pair(None, None, np.zeros((0, 2)), np.zeros((0, 2)))

    def _read(self, pair: PairMatches) -> None:
        photos = self._photos()
        a, b = (self.session.seen(photos[index]) for index in (pair.a, pair.b))

        def work(run: Run) -> tuple[PairMatches, Array, Array]:
            from graphos_core.bands import visible
            from graphos_core.images import read_pixels
            from graphos_core.preprocessing.grey import eight_bit

            return pair, eight_bit(visible(read_pixels(a))), eight_bit(visible(read_pixels(b)))

        self._job = Job(work, name="pair", engine=False)
        self._job.succeeded.connect(self._pixels_read)
        self._job.failed.connect(self.session.tell)
        self._job.finished.connect(self._over)
        self.session.jobs.start(self._job)

    def _pixels_read(self, read: tuple[PairMatches, Array, Array]) -> None:
        pair, image_a, image_b = read
        if self.result is None or not any(pair is one for one in self.result.pairs):
            return
        self._shown = pair
        self.descriptors.setEnabled(False)
        features, photos = self.result.features, self._photos()
        matches = np.asarray(pair.matches).reshape(-1, 2)
        self.matches.set_pair(
            image_a,
            image_b,
            np.asarray(features[pair.a].xy)[matches[:, 0]],
            np.asarray(features[pair.b].xy)[matches[:, 1]],
            pair,
            (photos[pair.a].name, photos[pair.b].name),
            cameras=self._cameras(pair),
        )
        self.thinning.show_pair(pair, features[pair.a], features[pair.b])

    def _cameras(self, pair: PairMatches) -> tuple[Camera, Camera] | None:
        cameras, photos = self.session.seen_cameras(), self._photos()
        if not cameras:
            return None
        return cameras[photos[pair.a].camera], cameras[photos[pair.b].camera]

    def _over(self) -> None:
        self._job = None
        if self._again:
            self._again = False
            self.show_pair(self.pair)

    def _photos(self) -> tuple[Photo, ...]:
        return self.session.project.photo_set.photos if self.session.project is not None else ()
