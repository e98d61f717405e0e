"""Plots that only the adjustment shows: distortion profiles with their bands, and quantiles against the normal ones."""

from __future__ import annotations

import numpy as np
import pyqtgraph as pg

from graphos_core.cameras.profile import Profile
from graphos_core.data.record import Array
from graphos_core.report.residual_figures import normal_correlation, normal_quantiles
from graphos_py.translation import tr
from graphos_py.views.plot_view import PlotView

MOST_QUANTILES = 4000
"""Points of a quantile plot at most: all of the tails, the middle thinned."""


class ProfilePlot(PlotView):
    """Displacement over the radius, each curve with its confidence band."""

    def show_profiles(self, profiles: dict[str, Profile], title: str = "") -> None:
        """Show curves by name; the band is that of 95 %."""
        self._show(lambda: self._draw_profiles(profiles), title)

    def _draw_profiles(self, profiles: dict[str, Profile]) -> None:
        header, columns = [], []
        for number, (name, profile) in enumerate(profiles.items()):
            x, y = profile.radius_px, profile.displacement_px
            if profile.sigma_px is not None:
                low, high = profile.band()
                edges = [pg.PlotDataItem(x, edge, pen=self._pen(number, 0.8)) for edge in (low, high)]
                fill = self._colour(number)
                fill.setAlpha(60)
                self.plot.addItem(pg.FillBetweenItem(*edges, brush=fill))
                for edge in edges:
                    self.plot.addItem(edge)
            self.plot.plot(x, y, pen=self._pen(number, 2.5), name=name)
            header += [f"{name} [px]", f"σ {name} [px]"]
            columns += [y, np.full(len(x), np.nan) if profile.sigma_px is None else profile.sigma_px]
        first = next(iter(profiles.values()))
        upper = float(np.nanmean(first.displacement_px)) > 0  # the legend goes where the curves are not
        legend = self.plot.getPlotItem().legend
        legend.anchor(
            (0, 0) if upper else (0, 1), (0, 0) if upper else (0, 1), (70, 12) if upper else (70, -50)
        )
        self._axes(tr("ideal radius"), "px", tr("radial displacement, measured − ideal"), "px")
        self._keep([f"{tr('ideal radius')} [px]", *header], [first.radius_px, *columns])


class QuantilePlot(PlotView):
    """Ordered standardised residuals over the quantiles of the normal distribution (Q–Q plot)."""

    def show_quantiles(self, values: Array, label: str) -> None:
        """Show values; they lie on the straight line when they are normal with standard deviation 1."""
        values = np.sort(np.asarray(values, np.float64))
        values = values[np.isfinite(values)]
        if len(values) < 3:
            self.clear()
            return
        expected = normal_quantiles(len(values))
        chosen = spread_out(len(values))
        title = tr("Correlation with the normal distribution {r}", r=f"{normal_correlation(values):.4f}")
        self._show(lambda: self._draw_quantiles(expected[chosen], values[chosen], label), title)

    def _draw_quantiles(self, expected: Array, values: Array, label: str) -> None:
        ends = np.array([expected[0], expected[-1]])
        self.plot.plot(ends, ends, pen=self._pen(1, 2), name=tr("normal, σ = 1"))
        colour = self._colour(0)
        self.plot.addItem(pg.ScatterPlotItem(expected, values, size=4, brush=colour, pen=None))
        self._axes(tr("normal quantile"), "", label, "")
        self._keep([tr("normal quantile"), label], [expected, values])


def spread_out(count: int) -> Array:
    """Return indices of at most `MOST_QUANTILES` of `count` ordered values: both tails whole, the middle thinned."""
    if count <= MOST_QUANTILES:
        return np.arange(count)
    tail = MOST_QUANTILES // 4
    middle = np.linspace(tail, count - tail - 1, MOST_QUANTILES - 2 * tail).astype(int)
    return np.unique(np.concatenate([np.arange(tail), middle, np.arange(count - tail, count)]))
