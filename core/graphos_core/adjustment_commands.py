"""What the words about an adjustment do: ``graphos adjust``, ``graphos compare runs``, ``graphos report``."""

from __future__ import annotations

import argparse
import json
from importlib.metadata import entry_points
from pathlib import Path

from graphos_core.errors import UserError
from graphos_core.outputs import check_writable
from graphos_core.project_file import FILE
from graphos_core.store import write_bytes, write_text
from graphos_core.text import Text

PAGE = "report.html"


def compare_runs(options: argparse.Namespace) -> int:
    """``graphos compare runs A B``: two adjustments of one block, as a table and, with --out, as files."""
    from graphos_core.compare_runs import compare, load_compared_run
    from graphos_core.run_comparison.page import comparison_page, comparison_text

    found = compare(load_compared_run(options.a), load_compared_run(options.b))
    print(comparison_text(found))
    if options.out is not None:
        check_writable(options.out)
        data = json.dumps(found.to_dict(), indent=1, ensure_ascii=False, allow_nan=False)
        write_text(options.out / "comparison.json", data)
        write_text(options.out / "comparison.html", comparison_page(found).html())
        print(f"\nWritten: {options.out / 'comparison.html'}")
    return 0


def report(options: argparse.Namespace) -> int:
    """``graphos report``: the report of a project's newest run, or of one run, as HTML, JSON and PDF."""
    folder = report_folder(options.project)
    page = (folder / PAGE).read_text("utf-8")
    target = options.pdf if options.pdf is not None else (options.out or folder) / "report.pdf"
    check_writable(target.absolute().parent)
    if options.out is not None and options.out.resolve() != folder.resolve():
        for name in (PAGE, "report.json"):
            write_bytes(options.out / name, (folder / name).read_bytes())
    print_page(page, target)
    print(f"Written: {target}")
    return 0


def report_folder(path: Path) -> Path:
    """Return the folder that holds the report of a project's newest run, or of the run named by its folder.

    Raises
    ------
    UserError
        When there is no report.
    """
    folder = path.parent if path.name in (FILE, PAGE) else path
    if not (folder / PAGE).is_file() or not (folder / "report.json").is_file():
        raise UserError(
            Text("{name} has no report.", name=path),
            "A report is written at the end of a run.",
            "Name the folder of a project that was run, or of one of its runs (MODEL/runs/0001).",
        )
    return folder


def print_page(page: str, path: Path) -> None:
    """Print a page as PDF; the application that can is found by its entry point, so the engine needs no screen.

    Raises
    ------
    UserError
        When none is installed, or the file cannot be written.
    """
    for point in entry_points(group="graphos.applications", name="print"):
        point.load()(page, path)
        return
    raise UserError(
        "A PDF cannot be printed here.",
        "The part of the program that prints is not installed.",
        "Install the whole distribution, or print report.html from a browser.",
    )
