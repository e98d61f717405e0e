"""Published adjustments: the smallest DBAT case, and BAL Ladybug-49."""

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.covariance import cofactors
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.problem import Freedom, make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.errors import UserError
from graphos_core.exchange.bal import FREE, read_bal
from graphos_core.exchange.dbat import read_photomodeler
from graphos_core.exchange.dbat_report import read_stations
from graphos_core.geometry.rotation import matrix_from_vector, opk_from_matrix

pytestmark = pytest.mark.data
BAL = "bal/problem-49-7776-pre.txt"


def f_op0(data_dir):
    folder = data_dir / "dbat" / "prague2016_sxb"
    export = folder / "pmexports" / "f-op0-with-orient-pmexport.txt"
    block = read_photomodeler(export, export.with_name("f-op0-with-orient-2dpts.txt"))
    return block, read_stations(folder / "dbatexports" / "f-op0-with-orient-dbatreport.txt")


def sigma_opk(adjusted, n):
    """Standard deviations of omega, phi, kappa of photo n, propagated from the small rotations about its axes."""
    problem = make_problem(
        adjusted.block, Freedom(fixed_points=np.ones(len(adjusted.block.points), dtype=bool))
    )
    system = ReducedSystem(problem, Rules(0, 1.0, True), 1)
    with system.working():
        reduced = cofactors(system, problem.scene).reduced
    column = problem.layout.photo_column[n]
    rotation = adjusted.block.rotations[n]
    slopes = [np.subtract(opk_from_matrix(matrix_from_vector(h) @ rotation),
                          opk_from_matrix(matrix_from_vector(-h) @ rotation)) / 2e-6 for h in 1e-6 * np.eye(3)]  # fmt: skip
    small = reduced[column : column + 3, column : column + 3]
    return adjusted.sigma0_px * np.sqrt(np.diag(np.transpose(slopes) @ small @ slopes))


@pytest.mark.parametrize("shake", [0.0, 0.01])
def test_dbat_f_op0_sigma0_redundancy_and_orientations(data_dir, shake):
    block, stations = f_op0(data_dir)
    rng = np.random.default_rng(0)
    shaken = [matrix_from_vector(rng.normal(0, shake, 3)) @ r for r in block.rotations]
    start = block.__class__(**{**vars(block), "rotations": np.array(shaken),
                               "centres": block.centres + rng.normal(0, 1000 * shake, (5, 3))})  # fmt: skip
    adjusted = adjust_block(start, Freedom(fixed_points=np.ones(16, dtype=bool)))
    assert adjusted.sigma0_px == pytest.approx(1.0419, abs=5e-5)
    assert (adjusted.observations, adjusted.unknowns, adjusted.redundancy) == (94, 30, 64)
    assert adjusted.datum == "16 fixed points"
    assert [s.photo for s in stations] == list(adjusted.block.names)
    for n, station in enumerate(stations):
        assert np.allclose(opk_from_matrix(adjusted.block.rotations[n]), station.opk, atol=np.radians(2e-5))
        assert np.allclose(adjusted.block.centres[n], station.centre, atol=1e-3)
        assert np.allclose(adjusted.sigma_centres[n], station.sigma_centre, rtol=5e-3)
        assert np.allclose(sigma_opk(adjusted, n), station.sigma_opk, rtol=5e-3)


def test_bal_cost_at_the_start_is_the_published_one(data_dir):
    block = read_bal(data_dir / BAL)
    assert (len(block.names), len(block.points), len(block.obs_xy)) == (49, 7776, 31843)
    start = adjust_block(block, options=Options(max_iterations=0, statistics=False, guard=False))
    assert start.iterations[0].cost == pytest.approx(850912.46, abs=0.005)
    assert 0.5 * (start.residuals**2).sum() == pytest.approx(850912.46, abs=0.005)


def test_bal_ladybug_reaches_the_published_cost(data_dir):
    block = read_bal(data_dir / BAL)
    options = Options(max_iterations=10, statistics=False, guard=False)
    adjusted = adjust_block(block, Freedom(interior=(FREE,) * 49), options)
    assert adjusted.iterations[-1].cost < 1.3410e4
    for camera in adjusted.block.cameras:
        assert camera.values[1] == camera.values[2] == 0.0


def test_what_is_not_bal_is_refused_with_a_sentence(tmp_path, data_dir):
    whole = (data_dir / BAL).read_text()
    for text in ("", "hello", "1 1 1\n0 0 1.0", whole[: len(whole) // 2], whole.replace("\n48 ", "\n77 ", 1)):
        path = tmp_path / "problem.txt"
        path.write_text(text)
        with pytest.raises(UserError, match="not a BAL problem"):
            read_bal(path)
