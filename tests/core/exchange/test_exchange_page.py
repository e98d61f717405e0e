"""``docs/exchange.md`` says what the engine does: its tables come from the data, its example runs."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

DOCS = Path(__file__).parents[3] / "docs"


def test_the_tables_are_those_of_the_data():
    writer = runpy.run_path(str(DOCS / "write_exchange.py"))
    text = (DOCS / "exchange.md").read_text("utf-8")
    assert writer["page"](text) == text, "run: python docs/write_exchange.py"
    for name, content in writer["tables"]().items():
        assert content in text, name


def test_the_example_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / "exchange.md").read_text("utf-8"), re.DOTALL)
    assert len(blocks) == 1
    script = tmp_path / "example.py"
    script.write_text(blocks[0], encoding="utf-8")
    runpy.run_path(str(script))
    assert "basic → opencv 4" in capsys.readouterr().out
    assert (tmp_path / "lens.yaml").is_file()
