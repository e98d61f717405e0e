"""Independent programs project to the same pixels: OpenCV, COLMAP, and Brown's corrections written out."""

import cv2
import numpy as np
import pytest

from graphos_core.cameras import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.cameras.kernels import project
from graphos_core.data import Camera

F, X0, Y0 = 1500.0, 805.0, 592.0
POINTS = np.random.default_rng(1).uniform([-0.6, -0.45, 0.9], [0.6, 0.45, 1.6], (200, 3))


def camera(name, **given):
    model = camera_model(name)
    values = {"focal_px": F, "x0": X0, "y0": Y0, "base_px": 800.0} | given
    assert set(given) <= set(model.names)
    return Camera(
        model=name, width=1600, height=1200, values=np.array([values.get(n, 0.0) for n in model.names])
    )


def matrix(b1=0.0):
    return np.array([[F * (1 + b1), 0.0, X0], [0.0, F, Y0], [0.0, 0.0, 1.0]])


def test_opencv_projects_to_the_same_pixels():
    names = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")
    values = (-0.12, 0.05, 1e-3, -7e-4, -0.01, 0.03, -0.02, 0.01, 2e-4, -3e-4, 1e-4, 2e-4)
    theirs, _ = cv2.projectPoints(POINTS, np.zeros(3), np.zeros(3), matrix(1e-3), np.array(values))
    ours = pixel_from_ray(camera("opencv", b1=1e-3, **dict(zip(names, values, strict=True))), POINTS)
    assert np.abs(ours - theirs[:, 0]).max() < 1e-9
    five = np.array(values[:5])
    theirs, _ = cv2.projectPoints(POINTS, np.zeros(3), np.zeros(3), matrix(1e-3), five)
    brown = camera("brown", k1=five[0], k2=five[1], k3=five[4], p1=five[3], p2=five[2], b1=1e-3)
    assert np.abs(pixel_from_ray(brown, POINTS) - theirs[:, 0]).max() < 1e-9


def test_opencv_fisheye_is_the_equidistant_model_with_its_polynomial():
    k = np.array([0.03, -0.01, 0.004, -0.001])
    points = POINTS * [3.0, 3.0, 1.0]
    theirs, _ = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), matrix(1e-3), k)
    ours = camera("fisheye_equidistant", k1=k[0], k2=k[1], k3=k[2], k4=k[3], b1=1e-3)
    assert np.abs(pixel_from_ray(ours, points) - theirs[:, 0]).max() < 1e-9


@pytest.mark.parametrize(
    ("colmap", "parameters", "ours"),
    [
        ("SIMPLE_RADIAL", [F, X0, Y0, -0.1], camera("basic", k1=-0.1)),
        ("RADIAL", [F, X0, Y0, -0.1, 0.04], camera("radial", k1=-0.1, k2=0.04)),
        (
            "OPENCV",
            [F * 1.001, F, X0, Y0, -0.1, 0.04, 1e-3, -5e-4],
            camera("brown", k1=-0.1, k2=0.04, p1=-5e-4, p2=1e-3, b1=1e-3),
        ),
        (
            "OPENCV",
            [F, F, X0, Y0, -0.1, 0.04, 1e-3, -5e-4],
            camera("complete", k1=-0.1, k2=0.04, p1=-5e-4, p2=1e-3),
        ),
        (
            "FULL_OPENCV",
            [F, F, X0, Y0, -0.1, 0.04, 1e-3, -5e-4, -0.01, 0.02, -0.01, 0.005],
            camera("opencv", k1=-0.1, k2=0.04, p1=1e-3, p2=-5e-4, k3=-0.01, k4=0.02, k5=-0.01, k6=0.005),
        ),
        (
            "OPENCV_FISHEYE",
            [F, F, X0, Y0, 0.03, -0.01, 0.004, -0.001],
            camera("fisheye_equidistant", k1=0.03, k2=-0.01, k3=0.004, k4=-0.001),
        ),
    ],
    ids=lambda v: v if isinstance(v, str) else "",
)
def test_colmap_projects_to_the_same_pixels(colmap, parameters, ours):
    pycolmap = pytest.importorskip("pycolmap")
    theirs = pycolmap.Camera(model=colmap, width=1600, height=1200, params=parameters)
    assert np.abs(pixel_from_ray(ours, POINTS) - theirs.img_from_cam(POINTS)).max() < 1e-9


def test_the_complete_model_shifts_the_centre_of_distortion():
    """Fraser's terms written out about a shifted centre."""
    u, v = POINTS[:, 0] / POINTS[:, 2], POINTS[:, 1] / POINTS[:, 2]
    s, t = u - 20.0 / F, v + 10.0 / F
    r2 = s**2 + t**2
    radial = -0.1 * r2 + 0.05 * r2**2 - 0.02 * r2**3
    x = F * (u + s * radial + 1e-3 * (r2 + 2 * s**2) - 2 * 5e-4 * s * t + 2e-3 * u - 1e-3 * v) + X0
    y = F * (v + t * radial - 5e-4 * (r2 + 2 * t**2) + 2 * 1e-3 * s * t) + Y0
    ours = camera(
        "complete", x1=20.0, y1=-10.0, k1=-0.1, k2=0.05, k3=-0.02, p1=1e-3, p2=-5e-4, b1=2e-3, b2=-1e-3
    )
    assert np.abs(pixel_from_ray(ours, POINTS) - np.stack([x, y], axis=1)).max() < 1e-9


