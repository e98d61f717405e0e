"""How matched points and the area of the format are shared out over radial zones."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg

from graphos_core.features.coverage import Coverage
from graphos_py.translation import tr
from graphos_py.views.plot_view import PlotView


class RadialPlot(PlotView):
    """Two bars per zone: what share of the points it holds, and what share of the area it is."""

    def show_zones(self, found: Coverage) -> None:
        """Show the zones of a coverage."""
        self._show(lambda: self._draw_zones(found), "")

    def _draw_zones(self, found: Coverage) -> None:
        edges = np.asarray(found.radii, np.float64)
        middle, width = 0.5 * (edges[1:] + edges[:-1]), float(edges[1] - edges[0])
        series = ((found.radial_share, tr("points")), (found.radial_area, tr("area of the format")))
        for number, (share, name) in enumerate(series):
            x = middle + (number - 0.5) * 0.4 * width
            bars = pg.BarGraphItem(
                x=x, height=100 * share, width=0.36 * width, brush=self._colour(number), pen=None
            )
            self.plot.addItem(bars)
            self.plot.plot([], [], pen=self._pen(number, 6), name=name)
        self._axes(tr("distance from the centre of the format"), "px", tr("share"), "%")
        highest = 100 * float(max(found.radial_share.max(initial=0), found.radial_area.max(initial=0)))
        self.plot.setYRange(0.0, 1.9 * max(highest, 1.0), padding=0.0)
        self._keep(
            ["radius from [px]", "radius to [px]", "share of points [%]", "share of area [%]"],
            [edges[:-1], edges[1:], 100 * found.radial_share, 100 * found.radial_area],
        )
