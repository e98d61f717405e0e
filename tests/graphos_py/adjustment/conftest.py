"""Jobs that end with each test, and a result with everything in it."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtWidgets import QApplication

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.data import Camera, CheckPoints, Finding, Georeference, Significance
from graphos_core.results import AdjustmentResult
from graphos_core.simulation.model import NoiseParams, theoretical_model
from graphos_core.simulation.objects import ObjectParams, cube
from graphos_core.simulation.templates import OrbitalParams, place
from graphos_py.app import make_application
from graphos_py.jobs import Jobs
from graphos_py.theme import theme


@pytest.fixture(scope="session")
def qapp() -> QApplication:
    app = make_application()
    theme().apply("light")
    return app


@pytest.fixture
def jobs(qapp: QApplication) -> Iterator[Jobs]:
    made = Jobs()
    yield made
    assert made.stop_all(), "a thread did not end"


@pytest.fixture(scope="session")
def result() -> AdjustmentResult:
    """An adjusted theoretical block with everything its statistics say, one blunder in it, and findings."""
    camera = Camera(
        model="basic",
        width=1600,
        height=1200,
        values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]),
        label="C",
    )
    stations = place("orbital", OrbitalParams(axis_x=9, axis_y=9, axis_z=6, equators=1, per_equator=6))
    model = theoretical_model(
        stations, camera, cube(ObjectParams(count=80)), NoiseParams(sigma_px=0.3), seed=2
    )
    block = model.as_block()
    xy = np.array(block.obs_xy)
    xy[40] += [6.0, -8.0]
    block = replace(block, obs_xy=xy, obs_sigma_px=np.full(len(xy), 0.3))
    free = Freedom(interior=(("focal_px", "x0", "y0", "k1", "k2"),))
    adjustment = adjust_block(block, free, Options(reliability=True))
    names = ("C1", "C2")
    check = CheckPoints(
        names=names,
        residuals=np.full((2, 3), 0.003),
        sigmas=np.full((2, 3), 0.001),
        given_sigmas=np.zeros((2, 3)),
    )
    findings = (
        Finding(severity="info", what="All is known."),
        Finding(
            severity="error", what="A blunder.", todo="Measure again.", learn="x/y", items=(block.names[1],)
        ),
    )
    significance = (
        Significance(camera=0, parameter="k2", value=0.02, sigma=0.02, t=1.0, limit=2.0, significant=False,
                     correlation=-0.95, correlated_with="k1"),
    )  # fmt: skip
    adjustment = replace(adjustment, check=check, findings=findings, significance=significance)
    georeference = Georeference(
        method="control points", scale=1.0, rotation=np.eye(3), translation=np.zeros(3), names=names,
        check=np.array([True, True]), residuals=np.full((2, 3), 0.003), rms_m=float("nan"), check_rms_m=0.003,
        origin=np.zeros(3),
    )  # fmt: skip
    return AdjustmentResult(adjustment=adjustment, georeference=georeference)
