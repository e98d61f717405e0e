"""Texts are translated at the border, and the catalogue can be made from the source."""

import json

import pytest

from graphos_core.text import Text
from graphos_py import translation
from graphos_py.extraction import collect, templates, update
from graphos_py.translation import languages, tr


@pytest.fixture
def catalogue(monkeypatch):
    table = {"{n} photos": "{n} Fotos", "features": "Merkmale", "needs {before}": "braucht {before}"}
    monkeypatch.setattr(translation, "_catalogue", table)


def test_a_template_is_translated_and_filled_in_again(catalogue):
    assert tr(Text("{n} photos", n=12)) == "12 Fotos"
    assert tr("{n} photos", n=3) == "3 Fotos"
    assert tr(Text("needs {before}", before=Text("features"))) == "braucht Merkmale"


def test_what_is_missing_stays_english(catalogue):
    assert tr("no such text") == "no such text"


def test_a_faulty_translation_does_not_cost_the_sentence(monkeypatch):
    monkeypatch.setattr(translation, "_catalogue", {"{n} photos": "{m} Fotos"})
    assert tr(Text("{n} photos", n=12)) == "12 photos"


def test_templates_are_found_in_source():
    source = 'tr("A {x}", x=1); Text("B"); About(label="C", help="D", choices={"v": "E"}); UserError("F", todo="G")'
    assert set(templates(source)) == {"A {x}", "B", "C", "D", "E", "F", "G"}


def test_a_catalogue_keeps_its_translations_and_loses_what_is_gone(tmp_path):
    file = tmp_path / "xx.json"
    file.write_text(json.dumps({"Run all": "Alles", "gone": "weg"}), "utf-8")
    entries = update(file)
    assert entries["Run all"] == "Alles"
    assert "gone" not in entries
    assert "Target mean" in entries, "labels of parameters are translatable"


def test_every_shipped_catalogue_is_complete_and_keeps_the_arguments():
    from importlib import resources
    from string import Formatter

    def fields(text: str) -> set[str]:
        return {name for _, name, _, _ in Formatter().parse(text) if name}

    known = set(collect())
    for code in languages()[1:]:
        file = resources.files("graphos_resources") / "translations" / f"{code}.json"
        entries = json.loads(file.read_text("utf-8"))
        for template, translated in entries.items():
            if translated and template in known:
                assert fields(template) == fields(translated), template
