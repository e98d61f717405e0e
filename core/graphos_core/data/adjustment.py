"""The adjusted block with everything its statistics say."""

from __future__ import annotations

from graphos_core.data.block import Block
from graphos_core.data.record import Array, record


@record
class IterationRecord:
    """One iteration of the adjustment.

    Attributes
    ----------
    iteration : int
    cost : float
        ½ Σ ρ(v²/σ²), robustly weighted as adjusted; without unit.
    step : float
        Norm of the parameter step relative to the norm of the parameters.
    damping : float
        Levenberg–Marquardt damping λ, the share of the step a line search took, or the radius of the trust region:
        what the method steers with.
    gradient : float
        Largest element of the gradient, absolute.
    accepted : bool
    interior : float64 (c, k) or None
        Parameters of every camera after the iteration, in the order of its model.
    """

    iteration: int
    cost: float
    step: float
    damping: float
    gradient: float
    accepted: bool
    interior: Array | None = None


@record
class Covariance:
    """Covariances of the unknowns, scaled by the a posteriori sigma0.

    Attributes
    ----------
    cameras : tuple of float64 (k, k)
        Of the parameters of each camera in the order of its model; rows of fixed parameters are zero.
    photos : float64 (n, 6, 6)
        Of each photo's small rotation about the camera's axes (radians) and projection centre (the block's unit);
        zero where held fixed or not oriented.
    points : float64 (p, 3, 3)
        Of each object point; infinite on the diagonal where its rays do not fix it.
    """

    cameras: tuple[Array, ...]
    photos: Array
    points: Array


@record
class Reliability:
    """How well each image observation is controlled by the others (Baarda 1968; Förstner 1985).

    Attributes
    ----------
    redundancy : float64 (m, 2)
        Redundancy numbers r of the two coordinates, 0 to 1; summed over all groups they give the redundancy.
    standardised : float64 (m, 2)
        Baarda's w: ``v / (σ √r)`` with the a priori σ; 0 where r is 0.
    studentised : float64 (m, 2)
        Pope's τ: ``v / (σ0 σ √r)`` with the a posteriori sigma0.
    mdb_px : float64 (m, 2)
        Minimal detectable bias ``δ0 σ / √r``, px; infinite where r is 0.
    effect : float64 (m, 2)
        How far the minimal detectable bias of each coordinate moves the observation's own object point, in the
        block's unit (external reliability).
    alpha, power : float
        Error probability of the test and power at which the bias is detected.
    critical : float
        Limit of |w| for `alpha`.
    delta0 : float
        Non-centrality for `alpha` and `power`.
    """

    redundancy: Array
    standardised: Array
    studentised: Array
    mdb_px: Array
    effect: Array
    alpha: float
    power: float
    critical: float
    delta0: float


@record
class ObservationGroup:
    """Observations of one kind: what they are, and what the adjustment found about them.

    Attributes
    ----------
    kind : str
        ``"tie points"``, ``"control image points"``, ``"control coordinates"``, ``"distances"``,
        ``"projection centres"``, ``"attitudes"``, ``"planes"``, ``"lines"``, ``"axes"``, ``"rig"``, ``"camera"``.
    unit : str
        ``"px"``, ``"m"``, ``"rad"`` …; ``""`` where they differ from observation to observation.
    count : int
        Observations (scalars).
    redundancy : float
        Sum of the redundancy numbers; NaN while not computed.
    squares : float
        vᵀPv of the group, of image points as in `Adjustment.sigma0`.
    sigma0 : float
        ``sqrt(squares / redundancy)``: 1 when the a priori standard deviations are right.
    rms : float
        Root mean square of the residuals, per scalar, in `unit`.
    factor : float
        By how much variance component estimation multiplied the a priori standard deviations; 1 without it.
    labels : tuple of str
        One per scalar observation: ``"T01 X"``; empty for image points, which have `Reliability`.
    observed, residuals, sigmas : float64 (k,)
        Observed value, adjusted − observed, and a priori standard deviation, in `unit` (or that of the label).
    redundancy_numbers, standardised, mdb : float64 (k,)
        As in `Reliability`; `mdb` in `unit`.
    """

    kind: str
    unit: str
    count: int
    redundancy: float
    squares: float
    sigma0: float
    rms: float
    factor: float
    labels: tuple[str, ...]
    observed: Array
    residuals: Array
    sigmas: Array
    redundancy_numbers: Array
    standardised: Array
    mdb: Array


@record
class CheckPoints:
    """Check points: accuracy, independent of the adjustment.

    Attributes
    ----------
    names : tuple of str
        Check points that two photos or more determine.
    residuals : float64 (k, 3)
        Computed − given, m.
    sigmas : float64 (k, 3)
        Standard deviations of the computed coordinates (precision), m.
    given_sigmas : float64 (k, 3)
        Standard deviations of the given coordinates, m; 0 where not known.
    """

    names: tuple[str, ...]
    residuals: Array
    sigmas: Array
    given_sigmas: Array


