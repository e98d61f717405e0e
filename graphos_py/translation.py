"""Translation at the border: English templates in, the person's language out.

The engine and the window write English templates (`graphos_core.text.Text` or a plain string); a catalogue is a
JSON file ``{"template": "translation"}`` in ``graphos_resources/translations``. What is missing stays English.
"""

from __future__ import annotations

import json
from importlib import resources
from typing import Any

from PySide6.QtCore import QTranslator

from graphos_core.text import Text

_catalogue: dict[str, str] = {}


def languages() -> list[str]:
    """Return the codes of the languages there are, English first."""
    folder = resources.files("graphos_resources") / "translations"
    found = (
        sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith(".json")) if folder.is_dir() else []
    )
    return ["en", *(code for code in found if code != "en")]


def use_language(code: str) -> None:
    """Load the catalogue of a language; an unknown one and ``"en"`` give English."""
    _catalogue.clear()
    file = resources.files("graphos_resources") / "translations" / f"{code}.json"
    if code != "en" and file.is_file():
        entries = json.loads(file.read_text("utf-8"))
        _catalogue.update({str(key): str(value) for key, value in entries.items() if value})


def tr(text: str, **arguments: Any) -> str:
    """Return `text` in the person's language, its ``{arguments}`` filled in.

    A `Text` brings its own template and arguments; arguments that are themselves `Text` are translated too.
    """
    if isinstance(text, Text):
        arguments = {**text.arguments, **arguments}
        template = text.template
    else:
        template = text
    found = _catalogue.get(template, template)
    if not arguments:
        return found
    filled = {key: tr(value) if isinstance(value, Text) else value for key, value in arguments.items()}
    try:
        return found.format(**filled)
    except (KeyError, IndexError, ValueError):  # a faulty catalogue must not cost the sentence
        return template.format(**filled)


class CatalogueTranslator(QTranslator):
    """Lets Qt's own ``tr`` of widgets read the same catalogue."""

    def translate(self, context: str, source: str, disambiguation: str | None = None, n: int = -1) -> str:
        """Return the translation of `source`, or `source` itself."""
        return _catalogue.get(source, source)
