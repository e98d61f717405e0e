"""Preprocessing: the selected photo before and after its filters, live; histogram, ways to grey, image analyser."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtCore import QTimer

from graphos_core.data import Array
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.translation import tr

VIEW, HISTOGRAM, GREY, ANALYSER = 0, 1, 2, 3


class PreprocessingTab(StageTab):
    """What is seen as "after" are always the parameters of the form, filtered only where somebody looks."""

    stage = "preprocessing"
    empty = (
        "Photos before and after filtering",
        "Here you will compare each photo with its filtered version, live while you change a parameter. "
        "Open or make a project first.",
    )
    empty_action = ""

    def __init__(self, session: Any, level: Any = "student") -> None:
        super().__init__(session, level)
        session.recipe_changed.connect(self._form_changed)
        session.run_changed.connect(self._ask)
        self._counting = QTimer(self, singleShot=True, interval=60)
        self._counting.timeout.connect(self._draw_histogram)

    @property
    def keeps_views(self) -> bool:
        """A photo is enough to show something."""
        return self.session.project is not None

    def make_views(self) -> None:
        """Preview, histogram, ways to grey, analyser."""
        from graphos_py.preprocessing.analyser_page import AnalyserPage
        from graphos_py.preprocessing.filter_view import FilterView
        from graphos_py.preprocessing.grey_page import GreyPage
        from graphos_py.preprocessing.live_preview import LivePreview
        from graphos_py.views.plot_view import PlotView

        self.image = FilterView()
        self.live = LivePreview(self.session, self.image.seen, self)
        self.live.opened.connect(self.image.set_photo)
        self.live.shown.connect(self._show)
        self.image.piece_wanted.connect(self.live.ask)
        self.histogram = PlotView()
        self.grey = GreyPage(self.session)
        self.analyser = AnalyserPage(self.session)
        self.add_view(self.image, "Before and after")
        self.add_view(self.histogram, "Histogram")
        self.add_view(self.grey, "Ways to grey")
        self.add_view(self.analyser, "Analyser")

    def refresh(self) -> None:
        """Show forms and preview."""
        super().refresh()
        self._ask()

    def show_result(self, result: Any) -> None:
        """Show the preview, which equals the result when nothing was changed."""
        self._ask()

    def show_photo(self, index: int) -> None:
        """Preview another photo."""
        self._ask()

    def view_shown(self, index: int) -> None:
        """Draw the histogram when it is seen."""
        if index == HISTOGRAM:
            self._counting.start()

    def _form_changed(self, stage: str) -> None:
        if stage == self.stage:
            self._ask()

    def _ask(self) -> None:
        project = self.session.project
        if project is None or not self._made or not self.isVisible():
            return
        photos = project.photo_set.photos
        if self.session.photo < len(photos):
            self.live.open(photos[self.session.photo])

    def _show(self, pieces: list[Any], filtered: bool) -> None:
        self.image.show_pieces(pieces, filtered)
        if self.views.currentIndex() == HISTOGRAM:
            self._counting.start()

    def _draw_histogram(self) -> None:
        piece = self.image.piece_seen()
        if piece is None:
            return
        series = {tr("before"): _shares(piece.before)}
        if self.image.filtered:
            series[tr("after")] = _shares(piece.after)
        self.histogram.show_lines(
            np.arange(256.0), series, tr("grey value"), tr("share of the pixels seen"), "", "%"
        )


def _shares(image: Array) -> Array:
    from graphos_core.preprocessing.grey import luma

    counts = np.bincount(np.ascontiguousarray(luma(image)).ravel(), minlength=256)
    return 100.0 * counts / max(1, counts.sum())
