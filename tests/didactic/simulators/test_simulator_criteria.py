"""The fifteen criteria of a simulator, as far as a program can check them, for every declared simulator."""

from __future__ import annotations

import csv
import dataclasses
import importlib
import io
import pkgutil
import xml.etree.ElementTree as ET
from collections.abc import Iterator

import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.params import Params
from graphos_core.registry import STAGES
from graphos_didactic.scene import Handle, Number, Scene
from graphos_didactic.scene_colours import PALETTES, contrast
from graphos_didactic.scene_drawing import Look
from graphos_didactic.scene_svg import scene_svg
from graphos_didactic.simulator import (
    History,
    Setting,
    Simulator,
    Task,
    Verdict,
    drag,
    find_simulator,
    simulators,
)
from graphos_didactic.simulator_files import State, data_csv, read_state, state_text

EVERY = pytest.mark.parametrize("simulator", simulators(), ids=lambda s: s.key)
SEEDS = pytest.mark.parametrize("seed", [0, 1, 2, 7, 42])


def all_params(simulator: Simulator) -> Iterator[Params]:
    yield simulator.params()
    for preset in simulator.presets:
        yield simulator.preset(preset.name)


def content(scene: Scene) -> list[tuple[object, ...]]:
    """Everything a scene says, with arrays as bytes; functions of handles aside."""
    found: list[tuple[object, ...]] = [(scene.says, *(dataclasses.astuple(panel) for panel in scene.panels))]
    for mark in scene.marks:
        values = (getattr(mark, field.name) for field in dataclasses.fields(mark) if field.name != "move")
        plain = (v.tobytes() if isinstance(v, np.ndarray) else repr(v) for v in values)
        found.append((type(mark).__name__, *plain))
    return found


def same(a: Scene, b: Scene) -> bool:
    return content(a) == content(b)


def test_simulators_are_found_in_the_order_of_the_workflow_and_of_their_places() -> None:
    found = simulators()
    order = [(STAGES.index(s.room), s.place, s.name) for s in found]
    assert order == sorted(order)
    keys = [s.key for s in found]
    assert len(set(keys)) == len(keys)
    assert {"preprocessing/wallis", "features/epipolar", "adjustment/intersection"} <= set(keys)
    assert [s.key for s in simulators("adjustment")] == [k for k in keys if k.startswith("adjustment/")]
    with pytest.raises(UserError, match="adjustment/intersection"):
        find_simulator("adjustment/intersektion")


@EVERY
def test_1_something_is_dragged_in_the_picture_and_changes_it(simulator: Simulator) -> None:
    params = simulator.params()
    scene = simulator.scene(params)
    assert scene.handles
    for handle in scene.handles:
        moved = drag(params, handle, handle.at[0] + 8 * handle.nudge[0], handle.at[1] + 8 * handle.nudge[1])
        assert moved != params, handle.name
        changed = {n for n in params.declarations() if getattr(moved, n) != getattr(params, n)}
        assert changed <= set(handle.parameters), handle.name


@EVERY
def test_handles_stay_within_the_declared_limits(simulator: Simulator) -> None:
    for params in all_params(simulator):
        for handle in simulator.scene(params).handles:
            for x, y in ((1e6, 1e6), (-1e6, 1e6), (-1e6, -1e6), (0.0, 0.0)):
                drag(params, handle, x, y)  # would raise ParamError outside


@EVERY
def test_a_handle_that_is_dragged_ends_under_the_pointer(simulator: Simulator) -> None:
    params = simulator.params()
    for handle in simulator.scene(params).handles:
        if handle.freedom in ("turn", "slide"):  # these stay on a circle, a line or a surface
            continue
        goal = handle.at[0] + 3 * handle.nudge[0], handle.at[1] + 3 * handle.nudge[1]
        after = simulator.scene(drag(params, handle, *goal))
        found = next(h for h in after.handles if h.name == handle.name)
        if handle.freedom in ("both", "x"):
            assert found.at[0] == pytest.approx(goal[0], abs=0.51 * abs(handle.nudge[0]) + 1e-6), handle.name
        if handle.freedom in ("both", "y"):
            assert found.at[1] == pytest.approx(goal[1], abs=0.51 * abs(handle.nudge[1]) + 1e-6), handle.name


@EVERY
def test_3_the_first_thing_to_try_is_one_line(simulator: Simulator) -> None:
    assert 10 < len(simulator.first) <= 90
    assert "\n" not in simulator.first


@EVERY
def test_4_a_thing_is_shown_in_several_panels_and_named(simulator: Simulator) -> None:
    scene = simulator.scene(simulator.params())
    assert len(scene.panels) >= 2
    shown: dict[str, set[str]] = {}
    for mark in scene.marks:
        if mark.thing:
            assert mark.thing in scene.things
            shown.setdefault(mark.thing, set()).add(mark.panel)
    assert sum(len(panels) >= 2 for panels in shown.values()) >= 3
    names = {panel.name for panel in scene.panels}
    assert {mark.panel for mark in scene.marks} <= names


