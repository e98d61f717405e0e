"""What the adjustment found, in words: problems first, each with its reason and what to try."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphos_core.adjustment.statistics.significance import INTERIOR, significance
from graphos_core.data import Adjustment, Finding, Known, ObservationGroup, Significance
from graphos_core.number_format import format_value
from graphos_core.run import Run
from graphos_core.text import Text

HIGH = 0.95
"""Correlation from which two parameters are named."""

WRONG_WEIGHT = 1.5
"""Ratio of a group's sigma0 to 1 from which its a priori standard deviations are called wrong."""

LISTED = 10
UNCONTROLLED = 0.1
"""Redundancy number below which an observation counts as hardly controlled."""

WORSE = 3.0
"""Check points whose RMS exceeds their predicted precision this many times tell of systematic errors; one that falls
short of it as much, of a priori standard deviations that are too large."""

MANY = 0.1
"""Share of image observations that fail their test from which it is a warning."""

ORDER = {"error": 0, "warning": 1, "info": 2}


def diagnosed(adjustment: Adjustment, known: Known, frozen: list[str], alpha: float, run: Run) -> Adjustment:
    """Return the adjustment with the significance of its parameters and everything to know about it, in words.

    Parameters
    ----------
    adjustment : Adjustment
        With covariances and reliability.
    known : Known
    frozen : list of str
        Sentences about parameters that were held because nothing determined them.
    alpha : float
        Error probability of the tests.
    run : Run
        Is warned of suspected blunders among what the person gave.
    """
    tested = significance(adjustment, alpha)
    findings = [
        *adjustment.findings,
        *(Finding(severity="warning", what=text, learn="adjustment/rank-defects") for text in frozen),
        *_converged(adjustment),
        *_blunders_known(adjustment, run),
        *_blunders_image(adjustment),
        *_weights(adjustment),
        *_global(adjustment),
        *_check(adjustment),
        *_distances(adjustment, known),
        *_uncontrolled(adjustment),
        *_parameters(adjustment, tested),
    ]
    findings.sort(key=lambda finding: ORDER[finding.severity])
    return replace(adjustment, significance=tested, findings=tuple(findings))


def _converged(a: Adjustment) -> list[Finding]:
    if a.converged:
        return []
    return [Finding(severity="error", what="The adjustment did not converge.", why=a.stop_reason,
                    todo="Allow more iterations, choose the strategy step by step, or look for gross errors.",
                    learn="adjustment/solver")]  # fmt: skip


def _blunders_known(a: Adjustment, run: Run) -> list[Finding]:
    """Control coordinates, distances and so on whose test fails, the largest first."""
    if a.reliability is None:
        return []
    limit = a.reliability.critical
    rows = []
    for group in a.groups:
        if not group.labels or group.kind == "camera":
            continue
        for i in np.flatnonzero(np.abs(group.standardised) > limit).tolist():
            rows.append((abs(float(group.standardised[i])), group, i))
    if not rows:
        return []
    rows.sort(key=lambda row: -row[0])
    w, group, i = rows[0]
    what = Text(
        "{label} ({kind}) is suspected of a blunder: residual {residual}, |w| = {w:.1f} against {limit:.2f}.",
        label=group.labels[i], kind=group.kind, residual=_amount(group, i), w=w, limit=limit,
    )  # fmt: skip
    run.warn(what)
    return [Finding(
        severity="warning", what=what,
        why="Only the largest is certain: one blunder makes its neighbours look bad.",
        todo="Check its value and its measurements, then adjust again; switch it off if it stays.",
        learn="adjustment/data-snooping", items=tuple(row[1].labels[row[2]] for row in rows[:LISTED]),
    )]  # fmt: skip


def _amount(group: ObservationGroup, i: int) -> str:
    value = float(group.residuals[i])
    return length_text(value) if group.unit == "m" else format_value(value, unit=group.unit, digits=3)


