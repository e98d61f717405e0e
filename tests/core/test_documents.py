"""The documents are true: the Python guide runs, and every file the documents name exists."""

from __future__ import annotations

import re
import sys
import types
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_the_python_guide_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "python-api.md").read_text("utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    module = types.ModuleType("guide")
    monkeypatch.setitem(sys.modules, "guide", module)
    from graphos_core import registry

    registry.algorithms()  # what is loaded now must not go with the patch
    monkeypatch.setattr(registry, "_declared", dict(registry._declared))
    for block in blocks:
        code = compile(block, "docs/python-api.md", "exec")
        run_block(code, module.__dict__)
    assert "5 of 5 photos" in capsys.readouterr().out


def run_block(code: object, module: dict[str, object]) -> None:
    """Run a block of the guide as its reader would."""
    exec(code, module)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["README.md", *(f"docs/{p.name}" for p in (ROOT / "docs").glob("*.md"))])
def test_links_and_pictures_exist(name: str) -> None:
    path = ROOT / name
    for target in re.findall(r"\]\(([^)#]+)", path.read_text("utf-8")):
        if "://" not in target:
            assert (path.parent / target).exists(), f"{name} names {target}"
