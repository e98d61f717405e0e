"""Profiles, grids and their uncertainty are those of the formula, and bands hold what they promise."""

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.cameras import camera_model, camera_models, pixel_from_ray, ray_from_pixel
from graphos_core.cameras.profile import (
    balanced_profile,
    decentring_profile,
    distortion_grid,
    largest_effects,
    projection_covariance,
    radial_profile,
)
from graphos_core.data import Camera

F = 1500.0
K = (-0.12, 0.05, -0.01)
P = (1e-3, -7e-4)


def brown(**given):
    values = {"focal_px": F, "x0": 805.0, "y0": 592.0, "k1": K[0], "k2": K[1], "k3": K[2]}
    values |= {"p1": P[0], "p2": P[1]} | given
    names = camera_model("brown").names
    return Camera(
        model="brown", width=1600, height=1200, values=np.array([values.get(n, 0.0) for n in names])
    )


def covariance():
    """A covariance as blocks have it: f, k1, k2, k3 and x0, p1 strongly correlated."""
    rng = np.random.default_rng(3)
    mix = rng.normal(size=(11, 8))
    sigma = np.array([0.5, 0.4, 0.4, 2e-3, 6e-3, 6e-3, 0.0, 2e-5, 2e-5, 1e-5, 1e-5])
    corr = mix @ mix.T
    d = np.sqrt(np.diag(corr))
    return corr / np.outer(d, d) * np.outer(sigma, sigma)


def test_the_gaussian_profile_is_the_polynomial():
    found = radial_profile(brown())
    r = found.radius_px
    assert r[0] == 0.0 and r[-1] == pytest.approx(np.hypot(805.0, 608.0))
    expected = K[0] * r**3 / F**2 + K[1] * r**5 / F**4 + K[2] * r**7 / F**6
    assert np.allclose(found.displacement_px, expected, rtol=0, atol=1e-9)
    assert found.focal_px == F and found.sigma_px is None


def test_the_balanced_profile_is_zero_where_it_should_and_describes_the_same_camera():
    r = np.linspace(0.0, 900.0, 31)
    gaussian, balanced = (
        radial_profile(brown(), radius_px=r),
        balanced_profile(brown(), zero_px=600.0, radius_px=r),
    )
    assert balanced.displacement_px[20] == pytest.approx(0.0, abs=1e-12)
    q = r**2 / F**2
    q0 = 600.0**2 / F**2
    expected = r * (K[0] * (q - q0) + K[1] * (q**2 - q0**2) + K[2] * (q**3 - q0**3))  # Wester-Ebbinghaus
    assert np.allclose(balanced.displacement_px, expected, rtol=0, atol=1e-9)
    tangent = r / F
    same = balanced.focal_px * tangent + balanced.displacement_px
    assert np.allclose(same, F * tangent + gaussian.displacement_px, rtol=0, atol=1e-9)
    zero = 2 / 3 * 1000.0  # of the half diagonal, by default
    moved = radial_profile(brown(), radius_px=np.array([zero])).displacement_px[0]
    assert balanced_profile(brown()).focal_px == pytest.approx(F * (1.0 + moved / zero), abs=1e-9)


def test_the_decentring_profile_is_browns():
    found = decentring_profile(brown())
    assert np.allclose(found.displacement_px, np.hypot(*P) * found.radius_px**2 / F, rtol=0, atol=1e-9)


def test_bands_are_the_spread_of_cameras_drawn_from_the_covariance():
    spread, camera = covariance(), brown()
    r = np.linspace(50.0, 900.0, 8)
    curves = {
        f: f(camera, spread, radius_px=r) for f in (radial_profile, decentring_profile, balanced_profile)
    }
    rng = np.random.default_rng(5)
    drawn = rng.multivariate_normal(camera.values, spread, 400)
    for function, curve in curves.items():
        sample = [  # at the same direction of the ray: r/f is kept
            function(replace(camera, values=v), radius_px=r * v[0] / F, **(
                {"zero_px": 2 / 3 * 1000.0 * v[0] / F} if function is balanced_profile else {}
            )).displacement_px
            for v in drawn
        ]  # fmt: skip
        ratio = np.std(sample, axis=0) / curve.sigma_px
        assert np.allclose(ratio, 1.0, atol=0.12), (function.__name__, ratio)
        low, high = curve.band(1.96)
        inside = np.mean((np.array(sample) > low) & (np.array(sample) < high))
        assert 0.93 < inside < 0.97


def test_a_vanishing_decentring_still_has_a_spread():
    found = decentring_profile(brown(p1=0.0, p2=0.0), covariance(), radius_px=np.array([600.0]))
    assert found.displacement_px[0] == pytest.approx(0.0, abs=1e-12)
    assert found.sigma_px[0] == pytest.approx(2e-5 * 600.0**2 / F, rel=0.6)


def test_the_grid_moves_rays_as_the_camera_does():
    camera = brown()
    grid = distortion_grid(camera, (9, 7))
    assert grid.ideal_px[0, 0].tolist() == [-0.5, -0.5] and grid.ideal_px[-1, -1].tolist() == [1599.5, 1199.5]
    flat = (grid.ideal_px.reshape(-1, 2) - camera.values[1:3]) / F
    rays = np.concatenate([flat, np.ones((63, 1))], axis=1)
    assert np.allclose(grid.measured_px.reshape(-1, 2), pixel_from_ray(camera, rays), rtol=0, atol=1e-8)


def test_projection_uncertainty_is_the_spread_of_projections():
    camera, spread = brown(), covariance()
    pixels, found = projection_covariance(camera, spread, (3, 3))
    rays = ray_from_pixel(camera, pixels.reshape(-1, 2))
    drawn = np.random.default_rng(6).multivariate_normal(camera.values, spread, 500)
    sample = np.array([pixel_from_ray(replace(camera, values=v), rays) for v in drawn])
    for i, expected in enumerate(found.reshape(-1, 2, 2)):
        assert np.allclose(np.cov(sample[:, i].T), expected, atol=0.2 * np.trace(expected))


def test_effects_are_those_of_moving_one_parameter():
    camera = brown()
    steps = np.array([0.5, 0.4, 0.3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-5, 1e-5])
    found = largest_effects(camera, steps)
    corner = ray_from_pixel(
        camera, np.array([[-0.5, -0.5], [1599.5, -0.5], [-0.5, 1199.5], [1599.5, 1199.5]])
    )
    for k, name in enumerate(camera_model("brown").names):
        moved = pixel_from_ray(replace(camera, values=camera.values + steps[k] * np.eye(11)[k]), corner)
        largest = np.linalg.norm(moved - pixel_from_ray(camera, corner), axis=1).max()
        assert found[name] == pytest.approx(largest, rel=0.02)


@pytest.mark.parametrize("name", sorted(camera_models()))
def test_every_model_has_profiles(name, typical):
    camera = typical(name, strong=True)
    spread = np.diag([(p.prior_sigma or 0.01 * p.usual) ** 2 for p in camera_model(name).parameters])
    for curve in (
        radial_profile(camera, spread),
        balanced_profile(camera, spread),
        decentring_profile(camera, spread),
    ):
        seen = np.isfinite(curve.displacement_px)
        assert seen[:40].all()  # of 101, up to the corner or the edge of the sphere
        assert (curve.sigma_px[seen] >= 0.0).all()
    assert np.isfinite(distortion_grid(camera).measured_px).mean() > 0.65