def length_text(metres: float) -> str:
    """Return a length in mm where it is below 0.1 m, else in m."""
    if abs(metres) < 0.1:
        return format_value(1000.0 * metres, unit="mm", digits=3)
    return format_value(metres, unit="m", digits=3)


def _blunders_image(a: Adjustment) -> list[Finding]:
    if a.reliability is None:
        return []
    w = np.abs(a.reliability.standardised).max(axis=1)
    worst = np.argsort(-w)[:LISTED]
    worst = worst[w[worst] > a.reliability.critical]
    total = int((w > a.reliability.critical).sum())
    expected = a.reliability.alpha * w.size * 2
    if not len(worst) or total <= max(2.0 * expected, expected + 3.0 * np.sqrt(expected)):
        return []
    block = a.block
    named = [_image_label(a, int(o)) for o in worst]
    return [Finding(
        severity="warning" if total > MANY * w.size else "info",
        what=Text("{count} image observations fail their test at {alpha:g}; {expected:.0f} would by chance.",
                  count=total, alpha=a.reliability.alpha, expected=expected),
        why=Text("The largest |w| is {w:.1f}, in {photo}.", w=float(w[worst[0]]),
                 photo=block.names[block.obs_photo[worst[0]]]),
        todo="Some are usual: real photos have more large residuals than a normal distribution. If they lie in one photo "
        "or on one object, look at them; a lower rejection limit takes them out.", learn="adjustment/data-snooping",
        items=tuple(named),
    )]  # fmt: skip


def _image_label(a: Adjustment, observation: int) -> str:
    point = int(a.block.obs_point[observation])
    name = a.point_names[point] if a.point_names else ""
    return f"{name or f'point {point}'} in {a.block.names[a.block.obs_photo[observation]]}"


def _weights(a: Adjustment) -> list[Finding]:
    out = []
    for group in a.groups:
        if not (np.isfinite(group.sigma0) and group.redundancy > 3.0) or group.kind in (
            "tie points",
            "camera",
        ):
            continue
        ratio = group.sigma0 / max(a.sigma0, 1e-12)
        if ratio < WRONG_WEIGHT:
            continue
        out.append(Finding(
            severity="warning",
            what=Text("The observations “{kind}” are {ratio:.1f} times less precise than their a priori standard "
                      "deviations say.", kind=group.kind, ratio=ratio),
            why="Their residuals are larger than the rest of the block explains.",
            todo="Raise their standard deviations, look for a blunder among them, or estimate variance components.",
            learn="adjustment/variance-components",
        ))  # fmt: skip
    return out


def _global(a: Adjustment) -> list[Finding]:
    test = a.global_test
    if test is None or test.passed:
        return []
    large = test.statistic > test.upper
    return [Finding(
        severity="warning",
        what=Text("The global test fails: vᵀPv = {value:.4g} is outside {lower:.4g} to {upper:.4g}.",
                  value=test.statistic, lower=test.lower, upper=test.upper),
        why="Residuals are larger than the a priori standard deviations allow." if large
        else "Residuals are smaller than the a priori standard deviations let expect.",
        todo="Look for blunders and systematic errors, or raise the a priori standard deviations." if large
        else "Lower the a priori standard deviations.",
        learn="adjustment/sigma0",
    )]  # fmt: skip


