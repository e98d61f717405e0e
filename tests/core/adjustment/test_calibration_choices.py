"""Kinds of cameras set what the parameter sheet knows; settings of single parameters are text and back."""

from graphos_core.adjustment.calibration_choices import (
    PRESETS,
    matching_preset,
    preset_values,
    settings_text,
    single_settings,
)
from graphos_core.recipe import Recipe


def test_every_kind_of_camera_sets_something_the_sheet_accepts() -> None:
    name = Recipe.default().chosen("adjustment", "bundle")[0]
    sheet = Recipe.default().params("adjustment", name)
    assert matching_preset(sheet) == ""
    for preset in PRESETS:
        values = preset_values(preset, sheet)
        changed = sheet.replace(**values)  # raises for a value out of the declaration
        assert all(getattr(changed, key) == value for key, value in values.items())
        if len(values) == len(preset.values) and changed != sheet:
            assert matching_preset(changed) == preset.name


def test_settings_of_single_parameters_are_text_and_back() -> None:
    text = "k2=fixed, p1=0.001, 2.k1=free"
    found = single_settings(text)
    assert found == {(0, "k2"): "fixed", (0, "p1"): "0.001", (2, "k1"): "free"}
    assert single_settings(settings_text(found)) == found and settings_text(found) == text
    assert single_settings("nonsense, =, a=") == {}
