"""Quality control: figures with advice, distances from the reference, and the cloud coloured by them, to be measured."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QScrollArea, QVBoxLayout, QWidget

from graphos_core.roles import ComparisonResult
from graphos_py.tabs.adjustment import show_cameras
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.translation import tr


class QualityTab(StageTab):
    """How good the model is, and what would help."""

    stage = "quality"
    empty = (
        "How good the model is",
        "Here you will see figures with advice, distances from a reference surface if there is one, and you can "
        "measure coordinates, distances and angles in the cloud.",
    )

    def make_views(self) -> None:
        """Figures with advice, histogram, cloud."""
        from graphos_py.views.cloud_view import CloudView
        from graphos_py.views.plot_view import PlotView
        from graphos_py.views.table_view import TableView

        self.advice = QLabel()
        self.advice.setTextFormat(Qt.TextFormat.RichText)
        self.advice.setWordWrap(True)
        self.advice.setMargin(12)
        self.advice.setAlignment(Qt.AlignmentFlag.AlignTop)
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setWidget(self.advice)
        self.figures = TableView()
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(scroll, 1)
        column.addWidget(self.figures, 3)
        self.histogram = PlotView()
        self.definition = QLabel()
        self.definition.setWordWrap(True)
        self.definition.setMargin(12)
        self.distances = QWidget()
        column = QVBoxLayout(self.distances)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.definition)
        column.addWidget(self.histogram, 1)
        self.cloud = CloudView()
        self.add_view(page, "Figures and advice")
        self.add_view(self.distances, "Distances")
        self.add_view(self.cloud, "Measure in the cloud")

    def show_result(self, result: Any) -> None:
        """Fill the pages."""
        from graphos_py.views.table_view import Column

        items = "".join(f"<li style='margin-bottom:6px'>{escape(tr(text))}</li>" for text in result.advice)
        heading = f"<h3>{escape(tr('What this means'))}</h3>"
        nothing = f"<p>{escape(tr('Nothing stands out.'))}</p>"
        self.advice.setText(heading + (f"<ul>{items}</ul>" if items else nothing))
        rows = [_figure(name, value) for name, value in result.figures.items()]
        comparison: ComparisonResult | None = result.comparison
        if comparison is not None:
            unit = tr(comparison.unit)
            rows += [
                (tr("Distance: {name}", name=tr(name)), value, "" if name == "count" else unit, "")
                for name, value in comparison.statistics.items()
            ]
        self.figures.set_table(
            [
                Column(tr("figure"), [row[0] for row in rows]),
                Column(tr("value"), [row[1] for row in rows]),
                Column(tr("unit"), [row[2] for row in rows]),
                Column(tr("what it is"), [row[3] for row in rows]),
            ]
        )
        self._show_distances(comparison)
        self._show_cloud(comparison)

    def _show_distances(self, comparison: ComparisonResult | None) -> None:
        self.views.setTabVisible(self.views.indexOf(self.distances), comparison is not None)
        if comparison is not None:
            distances = np.asarray(comparison.distances)
            reach = 1.5 * float(comparison.statistics.get("q95", np.nanmax(np.abs(distances)))) or 1.0
            self.histogram.show_histogram(
                distances[np.abs(distances) <= reach],
                tr("distance"),
                comparison.unit,
            )
            self.definition.setText(tr(comparison.definition))

    def _show_cloud(self, comparison: ComparisonResult | None) -> None:
        dense = self.session.results.get("dense")
        if dense is None:
            return
        cloud = dense.cloud
        self.cloud.set_cloud(cloud.points, cloud.colours, None, None, cloud.unit)
        oriented = self.session.results.get("adjustment")
        if oriented is not None and oriented.adjustment.block.unit == cloud.unit:
            show_cameras(self.cloud, oriented.adjustment.block)
        if comparison is not None and len(comparison.distances) == len(cloud.points):
            reach = float(comparison.statistics.get("q95", 0.0)) or 1.0
            self.cloud.set_values(
                comparison.distances, -reach, reach, tr("distance"), comparison.unit, "diverging"
            )


def _figure(name: str, figure: Any) -> tuple[str, Any, str, str]:
    """Return label, value, unit and definition (or why there is no value) of an internal figure."""
    if not isinstance(figure, dict):
        return tr(name), figure, "", ""
    value = figure.get("value")
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    why = figure.get("reason") or figure.get("definition", "")
    return tr(figure.get("label", name)), value, tr(figure.get("unit", "")), tr(why)