def test_a_shift_of_the_distortion_centre_is_decentring_to_first_order():
    """Why x1, y1 are tied: p = −k1 c/f replaces a shift c, and f, x0, y0 take the rest."""
    c = 3.0
    shifted, replaced = camera("complete", x1=c, k1=-0.1), camera("complete", k1=-0.1, p1=0.1 * c / F)
    difference = pixel_from_ray(shifted, POINTS) - pixel_from_ray(replaced, POINTS)
    plain = pixel_from_ray(shifted, POINTS) - pixel_from_ray(camera("complete", k1=-0.1), POINTS)
    assert np.abs(difference).max() < 0.01 * np.abs(plain).max()


def test_backward_corrections_are_added_to_the_measured_position():
    """The kernel's inner iteration inverts Brown's corrections exactly, also where first order is 10 px wrong."""
    ours = camera("brown_backward", k1=0.2, k2=-0.05, p1=1e-3, p2=-5e-4, b1=4e-4)
    pixels = pixel_from_ray(ours, POINTS)
    s, t = (1 + 4e-4) * (pixels[:, 0] - X0) / F, (pixels[:, 1] - Y0) / F
    r2 = s**2 + t**2
    u = s + s * (0.2 * r2 - 0.05 * r2**2) + 1e-3 * (r2 + 2 * s**2) - 2 * 5e-4 * s * t
    v = t + t * (0.2 * r2 - 0.05 * r2**2) - 5e-4 * (r2 + 2 * t**2) + 2 * 1e-3 * s * t
    assert np.abs(np.stack([u, v], axis=1) - POINTS[:, :2] / POINTS[:, 2:]).max() * F < 1e-9
    first_order = pixel_from_ray(camera("brown", k1=-0.2, k2=0.05, p1=-1e-3, p2=5e-4, b1=-4e-4), POINTS)
    assert np.abs(first_order - pixels).max() > 10.0


def test_ebner_is_orthogonal_to_the_interior_and_a_tilt_on_its_nine_points():
    """On the 3 × 3 grid every term is orthogonal to constants, scale, turn and the quadratic part of a tilt."""
    x, y = (a.ravel() for a in np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]))
    grid = np.stack([x * 800.0 / F, y * 800.0 / F, np.ones(9)], axis=1)
    plain = pixel_from_ray(camera("ebner"), grid)
    one, zero = np.ones(9), np.zeros(9)
    taken = [(one, zero), (zero, one), (x, y), (-y, x), (x * x - 2 / 3, x * y), (x * y, y * y - 2 / 3)]
    for i in range(1, 13):
        effect = pixel_from_ray(camera("ebner", **{f"e{i}": 1.0}), grid) - plain
        for dx, dy in taken:
            assert abs(effect[:, 0] @ dx + effect[:, 1] @ dy) < 1e-9


def test_the_panorama_has_its_directions_where_they_belong():
    panorama = Camera(model="spherical", width=1600, height=800, values=np.array([800 / np.pi, 799.5, 399.5]))
    right, behind, up = np.array([[1.0, 0, 0]]), np.array([[1e-9, 0, -1.0]]), np.array([[1e-9, -1.0, 0.0]])
    assert np.allclose(pixel_from_ray(panorama, right), [[799.5 + 400.0, 399.5]])
    assert np.allclose(pixel_from_ray(panorama, behind), [[1599.5, 399.5]])
    assert np.allclose(pixel_from_ray(panorama, up)[0, 1], -0.5)
    assert np.allclose(ray_from_pixel(panorama, np.array([[799.5 - 400.0, 399.5]])), [[-1.0, 0.0, 0.0]])


def test_colmaps_panorama_has_the_same_positions_all_round():
    pycolmap = pytest.importorskip("pycolmap")
    theirs = pycolmap.Camera(model="EQUIRECTANGULAR", width=1600, height=800, params=[1600.0, 800.0])
    points = np.random.default_rng(2).normal(size=(100, 3))
    values = np.array([800 / np.pi, 800.0, 400.0])
    ours = Camera(model="spherical", width=1600, height=800, values=values)
    assert np.abs(pixel_from_ray(ours, points) - theirs.img_from_cam(points)).max() < 1e-9


def test_the_equisolid_fisheye_maps_equal_solid_angles_to_equal_areas():
    """Rings of the sphere between 0° and 110°, each of solid angle 2π (cos θ1 − cos θ2)."""
    lens = Camera(
        model="fisheye_equisolid", width=1600, height=1200, values=np.array([500.0, 800.0, 600.0, *[0.0] * 8])
    )
    theta = np.radians(np.linspace(0.0, 110.0, 12))
    rays = np.stack([np.sin(theta), np.zeros(12), np.cos(theta)], axis=1)
    area = np.pi * np.diff((pixel_from_ray(lens, rays)[:, 0] - 800.0) ** 2)
    assert np.allclose(area / (2.0 * np.pi * -np.diff(np.cos(theta))), 500.0**2, rtol=1e-10)


def test_a_position_beyond_the_seam_of_a_panorama_is_compared_with_the_near_one():
    model = camera_model("spherical")
    values = np.array([800 / np.pi, 799.5, 399.5])
    point = np.array([0.02, 0.1, -1.0])  # just left of the seam
    pixel, slope, inner = np.empty(2), np.empty((2, 3)), np.empty((2, 3))

    def compared(v, measured):
        pixel[:] = measured
        assert project(model.residual_code, v, *point, pixel, slope, inner)
        return pixel.copy()

    plain = pixel_from_ray(Camera(model="spherical", width=1600, height=800, values=values), point[None])[0]
    assert plain[0] > 1590.0
    assert np.allclose(compared(values, plain), plain)
    assert np.allclose(compared(values, [-3.0, plain[1]]), plain - [1600.0, 0.0])
    h = np.array([1e-4, 0.0, 0.0])
    numeric = (compared(values + h, [-3.0, plain[1]]) - compared(values - h, [-3.0, plain[1]])) / 2e-4
    compared(values, [-3.0, plain[1]])
    assert np.allclose(inner[:, 0], numeric, rtol=1e-6)
