"""The adjustment in tables: value, standard deviation and unit of everything that was estimated."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from graphos_core.data import Adjustment, Block, Georeference
from graphos_core.geometry.rotation import opk_from_matrix
from graphos_core.number_format import format_value
from graphos_core.report.adjustment_figures import rotation_covariance, sigma_opk
from graphos_py.translation import tr
from graphos_py.views.table_view import Column


def summary(adjustment: Adjustment, georeference: Georeference) -> list[tuple[str, str]]:
    """Return the figures at a glance, as (what, value with unit)."""
    block = adjustment.block
    facts = [
        (tr("photos oriented"), f"{int(np.sum(block.oriented))} / {len(block.names)}"),
        (tr("object points"), format_value(len(block.points))),
        (
            tr("σ0 (a priori {px} px)", px=f"{adjustment.prior_px:.3g}"),
            format_value(adjustment.sigma0_px, unit="px", digits=3),
        ),
        (tr("RMS per coordinate"), format_value(adjustment.rms_px, unit="px", digits=3)),
        (tr("observations"), format_value(adjustment.observations)),
        (tr("unknowns"), format_value(adjustment.unknowns)),
        (tr("redundancy"), format_value(adjustment.redundancy)),
        (tr("unit of the object space"), tr(block.unit)),
    ]
    if math.isfinite(georeference.rms_m):
        facts.append(
            (tr("control RMS per coordinate"), format_value(1000 * georeference.rms_m, unit="mm", digits=3))
        )
    if math.isfinite(georeference.check_rms_m):
        facts.insert(
            9,
            (
                tr("check RMS per coordinate"),
                format_value(1000 * georeference.check_rms_m, unit="mm", digits=3),
            ),
        )
    return facts


def endings(adjustment: Adjustment) -> list[tuple[str, str]]:
    """Return how the datum was defined and why the iterations ended."""
    return [(tr("Datum"), tr(adjustment.datum)), (tr("Iterations"), tr(adjustment.stop_reason))]


def photo_columns(adjustment: Adjustment) -> list[Column]:
    """Return one row per photo: angles and centre with standard deviations, points, RMS; a reason if not oriented."""
    block = adjustment.block
    oriented = np.asarray(block.oriented)
    squares = (np.asarray(adjustment.residuals) ** 2).sum(axis=1)
    count = np.bincount(np.asarray(block.obs_photo), minlength=len(block.names))
    total = np.bincount(np.asarray(block.obs_photo), weights=squares, minlength=len(block.names))
    reasons = {failure.item: failure.reason for failure in block.failures}
    angles = np.full((len(block.names), 3), math.nan)
    sigmas = angles.copy()
    for i in np.flatnonzero(oriented):
        angles[i] = np.degrees(opk_from_matrix(block.rotations[i]))
        sigmas[i] = np.degrees(sigma_opk(block.rotations[i], rotation_covariance(adjustment, int(i))))
    centres = np.where(oriented[:, None], np.asarray(block.centres), math.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        rms = np.sqrt(total / (2 * count))
    columns = [Column(tr("photo"), list(block.names))]
    for axis, symbol in enumerate("ωφκ"):
        columns.append(Column(symbol, angles[:, axis], "°", sigmas[:, axis], 6))
    for axis, symbol in enumerate("XYZ"):
        columns.append(
            Column(symbol, centres[:, axis], tr(block.unit), np.asarray(adjustment.sigma_centres)[:, axis], 6)
        )
    columns.append(Column(tr("points"), [int(n) for n in count]))
    columns.append(
        Column("RMS", rms, "px", digits=3, help=tr("Per coordinate, over the photo's observations."))
    )
    columns += _tree_columns(block)
    if not oriented.all():
        columns.append(
            Column(
                tr("why not oriented"),
                ["" if o else tr(reasons.get(n, "–")) for o, n in zip(oriented, block.names)],
            )
        )
    return columns


def _tree_columns(block: Block) -> list[Column]:
    """Return when, on which photos and how every photo was oriented; no column where nobody recorded it."""
    tree = block.tree
    if tree is None:
        return []
    order: list[Any] = ["–"] * len(block.names)
    on, how = ["–"] * len(block.names), ["–"] * len(block.names)
    for place, (photo, parents, method) in enumerate(zip(tree.photo, tree.on, tree.method, strict=True), 1):
        order[int(photo)] = place
        on[int(photo)] = ", ".join(block.names[p] for p in parents[:3]) or tr("first photo")
        how[int(photo)] = tr(method)
    return [
        Column(tr("order"), order, help=tr("When it was oriented.")),
        Column(tr("oriented on"), on, help=tr("The photos that see most of the points it was oriented by.")),
        Column(tr("how"), how),
    ]
