"""What the simulator of networks shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.cameras import camera_model
from graphos_didactic.simulator import find_simulator
from graphos_didactic.simulators.adjustment.network_model import CAMERA, Network
from graphos_didactic.simulators.adjustment.network_params import NetworkParams


def test_errors_scatter_as_the_covariance_says() -> None:
    params = NetworkParams(tilt=35.0, roll=0.0, depth=1.0, photos=5)
    names = ("focal_px", "x0", "y0", "k1", "p1")
    truth = Network(params)
    drawn = (Network(params.replace(seed=s)) for s in range(50))
    errors = np.array([[network.error(name) for name in names] for network in drawn])
    for i, name in enumerate(names):
        assert errors[:, i].std() == pytest.approx(truth.sigmas[name], rel=0.35), name
        assert abs(errors[:, i].mean()) < 4 * truth.sigmas[name] / np.sqrt(len(errors)), name
    found = np.corrcoef(errors.T)[1, 4]
    assert found == pytest.approx(truth.correlation("x0", b="p1"), abs=0.2)


def test_parallel_views_of_a_plane_determine_neither_focal_length_nor_anything_that_imitates_it() -> None:
    simulator = find_simulator("adjustment/network")
    scene = simulator.scene(simulator.preset("flat"))
    assert not np.isfinite(scene.numbers()["σ of f"].value)
    assert "do not determine" in scene.says


def test_what_a_book_says_about_networks() -> None:
    upright, tilted = (Network(NetworkParams(tilt=t, roll=0.0)) for t in (5.0, 45.0))
    assert abs(upright.correlation("focal_px", 5)) > 0.99
    assert abs(tilted.correlation("focal_px", 5)) < 0.8
    assert tilted.sigmas["focal_px"] < 0.1 * upright.sigmas["focal_px"]
    rolled = Network(NetworkParams(tilt=20.0, roll=90.0))
    assert rolled.sigmas["x0"] < 0.6 * Network(NetworkParams(tilt=20.0, roll=0.0)).sigmas["x0"]


def test_the_corner_effect_of_the_principal_point_is_its_standard_deviation() -> None:
    network = Network(NetworkParams(tilt=35.0, roll=90.0))
    assert network.effects["x0"] == pytest.approx(network.sigmas["x0"], rel=1e-6)
    assert camera_model(CAMERA.model).names[0] == "focal_px"
