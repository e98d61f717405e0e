"""Does an adjustment tell the truth about itself? Simulated blocks of every camera model and kind of observation.

The errors of an estimate, weighted by its own covariance, must be χ² distributed: ``eᵀ C⁻¹ e`` with as many degrees of
freedom as there are unknowns in e (Förstner and Wrobel 2016, section 4.6.8, "evaluating the implementation").
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.known.build import Defaults, join_measured, observe
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.bundle.self_calibration import Calibrated
from graphos_core.cameras import camera_model, pixel_from_ray
from graphos_core.data import (
    Adjustment,
    Array,
    Block,
    Camera,
    Control,
    ControlObservations,
    Known,
    KnownAttitudes,
    KnownCentres,
    KnownDistance,
    KnownRig,
    KnownShape,
)
from graphos_core.geometry.rotation import look_at, matrix_from_vector, vector_from_matrix
from graphos_core.run import Run

SIGMA_PX, SIGMA_M = 0.3, 0.002
SIZE = 1600, 1200
PHOTOS, POINTS, TARGETS = 10, 260, 12
KINDS = ("control", "distances", "positions", "attitudes", "planes", "lines", "axes", "rig", "priors")
"""Kinds of observations that can be simulated beside tie points; control is always there, it gives the datum."""


@dataclass(frozen=True)
class Case:
    """A simulated block, what is known about it, and the truth.

    Attributes
    ----------
    truth, block : Block
    known : Known
    calibrated : Calibrated
    start : Camera
        What priors speak of.
    extras : dict of str to float
        True values of the other unknowns, as far as they have one.
    """

    truth: Block
    block: Block
    known: Known
    calibrated: Calibrated
    start: Camera
    extras: dict[str, float]


def true_camera(model: str, rng: np.random.Generator) -> Camera:
    """Return a camera with plausible distortion in every parameter that is free by default."""
    values = np.zeros(len(camera_model(model).parameters))
    wide = camera_model(model).wide
    for i, parameter in enumerate(camera_model(model).parameters):
        if parameter.default == "free":
            values[i] = 0.2 * parameter.usual * rng.uniform(-1.0, 1.0)
        elif parameter.default == "constant":
            values[i] = 0.5 * SIZE[0]
    values[:3] = [500.0 if wide else 1500.0, 803.0, 596.0]
    return Camera(model=model, width=SIZE[0], height=SIZE[1], values=values)


def simulate(model: str, kinds: tuple[str, ...], seed: int) -> Case:
    """Make a block of convergent and rolled photos round a scene with depth, with noise on everything observed."""
    rng = np.random.default_rng(seed)
    fixed = np.random.default_rng(7)  # the scene is the same for every seed: only the noise differs
    camera = true_camera(model, fixed)
    points = fixed.uniform([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0], (POINTS, 3))
    rotations, centres = _stations(fixed, "rig" in kinds)
    targets = _targets(fixed)
    obs = _observations(camera, rotations, centres, points)
    names = tuple(f"photo {n}" for n in range(len(centres)))
    truth = Block(
        cameras=(camera,), names=names, camera_of_photo=np.zeros(len(names), dtype=np.int32),
        oriented=np.ones(len(names), dtype=bool), rotations=rotations, centres=centres, points=points,
        colours=np.zeros((POINTS, 3), dtype=np.uint8), point_track=np.arange(POINTS, dtype=np.int32),
        obs_photo=obs[:, 1].astype(np.int32), obs_point=obs[:, 0].astype(np.int32), obs_xy=obs[:, 2:], unit="m",
    )  # fmt: skip
    noisy = obs[:, 2:] + rng.normal(0.0, SIGMA_PX, (len(obs), 2))
    block = replace(truth, obs_xy=noisy, obs_sigma_px=np.full(len(obs), SIGMA_PX))
    measured = _observations(camera, rotations, centres, targets)
    known, extras = _known(kinds, truth, targets, measured, rng)
    free = tuple(p.name for p in camera_model(model).parameters if p.default == "free")
    priors, start = _priors(kinds, camera, free, rng)
    return Case(truth, block, known, Calibrated((free,), priors), start, extras)


def adjusted(case: Case, *, bias: tuple[int, int, float] | None = None) -> Adjustment:
    """Adjust a case; with `bias` (observation, coordinate, px) one image coordinate gets a gross error."""
    defaults = Defaults(measured_px=SIGMA_PX, threshold_px=50.0)
    joined = join_measured(case.block, case.known, defaults)
    if bias is not None:
        xy = np.array(joined.obs_xy)
        xy[bias[0], bias[1]] += bias[2]
        joined = replace(joined, obs_xy=xy)
    observed = observe(joined, case.known, defaults, Run())
    priors = case.calibrated.prior_group(replace(case.block, cameras=(case.start,)))
    return adjust_block(
        observed.block, Freedom(interior=case.calibrated.interior),
        Options(reliability=True, tolerance=1e-11, max_iterations=60), (*observed.groups, *priors),
    )  # fmt: skip


@dataclass(frozen=True)
class Weighted:
    """Sums of weighted squared errors over many seeds, with their degrees of freedom."""

    name: str
    statistic: float
    freedom: int

    @property
    def inside(self) -> bool:
        """Whether it lies within the 99 % interval of χ²."""
        low, high = stats.chi2.ppf([0.005, 0.995], self.freedom)
        return bool(low <= self.statistic <= high)

    @property
    def ratio(self) -> float:
        """Statistic per degree of freedom: 1 when the covariance tells the truth."""
        return self.statistic / self.freedom


def weighted_errors(case: Case, found: Adjustment) -> list[Weighted]:
    """Return the weighted squared errors of the camera, of one photo, of one point, of every other unknown, and vᵀPv."""
    covariance = found.covariance
    assert covariance is not None
    scale = found.sigma0**2
    truth, block = case.truth, found.block
    model = camera_model(block.cameras[0].model)
    free = [model.index(name) for name in case.calibrated.interior[0]]
    out = []
    if free:
        error = (block.cameras[0].values - truth.cameras[0].values)[free]
        out.append(_weighted("camera", error, covariance.cameras[0][np.ix_(free, free)] / scale))
    turn = vector_from_matrix(block.rotations[1] @ truth.rotations[1].T)
    error = np.concatenate([turn, block.centres[1] - truth.centres[1]])
    out.append(_weighted("photo", error, covariance.photos[1] / scale))
    index = int(np.flatnonzero(block.point_track == 5)[0])
    out.append(_weighted("point", block.points[index] - truth.points[5], covariance.points[index] / scale))
    for extra in found.extras:
        if extra.name in case.extras:
            error = np.array([extra.value - case.extras[extra.name]])
            out.append(_weighted("other unknowns", error, np.array([[extra.sigma**2 / scale]])))
    out.append(Weighted("residuals", scale * found.redundancy, found.redundancy))
    return out


def _weighted(name: str, error: Array, cofactor: Array) -> Weighted:
    return Weighted(name, float(error @ np.linalg.solve(cofactor, error)), len(error))


def total(parts: list[Weighted]) -> dict[str, Weighted]:
    """Add up the weighted errors of many seeds by name."""
    names = dict.fromkeys(part.name for part in parts)
    return {
        name: Weighted(name, sum(p.statistic for p in parts if p.name == name),
                       sum(p.freedom for p in parts if p.name == name))
        for name in names
    }  # fmt: skip


def _stations(rng: np.random.Generator, rig: bool) -> tuple[Array, Array]:
    """Return rotations and centres; with a rig every second photo belongs to the one before it."""
    azimuth = 2.0 * np.pi * np.arange(PHOTOS) / PHOTOS
    centres = np.stack([5.0 * np.cos(azimuth), 5.0 * np.sin(azimuth), 4.0 + np.sin(3 * azimuth)], axis=1)
    rotations = np.stack([
        matrix_from_vector(np.array([0.0, 0.0, (i % 4) * np.pi / 2])) @ look_at(c, rng.normal(0.0, 0.2, 3))
        for i, c in enumerate(centres)
    ])  # fmt: skip
    if rig:
        turn, shift = matrix_from_vector(np.array([0.02, -0.05, 0.03])), np.array([0.3, 0.05, -0.02])
        for i in range(0, PHOTOS, 2):
            rotations[i + 1] = turn @ rotations[i]
            centres[i + 1] = centres[i] + rotations[i].T @ shift
    return rotations, centres


def _targets(rng: np.random.Generator) -> Array:
    """Return signalised points: four on a floor, four on a wall, a vertical pole of three, one loose."""
    xyz = rng.uniform(-1.5, 1.5, (TARGETS, 3))
    xyz[:4, 2] = -0.8
    normal = np.array([0.6, 0.8, 0.0])
    xyz[4:8] -= (xyz[4:8] @ normal - 0.5)[:, None] * normal
    xyz[9:11, :2] = xyz[8, :2]
    return xyz


def _observations(camera: Camera, rotations: Array, centres: Array, points: Array) -> Array:
    """Return rows point, photo, x, y of everything inside the format, sorted by point."""
    rows = []
    for n, (rotation, centre) in enumerate(zip(rotations, centres, strict=True)):
        pixel = pixel_from_ray(camera, (points - centre) @ rotation.T)
        inside = (pixel > 0).all(axis=1) & (pixel < np.array(SIZE) - 1.0).all(axis=1)
        rows += [(p, n, *pixel[p]) for p in np.flatnonzero(inside)]
    return np.array(sorted(rows))


def _known(
    kinds: tuple[str, ...], truth: Block, targets: Array, measured: Array, rng: np.random.Generator
) -> tuple[Known, dict[str, float]]:
    names = tuple(f"T{i}" for i in range(TARGETS))
    control = Control(
        names=names, xyz=targets + rng.normal(0.0, SIGMA_M, targets.shape), check=np.zeros(TARGETS, dtype=bool),
        origin=np.zeros(3), sigma=np.full(targets.shape, SIGMA_M),
    )  # fmt: skip
    seen = ControlObservations(
        point=measured[:, 0].astype(np.int32), photo=tuple(truth.names[int(n)] for n in measured[:, 1]),
        xy=measured[:, 2:] + rng.normal(0.0, SIGMA_PX, (len(measured), 2)),
    )  # fmt: skip
    extras: dict[str, float] = {}
    known = Known(control=control, measured=seen)
    if "distances" in kinds:
        known = replace(known, distances=tuple(
            KnownDistance(a=f"T{a}", b=f"T{b}", sigma=0.0005, metres=float(
                np.linalg.norm(targets[a] - targets[b]) + rng.normal(0.0, 0.0005)))
            for a, b in ((0, 5), (1, 9), (3, 7))))  # fmt: skip
    if "positions" in kinds:
        known = replace(known, centres=_positions(truth, rng, extras))
    if "attitudes" in kinds:
        known = replace(known, attitudes=_attitudes(truth, rng, extras))
    if "rig" in kinds:
        known = replace(known, rigs=(_rig(truth, extras),))
    return replace(known, shapes=_shapes(kinds)), extras


def _positions(truth: Block, rng: np.random.Generator, extras: dict[str, float]) -> KnownCentres:
    arm = np.array([0.05, -0.1, 0.02])
    xyz = (
        truth.centres
        + np.einsum("nji,j->ni", truth.rotations, arm)
        + rng.normal(0.0, 0.01, truth.centres.shape)
    )
    extras |= {f"lever arm {axis}": float(v) for axis, v in zip("xyz", arm, strict=True)}
    return KnownCentres(photo=truth.names, xyz=xyz, sigma=np.full(xyz.shape, 0.01), lever_arm=np.zeros(3),
                        lever_arm_free=True)  # fmt: skip


def _attitudes(truth: Block, rng: np.random.Generator, extras: dict[str, float]) -> KnownAttitudes:
    beta = np.array([0.01, -0.02, 0.015])
    noise = [matrix_from_vector(rng.normal(0.0, 1e-3, 3)) for _ in truth.names]
    measured = np.stack(
        [n @ matrix_from_vector(beta).T @ r for n, r in zip(noise, truth.rotations, strict=True)]
    )
    extras |= {f"boresight about {axis}": float(v) for axis, v in zip("xyz", beta, strict=True)}
    return KnownAttitudes(photo=truth.names, rotations=measured, sigma=np.full((len(truth.names), 3), 1e-3),
                          boresight=np.eye(3), boresight_free=True)  # fmt: skip


def _rig(truth: Block, extras: dict[str, float]) -> KnownRig:
    """Return a rig whose relative orientation is exactly the same at every moment and is estimated."""
    moments = tuple((truth.names[i], truth.names[i + 1]) for i in range(0, PHOTOS, 2))
    turn = truth.rotations[1] @ truth.rotations[0].T
    shift = truth.rotations[0] @ (truth.centres[1] - truth.centres[0])
    extras |= {f"rig, camera 2: centre {axis}": float(v) for axis, v in zip("xyz", shift, strict=True)}
    return KnownRig(photos=moments, rotations=np.stack([np.eye(3), turn]), centres=np.stack([np.zeros(3), shift]),
                    sigma_rotation=1e-6, sigma_centre=1e-6)  # fmt: skip


def _shapes(kinds: tuple[str, ...]) -> tuple[KnownShape, ...]:
    """Shapes hold exactly in the simulated scene: their points are on them to a micrometre."""
    exact = 1e-6
    out = []
    if "planes" in kinds:
        out += [KnownShape(kind="horizontal plane", points=("T0", "T1", "T2", "T3"), sigma=exact, name="floor"),
                KnownShape(kind="plane", points=("T4", "T5", "T6", "T7"), sigma=exact, name="wall")]  # fmt: skip
    if "lines" in kinds:
        out.append(KnownShape(kind="line", points=("T8", "T9", "T10"), sigma=exact, name="edge"))
    if "axes" in kinds:
        out.append(KnownShape(kind="z axis", points=("T8", "T9"), sigma=exact))
    return tuple(out)


def _priors(
    kinds: tuple[str, ...], camera: Camera, free: tuple[str, ...], rng: np.random.Generator
) -> tuple[tuple[tuple[int, str, float], ...], Camera]:
    if "priors" not in kinds or not free:
        return (), camera
    values = np.array(camera.values)
    values[0] += rng.normal(0.0, 2.0)
    values[1] += rng.normal(0.0, 1.0)
    return ((0, "focal_px", 2.0), (0, "x0", 1.0)), replace(camera, values=values)
