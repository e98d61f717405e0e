"""Features: one page per question, from keypoints and descriptors over matches to how the photos hang together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from graphos_core.data import PairMatches, Photo
from graphos_core.params import Level
from graphos_py.tabs.stage_tab import StageTab

if TYPE_CHECKING:
    from graphos_py.result_page import ResultPage


class FeaturesTab(StageTab):
    """What was found in the photos and how it was matched, see `graphos_py.features`."""

    stage = "features"
    empty = (
        "Points that several photos see",
        "Here you will see the keypoints of each photo, the matches that survive the epipolar check, and which "
        "photos hang together. Run finds them.",
    )

    def make_views(self) -> None:
        """Make all pages; each fills itself when it is seen."""
        from graphos_py.features.compare_page import ComparePage
        from graphos_py.features.coverage_page import CoveragePage
        from graphos_py.features.descriptor_page import DescriptorPage
        from graphos_py.features.graph_page import GraphPage
        from graphos_py.features.keypoints_page import KeypointsPage
        from graphos_py.features.matching_page import MatchingPage
        from graphos_py.features.numbers_page import NumbersPage

        self._live: list[PairMatches] | None = None
        self.keypoints = KeypointsPage(self.session)
        self.descriptor = DescriptorPage(self.session)
        self.matching = MatchingPage(self.session)
        self.coverage = CoveragePage(self.session)
        self.graph = GraphPage(self.session)
        self.numbers = NumbersPage(self.session)
        self.comparing = ComparePage(self.session)
        self.keypoints.keypoint_chosen.connect(self.descriptor.choose)
        self.keypoints.descriptor_wanted.connect(self._show_descriptor)
        self.descriptor.keypoint_chosen.connect(self.keypoints.choose)
        self.matching.descriptors_wanted.connect(self._compare_descriptors)
        self.graph.pair_chosen.connect(self._show_pair)
        self.pages: list[ResultPage] = [
            self.keypoints, self.descriptor, self.matching, self.coverage, self.graph, self.numbers,
            self.comparing,
        ]  # fmt: skip
        for page in self.pages:
            page.photo_wanted.connect(self.session.select_photo)
            page.lesson.connect(self.lesson)
            self.add_view(page, page.label)
        self.set_level(self.panel.level)

    # ---------------------------------------------------------------------------------------------- results

    def show_result(self, result: Any) -> None:
        """Hand the result to all pages, unless it belongs to another set of photos."""
        self._live = None
        if len(self._photos()) != len(result.features):
            self.stack.setCurrentWidget(self.empty_state)
            return
        for page in self.pages:
            page.show_result(result)

    def show_partial(self, key: str, values: list[Any]) -> None:
        """Show keypoints and pairs as they are found."""
        photos = self._photos()
        self.need_views()
        if key == "features":
            index, features = values[-1]
            if index < len(photos):
                self.views.setCurrentWidget(self.keypoints)
                self.keypoints.show_found(index, features)
        elif key == "pair":
            if self._live is None:
                self.views.setCurrentWidget(self.matching)
            self._live = [*(self._live or []), *values]
            self.matching.show_live(self._live)
            self.graph.show_live(self._live, [photo.name for photo in photos])

    def show_photo(self, index: int) -> None:
        """Show another photo on every page."""
        if self.result is not None:
            for page in self.pages:
                page.show_photo(index)

    def set_level(self, level: Level) -> None:
        """Show the pages of a level."""
        super().set_level(level)
        if self._made:
            for page in self.pages:
                page.set_level(level)
                self.views.setTabVisible(self.views.indexOf(page), page.seen_by(level))

    # --------------------------------------------------------------------------------------------- reacting

    def _show_pair(self, index: int) -> None:
        self.views.setCurrentWidget(self.matching)
        self.matching.show_pair(index)

    def _show_descriptor(self, keypoint: int) -> None:
        self.views.setCurrentWidget(self.descriptor)
        self.descriptor.choose(keypoint)

    def _compare_descriptors(self, photo: int, keypoint: int, other: int) -> None:
        self.session.select_photo(photo)
        self.views.setCurrentWidget(self.descriptor)
        self.descriptor.compare(keypoint, other)

    def _photos(self) -> tuple[Photo, ...]:
        return self.session.project.photo_set.photos if self.session.project is not None else ()
