"""What the simulator of the scale space shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.features.detectors.scale_space_extrema import EDGE, KEPT, WEAK
from graphos_didactic.simulator import Setting, find_simulator
from graphos_didactic.simulators.features.scale_space_model import BLOB, Looked, blob_scale
from graphos_didactic.simulators.features.scale_space_params import ScaleSpaceParams
from graphos_didactic.simulators.features.scale_space_tasks import PREDICTION


def at_blob(**values: object) -> Looked:
    return Looked(ScaleSpaceParams(noise=0.5, **values), Setting())  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [2.5, 5.0, 9.0])
@pytest.mark.parametrize("layers", [2, 3, 5])
def test_a_blob_answers_at_the_scale_of_its_size(size: float, layers: int) -> None:
    seen = at_blob(size=size, layers=layers)
    i = seen.chosen
    assert i is not None
    assert seen.extrema.verdict[i] == KEPT
    assert seen.found_size(i) == pytest.approx(size, rel=0.04)
    assert seen.scale_of(i) == pytest.approx(blob_scale(size, layers, 1.6), abs=0.08)
    np.testing.assert_allclose(seen.extrema.xy[i], BLOB, atol=0.2)


def test_the_curve_meets_the_extremum() -> None:
    seen = at_blob()
    i = seen.chosen
    assert i is not None
    u, d = seen.response.T
    assert u[np.abs(d).argmax()] == pytest.approx(seen.scale_of(i), abs=1 / 3)
    parabola = seen.parabola(i)
    best = parabola[np.abs(parabola[:, 1]).argmax()]
    assert best[0] == pytest.approx(seen.scale_of(i), abs=0.05)
    assert best[1] == pytest.approx(seen.extrema.value[i], rel=0.01)
    assert abs(seen.extrema.sample[i]) >= abs(seen.neighbour(i))


def test_faint_and_stretched_blobs_are_rejected_for_the_right_reason() -> None:
    simulator = find_simulator("features/scale_space")
    for preset, verdict in (("faint", WEAK), ("long", EDGE), ("blobs", KEPT)):
        params = simulator.preset(preset)
        assert isinstance(params, ScaleSpaceParams)
        seen = Looked(params, Setting())
        assert seen.chosen is not None
        assert seen.extrema.verdict[seen.chosen] == verdict


def test_keypoints_on_edges_do_not_come_again() -> None:
    simulator = find_simulator("features/scale_space")
    edges, blobs = (Looked(simulator.preset(name), Setting()) for name in ("edges", "blobs"))  # type: ignore[arg-type]
    assert edges.repeated < 0.6
    assert blobs.repeated > 0.7


def test_the_prediction_knows_octaves_layers_and_lost_points() -> None:
    answer = PREDICTION.answer
    assert answer(ScaleSpaceParams(size=3.0, noise=0.5), Setting()) == 2
    assert answer(ScaleSpaceParams(size=3.0, noise=0.5, strength=5.0), Setting()) == 3
    assert answer(ScaleSpaceParams(size=12.0, layers=5, noise=0.5), Setting()) == 1
