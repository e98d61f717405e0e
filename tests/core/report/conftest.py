"""A small adjusted block with known numbers in every part, made without the solver."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import (
    Adjustment,
    Block,
    Camera,
    CheckPoints,
    Covariance,
    Finding,
    Georeference,
    GlobalTest,
    IterationRecord,
    ObservationGroup,
    Reliability,
    Significance,
)
from graphos_core.geometry.rotation import look_at

PHOTOS, POINTS = 6, 80


def block(rng: np.random.Generator) -> Block:
    camera = Camera(
        model="basic", width=1600, height=1200, values=np.array([1500.0, 805.0, 592.0, -0.12, 0.05]),
        sigmas=np.array([0.5, 0.3, 0.0, 0.002, 0.004]), label="<Simulated> & tested",
    )  # fmt: skip
    points = rng.uniform([-2.0, -2.0, -1.0], [2.0, 2.0, 1.0], (POINTS, 3))
    azimuth = 2.0 * np.pi * np.arange(PHOTOS) / PHOTOS
    centres = np.stack([6.0 * np.cos(azimuth), 6.0 * np.sin(azimuth), 5.0 + np.sin(3 * azimuth)], axis=1)
    rotations = np.stack([look_at(c, rng.normal(0.0, 0.2, 3)) for c in centres])
    rows = []
    for i in range(PHOTOS):
        xy = pixel_from_ray(camera, (points - centres[i]) @ rotations[i].T)
        rows += [(p, i, *xy[p]) for p in range(POINTS)]
    table = np.array(sorted(rows))
    return Block(
        cameras=(camera,), names=tuple(f"photo {i}" for i in range(PHOTOS)), camera_of_photo=np.zeros(PHOTOS, np.int32),
        oriented=np.ones(PHOTOS, dtype=bool), rotations=rotations, centres=centres, points=points,
        colours=np.full((POINTS, 3), 128, np.uint8), point_track=np.arange(POINTS, dtype=np.int32),
        obs_photo=table[:, 1].astype(np.int32), obs_point=table[:, 0].astype(np.int32), obs_xy=table[:, 2:], unit="m",
    )  # fmt: skip


def group(kind: str, unit: str, labels: tuple[str, ...], rng: np.random.Generator) -> ObservationGroup:
    k = len(labels)
    sigmas = np.full(k, 0.002)
    residuals = rng.normal(0.0, 0.001, k)
    return ObservationGroup(
        kind=kind, unit=unit, count=k, redundancy=0.6 * k, squares=float(((residuals / sigmas) ** 2).sum()), sigma0=1.1,
        rms=float(np.sqrt((residuals**2).mean())), factor=1.0, labels=labels, observed=rng.uniform(1, 9, k),
        residuals=residuals, sigmas=sigmas, redundancy_numbers=np.full(k, 0.6),
        standardised=residuals / sigmas / np.sqrt(0.6), mdb=np.full(k, 0.01),
    )  # fmt: skip


@pytest.fixture(scope="session")
def adjusted() -> Adjustment:
    """Noise of 0.3 px, one residual of 5 px in photo 2, three check points, four control points, two distances."""
    rng = np.random.default_rng(3)
    made = block(rng)
    m = len(made.obs_xy)
    residuals = rng.normal(0.0, 0.3, (m, 2))
    residuals[2, 1] = 5.0  # point 0 in photo 2
    redundancy = rng.uniform(0.3, 0.8, (m, 2))
    w = residuals / np.sqrt(redundancy)
    mixing = rng.normal(0.0, 1.0, (5, 5)) + 3.0 * np.eye(5)
    interior = mixing @ mixing.T * 1e-4
    interior[2] = interior[:, 2] = 0.0
    names = ["A 1", "B", "C", "D", "E1", "E2", "E3"] + [""] * (POINTS - 7)
    labels = tuple(f"{name} {axis}" for name in names[:4] for axis in "XYZ")
    return Adjustment(
        block=made, sigma0=0.31, sigma0_px=0.31, prior_px=1.0, redundancy=2 * m + 14 - 300, observations=2 * m + 14,
        unknowns=300, datum="weighted control", rms_px=float(np.sqrt((residuals**2).mean())), residuals=residuals,
        weights=np.ones(m), sigma_rotations=np.full((PHOTOS, 3), 1e-4), sigma_centres=np.full((PHOTOS, 3), 1e-3),
        sigma_points=np.tile([0.001, 0.002, 0.003], (POINTS, 1)),
        iterations=tuple(
            IterationRecord(iteration=i, cost=100.0 + 10.0 ** (3 - 2 * i), step=1e-3, damping=1.0, gradient=1.0,
                            accepted=True) for i in range(5)
        ),
        converged=True, stop_reason="the cost hardly falls", point_names=tuple(names),
        groups=(
            group("control coordinates", "m", labels, rng), group("distances", "m", ("A 1–B", "C–D"), rng),
        ),
        covariance=Covariance(
            cameras=(interior,), photos=np.tile(np.diag([1e-4, 2e-4, 3e-4, 1e-3, 1e-3, 1e-3]) ** 2, (PHOTOS, 1, 1)),
            points=np.tile(np.diag([0.001, 0.002, 0.003]) ** 2, (POINTS, 1, 1)),
        ),
        reliability=Reliability(
            redundancy=redundancy, standardised=w, studentised=w / 0.31, mdb_px=4.13 / np.sqrt(redundancy),
            effect=np.full((m, 2), 0.004), alpha=0.001, power=0.8, critical=3.29, delta0=4.13,
        ),
        check=CheckPoints(
            names=("E1", "E2", "E3"), residuals=np.array([[1.0, -2, 3], [-1, 2, -3], [1, 2, 3]]) * 1e-3,
            sigmas=np.tile([0.001, 0.002, 0.003], (3, 1)), given_sigmas=np.zeros((3, 3)),
        ),
        global_test=GlobalTest(statistic=660.0, lower=600.0, upper=760.0, alpha=0.05, passed=True),
        significance=(
            Significance(camera=0, parameter="k2", value=0.05, sigma=0.04, t=1.25, limit=1.96, significant=False,
                         correlation=-0.93, correlated_with="k1"),
        ),
        findings=(
            Finding(severity="info", what="A note.", learn="adjustment/sigma0"),
            Finding(severity="error", what="The scale is free.", why="No distance.", todo="Give one distance.",
                    learn="adjustment/rank-defects", items=("photo 1",)),
        ),
    )  # fmt: skip


@pytest.fixture(scope="session")
def placed() -> Georeference:
    """Nothing was placed by a similarity."""
    return Georeference(
        method="none", scale=1.0, rotation=np.eye(3), translation=np.zeros(3), names=(), check=np.zeros(0, bool),
        residuals=np.zeros((0, 3)), rms_m=float("nan"), check_rms_m=float("nan"), origin=np.zeros(3),
    )  # fmt: skip
