"""Recipes: defaults, assignments, round trip, and refusals that name what is valid."""

from __future__ import annotations

import pytest

from graphos_core import registry
from graphos_core.errors import ParamError, UserError
from graphos_core.recipe import DEFAULTS, Recipe


def test_every_default_names_an_algorithm_of_its_role() -> None:
    for stage, roles in DEFAULTS.items():
        for role, names in roles.items():
            for name in names:
                assert registry.find(stage, name).role == role


def test_every_declared_role_has_a_default() -> None:
    for algorithm in registry.algorithms():
        assert algorithm.role in DEFAULTS[algorithm.stage]


def test_every_algorithm_has_source_summary_and_explained_parameters() -> None:
    for algorithm in registry.algorithms():
        assert algorithm.source
        assert algorithm.summary.endswith(".")
        for declaration in algorithm.params.declarations().values():
            assert declaration.about.label
            assert declaration.about.help.endswith(".")
            assert declaration.about.effect, f"{algorithm.name}.{declaration.name} does not say its effect"
            assert declaration.check(declaration.default) == declaration.default


def test_a_complete_recipe_comes_back_from_its_file_text() -> None:
    recipe = (
        Recipe.default(7)
        .choose("preprocessing", "filter", ["wallis"])
        .set("preprocessing.wallis.target_mean=120")
    )
    back = Recipe.from_toml(recipe.to_toml(complete=True))
    assert back.seed == 7
    assert back.chosen("preprocessing", "filter") == ("wallis",)
    for algorithm in registry.algorithms():
        assert back.params(algorithm.stage, algorithm.name) == recipe.params(algorithm.stage, algorithm.name)
    assert back.params("preprocessing", "wallis").to_dict()["target_mean"] == 120.0


def test_unknown_names_are_refused_with_the_valid_ones() -> None:
    with pytest.raises(UserError, match="Valid: preprocessing, features"):
        Recipe.from_toml("[featurse]\nx = 1")
    with pytest.raises(UserError, match="Did you mean “sift”"):
        Recipe.from_toml("[features.sitf]\nx = 1")
    with pytest.raises(ParamError, match=r"\[features.sift\] Unknown parameter “contrst”"):
        Recipe.from_toml("[features.sift]\ncontrst = 1")
    with pytest.raises(UserError, match="Valid"):
        Recipe.default().set("features.detectr=sift")


def test_a_value_out_of_range_is_refused() -> None:
    with pytest.raises(ParamError, match="needs"):
        Recipe.from_toml("[preprocessing.wallis]\ntarget_mean = 999")
    with pytest.raises(ParamError):
        Recipe.default().with_seed(-1)
    with pytest.raises(UserError, match="not an assignment"):
        Recipe.default().set("nonsense")


def test_a_recipe_that_is_not_toml_is_refused_with_its_line() -> None:
    with pytest.raises(UserError, match="line 1"):
        Recipe.from_toml("x = = 3")


def test_a_recipe_of_the_first_version_keeps_its_meaning() -> None:
    old = "[adjustment.schur]\nfree_k1 = true\nfree_k2 = false\n"
    params = Recipe.from_toml(old).algorithm("adjustment", "bundle")[1]
    assert params.parameters == "k2=fixed"
