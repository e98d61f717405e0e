r"""Robust functions: how observations with large residuals lose weight.

The cost of an observation is ``½ ρ(s)`` with ``s = v²/σ²``, its weight ``ρ'(s)``; c is the scale, in units of σ.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np

from graphos_core.adjustment.bundle import robust_kernels as kernels
from graphos_core.data.record import Array

Robust = Literal["none", "huber", "cauchy", "geman-mcclure", "tukey", "l1", "danish"]


@dataclass(frozen=True)
class RobustFunction:
    """A robust function.

    Attributes
    ----------
    name, label : str
    code : int
        For compiled loops.
    rho, weight : str
        ρ(s) and ρ'(s) in mathtext.
    convex : bool
        Whether the cost stays convex in the residual; others need a good start, but let gross errors go.
    effect, source : str
    """

    name: Robust
    label: str
    code: int
    rho: str
    weight: str
    convex: bool
    effect: str
    source: str

    def __call__(self, square: Array, scale: float) -> tuple[Array, Array]:
        """Return ρ and weight of squared normalised residuals, by the function the compiled loops use."""
        pairs = [kernels.robust(self.code, scale, float(s)) for s in np.ravel(square)]
        both = np.array(pairs, dtype=np.float64).reshape(*np.shape(square), 2)
        return both[..., 0], both[..., 1]


ROBUST: dict[str, RobustFunction] = {
    function.name: function
    for function in (
        RobustFunction("none", "None", kernels.NONE, "s", "1", True,
                       "Every observation counts in full: plain least squares.", "Gauss 1809"),
        RobustFunction("huber", "Huber", kernels.HUBER, r"2c\sqrt{s} - c^2", r"c/\sqrt{s}", True,
                       "Beyond c an observation pulls with constant force.",
                       "Huber 1964, Robust estimation of a location parameter"),
        RobustFunction("l1", "L1", kernels.L1, r"2c\sqrt{s}", r"c/\sqrt{s}", True,
                       "The sum of lengths instead of squares; rounded off close to zero.",
                       "Triggs et al. 2000, section 3.3"),
        RobustFunction("cauchy", "Cauchy", kernels.CAUCHY, r"c^2\,\ln(1 + s/c^2)", r"1/(1 + s/c^2)", False,
                       "Large residuals pull less and less.", "Holland and Welsch 1977"),
        RobustFunction("geman-mcclure", "Geman–McClure", kernels.GEMAN_MCCLURE, r"s/(1 + s/c^2)",
                       r"1/(1 + s/c^2)^2", False, "Very large residuals hardly pull at all.",
                       "Geman and McClure 1987"),
        RobustFunction("tukey", "Tukey", kernels.TUKEY, r"\frac{c^2}{3}\left(1 - (1 - s/c^2)^3\right)",
                       r"(1 - s/c^2)^2", False, "Beyond c an observation has no weight at all.",
                       "Beaton and Tukey 1974"),
        RobustFunction("danish", "Danish", kernels.DANISH, r"c^2\,(2 - e^{1 - s/c^2})", r"e^{1 - s/c^2}", False,
                       "Full weight up to c, then a fast exponential fall.",
                       "Krarup, Juhl, Kubik 1980, Götterdämmerung over least squares adjustment"),
    )
}  # fmt: skip
"""Every robust function by name."""

MOST_LENGTH, STEP = 8.0, 0.01
"""Integrals over the length of a residual vector end here, in units of σ, and are summed with this step."""


def consistency(name: str, scale: float, mean_square: float) -> tuple[float, float]:
    """Return what a robust function leaves of the squares of good observations, and what it costs in precision.

    For normal residual vectors of two coordinates, with s = v²/σ² and weight w(s), a robust adjustment has
    ``E Σ w s = k r`` with ``k = E(w s) / 2``, and the covariance of its unknowns is
    ``(E(w² s) / 2 k²) (AᵀA)⁻¹ ≈ g (AᵀWA)⁻¹`` with ``g = E(w² s) E(w) / 2 k²`` (Huber 1981, Robust statistics,
    sections 5.2 and 7.6; for such vectors the mean derivative of w v is k too).

    Parameters
    ----------
    name : str
        Of the function.
    scale : float
        c, in units of the a priori σ.
    mean_square : float
        vᵀPv / r found, from which the real σ follows.

    Returns
    -------
    float
        k; 1 without a robust function.
    float
        g; 1 without a robust function.
    """
    if name == "none" or not mean_square > 0.0:
        return 1.0, 1.0
    reach, kept, cost = _shares(name)
    variance = mean_square
    for _ in range(100):  # from below: redescending functions have a second solution, where nothing is good
        k = float(np.interp(scale / np.sqrt(variance), reach, kept))
        before, variance = variance, min(mean_square / k, (scale / SMALLEST_REACH) ** 2)
        if abs(variance - before) < 1e-9 * variance:
            break
    at = scale / np.sqrt(variance)
    return float(np.interp(at, reach, kept)), float(np.interp(at, reach, cost))


SMALLEST_REACH = 1.5
"""Scales below this many σ are not told apart: the residuals then say nothing about σ."""


@cache
def _shares(name: str) -> tuple[Array, Array, Array]:
    """Return scales c/σ (n,), k and g of each."""
    reach = np.geomspace(SMALLEST_REACH, MOST_LENGTH, 40)
    length = np.arange(0.0, MOST_LENGTH, STEP)
    density = length * np.exp(-0.5 * length**2) * STEP
    weight = np.stack([ROBUST[name](length**2, float(c))[1] for c in reach])
    kept = 0.5 * (weight * length**2) @ density
    squares = 0.5 * (weight**2 * length**2) @ density
    return reach, kept, squares * (weight @ density) / kept**2