def _check(a: Adjustment) -> list[Finding]:
    """Compare accuracy at check points with the precision that the covariance promises."""
    if a.check is None:
        return []
    rms = float(np.sqrt((a.check.residuals**2).mean()))
    sigma = np.asarray(a.check.sigmas) ** 2 + np.asarray(a.check.given_sigmas) ** 2
    predicted = float(np.sqrt(sigma.mean()))
    if not (np.isfinite(predicted) and predicted > 0):
        return []
    told = Text(
        "Check points: RMS {rms} per coordinate against a predicted {sigma}.",
        rms=length_text(rms),
        sigma=length_text(predicted),
    )
    if rms < predicted / WORSE:
        return [Finding(severity="info", what=told, why="The block is better than its covariance promises: the a priori "
                        "standard deviations of control are probably too large.",
                        todo="Lower them, or estimate variance components.", learn="adjustment/check-points")]  # fmt: skip
    if rms <= WORSE * predicted:
        return [Finding(severity="info", what=told, why="Accuracy is what precision promised.",
                        learn="adjustment/check-points")]  # fmt: skip
    return [Finding(
        severity="warning", what=told,
        why="The block has errors that its covariance does not know: lens model, blunders, a bent shape.",
        todo="Try a fuller camera model, add control points at the edges and in the middle, or photos rolled by 90°.",
        learn="adjustment/check-points", items=a.check.names,
    )]  # fmt: skip


def _distances(a: Adjustment, known: Known) -> list[Finding]:
    place = {name: i for i, name in enumerate(a.point_names) if name}
    out = []
    for d in known.distances:
        if not (d.check and d.a in place and d.b in place):
            continue
        if a.block.unit != "m":
            out.append(Finding(
                severity="info", learn="adjustment/scale-bars",
                what=Text("Check distance {a}–{b} cannot be compared: the block has no scale.", a=d.a, b=d.b),
                todo="Give another distance that takes part, or control points.",
            ))  # fmt: skip
            continue
        length = float(np.linalg.norm(a.block.points[place[d.a]] - a.block.points[place[d.b]]))
        out.append(Finding(
            severity="info", learn="adjustment/scale-bars",
            what=Text("Check distance {a}–{b}: computed {length}, given {given}, difference {miss}.", a=d.a, b=d.b,
                      length=format_value(length, unit="m", digits=6), given=format_value(d.metres, unit="m", digits=6),
                      miss=length_text(length - d.metres)),
        ))  # fmt: skip
    return out


def _uncontrolled(a: Adjustment) -> list[Finding]:
    if a.reliability is None or not len(a.reliability.redundancy):
        return []
    weak = a.reliability.redundancy < UNCONTROLLED
    share = float(weak.mean())
    if share < 0.05:
        return []
    return [Finding(
        severity="info",
        what=Text("{share:.0f} % of the image coordinates are hardly controlled by others (redundancy below {limit:g}).",
                  share=100 * share, limit=UNCONTROLLED),
        why="A blunder in them would go unnoticed; points with two rays control only one direction.",
        todo="More photos per point.", learn="adjustment/redundancy",
    )]  # fmt: skip


def _parameters(a: Adjustment, tested: tuple[Significance, ...]) -> list[Finding]:
    out = []
    done: set[frozenset[tuple[int, str]]] = set()
    for s in tested:
        c, name, other = s.camera, s.parameter, s.correlated_with
        label = a.block.cameras[c].label or f"Camera {c + 1}"
        pair = frozenset({(c, name), (c, other)})
        if abs(s.correlation) > HIGH and pair not in done and not ({name, other} <= {"k1", "k2", "k3"}):
            done.add(pair)
            out.append(Finding(
                severity="info",
                what=Text("{camera}: {a} and {b} are correlated by {r:.1f} %.", camera=label, a=name, b=other,
                          r=100 * s.correlation),
                why="The photos hardly tell them apart; their sum is well determined, the single values are not.",
                todo="Photos rolled by 90°, convergent, with depth in the scene; or hold one of them.",
                learn="adjustment/network-design", items=(name, other),
            ))  # fmt: skip
        if not s.significant and name not in INTERIOR:
            out.append(Finding(
                severity="info",
                what=Text("{camera}: {name} is not significant (t = {t:.1f} against {limit:.1f}).", camera=label,
                          name=name, t=s.t, limit=s.limit),
                why="The block is explained as well without it.", todo="It may be held fixed.",
                learn="adjustment/significance", items=(name,),
            ))  # fmt: skip
    return out
