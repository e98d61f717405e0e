"""The parameter sheet of the bundle adjustment."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

Calibration = Literal[
    "fixed", "basic", "radial", "complete", "brown", "ebner", "polynomial3", "polynomial4", "polynomial5",
    "polynomial6", "polynomial7", "fisheye-equidistant", "fisheye-equisolid", "opencv", "as it is",
]  # fmt: skip

CALIBRATIONS: dict[str, str] = {
    "fixed": "Fixed",
    "basic": "Basic (f, x0, y0, k1, k2)",
    "radial": "Radial polynomial",
    "complete": "Complete (Fraser)",
    "brown": "Brown",
    "ebner": "Ebner (12)",
    "polynomial3": "Polynomial of degree 3",
    "polynomial4": "Polynomial of degree 4",
    "polynomial5": "Polynomial of degree 5",
    "polynomial6": "Polynomial of degree 6",
    "polynomial7": "Polynomial of degree 7",
    "fisheye-equidistant": "Fish-eye, equidistant",
    "fisheye-equisolid": "Fish-eye, equisolid-angle",
    "opencv": "OpenCV (rational, thin prism)",
    "as it is": "The model each camera has",
}
"""What a self-calibration estimates; the name of the model with an underscore."""


class BundleParams(Params):
    """Parameters of the bundle adjustment."""

    calibration: Annotated[Calibration, About(
        label="Calibration",
        help="Whether the camera is calibrated by the photos themselves, and by which model, or held as it is.",
        effect="Basic suits most lenses. Complete and Brown add decentring; Ebner and polynomials describe whatever is "
        "left over, without an optical meaning; a fish-eye needs its own projection.",
        choices=CALIBRATIONS, learn="adjustment/self-calibration", level="novice", group="Self-calibration",
    )] = "basic"  # fmt: skip
    free_focal: Annotated[bool, About(
        label="Free principal distance", symbol="f",
        help="Whether the principal distance is an unknown of the self-calibration.",
        effect="On: needs photos that are rotated, convergent, or of a scene with depth.",
        learn="adjustment/self-calibration", group="Self-calibration",
    )] = True  # fmt: skip
    principal_point: Annotated[Literal["automatic", "free", "fixed"], About(
        label="Principal point", symbol="x_0, y_0",
        help="Whether the principal point is an unknown of the self-calibration.",
        effect="Automatic: free where photos are rolled against each other by at least 60°; without roll a shift of "
        "the principal point and a tilt of the photos are nearly the same thing. Free: always. Fixed: never.",
        choices={"automatic": "Automatic", "free": "Free", "fixed": "Fixed"},
        learn="adjustment/self-calibration", group="Self-calibration",
    )] = "automatic"  # fmt: skip
    parameters: Annotated[str, About(
        label="Single parameters",
        help="What becomes of single parameters, such as “k2=fixed, b1=free, p1=0.001”: fixed, free, or free with a "
        "standard deviation of its start value. “2.k1=fixed” speaks of the second camera only.",
        effect="Overrides the three settings above.",
        learn="adjustment/self-calibration", level="expert", group="Self-calibration",
    )] = ""  # fmt: skip
    per_photo: Annotated[bool, About(
        label="One calibration per photo",
        help="Whether every photo has a calibration of its own, as with a zoom lens that moved.",
        effect="On: many more unknowns; weak for blocks with few points per photo.",
        level="expert", group="Self-calibration",
    )] = False  # fmt: skip
    strategy: Annotated[Literal["together", "interior later", "step by step"], About(
        label="Order of unknowns",
        help="Which unknowns are held in the first rounds.",
        effect="Together: everything free from the start. Interior later: the camera is held in the first round. Step "
        "by step: then only the principal distance becomes free, then everything; for poor starts.",
        choices={"together": "Together", "interior later": "Interior orientation later", "step by step": "Step by step"},
        learn="adjustment/self-calibration", level="expert", group="Self-calibration",
    )] = "together"  # fmt: skip
    control: Annotated[Literal["weighted", "check"], About(
        label="Control points",
        help="How control points and their standard deviations take part.",
        effect="Weighted: they are observations like the image points; the block is fitted to them and bends as little "
        "as their standard deviations demand. Check: they only placed the block before and are compared with it "
        "afterwards; the block keeps its own shape.",
        choices={"weighted": "Weighted observations", "check": "Only place and check"},
        learn="adjustment/control-points", group="Control and weights",
    )] = "weighted"  # fmt: skip
    control_sigma_m: Annotated[float, About(
        label="Precision of control", symbol=r"\sigma_c", unit="m", low=0, low_open=True, high=1000, step=0.005,
        help="A priori standard deviation of control coordinates and distances that say none themselves.",
        effect="Lower: the block is pulled harder towards the control points.",
        learn="adjustment/control-points", group="Control and weights",
    )] = 0.01  # fmt: skip
    measured_sigma_px: Annotated[float, About(
        label="Precision of measured points", symbol=r"\sigma_m", unit="px", low=0, low_open=True, high=100, step=0.1,
        help="A priori standard deviation per coordinate of points measured by hand in the photos.",
        effect="Lower: measured points count more against the tie points.",
        learn="adjustment/variance-components", level="student", group="Control and weights",
    )] = 0.5  # fmt: skip
    tie_sigma_px: Annotated[float | None, About(
        label="Precision of tie points", symbol=r"\sigma_t", unit="px", low=0, low_open=True, high=100, step=0.1,
        help="A priori standard deviation per coordinate of tie points; empty: from their own residuals.",
        effect="Lower: tie points count more against control points and other observations.",
        learn="adjustment/variance-components", level="expert", group="Control and weights",
    )] = None  # fmt: skip
    scale_weights: Annotated[bool, About(
        label="Weigh by keypoint scale",
        help="Whether coarse keypoints count less than fine ones, as their residuals say they should.",
        effect="On: the standard deviation of a tie point grows slowly with the scale at which it was detected.",
        learn="adjustment/variance-components", level="expert", group="Control and weights",
    )] = True  # fmt: skip
    variance_components: Annotated[bool, About(
        label="Estimate variance components",
        help="Whether the a priori standard deviation of each group of observations is estimated from its residuals.",
        effect="On: groups get the weight they deserve; needs a good redundancy in every group.",
        learn="adjustment/variance-components", level="expert", group="Control and weights",
    )] = False  # fmt: skip
    datum: Annotated[Literal["inner", "minimal"], About(
        label="Datum of free motions",
        help="What holds the motions of the block that nothing known fixes, for the standard deviations.",
        effect="Inner: the mean of all photos; the smallest standard deviations. Minimal: some coordinates of photos; "
        "standard deviations grow away from them. The shape of the block is the same.",
        choices={"inner": "Inner constraints (free network)", "minimal": "Minimal constraints"},
        learn="adjustment/datum", level="expert", group="Control and weights",
    )] = "inner"  # fmt: skip
    robust: Annotated[
        Literal["none", "huber", "l1", "cauchy", "geman-mcclure", "tukey", "danish"],
        About(
            label="Robust function",
            help="How observations with large residuals lose weight.",
            effect="None: all count the same. Huber and L1: mild. Cauchy and Geman–McClure: strong. Tukey and Danish: "
            "what is far out counts for nothing.",
            choices={"none": "None", "huber": "Huber", "l1": "L1", "cauchy": "Cauchy",
                     "geman-mcclure": "Geman–McClure", "tukey": "Tukey", "danish": "Danish"},
            learn="adjustment/robust", group="Outliers",
        ),
    ] = "huber"  # fmt: skip
    robust_scale_px: Annotated[float | None, About(
        label="Robust scale", symbol="c", unit="px", low=0, low_open=True, high=1000, step=0.5,
        help="Length of a residual from which its weight falls; empty: three times their standard deviation, "
        "six times for Tukey.",
        effect="Higher: fewer observations lose weight.",
        learn="adjustment/robust", level="expert", group="Outliers",
    )] = None  # fmt: skip
    rejection: Annotated[float | None, About(
        label="Rejection limit", symbol="q", unit="σ", low=2.5, high=100, step=0.5,
        help="Observations with residuals longer than this many standard deviations are removed; empty: none is. "
        "Measured points are never removed, but tested and named.",
        effect="Higher: more observations are kept, also wrong ones.",
        learn="adjustment/robust", group="Outliers",
    )] = 4.0  # fmt: skip
    alpha: Annotated[float, About(
        label="Error probability", symbol=r"\alpha", low=1e-6, high=0.2,
        help="Probability with which the test of an observation takes a good one for a blunder.",
        effect="Lower: fewer false alarms, larger minimal detectable biases.",
        learn="adjustment/data-snooping", level="expert", group="Tests",
    )] = 0.001  # fmt: skip
    power: Annotated[float, About(
        label="Power", symbol=r"1-\beta", low=0.5, high=0.999,
        help="Probability with which a blunder of the size of the minimal detectable bias is found.",
        effect="Higher: larger minimal detectable biases.",
        learn="adjustment/minimal-detectable-bias", level="expert", group="Tests",
    )] = 0.8  # fmt: skip
    method: Annotated[Literal["levenberg-marquardt", "gauss-newton", "powell"], About(
        label="Method",
        help="How the sum of squares is minimised.",
        effect="Levenberg–Marquardt: damped steps, robust against poor starts. Gauss–Newton with step control: the fewest "
        "iterations near the minimum. Levenberg–Marquardt–Powell: steps inside a region of trust.",
        choices={"levenberg-marquardt": "Levenberg–Marquardt", "gauss-newton": "Gauss–Newton with step control",
                 "powell": "Levenberg–Marquardt–Powell (dogleg)"},
        learn="adjustment/solver", level="expert", group="Iteration",
    )] = "levenberg-marquardt"  # fmt: skip
    max_iterations: Annotated[int, About(
        label="Largest number of iterations", low=1, high=10000, step=10,
        help="When the adjustment stops even if it has not converged.",
        effect="Higher: a bad start has more time to converge.", level="expert", group="Iteration",
    )] = 100  # fmt: skip
    tolerance: Annotated[float, About(
        label="Convergence limit", low=1e-15, high=0.1,
        help="The adjustment has converged when the sum of squares can fall by less than this share of itself.",
        effect="Lower: more iterations, more digits.", level="expert", group="Iteration",
    )] = 1e-8  # fmt: skip
