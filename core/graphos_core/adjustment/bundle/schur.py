"""The bundle adjustment stage: what is known, self-calibration, robust weights, rejection of outliers, statistics."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.data import Adjustment, Array, Block, CheckPoints, Control, Known
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

SCALE_SIGMAS = 3.0
"""The automatic robust scale in units of the robust standard deviation; twice that for Tukey, whose weight is zero there:
good observations without weight would be taken for redundancy."""


@algorithm(
    stage="adjustment", role="bundle", name="schur", version=2,
    label="Bundle adjustment (Schur complement, Levenberg–Marquardt)",
    source="Triggs, McLauchlan, Hartley, Fitzgibbon 2000, sections 4 and 6; Marquardt 1963; Nielsen 1999",
    learn="adjustment/bundle",
)  # fmt: skip
def adjust(block: Block, known: Known, params: BundleParams, *, run: Run) -> Adjustment:
    """Adjust orientations, object points and the camera together by least squares.

    Image points, control points and whatever else is known are observations with standard deviations. Rounds of
    adjustment and rejection follow each other until no tie point observation is longer than ``rejection`` robust
    standard deviations. Where nobody gave the precision of tie points it is taken from their residuals, so that all
    groups of observations have the weight they deserve against each other. Standard deviations, tests and what they
    say in words are computed in the end.

    Parameters
    ----------
    block : Block
        Oriented, in the frame of what is known.
    known : Known
    params : BundleParams
    run : Run

    Raises
    ------
    UserError
        When no two oriented photos share enough points.
    Stopped
        When the person asked to stop.
    """
    from graphos_core.adjustment.bundle.rejection import without_weak_photos
    from graphos_core.adjustment.bundle.rounds import Rounds
    from graphos_core.adjustment.bundle.self_calibration import prepare
    from graphos_core.adjustment.statistics.diagnosis import diagnosed

    placed = without_weak_photos(prepare(block, params.calibration, per_photo=params.per_photo))
    rounds = Rounds(placed, known, params, run)
    rounds.reject()
    run.check()
    result, named = rounds.final()
    run.progress(1, 1, Text("rounds of adjustment"))
    if rounds.rejected:
        run.say(Text(
            "{rejected} observations were longer than {limit:g} standard deviations and were rejected.",
            rejected=rounds.rejected, limit=params.rejection,
        ))  # fmt: skip
    if not result.converged:
        run.warn(Text("The adjustment did not converge: {reason}.", reason=result.stop_reason))
    trace = (*rounds.trace, *result.iterations)
    result = replace(
        result, iterations=tuple(replace(r, iteration=i) for i, r in enumerate(trace)), point_names=named.names(result),
        check=check_points(result, known.control, named, all_check=params.control == "check"),
    )  # fmt: skip
    return diagnosed(result, known, rounds.frozen, params.alpha, run)


@dataclass(frozen=True)
class Named:
    """The measured points of an adjusted block: name → index into its points."""

    place: dict[str, int]

    def names(self, adjustment: Adjustment) -> tuple[str, ...]:
        """Return the name of every object point, empty where none has one."""
        if not self.place:
            return ()
        out = [""] * len(adjustment.block.points)
        for name, index in self.place.items():
            out[index] = name
        return tuple(out)


def check_points(
    adjustment: Adjustment, control: Control | None, named: Named, *, all_check: bool
) -> CheckPoints | None:
    """Compare check points with their given coordinates; None where there are none, or the block is not in metres.

    Parameters
    ----------
    adjustment : Adjustment
    control : Control or None
    named : Named
    all_check : bool
        Whether control points took no part either.
    """
    if control is None or adjustment.block.unit != "m":
        return None
    wanted = np.isfinite(control.xyz).all(axis=1) & (np.asarray(control.check) | all_check)
    rows = [i for i in np.flatnonzero(wanted) if control.names[i] in named.place]
    if not rows:
        return None
    index = np.array([named.place[control.names[i]] for i in rows])
    sigma: Array = np.zeros((len(rows), 3)) if control.sigma is None else np.nan_to_num(control.sigma[rows])
    return CheckPoints(
        names=tuple(control.names[i] for i in rows), residuals=adjustment.block.points[index] - control.xyz[rows],
        sigmas=np.asarray(adjustment.sigma_points)[index], given_sigmas=sigma,
    )  # fmt: skip
