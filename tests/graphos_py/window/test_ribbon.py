"""The ribbon says every state in words, with its reason."""

import pytest

from graphos_py.icons import NAMES
from graphos_py.ribbon import COLOURS, WORDS, Ribbon, StepState
from graphos_py.theme import colour_table, contrast


@pytest.fixture
def ribbon(qtbot, qapp) -> Ribbon:
    made = Ribbon([("images", "Images"), ("features", "Features"), ("learn", "Learn")])
    qtbot.addWidget(made)
    made.show()
    return made


@pytest.mark.parametrize("status", ["not yet", "next", "done", "stale", "failed", "running"])
def test_every_state_is_said_by_icon_word_and_reason_not_by_colour_alone(ribbon, status):
    step = ribbon.step("features")
    step.show_state(StepState(status, "σ0 0.43 px", "needs preprocessing"))
    assert status in NAMES
    assert WORDS[status] in step.toolTip()
    assert "σ0 0.43 px" in step.toolTip() and "needs preprocessing" in step.toolTip()
    assert step.accessibleName().startswith("Features")
    step.grab()


def test_states_look_different(ribbon):
    step = ribbon.step("features")
    pictures = set()
    for status in WORDS:
        step.show_state(StepState(status, "the same line"))
        pictures.add(bytes(step.grab().toImage().constBits()))
    assert len(pictures) == len(WORDS)


def test_a_click_goes_to_the_tab_in_every_state(qtbot, ribbon):
    for status in WORDS:
        ribbon.step("features").show_state(StepState(status))
        with qtbot.waitSignal(ribbon.chosen) as told:
            ribbon.step("features").click()
        assert told.args == ["features"]


@pytest.mark.parametrize("name", ["light", "dark"])
def test_text_has_contrast_of_at_least_4_5(name):
    table = colour_table()[name]
    texts = {"text", "muted", "disabled", "accent", "good", "warn", "bad"} | set(COLOURS.values())
    for text in texts:
        for ground in ("window", "base", "raised"):
            assert contrast(table[text], table[ground]) >= 4.5, (text, ground)
    for ground in ("hover", "selected"):
        for text in texts:
            assert contrast(table[text], table[ground]) >= 4.5, (text, ground)
    assert contrast(table["on_accent"], table["accent"]) >= 4.5


def test_both_themes_have_the_same_colours():
    assert set(colour_table()["light"]) == set(colour_table()["dark"])
