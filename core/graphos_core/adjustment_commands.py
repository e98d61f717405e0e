"""What the words about an adjustment do: ``graphos adjust``, ``graphos compare runs``, ``graphos report``."""

from __future__ import annotations

import argparse
import json
from importlib.metadata import entry_points
from pathlib import Path

from graphos_core.commands import console, make_project, print_summary, run_pipeline
from graphos_core.errors import UserError
from graphos_core.outputs import check_writable
from graphos_core.pipeline import Pipeline
from graphos_core.project_file import FILE, read_settings
from graphos_core.recipe import Recipe
from graphos_core.report import build_report
from graphos_core.store import Store, write_bytes, write_text
from graphos_core.text import Text

PAGE = "report.html"

KEPT_STEPS = ("images", "keypoints", "matches", "orientation")
"""Steps whose results an adjustment starts from."""


def adjust(options: argparse.Namespace) -> int:
    """``graphos adjust``: take features and orientation of a project or run, adjust again into a project of its own."""
    check_writable(options.out)
    recipe, source = adjustment_recipe(options), _project_folder(options.source)
    progress = console(options, recipe.seed)
    options = argparse.Namespace(
        **(
            dict.fromkeys(("focal_px", "principal_point", "lens", "camera", "distance", "reference"))
            | vars(options)
        )
    )
    options.source = source
    recipe = recipe.moved(source, options.out)
    project = make_project(options, recipe.seed, progress)
    pipeline = Pipeline(project, recipe)
    results = Store(source / "results")
    taken = [step for step in KEPT_STEPS if project.store.take_over(results, step, pipeline.key(step))]
    if "matches" not in taken:
        raise UserError(
            Text("{name} has no features to adjust with this recipe and seed.", name=source),
            "Its stored matches were made with other parameters, or were deleted.",
            "Run it as far as the features first, or take the recipe of one of its runs.",
        )
    if "orientation" not in taken:
        progress.say(
            Text("The orientation is computed again: its parameters are not those of a stored result.")
        )
    folder = run_pipeline(pipeline, "adjustment", progress)
    print_summary(build_report(pipeline), folder)
    return 0


def adjustment_recipe(options: argparse.Namespace) -> Recipe:
    """Return the recipe of the source with the adjustment room of the given one, and what the options set.

    Raises
    ------
    ParamError, UserError
        For a value or an assignment that is not possible, or one that belongs to a room whose results are kept.
    """
    folder = options.source.parent if options.source.name == FILE else options.source
    stored = folder / "recipe.toml"
    recipe = (
        Recipe.load(stored)
        if stored.is_file()
        else Recipe.default(read_settings(_project_folder(folder)).seed)
    )
    if options.recipe is not None:
        recipe = recipe.with_room_of(Recipe.load(options.recipe), "adjustment")
    if options.seed is not None:
        recipe = recipe.with_seed(options.seed)
    if options.calibration is not None:
        (bundle,) = recipe.chosen("adjustment", "bundle")
        recipe = recipe.set(f"adjustment.{bundle}.calibration={options.calibration}")
    for assignment in options.assignments:
        if not assignment.startswith("adjustment."):
            raise UserError(
                Text("“{text}” is not of the adjustment room.", text=assignment),
                "An adjustment that starts from stored features keeps them as they are.",
                "Use graphos run to compute other features.",
            )
        recipe = recipe.set(assignment)
    return recipe


def _project_folder(path: Path) -> Path:
    """Return the project folder of a project, its file, or one of its runs."""
    folder = path.parent if path.name == FILE else path
    if not (folder / FILE).is_file() and (folder.resolve().parent.parent / FILE).is_file():
        return folder.resolve().parent.parent
    return folder


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
