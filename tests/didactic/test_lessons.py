"""Every lesson that the program points to exists, and says nothing the program would refuse."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib import resources
from pathlib import Path

import matplotlib.mathtext
import pytest

import graphos_core
import graphos_didactic
from graphos_core.cameras.model import camera_models
from graphos_core.errors import GraphosError, UserError
from graphos_core.registry import STAGES, algorithms, find
from graphos_didactic.explain import camera_lesson, explain_algorithm, explain_parameter, lesson_about
from graphos_didactic.lesson_pictures import OWN
from graphos_didactic.lessons import (
    NUMBER,
    Lesson,
    camera_table,
    find_lesson,
    lessons,
    parameter_table,
    read_lesson,
    trial_sheet,
)
from graphos_didactic.simulator import find_simulator, simulators

ALL = sorted(lessons())
LEARN = re.compile(rf'(?:learn=|LESSON = |^ +)"((?:{"|".join(STAGES)})/[a-z0-9-]+)"', re.MULTILINE)


def named() -> Iterator[str]:
    """Lessons named by algorithms, parameters and simulators."""
    for algorithm in algorithms():
        yield algorithm.learn
        for declaration in algorithm.params.declarations().values():
            yield declaration.about.learn
    for simulator in simulators():
        yield simulator.learn
        for declaration in simulator.params.declarations().values():
            yield declaration.about.learn


def named_in_sources() -> set[str]:
    """Lessons named anywhere in the source, so those of errors as well."""
    found: set[str] = set()
    for package in (graphos_core, graphos_didactic):
        for file in Path(str(package.__file__)).parent.rglob("*.py"):
            found |= set(LEARN.findall(file.read_text("utf-8")))
    return found


def test_every_lesson_that_is_named_exists() -> None:
    wanted = {name for name in named() if name} | named_in_sources()
    assert len(wanted) > 20
    assert not wanted - set(lessons())


def test_every_algorithm_has_a_lesson() -> None:
    assert not [a.name for a in algorithms() if lesson_about(a) is None]


@pytest.mark.parametrize("name", ALL)
def test_a_lesson_has_what_a_lesson_needs(name: str) -> None:
    lesson = find_lesson(name)
    assert lesson.title
    assert lesson.formula
    assert lesson.fails
    assert "**When it fails.**" in lesson.text
    assert "*Source: " in lesson.text
    assert 100 <= len(lesson.text.split()) <= 260
    assert lesson.summary.endswith(".")


@pytest.mark.parametrize("name", ALL)
def test_every_directive_of_a_lesson_is_known(name: str) -> None:
    def picture(simulator: str, preset: str) -> str:
        if simulator in OWN:
            assert OWN[simulator](preset).marks
        else:
            find_simulator(simulator).described(preset)
        return "picture"

    text = find_lesson(name).markdown(picture)
    assert ":::" not in text
    assert "{{" not in text


@pytest.mark.parametrize("name", ALL)
def test_every_trial_of_a_lesson_is_valid_and_changes_something(name: str) -> None:
    lesson = find_lesson(name)
    for trial in lesson.trials:
        sheet = trial_sheet(lesson, trial)
        assert sheet is not None
        assert sheet.from_dict(trial.values) != sheet(), trial.what
    if lesson.simulator:
        find_simulator(lesson.simulator)


@pytest.mark.parametrize("name", ALL)
def test_every_formula_of_a_lesson_can_be_set(name: str) -> None:
    lesson = find_lesson(name)
    inside = re.findall(r"\$\$(.+?)\$\$|(?<!\$)\$([^$]+)\$(?!\$)", lesson.text, re.DOTALL)
    formulas = [line for line in lesson.formula.splitlines() if line.strip()]
    formulas += [(a or b).strip() for a, b in inside]
    parser = matplotlib.mathtext.MathTextParser("path")
    for formula in formulas:
        parser.parse(f"${formula}$")


@pytest.mark.parametrize("name", ALL)
def test_every_link_of_a_lesson_leads_somewhere(name: str) -> None:
    for kind, target in re.findall(r"\]\((\w+):([^)]+)\)", find_lesson(name).text):
        if kind == "lesson":
            find_lesson(target)
        else:
            assert kind == "simulator"
            find_simulator(target)


def test_numbers_in_a_lesson_are_those_of_the_declaration() -> None:
    for lesson in lessons().values():
        for stage, algorithm, parameter, _ in NUMBER.findall(lesson.text):
            declaration = find(stage, algorithm).params.declarations()[parameter]
            text = lesson.markdown(lambda *_: "")
            value = declaration.default
            assert (f"{value:g}" if isinstance(value, float) else str(value)) in text


def test_the_table_of_parameters_has_a_row_for_each() -> None:
    rows = parameter_table("preprocessing", "wallis").splitlines()
    assert len(rows) == 2 + len(find("preprocessing", "wallis").params.declarations())


def test_only_lessons_are_in_the_folder_of_lessons() -> None:
    folder = resources.files("graphos_resources") / "lessons"
    files = {f"{room.name}/{f.name}" for room in folder.iterdir() if room.is_dir() for f in room.iterdir()}
    assert files == {f"{name}.md" for name in ALL}


@pytest.mark.parametrize(
    ("source", "why"),
    [
        ("no head", "+++"),
        ("+++\nformula = ''\n+++\ntext", "title"),
        ("+++\ntitle = \n+++\ntext", "line 2"),
        ("+++\ntitle = 'a'\ntry = [1]\n+++\ntext", "read"),
    ],
)
def test_a_broken_lesson_is_refused_with_its_name(source: str, why: str) -> None:
    with pytest.raises(UserError) as refused:
        read_lesson("features/broken", source)
    assert "features/broken" in str(refused.value)
    assert why in str(refused.value)


def test_an_unknown_directive_is_refused() -> None:
    with pytest.raises(UserError, match="directive"):
        Lesson("features/x", "x", ":::film a\n").markdown(lambda *_: "")


def test_an_explanation_offers_only_what_fits_the_algorithm() -> None:
    for algorithm in algorithms():
        explained = explain_algorithm(algorithm)
        assert explained.what
        assert explained.lesson in lessons()
        for trial in explained.trials:
            algorithm.params.from_dict(trial.values)
        for name in algorithm.params.declarations():
            for trial in explain_parameter(algorithm, name).trials:
                assert name in trial.values
                algorithm.params.from_dict(trial.values)


def test_a_parameter_set_of_a_picture_is_read_and_a_wrong_one_refused() -> None:
    simulator = find_simulator("adjustment/coplanarity")
    assert simulator.described("fold=0,count=20") == simulator.params.from_dict({"fold": 0.0, "count": 20})
    assert simulator.described("") == simulator.params()
    assert simulator.described("flat") == simulator.preset("flat")
    for wrong in ("fold=99", "foold=1", "flatt"):
        with pytest.raises(GraphosError):
            simulator.described(wrong)


@pytest.mark.parametrize("name", sorted(camera_models()))
def test_the_table_of_a_camera_model_names_every_kind_of_parameter_and_can_be_set(name: str) -> None:
    model = camera_models()[name]
    table = camera_table(name)
    assert model.direction in table
    parser = matplotlib.mathtext.MathTextParser("path")
    inside = re.findall(r"\$\$(.+?)\$\$|(?<!\$)\$([^$\n]+)\$(?!\$)", table)
    assert len(inside) >= len(model.formula.split(r",\quad ")) + 3
    for formula in inside:
        parser.parse(f"${(formula[0] or formula[1]).strip()}$")
    assert f"${model.parameters[-1].symbol}$" in table


def test_every_kind_of_camera_model_has_a_lesson_with_its_table() -> None:
    told = {found for lesson in lessons().values() for found in re.findall(r":::camera (\w+)", lesson.text)}
    kinds = {
        "pinhole",
        "basic",
        "radial",
        "brown",
        "complete",
        "ebner",
        "polynomial3",
        "fisheye_equisolid",
        "spherical",
    }
    assert kinds <= told


@pytest.mark.parametrize(
    ("model", "lesson"),
    [
        ("complete", "camera-complete"),
        ("polynomial6", "camera-polynomial"),
        ("fisheye_equidistant", "camera-fisheye"),
        ("brown_backward", "camera-brown"),
        ("radial", "camera-radial"),
    ],
)
def test_a_camera_model_leads_to_its_lesson(model: str, lesson: str) -> None:
    assert model in camera_models()
    assert camera_lesson(model) == f"adjustment/{lesson}"
    assert camera_lesson("nonsense") == ""
