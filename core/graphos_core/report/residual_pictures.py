"""Pictures of distributions: residuals, quantiles against the normal distribution, reliability, distances."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Adjustment, Array
from graphos_core.number_format import format_number
from graphos_core.report.page import Picture
from graphos_core.report.plot import BLUE, INK, ORANGE, Axis, Plot
from graphos_core.report.residual_figures import normal_quantiles, standardised
from graphos_core.report.values import nmad
from graphos_core.text import Text

BINS = 80
MOST_DOTS = 400
"""So many points of a Q–Q plot are drawn: evenly spread, and all at the ends."""


def residual_histogram(residuals: Array) -> Picture:
    """Histogram of all image residuals with the normal curve of the same NMAD."""
    return histogram(residuals.ravel(), Text("image residual per coordinate"), "px")


def distance_histogram(distances: Array, unit: str) -> Picture:
    """Histogram of signed distances from a reference."""
    return histogram(distances, Text("signed distance from the reference"), unit)


def histogram(values: Array, label: str, unit: str) -> Picture:
    """Histogram over ±5 NMAD round the median with the normal curve of that NMAD; the rest is counted in the caption."""
    values = np.asarray(values, dtype=np.float64).ravel()
    values = values[np.isfinite(values)]
    if not len(values):
        return Picture(Text("No values"), caption=Text("There are no values to draw."))
    centre = float(np.median(values))
    width = nmad(values) or float(values.std()) or 1.0
    edges = np.linspace(centre - 5 * width, centre + 5 * width, BINS + 1)
    counts, _ = np.histogram(values, edges)
    middle = np.linspace(edges[0], edges[-1], 241)
    normal = normal_density((middle - centre) / width) / width * len(values) * (edges[1] - edges[0])
    top = 1.08 * max(float(counts.max()), float(normal.max()))
    alt = Text("Histogram of the {label}", label=label)
    plot = Plot(Axis(edges[0], edges[-1], f"{label} [{unit}]"), Axis(0.0, top, "count"), alt)
    plot.bars(edges, counts, Text("{n} values", n=format_number(len(values))))
    spread = format_number(width, digits=3)
    plot.line(middle, normal, Text("normal, σ = NMAD = {s} {unit}", s=spread, unit=unit))
    outside = int(len(values) - counts.sum())
    caption = (
        Text("{n} values lie outside the picture, beyond 5 NMAD.", n=format_number(outside))
        if outside
        else ""
    )
    return Picture(alt, svg=plot.svg(), caption=caption)


def quantile_plot(adjustment: Adjustment) -> Picture:
    """Q–Q plot of the standardised residuals: on the line they are normal, off it at the ends the tails are heavy."""
    values = np.sort(standardised(adjustment))
    theory = normal_quantiles(len(values))
    kept = _spread_out(len(values))
    reach = 1.05 * float(max(np.abs(theory).max(initial=1.0), np.abs(values).max(initial=1.0)))
    alt = Text("Quantiles of the standardised residuals against those of the normal distribution")
    plot = Plot(Axis(-reach, reach, Text("quantile of the normal distribution")),
                Axis(-reach, reach, Text("standardised residual")), alt, width=430, height=400)  # fmt: skip
    plot.line(np.array([-reach, reach]), np.array([-reach, reach]), Text("normal"), INK, "6 3")
    plot.dots(theory[kept], values[kept], Text("residuals"), BLUE, 2.2)
    return Picture(alt, svg=plot.svg())


def redundancy_histogram(adjustment: Adjustment) -> Picture:
    """Histogram of the redundancy numbers of the image coordinates."""
    assert adjustment.reliability is not None
    r = adjustment.reliability.redundancy.ravel()
    edges = np.linspace(0.0, 1.0, 41)
    counts, _ = np.histogram(np.clip(r, 0.0, 1.0), edges)
    alt = Text("Histogram of the redundancy numbers of the image coordinates")
    plot = Plot(Axis(0.0, 1.0, Text("redundancy number r")), Axis(0.0, 1.08 * counts.max(initial=1), "count"), alt,
                width=430, height=300)  # fmt: skip
    plot.bars(edges, counts, Text("{n} coordinates", n=format_number(len(r))))
    plot.mark_x(float(r.mean()), Text("mean {m}", m=format_number(float(r.mean()), digits=2)))
    return Picture(alt, svg=plot.svg())


def w_histogram(adjustment: Adjustment) -> Picture:
    """Histogram of Baarda's w with the standard normal curve and the limits of the test."""
    found = adjustment.reliability
    assert found is not None
    w = found.standardised.ravel()[found.redundancy.ravel() > 1e-6]
    reach = max(6.0, 1.2 * found.critical)
    edges = np.linspace(-reach, reach, BINS + 1)
    counts, _ = np.histogram(np.clip(w, -reach, reach), edges)
    middle = np.linspace(-reach, reach, 241)
    normal = normal_density(middle) * len(w) * (edges[1] - edges[0])
    alt = Text("Histogram of the standardised residuals w with the limits of the test")
    plot = Plot(Axis(-reach, reach, Text("standardised residual w")),
                Axis(0.0, 1.08 * max(counts.max(initial=1), normal.max(initial=1.0)), "count"), alt, width=430,
                height=300)  # fmt: skip
    plot.bars(edges, counts, "w", BLUE)
    plot.line(middle, normal, Text("standard normal"))
    plot.mark_x(-found.critical, Text("limit ±{c}", c=format_number(found.critical, digits=3)))
    plot.mark_x(found.critical, "")
    return Picture(alt, svg=plot.svg())


