"""Labs with a test field, and labs in which control points are chosen: played by a student, against the truth."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from graphos_core.data import CheckPoints, Control
from graphos_core.errors import UserError
from graphos_core.exchange.control import read_control
from graphos_core.run import Run
from graphos_didactic.lab_calibration import tilt_deg
from graphos_didactic.lab_check import check
from graphos_didactic.lab_figures import FIGURES
from graphos_didactic.lab_session import SURVEY_SIGMA_M, LabSession, hand_in, key_page, surveyed_control
from graphos_didactic.labs import Step, read_lab

TARGET_LAB = """title = "T"
goal = "G"
minutes = 10
target = { target = "chessboard", columns = 8, rows = 5, square_mm = 25.0, photos = 8, width = 480, height = 360 }

[[step]]
kind = "predict"
title = "Guess"
text = "x"
figure = "calibrated_f"

[[step]]
kind = "calibrate"
title = "All"
text = "x"
photos = "all"

[[step]]
kind = "compare"
title = "True?"
text = "x"
figure = "calibrated_f"

[[step]]
kind = "calibrate"
title = "Facing"
text = "x"
photos = "facing"

[[step]]
kind = "measure"
title = "Ratio"
text = "x"
figure = "facing_sigma_ratio"
"""
BLOCK = 'block = { template = "facade", photos = 4, width = 320, height = 240 }'


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> LabSession:
    """A student who has calibrated with all photos and with those that face the board."""
    session = LabSession(read_lab("target", TARGET_LAB), "Anna", tmp_path_factory.mktemp("lab ä"))
    run = Run(threads=2)
    session.prepare(run)
    assert session.answer(0, "500", None).passed
    assert session.answer(1, "", None, run).passed
    assert session.answer(3, "", None, run).passed
    return session


def test_the_calibration_of_a_student_agrees_with_the_students_own_truth(played: LabSession) -> None:
    outcome = played.answer(2, "", None)
    assert outcome.passed
    assert "You predicted 500." in outcome.text
    bench = played.bench()
    assert bench is not None and bench.truth is not None
    assert f"true {bench.truth.focal_px:.6g}" in outcome.text


def test_facing_photos_determine_the_principal_distance_worse(played: LabSession) -> None:
    bench = played.bench()
    assert bench is not None
    whole, facing = bench.report("all"), bench.report("facing")
    assert whole is not None and facing is not None
    assert len(facing["orientation"]["photos"]) == 4
    used = {p["name"]: tilt_deg(p["omega_phi_kappa_deg"]) for p in whole["orientation"]["photos"]}
    assert max(used[p["name"]] for p in facing["orientation"]["photos"]) == sorted(used.values())[3]
    ratio = facing["cameras"][0]["parameters"][0]["sigma"] / whole["cameras"][0]["parameters"][0]["sigma"]
    assert ratio > 2.0
    assert played.answer(4, f"{ratio:.2f}", None).passed
    assert not played.answer(4, f"{1.3 * ratio:.2f}", None).passed


def test_two_students_have_two_cameras_and_progress_resumes(played: LabSession, tmp_path: Path) -> None:
    other = LabSession(played.lab, "Ben", tmp_path)
    assert other.seed != played.seed
    again = LabSession.resume(played.lab, played.folder)
    assert again.passed == played.passed
    bench, kept = played.bench(), again.bench()
    assert bench is not None and kept is not None and bench.truth is not None and kept.truth is not None
    assert np.array_equal(kept.truth.values, bench.truth.values)


def test_hand_in_and_key_of_a_lab_with_a_test_field(played: LabSession) -> None:
    page = hand_in(played, None)
    assert "data:image/png;base64," in page
    assert "columns = 8" in page
    bench = played.bench()
    assert bench is not None and bench.truth is not None
    assert f"truth {bench.truth.focal_px:.6g}" in dict(key_page(played, None))["True?"]


def test_own_photos_have_no_truth_and_are_not_judged_by_it(played: LabSession, tmp_path: Path) -> None:
    own = LabSession(played.lab, "Zoë", tmp_path)
    own.own = {"photos": str(played.simulation / "photos"), "target": "chessboard", "columns": 8, "rows": 5,
               "square_mm": 25.0}  # fmt: skip
    own.prepare(Run())
    assert not own.simulation.exists()
    assert own.answer(1, "", None, Run(threads=2)).passed
    outcome = own.answer(2, "", None)
    assert outcome.passed
    assert "Nobody knows the truth" in outcome.text
    assert LabSession.resume(own.lab, tmp_path).own == own.own


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (('photos = "facing"', 'photos = "facin"'), "Did you mean “facing”"),
        (('photos = "facing"', ""), "line 24"),
        (('figure = "calibrated_f"', 'figure = "sigma0"'), "line 6"),
        (("columns = 8", "columns = 1"), "Columns: 1"),
        (("photos = 8", "photos = 2"), "needs 3"),
        (('target = "chessboard"', 'target = "chess"'), "chess"),
        (('kind = "calibrate"\ntitle = "All"', 'kind = "do"\nstage = "features"\ntitle = "All"'), "line 12"),
        (("target = {", "rahmen = {"), "target"),
    ],
)
def test_a_broken_lab_with_a_test_field_is_refused(change: tuple[str, str], says: str) -> None:
    assert change[0] in TARGET_LAB
    with pytest.raises(UserError) as refused:
        read_lab("broken", TARGET_LAB.replace(*change, 1))
    assert says in str(refused.value)


def test_calibrating_needs_a_test_field() -> None:
    broken = TARGET_LAB.replace(TARGET_LAB.splitlines()[3], BLOCK).replace(
        'figure = "calibrated_f"', 'figure = "k1"'
    )
    with pytest.raises(UserError, match="needs a lab with a target"):
        read_lab("broken", broken.replace('figure = "facing_sigma_ratio"', 'figure = "k1"'))


# ------------------------------------------------------------------------------------------------ control points


class Chosen:
    """Stands for a pipeline whose project has nine control points, some of them control."""

    def __init__(self, control: list[int], checked: CheckPoints | None = None) -> None:
        xyz = np.array([[x, y, 0.0] for y in range(3) for x in range(3)], dtype=float)
        role = np.ones(9, dtype=bool)
        role[control] = False
        made = Control(names=tuple(f"P{i}" for i in range(9)), xyz=xyz, check=role, origin=np.zeros(3))
        self.project = SimpleNamespace(control=lambda: (made, None))
        self._result = SimpleNamespace(adjustment=SimpleNamespace(check=checked))

    def result(self, stage: str) -> Any:
        return self._result if stage == "adjustment" else None


WIDE = Step("choose", "t", "x", control=3, check=4, spread_at_least=0.6)
CLOSE = Step("choose", "t", "x", control=3, check=4, spread_at_most=0.5)


@pytest.mark.parametrize(
    ("step", "control", "passes", "says"),
    [
        (WIDE, [0, 2, 6], True, "P0, P2, P6"),
        (WIDE, [0, 8], False, "3 control points are needed"),
        (WIDE, [0, 1, 2, 3, 5, 6, 7, 8], False, "4 check points are needed"),
        (WIDE, [0, 1, 3], False, "at least 60 %"),
        (CLOSE, [0, 1, 3], True, "span 50 %"),
        (CLOSE, [0, 2, 6], False, "at most 50 %"),
    ],
)
def test_a_choice_of_control_points_is_judged(
    step: Step, control: list[int], passes: bool, says: str
) -> None:
    outcome = check(step, "", Chosen(control), None)  # type: ignore[arg-type]
    assert outcome.passed is passes
    assert says in outcome.text


def test_accuracy_over_precision_is_one_when_errors_have_their_standard_deviations() -> None:
    rng = np.random.default_rng(3)
    sigmas, given = rng.uniform(1e-3, 5e-3, (400, 3)), np.full((400, 3), 2e-3)
    errors = np.hypot(sigmas, given) * rng.standard_normal((400, 3))
    checked = CheckPoints(
        names=tuple(f"C{i}" for i in range(400)), residuals=errors, sigmas=sigmas, given_sigmas=given
    )
    pipeline: Any = Chosen([0, 2, 6], checked)
    ratio = FIGURES["check_ratio"](pipeline, None)
    assert ratio is not None
    assert ratio.value == pytest.approx(1.0, abs=3.0 / np.sqrt(2 * 1200))
    assert ratio.sigma == pytest.approx(1.0 / np.sqrt(2 * 9))  # three control points
    accuracy = FIGURES["check_accuracy"](pipeline, None)
    assert accuracy is not None and accuracy.value == pytest.approx(1000 * np.sqrt((errors**2).mean()))


def test_the_surveyor_states_the_noise_that_is_in_the_coordinates(tmp_path: Path) -> None:
    exact = tmp_path / "control.csv"
    names = [f"T{i:03d}" for i in range(300)]
    exact.write_text(
        "name,x [m],y [m],z [m],role\n" + "".join(f"{n},{i}.0,2.0,3.0,control\n" for i, n in enumerate(names))
    )
    (tmp_path / "control_measurements.csv").write_text("photo,name,x [px],y [px]\na.jpg,T000,1.5,2.5\n")
    control, measured = read_control(surveyed_control(exact, tmp_path / "surveyed.csv", 5))
    assert control is not None and measured is not None
    assert control.check.all()
    errors = control.xyz - np.column_stack([np.arange(300.0), np.full(300, 2.0), np.full(300, 3.0)])
    assert errors.std() == pytest.approx(SURVEY_SIGMA_M, rel=0.1)
    assert control.sigma is not None and np.all(control.sigma == SURVEY_SIGMA_M)
    assert measured.sigma_px is not None and measured.sigma_px[0] == 0.1
