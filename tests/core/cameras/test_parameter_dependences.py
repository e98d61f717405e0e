"""What a model leaves free can be told from f, x0, y0 and the rotation; what it holds fixed cannot, as it says."""

import numpy as np
import pytest

from graphos_core.cameras import camera_model, camera_models, derivatives, ray_from_pixel
from graphos_core.cameras.chain import without_distortion
from graphos_core.cameras.conversion import format_grid


def weakest(camera, names):
    """Smallest singular value of the effects, each of length 1, of parameters and a rotation over the format."""
    rays = ray_from_pixel(camera, format_grid(camera))
    rays = rays[np.isfinite(rays[:, 0])]
    _, by_point, by_values = derivatives(camera, rays)
    turns = [by_point @ np.cross(axis, rays)[:, :, None] for axis in np.eye(3)]
    chosen = [by_values[:, :, camera_model(camera.model).index(n)] for n in names]
    columns = np.stack([c.ravel() for c in (*chosen, *turns)], axis=1)
    return np.linalg.svd(columns / np.linalg.norm(columns, axis=0), compute_uv=False)[-1]


@pytest.mark.parametrize("name", sorted(camera_models()))
def test_free_terms_are_no_combination_of_interior_and_rotation(name, typical):
    model = camera_model(name)
    camera = without_distortion(typical(name))
    free = [p.name for p in model.parameters if p.default == "free"]
    interior = weakest(camera, [n for n in free if n in ("focal_px", "x0", "y0")])
    assert weakest(camera, free) > 3e-3
    assert interior > 0.02


def test_what_is_tied_or_fixed_would_be_nearly_or_exactly_dependent(typical):
    panorama = typical("spherical")
    assert weakest(panorama, []) > 0.3
    assert weakest(panorama, ["x0"]) < 1e-9  # a turn about the vertical
    complete = typical("complete")
    values = np.array(complete.values)
    values[3:5] = 0.0
    values[6:] = 0.0  # k1 alone
    radial = type(complete)(model="complete", width=1600, height=1200, values=values)
    free = ["focal_px", "x0", "y0", "k1", "p1", "p2"]
    assert weakest(radial, [*free, "x1", "y1"]) < 0.02 * weakest(radial, free)
    opencv = without_distortion(typical("opencv"))
    assert weakest(opencv, ["focal_px", "k1", "k4"]) < 1e-9  # numerator and denominator, to first order


@pytest.mark.parametrize("term", ["scale", "turn", "tilt"])
def test_the_terms_left_out_of_the_polynomials_are_those_of_interior_and_rotation(term, typical):
    camera = without_distortion(typical("polynomial3"))
    rays = ray_from_pixel(camera, format_grid(camera))
    _, by_point, by_values = derivatives(camera, rays)
    model = camera_model("polynomial3")
    own = [by_values[:, :, k].ravel() for k, p in enumerate(model.parameters) if p.group == "polynomial"]
    if term == "scale":
        extra = by_values[:, :, 0].ravel()
    else:
        axis = np.eye(3)[2 if term == "turn" else 0]
        extra = (by_point @ np.cross(axis, rays)[:, :, None]).ravel()
        if term == "tilt":  # less its constant part, which is y0
            extra = extra - by_values[:, :, 2].ravel() * extra.reshape(-1, 2)[:, 1].mean()
    columns = np.stack(own, axis=1)
    left = extra - columns @ np.linalg.lstsq(columns, extra, rcond=None)[0]
    assert np.linalg.norm(left) > 0.3 * np.linalg.norm(extra)