def counts_picture(numbers: Array, counts: Array, label: str) -> Picture:
    """Bars of counts by whole number, such as object points by number of rays."""
    alt = Text("Object points by {label}", label=label)
    top = 1.12 * float(np.max(counts, initial=1))
    plot = Plot(Axis(float(numbers.min()) - 0.6, float(numbers.max()) + 0.6, label), Axis(0.0, top, "points"), alt,
                width=430, height=260)  # fmt: skip
    for n, count in zip(numbers, counts, strict=True):
        plot.bars(np.array([n - 0.42, n + 0.42]), np.array([count]))
    return Picture(alt, svg=plot.svg())


def angle_histogram(angles_deg: Array) -> Picture:
    """Histogram of the widest intersection angle of each object point."""
    high = float(np.ceil(max(float(angles_deg.max(initial=1.0)), 1.0)))
    edges = np.linspace(0.0, high, 46)
    counts, _ = np.histogram(angles_deg, edges)
    alt = Text("Histogram of the intersection angles")
    plot = Plot(Axis(0.0, high, Text("widest intersection angle [°]")), Axis(0.0, 1.1 * counts.max(initial=1), "points"),
                alt, width=430, height=260)  # fmt: skip
    plot.bars(edges, counts)
    median = float(np.median(angles_deg)) if len(angles_deg) else 0.0
    plot.mark_x(median, Text("median {m}°", m=format_number(median, digits=3)))
    return Picture(alt, svg=plot.svg())


def convergence_picture(adjustment: Adjustment) -> Picture | None:
    """Cost by iteration above its last value, on a scale of powers of ten; None with fewer than three iterations."""
    records = [i for i in adjustment.iterations if i.accepted]
    if len(records) < 3:
        return None
    costs = np.array([i.cost for i in records], dtype=np.float64)
    above = costs[:-1] / costs[-1] - 1.0
    good = np.isfinite(above) & (above > 0)
    if good.sum() < 2:
        return None
    exponents = np.log10(above[good])
    low, high = np.floor(exponents.min()), np.ceil(exponents.max() + 1e-9)
    alt = Text("Cost of each iteration above the final one")
    plot = Plot(Axis(0.0, float(len(costs) - 1), Text("accepted iteration")),
                Axis(low, max(high, low + 1), Text("log₁₀ (cost / final − 1)")), alt, height=220,
                margins=(74, 12, 16, 46))  # fmt: skip
    plot.line(np.arange(len(above))[good], exponents, "", BLUE, weight=2)
    plot.dots(np.arange(len(above))[good], exponents, "", ORANGE, 3.5)
    return Picture(alt, svg=plot.svg(), caption=Text(
        "A straight fall is linear convergence; a bend downwards is the quadratic end of a Gauss–Newton step."
    ))  # fmt: skip


def normal_density(values: Array) -> Array:
    """Return the density of the standard normal distribution."""
    return np.asarray(np.exp(-0.5 * values**2) / np.sqrt(2.0 * np.pi))


def _spread_out(count: int) -> Array:
    """Return indices of at most `MOST_DOTS` of `count` ordered values, all of the fifty at each end among them."""
    if count <= MOST_DOTS:
        return np.arange(count)
    middle = np.linspace(50, count - 51, MOST_DOTS - 100).round().astype(int)
    return np.unique(np.concatenate([np.arange(50), middle, np.arange(count - 50, count)]))
