"""Quality control: figures with advice, distances from the reference, and the cloud coloured by them, to be measured."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSplitter, QVBoxLayout, QWidget

from graphos_core.roles import ComparisonResult
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.translation import tr
from graphos_py.views.block_cameras import show_cameras

LABELS = {
    "count": "number",
    "mean": "mean",
    "std": "standard deviation",
    "rmse": "RMSE",
    "median": "median",
    "nmad": "NMAD",
    "q68": "68.3 %",
    "q95": "95 %",
}
"""What people call the statistics."""


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
        self.figures = TableView()
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.advice)
        column.addWidget(self.figures, 1)
        self.histogram = PlotView()
        self.definition = QLabel()
        self.definition.setWordWrap(True)
        self.definition.setMargin(12)
        self.distances = QWidget()
        self.definition.setAlignment(Qt.AlignmentFlag.AlignTop)
        row = QHBoxLayout(self.distances)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.definition, 1)
        row.addWidget(self.histogram, 3)
        self.cloud = CloudView()
        self.cloud.show_cameras(False)
        both = QSplitter(Qt.Orientation.Vertical)
        both.setChildrenCollapsible(False)
        both.addWidget(self.cloud)
        both.addWidget(self.distances)
        both.setSizes([620, 380])
        self.add_view(page, "Figures and advice")
        self.add_view(both, "Distances and measuring")

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
            rows = _distance_rows(comparison) + rows
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
        self.distances.setVisible(comparison is not None)
        if comparison is not None:
            factor, unit = _readable_unit(comparison)
            distances = np.asarray(comparison.distances)
            reach = 1.5 * float(comparison.statistics.get("q95", np.nanmax(np.abs(distances)))) or 1.0
            self.histogram.show_histogram(
                factor * distances[np.abs(distances) <= reach], tr("distance"), unit
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
            factor, unit = _readable_unit(comparison)
            reach = factor * float(comparison.statistics.get("q95", 0.0)) or 1.0
            values = factor * np.asarray(comparison.distances)
            self.cloud.set_values(values, -reach, reach, tr("distance"), unit, "diverging")


def _readable_unit(comparison: ComparisonResult) -> tuple[float, str]:
    """Return the factor and unit in which the distances are easy to read: millimetres where they are small."""
    small = float(comparison.statistics.get("q95", 1.0)) < 0.1
    return (1000.0, "mm") if comparison.unit == "m" and small else (1.0, tr(comparison.unit))


def _distance_rows(comparison: ComparisonResult) -> list[tuple[str, Any, str, str]]:
    """Return label, value, unit and definition of the statistics of the distances from the reference."""
    from graphos_core.quality.statistics import DEFINITIONS

    factor, unit = _readable_unit(comparison)
    rows: list[tuple[str, Any, str, str]] = []
    for name, value in comparison.statistics.items():
        label = tr("Distance from the reference: {name}", name=tr(LABELS.get(name, name)))
        shown = int(value) if name == "count" else factor * value
        rows.append((label, shown, "" if name == "count" else unit, tr(DEFINITIONS.get(name, ""))))
    return rows


def _figure(name: str, figure: Any) -> tuple[str, Any, str, str]:
    """Return label, value, unit and definition (or why there is no value) of an internal figure."""
    if not isinstance(figure, dict):
        return tr(name), figure, "", ""
    value = figure.get("value")
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    why = figure.get("reason") or figure.get("definition", "")
    return tr(figure.get("label", name)), value, tr(figure.get("unit", "")), tr(why)
