"""Observations group by group: residuals, redundancy, and whether their a priori standard deviations are right."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.known.assembly import Linear
from graphos_core.adjustment.bundle.known.group import Group
from graphos_core.adjustment.statistics.reliability import detectable, standardised
from graphos_core.data import Array, ObservationGroup

NOTHING = np.empty(0)


def image_group(
    kind: str, residuals: Array, weights: Array, sigma: Array, redundancy: Array | None
) -> ObservationGroup:
    """Return the group of some image observations.

    Parameters
    ----------
    kind : str
    residuals : float64 (k, 2)
        px.
    weights : float64 (k,)
        Robust weights.
    sigma : float64 (k,)
        A priori standard deviations, px.
    redundancy : float64 (k, 2) or None
    """
    squares = float((weights[:, None] * (residuals / sigma[:, None]) ** 2).sum())
    share = float("nan") if redundancy is None else float(redundancy.sum())
    return ObservationGroup(
        kind=kind, unit="px", count=residuals.size, redundancy=share, squares=squares, sigma0=_ratio(squares, share),
        rms=float(np.sqrt((residuals**2).mean())) if residuals.size else float("nan"), factor=1.0, labels=(),
        observed=NOTHING, residuals=NOTHING, sigmas=NOTHING, redundancy_numbers=NOTHING, standardised=NOTHING,
        mdb=NOTHING,
    )  # fmt: skip


def other_groups(
    groups: tuple[Group, ...], found: Linear, cofactor: Array | None, delta0: float
) -> tuple[ObservationGroup, ...]:
    """Return the groups of other observations.

    Parameters
    ----------
    groups : tuple of Group
    found : Linear
        At the adjusted scene.
    cofactor : float64 (u, u) or None
        Of the reduced unknowns; None leaves the redundancy out.
    delta0 : float
        Non-centrality of the minimal detectable bias.
    """
    numbers = np.full(len(found.residuals), np.nan)
    if cofactor is not None:
        _, jacobian = found.weighted
        numbers = np.clip(1.0 - np.asarray((jacobian @ cofactor) * jacobian.toarray()).sum(axis=1), 0.0, 1.0)
    out = []
    for g, group in enumerate(groups):
        mine = found.group == g
        v, sigma, r = found.residuals[mine], found.sigma[mine], numbers[mine]
        squares = float(((v / sigma) ** 2).sum())
        out.append(ObservationGroup(
            kind=group.kind, unit=group.unit, count=len(v), redundancy=float(r.sum()), squares=squares,
            sigma0=_ratio(squares, float(r.sum())), rms=float(np.sqrt((v**2).mean())), factor=1.0,
            labels=tuple(group.labels), observed=np.array(group.observed), residuals=v, sigmas=sigma,
            redundancy_numbers=r, standardised=standardised(v, sigma, r), mdb=detectable(sigma, r, delta0),
        ))  # fmt: skip
    return tuple(out)


def _ratio(squares: float, redundancy: float) -> float:
    return float(np.sqrt(squares / redundancy)) if redundancy > 1e-6 else float("nan")
