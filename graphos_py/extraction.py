"""Collects every translatable template of the program: ``python -m graphos_py.extraction FILE``.

Walks the source as a syntax tree and takes the literal first argument of ``tr``, ``Text`` and the texts of
``About``, ``@algorithm``, ``Parameter``, ``CameraModel`` and ``UserError``. FILE becomes a catalogue that keeps the
translations it has, gets new templates with an empty translation, and loses those that are gone.
"""

from __future__ import annotations

import ast
import json
import sys
from collections.abc import Iterator
from importlib import resources
from pathlib import Path

PACKAGES = ("graphos_core", "graphos_didactic", "graphos_py")
POSITIONAL = {"tr": 1, "Text": 1, "UserError": 3, "ItemFailure": 0}
KEYWORDS = {
    "About": ("label", "help", "effect", "unit", "group"),
    "algorithm": ("label",),
    "Parameter": ("label",),
    "CameraModel": ("label", "direction"),
    "UserError": ("what", "why", "todo"),
    "ItemFailure": ("reason",),
}


def templates(source: str) -> Iterator[str]:
    """Yield the templates of one module's source."""
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call):
            continue
        name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
        for argument in node.args[: POSITIONAL.get(name, 0)]:
            yield from _literal(argument)
        for keyword in node.keywords:
            if keyword.arg in KEYWORDS.get(name, ()):
                yield from _literal(keyword.value)
            elif name == "About" and keyword.arg == "choices" and isinstance(keyword.value, ast.Dict):
                for value in keyword.value.values:
                    yield from _literal(value)


def _literal(node: ast.expr) -> Iterator[str]:
    if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value.strip():
        yield node.value


def collect() -> list[str]:
    """Return the templates of all packages, each once, sorted."""
    found: set[str] = set()
    for package in PACKAGES:
        folder = Path(str(resources.files(package)))
        for file in sorted(folder.rglob("*.py")):
            found.update(templates(file.read_text("utf-8")))
    return sorted(found)


def update(catalogue: Path) -> dict[str, str]:
    """Bring a catalogue file up to date and return it."""
    known = json.loads(catalogue.read_text("utf-8")) if catalogue.exists() else {}
    entries = {template: str(known.get(template, "")) for template in collect()}
    catalogue.write_text(json.dumps(entries, ensure_ascii=False, indent=1) + "\n", "utf-8")
    return entries


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m graphos_py.extraction CATALOGUE.json")
    table = update(Path(sys.argv[1]))
    print(f"{len(table)} texts, {sum(not value for value in table.values())} without translation")