@EVERY
def test_5_the_prediction_is_answered_by_the_engine_and_hides_the_answer(simulator: Simulator) -> None:
    prediction, params = simulator.prediction, simulator.params()
    assert 2 <= len(prediction.choices) <= 5
    assert prediction.answer(params, Setting()) in range(len(prediction.choices))
    assert prediction.change(params) != params
    assert any(character.isdigit() for character in prediction.explain(params, Setting()))
    scene = simulator.scene(params)
    assert len(scene.visible(truth=True, answers=False)) < len(scene.visible(truth=True, answers=True))


def test_5_the_predictions_have_answers_that_depend_on_the_situation() -> None:
    for key, other in (("features/epipolar", "rotation"), ("preprocessing/wallis", "strict")):
        simulator = find_simulator(key)
        answer = simulator.prediction.answer
        assert answer(simulator.params(), Setting()) != answer(simulator.preset(other), Setting())


def judge(task: Task, answer: Params | float) -> Verdict:
    if isinstance(answer, Params):
        return task.check(answer, None)
    return task.check(task.start, answer)


@EVERY
@SEEDS
def test_6_the_challenge_accepts_what_is_right(simulator: Simulator, seed: int) -> None:
    task = simulator.challenge(seed)
    assert judge(task, task.solution).right
    assert simulator.challenge(seed).text == task.text
    assert set(task.free) <= set(task.start.declarations())


@EVERY
@SEEDS
def test_6_the_challenge_names_the_misconception_behind_typical_wrong_answers(
    simulator: Simulator, seed: int
) -> None:
    task = simulator.challenge(seed)
    assert len(task.mistakes) >= 2
    for name, answer in task.mistakes.items():
        verdict = judge(task, answer)
        assert not verdict.right, name
        assert verdict.misconception == name


@EVERY
def test_6_another_seed_is_another_instance(simulator: Simulator) -> None:
    assert len({simulator.challenge(seed).start for seed in range(4)}) == 4


@EVERY
def test_6_the_state_to_start_from_is_no_answer(simulator: Simulator) -> None:
    for seed in range(4):
        task = simulator.challenge(seed)
        assert not task.check(task.start, None).right


@EVERY
def test_7_truth_can_be_hidden_and_errors_have_units(simulator: Simulator) -> None:
    scene = simulator.scene(simulator.params())
    hidden = [mark for mark in scene.marks if mark.truth]
    assert hidden
    numbers = [mark for mark in hidden if isinstance(mark, Number)]
    assert numbers
    assert all(number.unit for number in numbers)
    assert not any(mark.truth for mark in scene.visible(truth=False, answers=True))


@EVERY
def test_8_presets_include_a_breaking_one_and_one_with_a_photo(simulator: Simulator) -> None:
    kinds = [preset.kind for preset in simulator.presets]
    assert len(kinds) >= 3
    assert "degenerate" in kinds
    assert "photo" in kinds
    for params in all_params(simulator):
        scene = simulator.scene(params)
        assert scene.says
        ET.fromstring(scene_svg(scene))


@EVERY
def test_8_the_photo_of_the_project_is_used(simulator: Simulator) -> None:
    name = next(preset.name for preset in simulator.presets if preset.kind == "photo")
    params = simulator.preset(name)
    photo = np.random.default_rng(0).integers(0, 255, (300, 400, 3)).astype(np.uint8)
    assert not same(simulator.scene(params), simulator.scene(params, Setting(photo, "mine.jpg")))
    assert not same(simulator.scene(params, Setting(photo[..., 0])), simulator.scene(params, Setting(photo)))


@EVERY
def test_8_undo_and_redo_restore_the_parameters(simulator: Simulator) -> None:
    first, second = simulator.params(), simulator.preset(simulator.presets[1].name)
    history = History(first)
    history.push(second)
    history.push(second)
    assert history.undo()
    assert history.present == first
    assert not history.undo()
    assert history.redo()
    assert history.present == second
    assert not history.can_redo


@EVERY
def test_9_the_functions_are_the_engines_own(simulator: Simulator) -> None:
    stem = simulator.function.__module__
    package = importlib.import_module(stem.rpartition(".")[0])
    shared = importlib.import_module("graphos_didactic.simulators")
    family = [
        importlib.import_module(found.name)
        for place, start in ((package, stem), (shared, shared.__name__))
        for found in pkgutil.iter_modules(place.__path__, place.__name__ + ".")
        if found.name.startswith(start) and not found.ispkg
    ]
    assert len(simulator.engine) >= 3
    for function in simulator.engine:
        where = function.__module__
        assert where.startswith("graphos_core."), function
        assert getattr(importlib.import_module(where), function.__name__) is function
        used = [m for m in family for value in vars(m).values() if value is function]
        assert used, f"{function.__name__} is named but not used"


