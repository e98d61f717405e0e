"""Every camera model: analytic derivatives are the numerical ones, and distortion can be undone over the format."""

from types import SimpleNamespace

import numpy as np
import pytest

from graphos_core.cameras import camera_model, camera_models, pixel_from_ray, ray_from_pixel
from graphos_core.cameras.kernels import MAX_VALUES, project
from graphos_core.cameras.projections import PROJECTIONS
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.text import Text

MODELS = sorted(camera_models())


def projected(code, values, point):
    pixel, slope, inner = np.empty(2), np.empty((2, 3)), np.empty((2, MAX_VALUES))
    assert project(code, values, *point, pixel, slope, inner)
    return pixel, slope, inner[:, : len(values)]


def points_of(model):
    rng = np.random.default_rng(0)
    points = rng.uniform([-0.5, -0.4, 0.8], [0.5, 0.4, 2.0], (20, 3))
    if model.wide:  # also sideways and behind
        points[10:, 2] = rng.uniform(-0.3, 0.3, 10)
    return points


@pytest.mark.parametrize("name", MODELS)
def test_analytic_derivatives_are_the_numerical_ones(name, typical):
    model, values = camera_model(name), typical(name).values.copy()
    for point in points_of(model):
        _, slope, inner = projected(model.code, values, point)
        for k in range(3):
            h = 1e-6 * np.eye(3)[k]
            plus, minus = (
                projected(model.code, values, point + h)[0],
                projected(model.code, values, point - h)[0],
            )
            assert np.allclose(slope[:, k], (plus - minus) / 2e-6, rtol=1e-7, atol=1e-4)
        for k in range(len(values)):
            h = 1e-5 * max(1.0, abs(values[k])) * np.eye(len(values))[k]
            numeric = (
                projected(model.code, values + h, point)[0] - projected(model.code, values - h, point)[0]
            )
            assert np.allclose(inner[:, k], numeric / (2 * h[k]), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", [n for n in MODELS if camera_models()[n].equations])
def test_the_generated_kernel_computes_the_equations_of_the_model(name, typical):
    camera = typical(name)
    model = camera_model(name)
    values = SimpleNamespace(**dict(zip(model.names, camera.values, strict=True)))
    points = points_of(model)
    ideal = PROJECTIONS[model.projection](np, *points.T)
    pixels = pixel_from_ray(camera, points)
    if model.backward:
        assert np.allclose(np.stack(model.equations(values, *pixels.T)), np.stack(ideal), rtol=0, atol=1e-13)
    else:
        assert np.allclose(pixels, np.stack(model.equations(values, *ideal), axis=1), rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", [n for n in MODELS if camera_models()[n].backward])
def test_residuals_in_the_corrected_picture_are_those_of_the_equations(name, typical):
    model, values = camera_model(name), typical(name).values.copy()

    def residual(v, point, measured):
        pixel, slope, inner = measured.copy(), np.empty((2, 3)), np.empty((2, MAX_VALUES))
        assert project(model.residual_code, v, *point, pixel, slope, inner)
        return pixel - measured, slope, inner[:, : len(v)]

    for point in points_of(model)[:6]:
        measured = projected(model.code, values, point)[0] + [0.7, -0.4]
        found, slope, inner = residual(values, point, measured)
        corrected = model.equations(SimpleNamespace(**dict(zip(model.names, values, strict=True))), *measured)
        assert np.allclose(found, values[0] * (point[:2] / point[2] - corrected), rtol=0, atol=1e-10)
        for k in range(3):
            h = 1e-6 * np.eye(3)[k]
            numeric = residual(values, point + h, measured)[0] - residual(values, point - h, measured)[0]
            assert np.allclose(slope[:, k], numeric / 2e-6, rtol=1e-7, atol=1e-4)
        for k in range(len(values)):
            h = 1e-5 * max(1.0, abs(values[k])) * np.eye(len(values))[k]
            numeric = residual(values + h, point, measured)[0] - residual(values - h, point, measured)[0]
            assert np.allclose(inner[:, k], numeric / (2 * h[k]), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("strong", [False, True])
def test_distortion_is_undone_over_the_whole_format(name, strong, typical):
    camera = typical(name, strong=strong)
    x, y = np.meshgrid(np.linspace(-0.5, 1599.5, 41), np.linspace(-0.5, 1199.5, 31))
    pixels = np.stack([x.ravel(), y.ravel()], axis=1)
    if camera_model(name).projection == "spherical":
        pixels = pixels[np.abs(pixels[:, 1] - 599.5) < 399.0]  # between the poles
    rays = ray_from_pixel(camera, pixels)
    assert np.abs(pixel_from_ray(camera, 3.7 * rays) - pixels).max() < 1e-8
    if camera_model(name).wide:
        assert np.allclose(np.linalg.norm(rays, axis=1), 1.0)
        assert (rays[:, 2].min() < 0.0) == strong or camera_model(name).projection == "spherical"
    else:
        assert (rays[:, 2] == 1.0).all()


@pytest.mark.parametrize("name", MODELS)
def test_a_point_where_the_model_has_no_direction_has_no_image(name, typical):
    camera = typical(name)
    behind = np.array([[0.1, 0.1, -1.0], [0.1, 0.1, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 0.0]])
    none = {"central": [0, 1, 2, 3], "spherical": [3]}.get(camera_model(name).projection, [2, 3])
    seen = np.isfinite(pixel_from_ray(camera, behind)).all(axis=1)
    assert np.flatnonzero(~seen).tolist() == none
    assert np.isfinite(pixel_from_ray(camera, np.array([[0.1, 0.1, 1.0], [0.0, 0.0, 1.0]]))).all()


@pytest.mark.parametrize("name", MODELS)
def test_derivatives_hold_on_the_viewing_axis_and_close_to_it(name, typical):
    model, values = camera_model(name), typical(name).values.copy()
    _, slope, inner = projected(model.code, values, np.array([0.0, 0.0, 2.0]))
    for offset in (1e-9, 1e-6):
        _, near, inner_near = projected(model.code, values, np.array([offset, -offset, 2.0]))
        assert np.allclose(near, slope, rtol=1e-4, atol=1e-3)
        assert np.allclose(inner_near, inner, atol=1e-2)


def test_a_pixel_beyond_the_fold_of_the_distortion_has_no_ray():
    def camera(values):
        return Camera(model="basic", width=1600, height=1200, values=np.array(values))

    folded = camera([1000.0, 800.0, 600.0, -0.5, 0.0])  # r (1 − r²/2) never exceeds 0.544
    assert np.isnan(ray_from_pixel(folded, np.array([[800.0 + 600.0, 600.0]]))).all()
    assert np.isfinite(ray_from_pixel(folded, np.array([[800.0 + 500.0, 600.0]]))).all()


def test_a_fisheye_pixel_outside_the_image_circle_has_no_ray():
    values = np.array([500.0, 800.0, 600.0, *[0.0] * 8])
    equisolid = Camera(model="fisheye_equisolid", width=1600, height=1200, values=values)
    inside, outside = ray_from_pixel(equisolid, np.array([[800.0 + 999.0, 600.0], [800.0 + 1001.0, 600.0]]))
    assert np.degrees(np.arccos(inside[2])) == pytest.approx(np.degrees(2 * np.arcsin(0.999)))
    assert np.isnan(outside).all()


def test_interior_comes_first_and_axes_point_right_and_down(typical):
    for name, model in camera_models().items():
        assert model.names[:3] == ("focal_px", "x0", "y0")
        assert len(model.names) == len(set(model.names)) <= MAX_VALUES
        camera = typical(name)
        centre, right, down = pixel_from_ray(camera, np.array([[0, 0, 1.0], [0.01, 0, 1], [0, 0.01, 1]]))
        assert np.allclose(centre, camera.values[1:3], atol=5.0)  # Ebner has a constant part
        assert right[0] > centre[0] and right[1] == pytest.approx(centre[1], abs=0.2)
        assert down[1] > centre[1] and down[0] == pytest.approx(centre[0], abs=0.2)


def test_every_term_that_is_not_free_says_why():
    for model in camera_models().values():
        for parameter in model.parameters:
            assert parameter.default in ("free", "fixed", "prior", "constant")
            assert bool(parameter.reason) == (parameter.default != "free")
            assert all(isinstance(text, Text) for text in (parameter.label, parameter.reason) if text)
            assert parameter.default != "prior" or parameter.prior_sigma
        assert model.dependences or len(model.parameters) == 3
        assert all(isinstance(sentence, Text) for sentence in model.dependences)


def test_formulas_and_symbols_can_be_drawn():
    from matplotlib.mathtext import MathTextParser

    parser = MathTextParser("path")
    for model in camera_models().values():
        assert model.direction.startswith("measured → ideal" if model.backward else "ideal → measured")
        assert model.source and model.label
        for text in (model.formula, *(p.symbol for p in model.parameters)):
            assert parser.parse(f"${text}$").width > 0


@pytest.mark.parametrize("name", ["pinhole", "brown", "polynomial7", "fisheye_equisolid"])
def test_a_camera_with_too_few_values_is_refused_before_compiled_code_sees_it(name, typical):
    short = Camera(model=name, width=1600, height=1200, values=typical(name).values[:-1])
    for use in (
        lambda: pixel_from_ray(short, np.ones((1, 3))),
        lambda: ray_from_pixel(short, np.ones((1, 2))),
    ):
        with pytest.raises(UserError, match="damaged"):
            use()


def test_an_unknown_model_is_refused_with_the_known_ones():
    with pytest.raises(UserError, match="pinhole"):
        camera_model("pinhol")
