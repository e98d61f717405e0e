"""The form says what the declarations say, and gives back what was put in."""

from typing import Annotated, Literal

import pytest
from PySide6.QtCore import Qt

from graphos_core.params import About, Params
from graphos_core.registry import algorithms
from graphos_py.form import Form


class Sheet(Params):
    mean: Annotated[
        float, About(label="Mean", help="Brightness.", unit="grey level", low=0, high=255, step=1)
    ] = 127.0
    window: Annotated[int, About(label="Window", help="Side.", unit="px", low=3, high=99)] = 31
    robust: Annotated[bool, About(label="Robust", help="Whether.")] = True
    kind: Annotated[Literal["a", "b"], About(label="Kind", help="Which.", choices={"a": "first"})] = "a"
    name: Annotated[str, About(label="Name", help="Free text.")] = ""
    point: Annotated[tuple[float, float], About(label="Point", help="Where.", unit="px")] = (1.0, 2.0)
    limit: Annotated[float | None, About(label="Limit", help="Automatic when empty.", low=0)] = None
    easy: Annotated[int, About(label="Easy", help="For all.", level="novice")] = 1
    hard: Annotated[int, About(label="Hard", help="For experts.", level="expert", group="Fine")] = 1


CHANGED = Sheet(
    mean=100.5, window=11, robust=False, kind="b", name="x", point=(-3.25, 1e-7), limit=4.0, easy=2, hard=3
)


@pytest.fixture
def form(qtbot) -> Form:
    made = Form(Sheet())
    qtbot.addWidget(made)
    made.show()
    return made


def type_into(qtbot, form: Form, name: str, text: str) -> None:
    line = form.row(name).field.widget.lineEdit()
    line.selectAll()
    qtbot.keyClick(line, Qt.Key.Key_Delete)
    qtbot.keyClicks(line, text)


def test_a_sheet_comes_back_as_it_was_put_in(form):
    form.set_sheet(CHANGED)
    assert {name: form.row(name).field.value() for name in Sheet.declarations()} == {
        name: getattr(CHANGED, name) for name in Sheet.declarations()
    }
    assert form.sheet() == CHANGED


@pytest.mark.parametrize("algorithm", algorithms(), ids=lambda a: f"{a.stage}.{a.name}")
def test_every_algorithm_has_a_form_that_gives_its_defaults_back(qtbot, algorithm):
    made = Form(algorithm.params(), "expert")
    qtbot.addWidget(made)
    assert {n: made.row(n).field.value() for n in algorithm.params.declarations()} == {
        n: getattr(algorithm.params(), n) for n in algorithm.params.declarations()
    }
    assert made.problems() == {}


def test_a_wrong_value_shows_its_sentence_and_keeps_the_last_right_sheet(qtbot, form):
    type_into(qtbot, form, "mean", "300")
    row = form.row("mean")
    assert row.problem.text() == "Mean: 300 grey level, needs 0 to 255"
    assert row.problem.isVisible()
    assert row.field.widget.property("wrong") == "true"
    assert form.sheet().mean != 300
    with qtbot.waitSignal(form.changed):
        type_into(qtbot, form, "mean", "200")
    assert form.problems() == {}
    assert not row.problem.isVisible()
    assert form.sheet().mean == 200.0


def test_other_fields_stay_usable_beside_a_wrong_one(qtbot, form):
    type_into(qtbot, form, "mean", "x")
    type_into(qtbot, form, "window", "41")
    assert set(form.problems()) == {"mean"}
    type_into(qtbot, form, "mean", "5")
    assert (form.sheet().mean, form.sheet().window) == (5.0, 41)


def test_the_dot_marks_a_changed_value_and_resets_it(qtbot, form):
    dot = form.row("window").dot
    assert not dot.isVisible()
    type_into(qtbot, form, "window", "41")
    assert dot.isVisible()
    assert "31 px" in dot.toolTip()
    qtbot.mouseClick(dot, Qt.MouseButton.LeftButton)
    assert form.sheet().window == 31
    assert not dot.isVisible()


def test_the_level_decides_what_is_folded(form):
    visible = lambda: {n for n in Sheet.declarations() if form.row(n).field.widget.isVisible()}  # noqa: E731
    assert "hard" not in visible() and "mean" in visible()
    form.set_level("novice")
    assert visible() == {"easy"}
    form.set_level("expert")
    assert visible() == set(Sheet.declarations())


def test_arrows_step_by_the_declared_step_and_stop_at_the_end(form):
    box = form.row("mean").field.widget
    form.set_sheet(Sheet(mean=254.5))
    box.stepBy(3)
    assert form.sheet().mean == 255.0


def test_an_empty_optional_field_means_automatic(qtbot, form):
    form.set_sheet(CHANGED)
    type_into(qtbot, form, "limit", " ")
    assert form.sheet().limit is None


def test_the_focused_parameter_is_told(qtbot, form):
    with qtbot.waitSignal(form.focused) as told:
        type_into(qtbot, form, "window", "9")
    assert told.args == ["window"]
