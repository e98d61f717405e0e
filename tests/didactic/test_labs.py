"""Labs: broken ones are refused, answers are judged by their precision, progress and hand-in are safe."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from graphos_core.errors import UserError
from graphos_core.recipe import Recipe
from graphos_core.report import data_hash
from graphos_didactic import lab_check
from graphos_didactic.lab_check import check, parse_number, rounding
from graphos_didactic.lab_figures import FIGURES, Figure
from graphos_didactic.lab_session import LabSession, hand_in, key_page
from graphos_didactic.labs import Lab, labs, read_lab, read_lab_folder, student_seed
from graphos_didactic.lessons import find_lesson
from graphos_didactic.simulator import find_simulator

HEAD = """title = "T"
goal = "G"
minutes = 10
block = { template = "facade", photos = 4, width = 320, height = 240 }
"""
GOOD = (
    HEAD
    + """
[[step]]
kind = "read"
title = "Read"
text = "x"

[[step]]  # with a remark
kind = "predict"
title = "Guess"
text = "x"
figure = "focal_px"
hints = ["one", "two"]

[[step]]
kind = "measure"
title = "Measure"
text = "x"
figure = "focal_px"

[[step]]
kind = "compare"
title = "Compare"
text = "x"
figure = "focal_px"

[[step]]
kind = "explain"
title = "Explain"
text = "x"
words = 3
"""
)


@dataclass
class Photo:
    digest: str = "abc"


class Photos:
    photos = (Photo(), Photo("def"))


class OfPhotos:
    photo_set = Photos()


class Results:
    """Stands for a pipeline with results."""

    photos = Photos()
    project = OfPhotos()
    recipe = Recipe.default(0)

    def result(self, stage: str) -> None:
        return None


@pytest.fixture
def lab() -> Lab:
    return read_lab("good", GOOD)


@pytest.fixture
def results(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A pipeline whose principal distance is 1000.0 ± 0.2 px, truly 1000.5 px."""
    figure = Figure("principal distance", 1000.0, 0.2, "px", 1000.5)
    monkeypatch.setitem(FIGURES, "focal_px", lambda pipeline, truth: figure)
    monkeypatch.setattr(
        "graphos_core.report.model_picture.report_pictures", lambda p: {"model": "", "residuals": ""}
    )
    return Results()


# ------------------------------------------------------------------------------------------------ writing labs


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("minutes = 10", "minutes = "), "line 3"),
        (('kind = "predict"', 'kind = "guess"'), "line 11"),
        (('figure = "focal_px"', 'figure = "focal"'), "line 11"),
        (("words = 3", ""), "line 30"),
        (("words = 3", 'words = "three"'), "line 30"),
        (('hints = ["one", "two"]', "hints = [1, 2]"), "line 11"),
        (('title = "Guess"', 'titel = "Guess"'), "Did you mean “title”"),
        (('goal = "G"', ""), "goal"),
        (("minutes = 10", 'minutes = "ten"'), "minutes"),
        (('template = "facade"', 'template = "castle"'), "castle"),
        (("photos = 4", "photos = 0"), "photos"),
        (("width = 320,", ""), "width"),
    ],
)
def test_a_broken_lab_is_refused_with_the_line(change: tuple[str, str], says: str) -> None:
    with pytest.raises(UserError) as refused:
        read_lab("broken", GOOD.replace(*change, 1))
    assert "broken" in str(refused.value)
    assert says in str(refused.value)


def test_a_folder_without_a_lab_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"lab\.toml"):
        read_lab_folder(tmp_path)


