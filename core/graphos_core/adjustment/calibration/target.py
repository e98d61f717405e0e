"""The test field: what is printed on it, and where its points are."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from graphos_core.data.record import Array
from graphos_core.params import About, Params

Kind = Literal["chessboard", "circles", "aruco"]
Layout = Literal["symmetric", "asymmetric", "hexagonal"]
ROW_OVER_PITCH = float(np.sqrt(3.0) / 2.0)
"""Distance of rows over the distance of neighbours in a hexagonal grid."""


class TargetParams(Params):
    """A flat test field with a regular pattern."""

    target: Annotated[Kind, About(
        label="Target", help="What is printed on the board.",
        effect="ArUco: a chessboard with coded markers in its white squares (ChArUco); it may be seen in part.",
        choices={"chessboard": "Chessboard", "circles": "Grid of circles", "aruco": "ArUco markers"},
        level="novice", group="Target", learn="adjustment/calibrate",
    )] = "chessboard"  # fmt: skip
    columns: Annotated[int, About(
        label="Columns", symbol="n", low=2, high=200, step=1,
        help="Inner corners along a row, which is one less than the squares; circles, or markers of a grid, along a row.",
        effect="Higher: more points per photo.", level="novice", group="Target",
    )] = 9  # fmt: skip
    rows: Annotated[int, About(
        label="Rows", symbol="m", low=2, high=200, step=1,
        help="Inner corners along a column, which is one less than the squares; rows of circles or markers.",
        effect="Higher: more points per photo.", level="novice", group="Target",
    )] = 6  # fmt: skip
    square_mm: Annotated[float, About(
        label="Side of a square", symbol="s", unit="mm", low=0, low_open=True, high=10000, step=1,
        help="Side of a square; of circles the distance of neighbours (asymmetric: the distance of rows); "
        "of a grid of markers the distance from marker to marker.",
        effect="It scales distances to the board and nothing else: the calibration does not depend on it.",
        level="novice", group="Target",
    )] = 25.0  # fmt: skip
    layout: Annotated[Layout, About(
        label="Layout of the circles",
        help="Symmetric: rows and columns. Asymmetric: every second row is shifted by half the distance in a row, rows "
        "are half that distance apart. Hexagonal: every circle has six neighbours at the same distance.",
        choices={"symmetric": "Symmetric", "asymmetric": "Asymmetric", "hexagonal": "Hexagonal"},
        group="Circles",
    )] = "symmetric"  # fmt: skip
    circle_mm: Annotated[float | None, About(
        label="Diameter of a circle", symbol="d", unit="mm", low=0, low_open=True, high=10000, step=1,
        help="Used to correct that the centre of an ellipse is not the image of the circle's centre; "
        "empty: taken from the photos.",
        level="expert", group="Circles",
    )] = None  # fmt: skip
    markers_only: Annotated[bool, About(
        label="Markers without chessboard",
        help="The board is a grid of markers; their centres are the points.", group="ArUco",
    )] = False  # fmt: skip
    dictionary: Annotated[str, About(
        label="Dictionary", group="ArUco",
        help="Name of the dictionary of markers, such as DICT_5X5_100 or DICT_APRILTAG_36h11; empty: the one that "
        "fits the photos best.",
    )] = ""  # fmt: skip
    marker_mm: Annotated[float | None, About(
        label="Side of a marker", unit="mm", low=0, low_open=True, high=10000, step=1,
        help="Side of the black square of a marker; empty: taken from the photos.", group="ArUco",
    )] = None  # fmt: skip

    @property
    def shape(self) -> tuple[int, int]:
        """Columns and rows."""
        return self.columns, self.rows

    @property
    def symmetric_twice(self) -> bool:
        """Whether the board looks the same turned by 180°, so that one point cannot be told from its opposite."""
        if self.target == "aruco":
            return False
        if self.target == "chessboard":
            return (self.columns + self.rows) % 2 == 0
        return self.layout == "symmetric" or self.rows % 2 == 0

    def points(self, mirrored: bool = False) -> Array:
        """Return the points of the board, m: x along rows, y down the columns, z = 0, row by row; float64 (n, 3).

        Of a grid of markers their centres. Mirrored, the first row of shifted circles is shifted and not the second.
        """
        row, column = (a.ravel() for a in np.mgrid[: self.rows, : self.columns].astype(np.float64))
        shifted = (row + mirrored) % 2
        if self.target == "circles" and self.layout == "asymmetric":
            xy = np.column_stack([2.0 * column + shifted, row])
        elif self.target == "circles" and self.layout == "hexagonal":
            xy = np.column_stack([column + 0.5 * shifted, ROW_OVER_PITCH * row])
        else:
            xy = np.column_stack([column, row])
        xy = xy * self.square_mm
        return np.column_stack([xy, np.zeros(len(xy))]) * 1e-3