@EVERY
def test_10_the_figure_is_well_formed_in_light_and_dark(simulator: Simulator) -> None:
    scene = simulator.scene(simulator.params())
    for theme in ("light", "dark"):
        root = ET.fromstring(scene_svg(scene, look=Look(theme=theme)))
        assert root.tag.endswith("svg")
        assert root.findtext("{http://www.w3.org/2000/svg}title") == scene.says
        assert len(list(root.iter("{http://www.w3.org/2000/svg}text"))) > 20


@EVERY
def test_10_the_data_can_be_read_back_with_units(simulator: Simulator) -> None:
    params = simulator.params()
    scene = simulator.scene(params)
    text = data_csv(State(simulator, params), scene)
    rows = list(csv.DictReader(line for line in io.StringIO(text) if not line.startswith("#")))
    values = {row["label"]: float(row["value"]) for row in rows if row["value"]}
    for label, number in scene.numbers().items():
        if np.isfinite(number.value):
            assert values[label] == pytest.approx(number.value)
    assert any(row["x_axis"] for row in rows)


@EVERY
def test_10_a_state_restores_exactly(simulator: Simulator) -> None:
    for params in all_params(simulator):
        handle = simulator.scene(params).handles[0]
        moved = drag(params, handle, handle.at[0] + np.pi / 7 * handle.nudge[0], handle.at[1])
        state = State(simulator, moved, step=1, truth=False, seed=17)
        back = read_state(state_text(state))
        assert back == state
        assert same(simulator.scene(moved), back.simulator.scene(back.params))


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "format"),
        ("not toml [", "TOML"),
        ('format = "graphos simulator state"\nschema = 99\n', "newer"),
        ('format = "graphos simulator state"\nschema = 1\nsimulator = "os/system"\n', "Unknown"),
        (
            'format = "graphos simulator state"\nschema = 1\nsimulator = "features/epipolar"\n[params]\na_x = 1e9\n',
            "needs -6 to 6",
        ),
        (
            'format = "graphos simulator state"\nschema = 1\nsimulator = "features/epipolar"\n[params]\nevil = 1\n',
            "Unknown",
        ),
        ("x" * 200_000, "too long"),
    ],
)
def test_10_a_strangers_state_is_refused_in_a_sentence(text: str, word: str) -> None:
    with pytest.raises(UserError, match=word):
        read_state(text)


@EVERY
def test_11_every_control_has_unit_range_default_and_effect(simulator: Simulator) -> None:
    for name, declaration in simulator.params.declarations().items():
        about = declaration.about
        assert about.label, name
        assert about.help, name
        assert about.effect, name
        if declaration.kind in ("float", "int"):
            assert about.low is not None, name
            assert about.high is not None, name
            assert about.low < declaration.default < about.high or name == "seed", name


@EVERY
def test_12_the_steps_show_one_after_the_other(simulator: Simulator) -> None:
    params = simulator.params()
    assert len(simulator.steps) >= 3
    shown = [content(simulator.scene(params, Setting(step=i))) for i in range(len(simulator.steps))]
    assert all(a != b for i, a in enumerate(shown) for b in shown[:i])
    assert shown[-1] == content(simulator.scene(params))
    assert all(step.title and step.text for step in simulator.steps)


@EVERY
def test_13_the_same_parameters_give_the_same_scene(simulator: Simulator) -> None:
    for params in all_params(simulator):
        assert same(simulator.scene(params), simulator.scene(params))


@EVERY
def test_13_arrays_of_a_scene_cannot_be_written_to(simulator: Simulator) -> None:
    for mark in simulator.scene(simulator.params()).marks:
        for field in dataclasses.fields(mark):
            value = getattr(mark, field.name)
            assert not isinstance(value, np.ndarray) or not value.flags.writeable


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_14_text_has_enough_contrast(theme: str) -> None:
    colours = PALETTES[theme]  # type: ignore[index]
    for role in (
        "text",
        "muted",
        "accent",
        "truth",
        "estimate",
        "error",
        "first",
        "second",
        "third",
        "neutral",
    ):
        assert contrast(colours[role], colours["surface"]) >= 4.5, role


@EVERY
def test_14_lines_of_one_panel_differ_by_more_than_colour(simulator: Simulator) -> None:
    from graphos_didactic.scene import Line

    scene = simulator.scene(simulator.params())
    for panel in scene.panels:
        keyed = [m for m in scene.marks if isinstance(m, Line) and m.panel == panel.name and m.label]
        assert len({m.dash for m in keyed}) == len(keyed), panel.name


@EVERY
def test_14_every_handle_has_a_name_and_a_step_for_the_keyboard(simulator: Simulator) -> None:
    for params in all_params(simulator):
        handles = simulator.scene(params).handles
        assert len({h.name for h in handles}) == len(handles)
        for handle in handles:
            assert isinstance(handle, Handle)
            assert handle.label
            assert any(handle.nudge)
