"""Do covariances, tests and detectable biases tell the truth? Many simulated blocks of every kind.

Run: ``python benchmarks/statistics_truth.py [--seeds 200]``

For every camera model and kind of observation: errors weighted by their own covariance, per degree of freedom (1 is
right), and whether the sum lies within the 99 % interval of χ². Then the share of good observations that the test
rejects, and the share of biases of the minimal detectable size that it finds.
"""

from __future__ import annotations

import argparse

import numpy as np
from scipy import stats

from graphos_core.cameras import camera_models
from graphos_core.simulation.consistency import KINDS, adjusted, simulate, total, weighted_errors


def rows(seeds: int) -> list[tuple[str, str, tuple[str, ...]]]:
    """What is simulated: name, camera model, kinds of observations."""
    models = [(name, name, ("control",)) for name in camera_models()]
    kinds = [(f"basic with {kind}", "basic", ("control", kind)) for kind in KINDS[1:]]
    return [*models, *kinds, ("basic with everything", "basic", KINDS)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=200)
    seeds = parser.parse_args().seeds
    print(
        f"{'block':28} "
        + " ".join(f"{n:>16}" for n in ("camera", "photo", "point", "other unknowns", "residuals"))
    )
    for name, model, kinds in rows(seeds):
        parts = []
        for seed in range(seeds):
            case = simulate(model, kinds, seed)
            parts += weighted_errors(case, adjusted(case))
        sums = total(parts)
        cells = [f"{s.ratio:9.3f} {'ok' if s.inside else 'OUT':>6}" if (s := sums.get(n)) else f"{'–':>16}"
                 for n in ("camera", "photo", "point", "other unknowns", "residuals")]  # fmt: skip
        print(f"{name:28} " + " ".join(cells), flush=True)
    tests(seeds)


def tests(seeds: int) -> None:
    """Rate of false alarms, and power at the minimal detectable bias."""
    alarms = observations = found = 0
    redundancy = 0
    for seed in range(seeds):
        case = simulate("basic", ("control",), seed)
        clean = adjusted(case)
        checked = clean.reliability
        assert checked is not None
        alarms += int((np.abs(checked.standardised) > checked.critical).sum())
        observations += checked.standardised.size
        redundancy += clean.redundancy
        rng = np.random.default_rng(seed)
        o, axis = int(rng.integers(len(checked.mdb_px))), int(rng.integers(2))
        sign = 1.0 if rng.random() < 0.5 else -1.0
        spoiled = adjusted(case, bias=(o, axis, sign * float(checked.mdb_px[o, axis]))).reliability
        assert spoiled is not None
        found += int(abs(spoiled.standardised[o, axis]) > spoiled.critical)
    low, high = stats.binom.ppf([0.005, 0.995], observations, checked.alpha) / observations
    print(
        f"false alarms {alarms / observations:.5f} at alpha {checked.alpha:g} (99 % bound {low:.5f} to {high:.5f})"
    )
    low, high = stats.binom.ppf([0.005, 0.995], seeds, checked.power) / seeds
    print(f"biases of the minimal detectable size found: {found / seeds:.3f} at power {checked.power:g} "
          f"(99 % bound {low:.3f} to {high:.3f})")  # fmt: skip


if __name__ == "__main__":
    main()
