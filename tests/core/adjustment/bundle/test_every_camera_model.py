"""Every camera model calibrates itself in a block: errors of its parameters fit their covariance."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.cameras import camera_model, camera_models, pixel_from_ray, ray_from_pixel
from graphos_core.data import Block, Camera
from graphos_core.geometry.rotation import look_at, matrix_from_vector

NOISE_PX = 0.3
PHOTOS, POINTS = 12, 150
FOCAL = {"central": 1500.0, "equidistant": 520.0, "equisolid": 620.0, "spherical": 800.0 / np.pi}


def true_camera(name):
    """1600×1200 with every parameter at its usual size; fish-eyes see more than 180°."""
    model = camera_model(name)
    values = np.array([p.usual for p in model.parameters])
    terms = [k for k, p in enumerate(model.parameters) if p.group != "interior" and p.default != "constant"]
    values[terms[::2]] *= -1.0
    values[:3] = FOCAL[model.projection], 805.0, 592.0
    return Camera(model=name, width=1600, height=1200, values=values)


def surround(camera, rng):
    """A convergent and rolled block: the scene in the middle, or round the cameras where the model is wide."""
    wide = camera_model(camera.model).wide
    points = rng.normal(0.0, 3.0, (POINTS, 3)) if wide else rng.uniform(-1, 1, (POINTS, 3)) * [2, 2, 1]
    azimuth = 2.0 * np.pi * np.arange(PHOTOS) / PHOTOS
    height = 1.0 + 0.3 * np.sin(3 * azimuth)
    centres = (1.5 if wide else 4.2) * np.stack([np.cos(azimuth), np.sin(azimuth), height], axis=1)
    rotations = np.stack([
        matrix_from_vector([0.0, 0.0, (i % 4) * np.pi / 2]) @ look_at(c, rng.normal(0.0, 0.3, 3))
        for i, c in enumerate(centres)
    ])  # fmt: skip
    rows = []
    for i in range(PHOTOS):
        rays = (points - centres[i]) @ rotations[i].T
        pixels = pixel_from_ray(camera, rays)
        back = ray_from_pixel(camera, pixels)
        along = (
            np.einsum("ni,ni->n", back, rays) / np.linalg.norm(back, axis=1) / np.linalg.norm(rays, axis=1)
        )
        seen = (pixels > [40, 0]).all(axis=1) & (pixels < [1560, 1199]).all(axis=1) & (along > 1 - 1e-9)
        rows += [(p, i, *pixels[p]) for p in np.flatnonzero(seen)]
    table = np.array(sorted(rows))
    return Block(
        cameras=(camera,), names=tuple(f"photo {i}" for i in range(PHOTOS)),
        camera_of_photo=np.zeros(PHOTOS, dtype=np.int32), oriented=np.ones(PHOTOS, dtype=bool),
        rotations=rotations, centres=centres, points=points, colours=np.zeros((POINTS, 3), dtype=np.uint8),
        point_track=np.arange(POINTS, dtype=np.int32), obs_photo=table[:, 1].astype(np.int32),
        obs_point=table[:, 0].astype(np.int32), obs_xy=table[:, 2:],
    )  # fmt: skip


def self_calibrated(name, seed):
    """χ² of the free parameters with the covariance of the adjustment, their number, and sigma0."""
    rng, model, camera = np.random.default_rng(seed), camera_model(name), true_camera(name)
    truth = surround(camera, rng)
    free = [k for k, p in enumerate(model.parameters) if p.default == "free"]
    values = camera.values.copy()
    values[free] *= [1.005 if model.parameters[k].name == "focal_px" else 0.5 for k in free]
    values[1:3] = camera.values[1:3]
    start = replace(
        truth, cameras=(replace(camera, values=values),),
        rotations=np.stack([matrix_from_vector(rng.normal(0.0, 0.005, 3)) @ r for r in truth.rotations]),
        centres=truth.centres + rng.normal(0.0, 0.01, truth.centres.shape),
        points=truth.points + rng.normal(0.0, 0.01, truth.points.shape),
        obs_xy=truth.obs_xy + rng.normal(0.0, NOISE_PX, truth.obs_xy.shape),
    )  # fmt: skip
    found = adjust_block(start, Freedom(interior=(tuple(model.names[k] for k in free),)))
    assert found.converged
    if not free:
        return 0.0, 0, found.sigma0_px
    error = (found.block.cameras[0].values - camera.values)[free]
    cofactor = np.asarray(found.covariance.cameras[0])[np.ix_(free, free)] / found.sigma0_px**2
    scale = 1.0 / np.sqrt(np.diag(cofactor))
    normal = np.linalg.inv(cofactor * scale[:, None] * scale)
    return float((scale * error) @ normal @ (scale * error)) / NOISE_PX**2, len(free), found.sigma0_px


def test_errors_of_every_model_fit_their_covariance():
    results = {name: self_calibrated(name, seed) for seed, name in enumerate(camera_models())}
    for name, (total, count, sigma0) in results.items():
        assert sigma0 == pytest.approx(NOISE_PX, rel=0.06), name
        if count:
            low, high = chi2.ppf([1e-4, 1 - 1e-4], count)
            assert low < total < high, (name, total, count)
    total, count = (sum(r[i] for r in results.values()) for i in (0, 1))
    assert chi2.ppf(0.005, count) < total < chi2.ppf(0.995, count), (total, count)
