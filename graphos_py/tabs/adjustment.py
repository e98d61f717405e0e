"""Bundle adjustment: the block in space, what was found out, control, calibration, residuals, iterations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from graphos_core.data import Array, Block, IterationRecord
from graphos_core.params import Level
from graphos_py.tabs.stage_tab import StageTab

if TYPE_CHECKING:
    from graphos_py.result_page import ResultPage


class AdjustmentTab(StageTab):
    """What the orientation found and how well it is determined: one page per question, see `graphos_py.adjustment`."""

    stage = "adjustment"
    empty = (
        "Where the photos were taken, and how well that is known",
        "Here you will see cameras and object points in space, calibration and orientation with standard "
        "deviations, and residuals. Run computes them.",
    )

    def make_views(self) -> None:
        """Make all pages; each fills itself when it is seen."""
        from graphos_py.adjustment.calibration_page import CalibrationPage
        from graphos_py.adjustment.comparison_page import ComparisonPage
        from graphos_py.adjustment.findings_page import FindingsPage
        from graphos_py.adjustment.iterations_page import IterationsPage
        from graphos_py.adjustment.photos_page import PhotosPage
        from graphos_py.adjustment.reliability_page import ReliabilityPage
        from graphos_py.adjustment.residuals_page import ResidualsPage
        from graphos_py.adjustment.space_page import SpacePage
        from graphos_py.control.page import ControlPage

        self.space = SpacePage(self.panel.level)
        self.cloud = self.space.cloud
        self.space.photo_clicked.connect(self.session.select_photo)
        self.space.distance_wanted.connect(self._take_distance)
        self.control = ControlPage(self.session, self.panel.level)
        self.findings = FindingsPage()
        self.findings.item_wanted.connect(self._show_item)
        self.calibration = CalibrationPage(self.session)
        self.photos = PhotosPage()
        self.residuals = ResidualsPage(self.session)
        self.reliability = ReliabilityPage(self.session)
        self.iterations = IterationsPage()
        self.comparison = ComparisonPage(self.session)
        self.pages: list[ResultPage] = [
            self.findings, self.calibration, self.photos, self.residuals, self.reliability, self.iterations,
            self.comparison,
        ]  # fmt: skip
        self.add_view(self.space, "3D")
        self.add_view(self.control, "Control")
        for page in self.pages:
            page.photo_wanted.connect(self.session.select_photo)
            page.lesson.connect(self.lesson)
            self.add_view(page, page.label)
        self.set_level(self.panel.level)

    # ---------------------------------------------------------------------------------------------- results

    @property
    def keeps_views(self) -> bool:
        """Control points can be measured before there is a result."""
        return self.session.project is not None

    def show_result(self, result: Any) -> None:
        """Hand the result to all pages."""
        self.control.show_result(result)
        self.space.show_result(result, self._given(result))
        for page in self.pages:
            page.show_result(result)
        self.show_photo(self.session.photo)

    def refresh(self) -> None:
        """Bring the pages up to date; without a result they say what will be there."""
        super().refresh()
        if self._made and not self._stale and self.result is None and self.session.running != self.stage:
            self.control.show_result(None)
            self.space.clear()
            for page in self.pages:
                page.show_result(None)

    def show_partial(self, key: str, values: list[Any]) -> None:
        """Let the block grow and the cost fall while it runs."""
        if key == "block" and isinstance(values[-1], Block):
            self.need_views()
            self.space.show_block(values[-1])
            self.space.select_photo(self.session.photo)
        elif key == "iteration":
            self.need_views()
            self.iterations.add_records([record for record in values if isinstance(record, IterationRecord)])

    def show_photo(self, index: int) -> None:
        """Show another photo on every page."""
        self.control.show_photo(index)
        self.space.select_photo(index)
        for page in self.pages:
            page.show_photo(index)

    def set_level(self, level: Level) -> None:
        """Show the pages and columns of a level."""
        super().set_level(level)
        if not self._made:
            return
        self.control.set_level(level)
        self.space.set_level(level)
        for page in self.pages:
            page.set_level(level)
            self.views.setTabVisible(self.views.indexOf(page), page.seen_by(level))

    def closing(self) -> None:
        """Write an edit of the control points that waits."""
        if self._made:
            self.control.desk.flush()

    # --------------------------------------------------------------------------------------------- reacting

    def _given(self, result: Any) -> dict[str, Array]:
        """Return the given coordinates of control and check points in the frame of the block."""
        from graphos_core.adjustment.measuring.sights import known_place

        sheet, block = self.control.desk.sheet, result.adjustment.block
        places = {
            point.name: known_place(sheet, point.name, block, result.georeference) for point in sheet.points
        }
        return {name: place for name, place in places.items() if place is not None}

    def _take_distance(self, a: int, b: int) -> None:
        self.views.setCurrentWidget(self.control)
        self.control.take_distance((a, b))

    def _show_item(self, name: str) -> None:
        """Show the observation, photo or control point that a finding names."""
        names = list(self.result.adjustment.block.names) if self.result is not None else []
        photo = next((i for i, candidate in enumerate(names) if name.endswith(candidate)), -1)
        point = next((p.name for p in self.control.desk.sheet.points if p.name in (name, *name.split())), "")
        if photo >= 0:
            self.session.select_photo(photo)
        if point:
            self.views.setCurrentWidget(self.control)
            self.control.desk.choose(point)
        elif photo >= 0 and self.reliability.seen_by(self.panel.level):
            self.views.setCurrentWidget(self.reliability)
            self.reliability.show_observation(name)
        elif photo >= 0:
            self.views.setCurrentWidget(
                self.residuals if self.residuals.seen_by(self.panel.level) else self.photos
            )