def test_a_lab_of_an_instructor_is_read_from_its_folder(tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text(GOOD, "utf-8")
    assert len(read_lab_folder(tmp_path).steps) == 5


def test_the_labs_of_the_program_have_all_that_a_lab_needs() -> None:
    rooms = {name: {s.stage for s in lab.steps if s.kind == "do"} for name, lab in labs().items()}
    assert rooms["from-photos-to-a-model"] == {"preprocessing", "features", "adjustment", "dense", "quality"}
    assert rooms["georeference-and-prove-it"] == {"preprocessing", "features", "adjustment"}
    assert labs()["calibrate-your-camera"].target and not rooms["calibrate-your-camera"]
    for lab in labs().values():
        done = "calibrate" if lab.target else "do"
        assert {"predict", done, "measure", "compare", "explain"} <= {s.kind for s in lab.steps}
        for step in lab.steps:
            assert len(step.hints) == 2 or step.kind == "read"
            if step.lesson:
                find_lesson(step.lesson)
            if step.simulator:
                find_simulator(step.simulator)


# ---------------------------------------------------------------------------------------------------- judging


@pytest.mark.parametrize(
    ("answer", "passes"),
    [("1000.0", True), ("1000.59", True), ("999,45", True), ("1000.61", False), ("999.3", False), ("999", False),
     ("abc", False), ("nan", False), ("", False), ("1 000.1", True)],
)  # fmt: skip
def test_a_measurement_passes_within_three_sigma(lab: Lab, results: Any, answer: str, passes: bool) -> None:
    assert check(lab.steps[2], answer, results, None).passed is passes


def test_the_rounding_of_an_answer_is_allowed_but_not_a_coarse_one(
    lab: Lab, results: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(FIGURES, "focal_px", lambda p, t: Figure("sigma0", 0.1441, 0.001, "px"))
    assert check(lab.steps[2], "0.14", results, None).passed
    assert not check(lab.steps[2], "0", results, None).passed
    assert not check(lab.steps[2], "0.2", results, None).passed


def test_a_comparison_passes_within_three_sigma_of_the_truth(
    lab: Lab, results: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert check(lab.steps[3], "", results, None).passed
    monkeypatch.setitem(FIGURES, "focal_px", lambda p, t: Figure("f", 1000.0, 0.1, "px", 1000.5))
    outcome = check(lab.steps[3], "", results, None)
    assert not outcome.passed
    assert "5.0 σ" in str(outcome.text)
    monkeypatch.setitem(FIGURES, "focal_px", lambda p, t: Figure("f", 1000.0, 0.1, "px"))
    assert not check(lab.steps[3], "", results, None).passed


def test_a_prediction_is_never_wrong_and_words_are_counted(lab: Lab, results: Any) -> None:
    assert check(lab.steps[1], "7", results, None).passed
    assert not check(lab.steps[1], "seven", results, None).passed
    assert not check(lab.steps[4], "two words", results, None).passed
    assert check(lab.steps[4], "these are three", results, None).passed


def test_numbers_are_read_with_comma_and_spaces() -> None:
    assert parse_number(" 1\u2009234,5 ") == 1234.5
    assert parse_number("inf") is None
    assert rounding("12.30") == pytest.approx(0.005)


# --------------------------------------------------------------------------------------------------- students


def test_the_seed_belongs_to_student_and_lab() -> None:
    assert student_seed("Anna  Maier", "a") == student_seed(" anna maier ", "a") == 15_995_731
    assert student_seed("Anna Maier", "a") != student_seed("Anna Maier", "b")
    assert len({student_seed(f"student {i}", "a") for i in range(200)}) == 200


def test_progress_resumes(lab: Lab, results: Any, tmp_path: Path) -> None:
    begun = LabSession(lab, "Zoë", tmp_path)
    assert begun.answer(0, "", results).passed
    begun.answer(1, "1003", results)
    begun.keep(2, "12")
    assert begun.hint(1) == "one"
    assert begun.hint(1) == begun.hint(1) == "two"
    again = LabSession.resume(lab, tmp_path)
    assert (again.student, again.passed, again.answers, again.hints) == (
        "Zoë", {0, 1}, {0: "", 1: "1003", 2: "12"}, {1: 2},
    )  # fmt: skip
    assert again.current == 2


def test_a_changed_answer_is_open_again_and_a_prediction_stays(
    lab: Lab, results: Any, tmp_path: Path
) -> None:
    begun = LabSession(lab, "Zoë", tmp_path)
    begun.answer(1, "1003", results)
    begun.keep(1, "1000")
    assert begun.answers[1] == "1003"
    begun.answer(2, "1000.0", results)
    begun.keep(2, "900")
    assert 2 not in begun.passed


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"lab": "other"}', '{"lab": "good", "student": 1, "answers": 3}']
)
def test_damaged_progress_is_refused(lab: Lab, tmp_path: Path, text: str) -> None:
    (tmp_path / "lab.json").write_text(text, "utf-8")
    with pytest.raises(UserError):
        LabSession.resume(lab, tmp_path)


def test_steps_that_no_longer_exist_are_forgotten(lab: Lab, tmp_path: Path) -> None:
    document = {"lab": "good", "student": "A", "answers": {"77": "x"}, "passed": [0, 77], "hints": {}}
    (tmp_path / "lab.json").write_text(json.dumps(document), "utf-8")
    assert LabSession.resume(lab, tmp_path).passed == {0}


# ---------------------------------------------------------------------------------------------------- hand-in


def test_the_hand_in_escapes_what_students_type(lab: Lab, results: Any, tmp_path: Path) -> None:
    begun = LabSession(lab, "<script>alert(1)</script>", tmp_path)
    begun.answer(1, "1003", results)
    begun.keep(4, "<img src=x onerror=alert(2)> & more")
    page = hand_in(begun, results)
    assert "<script" not in page
    assert "<img src=x" not in page
    assert "&lt;script&gt;" in page
    assert "predicted 1003" in page
    assert data_hash(results.photos) in page
    assert str(begun.seed) in page


def test_the_key_is_computed_from_results_and_truth(lab: Lab, results: Any, tmp_path: Path) -> None:
    key = dict(key_page(LabSession(lab, "A", tmp_path), results))
    assert set(key) == {"Guess", "Measure", "Compare"}
    assert key["Compare"] == "1000.00 ± 0.20 px; truth 1000.5"


def test_figures_without_results_are_missing_not_wrong(lab: Lab) -> None:
    for name, source in FIGURES.items():
        assert source(Results(), None) is None, name  # type: ignore[arg-type]
    assert not check(lab.steps[2], "1", Results(), None).passed  # type: ignore[arg-type]
    assert lab_check.answer_key(lab, Results(), None)[0][1] == "not computed yet"  # type: ignore[arg-type]


def test_a_wrong_number_is_not_answered_with_the_right_one(lab: Lab, results: Any) -> None:
    step = next(s for s in lab.steps if s.kind == "measure")
    wrong = check(step, "990", results, None)
    assert not wrong.passed
    assert "Too small" in str(wrong.text)
    assert "1000" not in str(wrong.text) and "10 " not in str(wrong.text)


def test_a_number_may_carry_its_unit_and_typographic_signs(lab: Lab, results: Any) -> None:
    step = next(s for s in lab.steps if s.kind == "measure")
    for typed in ("1000.1 px", "1000,1px", "1\u202f000.1"):
        assert check(step, typed, results, None).passed
    assert not check(step, "1000.1 mm", results, None).passed


def test_a_result_that_was_predicted_is_shown_beside_the_prediction(
    lab: Lab, results: Any, tmp_path: Path
) -> None:
    session = LabSession(lab, "Anna", tmp_path)
    guess = next(i for i, s in enumerate(lab.steps) if s.kind == "predict")
    read = next(i for i, s in enumerate(lab.steps) if s.kind == "measure")
    session.answer(guess, "950", results)
    assert "You predicted 950." in str(session.answer(read, "1000.1", results).text)


def test_a_step_may_lead_to_the_images_but_they_are_not_run(lab: Lab) -> None:
    with_place = read_lab("good", GOOD.replace('kind = "predict"', 'kind = "predict"\nstage = "images"', 1))
    assert "images" in {s.stage for s in with_place.steps}
    broken = GOOD.replace('kind = "predict"', 'kind = "do"\nstage = "images"', 1)
    with pytest.raises(UserError, match="images"):
        read_lab("broken", broken)
