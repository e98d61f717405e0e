"""The exterior orientation of every photo with its standard deviations."""

from __future__ import annotations

from graphos_py.adjustment.tables import photo_columns
from graphos_py.result_page import ResultPage
from graphos_py.translation import tr
from graphos_py.views.table_view import TableView


class PhotosPage(ResultPage):
    """One row per photo."""

    label = "Photos"

    def __init__(self) -> None:
        super().__init__()
        self.table = TableView()
        self.table.set_empty_text(
            tr("Position and attitude of every photo"),
            tr("Run this step; standard deviations stand beside the values."),
        )
        self.table.row_selected.connect(self.photo_wanted)
        self.column.addWidget(self.table)

    def fill(self) -> None:
        """Fill the table."""
        self.table.set_table([] if self.result is None else photo_columns(self.result.adjustment))

    def show_photo(self, index: int) -> None:
        """Select the row of a photo."""
        if self.result is not None and index < len(self.result.adjustment.block.names):
            self.table.select_rows([index])
