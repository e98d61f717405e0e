"""Table, plot and depth views: true values behind the texts."""

from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFont, QPalette
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from graphos_core.number_format import THIN_SPACE
from graphos_core.rendering import colour_table
from graphos_py.views.depth_view import DepthView
from graphos_py.views.plot_view import PlotView
from graphos_py.views.table_view import Column, TableView


@pytest.fixture
def table(qtbot: QtBot) -> TableView:
    made = TableView()
    qtbot.addWidget(made)
    made.set_table([
        Column("Photo", ["DSC_10", "DSC_9", "=1+1", "DSC_1"]),
        Column("f", [1000.5, 999.25, float("nan"), -3.0], "px", [0.12, 0.5, 0.1, 0.2]),
        Column("Points", [5, 18708, 20, 100]),
    ])  # fmt: skip
    return made


def texts(table: TableView, column: int) -> list[str]:
    model = table.model
    return [
        str(model.data(model.index(row, column))).replace(THIN_SPACE, " ") for row in range(model.rowCount())
    ]


def test_cells_show_value_and_sigma_and_headers_units(table: TableView) -> None:
    assert texts(table, 1) == ["1 000.50 ± 0.12", "999.25 ± 0.50", "–", "−3.00 ± 0.20"]
    assert table.model.headerData(1, Qt.Orientation.Horizontal) == "f [px]"
    right = int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
    assert table.model.data(table.model.index(0, 1), Qt.ItemDataRole.TextAlignmentRole) == right


def test_sorting_goes_by_value_with_missing_ones_last(table: TableView) -> None:
    table.model.sort(1)
    assert table.model.order == [3, 1, 0, 2]
    table.model.sort(1, Qt.SortOrder.DescendingOrder)
    assert table.model.order == [0, 1, 3, 2]
    table.model.sort(0)
    assert texts(table, 0) == ["=1+1", "DSC_1", "DSC_9", "DSC_10"]


def test_selection_names_rows_as_given_whatever_the_sorting(table: TableView, qtbot: QtBot) -> None:
    table.model.sort(2, Qt.SortOrder.DescendingOrder)
    with qtbot.waitSignal(table.row_selected) as caught:
        table.table.selectRow(0)
    assert caught.args == [1]
    with qtbot.assertNotEmitted(table.row_selected):
        table.select_rows([0, 3])
    assert table.selected_rows() == [0, 3]
    table.model.sort(1)
    assert table.selected_rows() == [0, 3]


