"""The rules of the house: lint, format, types, import contracts, an engine that does not know the screen."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CODE = ["graphos", "graphos_py", "core", "didactic", "resources", "tests", "benchmarks"]


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *command], cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("command", [("check",), ("format", "--check")])
def test_ruff_has_nothing_to_say(command: tuple[str, ...]) -> None:
    done = run("-m", "ruff", *command, "--no-cache", *CODE)
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_are_strict() -> None:
    done = run("-m", "mypy")
    assert done.returncode == 0, done.stdout


def test_import_contracts_hold() -> None:
    done = run(
        "-c", "from importlinter.cli import lint_imports_command; lint_imports_command()", "--no-cache"
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_engine_and_teaching_run_with_the_screen_blocked() -> None:
    code = (
        "import sys\n"
        "for name in ('PySide6', 'pyqtgraph', 'shiboken6'): sys.modules[name] = None\n"
        "import importlib, pkgutil\n"
        "for top in ('graphos_core', 'graphos_didactic'):\n"
        "    package = importlib.import_module(top)\n"
        "    for module in pkgutil.walk_packages(package.__path__, top + '.'):\n"
        "        importlib.import_module(module.name)\n"
    )
    done = run("-c", code)
    assert done.returncode == 0, done.stderr


def test_help_pays_no_slow_import() -> None:
    code = (
        "import sys, graphos_core.cli as c\n"
        "c.build_parser().format_help()\n"
        "slow = {'numba', 'cv2', 'scipy', 'open3d', 'matplotlib', 'numpy'} & set(sys.modules)\n"
        "assert not slow, slow\n"
    )
    done = run("-c", code)
    assert done.returncode == 0, done.stderr


def test_no_file_is_named_after_nothing() -> None:
    forbidden = {"utils", "helpers", "common", "manager", "misc"}
    found = [p for top in CODE for p in (ROOT / top).rglob("*.py") if p.stem in forbidden]
    assert not found


def test_no_program_reads_code_from_data() -> None:
    pattern = re.compile(
        r"(?<![\w.])(eval|exec)\(|^\s*import pickle|allow_pickle=True|yaml\.load\(", re.MULTILINE
    )
    found = [
        str(p)
        for top in CODE[1:5]
        for p in (ROOT / top).rglob("*.py")
        if pattern.search(p.read_text("utf-8"))
    ]
    assert not found


def test_launcher_uses_only_the_standard_library() -> None:
    text = (ROOT / "graphos").read_text("utf-8")
    imported = set(re.findall(r"^\s*(?:import|from) (\w+)", text, re.MULTILINE))
    assert imported <= set(sys.stdlib_module_names)