@record
class GlobalTest:
    """Test of the a posteriori against the a priori variance of unit weight (χ², two-sided).

    Attributes
    ----------
    statistic : float
        ``vᵀPv``.
    lower, upper : float
        Bounds at the chosen error probability.
    alpha : float
    passed : bool
    """

    statistic: float
    lower: float
    upper: float
    alpha: float
    passed: bool


@record
class Finding:
    """Something the adjustment found out about the block, in words for people.

    Attributes
    ----------
    severity : str
        ``"error"``, ``"warning"`` or ``"info"``.
    what, why, todo : str
        What is the case, why, and what to do about it.
    learn : str
        Lesson.
    items : tuple of str
        Names of the photos, points or parameters concerned, the worst first.
    """

    severity: str
    what: str
    why: str = ""
    todo: str = ""
    learn: str = ""
    items: tuple[str, ...] = ()


@record
class Significance:
    """Whether a parameter of the self-calibration differs from what it would be without it (t test).

    Attributes
    ----------
    camera : int
    parameter : str
    value, sigma : float
        In the parameter's unit. The value is tested against 0; the principal distance and point, which a camera has
        whatever they are, count as significant.
    t : float
        |value| / sigma.
    limit : float
        Limit of `t` at the chosen error probability.
    significant : bool
    correlation : float
        The largest in absolute value with another unknown of the same camera, 0 without another.
    correlated_with : str
        That unknown; empty without another.
    """

    camera: int
    parameter: str
    value: float
    sigma: float
    t: float
    limit: float
    significant: bool
    correlation: float
    correlated_with: str


@record
class ExtraUnknown:
    """An estimated unknown beside cameras, photos and points.

    Attributes
    ----------
    name : str
        ``"lever arm x"``, ``"height of the horizontal plane"`` …
    value, sigma : float
    unit : str
    """

    name: str
    value: float
    sigma: float
    unit: str


@record
class Adjustment:
    """An adjusted block with its statistics.

    Attributes
    ----------
    block : Block
        Adjusted; its cameras carry `Camera.sigmas`.
    sigma0 : float
        A posteriori standard deviation of unit weight, ``sqrt(vᵀPv / r)``, without unit: 1 when the a priori
        standard deviations are right. With a robust function the part of image points in vᵀPv is divided by the
        share that the function leaves of the squares of good observations.
    sigma0_px : float
        The same in px: `sigma0` times `prior_px`.
    prior_px : float
        A priori standard deviation of an image coordinate of unit weight, px.
    redundancy : int
        observations − unknowns + datum conditions.
    observations, unknowns : int
        Numbers in the least-squares sense: two per image point, one per other observation; datum defect not
        subtracted.
    datum : str
        How the datum was defined, in words.
    rms_px : float
        Root mean square of the image residuals per coordinate, over all observations, px of the full photo.
    residuals : float64 (m, 2)
        Projected − measured, px, in the order of the block's observations.
    weights : float64 (m,)
        Final robust weight of each observation, 0 to 1.
    sigma_rotations : float64 (n, 3)
        Standard deviations of small rotations about the camera's x, y, z axes, radians; 0 where not oriented.
    sigma_centres : float64 (n, 3)
        Standard deviations of the projection centres, in the block's unit; 0 where not oriented.
    sigma_points : float64 (p, 3)
        Standard deviations of the object points, in the block's unit.
    iterations : tuple of IterationRecord
    converged : bool
    stop_reason : str
    point_names : tuple of str
        Name of each object point that has one (control, check and other measured points), ``""`` else; empty
        where no point has a name.
    groups : tuple of ObservationGroup
    covariance : Covariance or None
    reliability : Reliability or None
    check : CheckPoints or None
    global_test : GlobalTest or None
    significance : tuple of Significance
    findings : tuple of Finding
        Problems first.
    extras : tuple of ExtraUnknown
        Estimated unknowns beside cameras, photos and points.
    """

    block: Block
    sigma0_px: float
    redundancy: int
    observations: int
    unknowns: int
    datum: str
    rms_px: float
    residuals: Array
    weights: Array
    sigma_rotations: Array
    sigma_centres: Array
    sigma_points: Array
    iterations: tuple[IterationRecord, ...]
    converged: bool
    stop_reason: str
    sigma0: float = float("nan")
    prior_px: float = 1.0
    point_names: tuple[str, ...] = ()
    groups: tuple[ObservationGroup, ...] = ()
    covariance: Covariance | None = None
    reliability: Reliability | None = None
    check: CheckPoints | None = None
    global_test: GlobalTest | None = None
    significance: tuple[Significance, ...] = ()
    findings: tuple[Finding, ...] = ()
    extras: tuple[ExtraUnknown, ...] = ()