def test_csv_has_full_precision_units_sigmas_and_no_formulas(table: TableView, tmp_path: Path) -> None:
    lines = table.csv().splitlines()
    assert lines[0] == "Photo,f [px],σ f [px],Points"
    assert lines[1] == "DSC_10,1000.5,0.12,5"
    assert lines[3] == "'=1+1,,0.1,20"
    table.select_rows([3])
    table.copy()
    assert QApplication.clipboard().text().splitlines()[1:] == ["DSC_1,-3,0.2,100"]
    table.exports()["csv"](tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text("utf-8") == table.csv()


def test_columns_of_different_length_are_refused(table: TableView) -> None:
    with pytest.raises(ValueError, match="length"):
        table.set_table([Column("a", [1]), Column("b", [1, 2])])


@pytest.fixture
def plot(qtbot: QtBot) -> PlotView:
    made = PlotView()
    qtbot.addWidget(made)
    made.resize(500, 350)
    return made


def test_the_plotting_library_is_imported_off_the_windows_thread(plot: PlotView, qtbot: QtBot) -> None:
    with qtbot.waitSignal(plot.drawn, timeout=60_000):
        plot.show_scatter(np.arange(5), np.arange(5), "x", "y", "px", "px")
        plot.show_scatter(np.arange(6), np.arange(6), "x", "y", "px", "px")
    assert len(plot.rows()) == 6


def test_a_histogram_counts_every_value_within_its_edges_and_exports_them(
    plot: PlotView, tmp_path: Path
) -> None:
    values = np.random.default_rng(0).normal(0, 0.4, 5000)
    plot.show_histogram(np.r_[values, np.nan], "residual", "px", bins=20)
    plot.draw_now()
    rows = plot.rows()
    assert sum(row[2] for row in rows) == 5000
    assert rows[0][0] == pytest.approx(values.min())
    for ending, write in plot.exports().items():
        write(tmp_path / f"p.{ending}")
    assert (tmp_path / "p.csv").read_text("utf-8").splitlines()[
        0
    ] == "residual from [px],residual to [px],count"
    assert (tmp_path / "p.png").stat().st_size > 1000
    assert "<svg" in (tmp_path / "p.svg").read_text("utf-8")


def test_lines_bars_and_an_empty_histogram_are_drawn(plot: PlotView) -> None:
    plot.show_lines(
        np.arange(4), {"cost": np.array([1e5, 1e3, 0.0, 10])}, "iteration", "cost", y_unit="px²", log_y=True
    )
    plot.draw_now()
    assert plot.rows()[0] == (0.0, 1e5)
    plot.show_bars(["a", "b"], np.array([1.0, 2.0]), "RMS", "px", np.array([0.1, 0.1]))
    plot.draw_now()
    assert plot.rows() == [("a", 1.0), ("b", 2.0)]
    plot.grab()
    plot.show_histogram(np.full(5, np.nan), "x")
    plot.grab()
    assert plot.rows() == []


@pytest.fixture
def depth(qtbot: QtBot) -> DepthView:
    made = DepthView()
    qtbot.addWidget(made)
    made.resize(400, 300)
    return made


def test_depths_run_through_viridis_and_unknown_ones_are_grey(depth: DepthView) -> None:
    values = np.linspace(2.0, 4.0, 40, dtype=np.float32).reshape(5, 8).copy()
    values[2, 3] = np.nan
    depth.set_depth(values, "m", limits=(2.0, 4.0))
    picture = depth.picture()
    assert picture is not None
    assert tuple(picture[0, 0]) == tuple(colour_table()[0])
    assert tuple(picture[-1, -1]) == tuple(colour_table()[255])
    assert len(set(picture[2, 3].tolist())) == 1
    assert "2.000\u2009m" in depth.readout(0.2, -0.2)
    assert "unknown" in depth.readout(3, 2)
    assert depth.readout(8, 2) == ""
    depth.grab()


def test_signed_figures_have_zero_in_the_middle(depth: DepthView) -> None:
    depth.set_depth(np.random.default_rng(0).normal(1.0, 0.3, (40, 50)), "m", "Distance", signed=True)
    assert depth.range[0] == -depth.range[1]
    assert depth.table == "diverging"
    depth.set_depth(None)
    depth.grab()


def test_a_plot_survives_a_change_of_theme_and_its_axis_keeps_its_unit(plot: PlotView, qtbot: QtBot) -> None:
    plot.show()
    plot.show_histogram(np.random.default_rng(0).normal(0, 0.3, 500), "residual", "px")
    plot.draw_now()
    app = QApplication.instance()
    assert isinstance(app, QApplication)
    old_palette, old_font = app.palette(), app.font()
    dark, large = QPalette(QColor("#202020")), QFont(old_font)
    large.setPointSizeF(old_font.pointSizeF() * 1.5)
    with qtbot.waitSignal(plot.drawn, timeout=5000):
        app.setFont(large)
        app.setPalette(dark)
        app.setStyleSheet("QWidget { padding: 1px; }")
    try:
        assert plot.plot.getAxis("bottom").autoSIPrefixScale == 1.0
        assert plot.plot.backgroundBrush().color() == plot.palette().color(QPalette.ColorRole.Base)
    finally:
        app.setStyleSheet("")
        app.setFont(old_font)
        app.setPalette(old_palette)


def test_axis_values_below_one_are_true_in_every_plot_not_only_in_the_first(qtbot: QtBot) -> None:
    view = PlotView()
    qtbot.addWidget(view)
    view.resize(500, 400)
    view.show()
    for _ in range(3):
        view.show_lines(np.array([0.0, 0.2, 0.4]), {"a": np.array([0.1, 0.3, 0.2])}, "x", "y", "px", "px")
        view.draw_now()
        qtbot.wait(30)
        for side in ("bottom", "left"):
            axis = view.plot.getAxis(side)
            values = [0.1, 0.2, 0.3]
            assert axis.tickStrings(values, axis.autoSIPrefixScale * axis.scale, 0.1) == ["0.1", "0.2", "0.3"]


def test_a_column_with_fixed_decimals_can_be_compared_at_a_glance() -> None:
    column = Column("dX", [-0.26134, 12345.678, 0.0], "mm", decimals=2)
    shown = [column.text(row).replace(THIN_SPACE, " ") for row in range(3)]
    assert shown == ["−0.26", "12 345.68", "0.00"]
