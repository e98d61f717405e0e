"""What the words of the command line do."""

from __future__ import annotations

import argparse
import os
import sys
import textwrap
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, cast

from graphos_core import registry
from graphos_core.adjustment.orientation.groups import listed
from graphos_core.data import Block
from graphos_core.errors import UserError
from graphos_core.images import told_remarks
from graphos_core.mask_import import import_masks
from graphos_core.outputs import check_writable, write_outputs
from graphos_core.params import unknown_name
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.project_file import FILE, copy_known, read_settings, relative_path
from graphos_core.recipe import Recipe
from graphos_core.registry import STAGES, Algorithm, Stage
from graphos_core.report import build_report
from graphos_core.run import ConsoleRun, Run
from graphos_core.text import Text


def console(options: argparse.Namespace, seed: int = 0) -> ConsoleRun:
    """Return the run that prints on the error stream."""
    return ConsoleRun(sys.stderr, threads=options.threads, seed=seed)


def run(options: argparse.Namespace) -> int:
    """``graphos run``: photos or project to model and report."""
    check_writable(options.out)
    if options.lens is None and (options.calibration or "").startswith("fisheye-"):
        options.lens = options.calibration
    recipe = _recipe(options)
    progress = console(options, recipe.seed)
    project = make_project(options, recipe.seed, progress)
    if options.orientation is not None:
        project = project.with_orientation(
            given_orientation(options.orientation, progress), str(options.orientation)
        )
    if options.masks is not None:
        taken, failures = import_masks(options.masks, project.folder, project.photo_set.photos)
        for failure in failures:
            progress.warn(f"{failure.item}: {failure.reason}")
        progress.say(Text("masks for {count} photos", count=len(taken)))
    pipeline = Pipeline(project, recipe)
    folder = run_pipeline(pipeline, cast(Stage, options.until), progress)
    print_summary(build_report(pipeline), folder)
    return 0


def given_orientation(path: Path, progress: Run) -> Block:
    """Read an orientation to start from: of a project's last run, or a file or folder of another program.

    Raises
    ------
    UserError
        When it cannot be read, or the project has no oriented block.
    """
    from graphos_core.exchange.orientation_formats import (
        OrientationOptions,
        guess_orientation_format,
        orientation_format,
    )

    if (path / FILE).is_file() or path.name == FILE:
        project = Project.open(path, run=progress)
        found = Pipeline(project, _recipe_of(project.folder)).latest("adjustment")
        if found is None:
            raise UserError(
                Text("The project {path} has no oriented block.", path=path),
                todo="Run its adjustment first, or choose another orientation.",
            )
        block: Block = found.adjustment.block
        return block
    read = orientation_format(guess_orientation_format(path)).read(path, OrientationOptions())
    for remark in read.remarks:
        progress.warn(remark)
    return read.block


def run_pipeline(pipeline: Pipeline, until: Stage, progress: Run) -> Path:
    """Run all stages up to `until` and write the outputs, also of what was finished when a later stage fails."""
    made = datetime.now(UTC).isoformat(timespec="seconds")
    for failure in pipeline.photos.failures:
        progress.warn(f"{failure.item} is not used: {failure.reason}")
    for remark in told_remarks(pipeline.photos):
        progress.warn(remark)
    for camera in pipeline.photos.cameras:
        if camera.focal_estimated:
            progress.warn(
                f"The principal distance of {camera.label or 'the camera'} is an estimate: {camera.focal_source}"
            )
    try:
        for stage in STAGES[: STAGES.index(until) + 1]:
            known = pipeline.state(stage).status == "done"
            started = time.perf_counter()
            pipeline.run(stage, progress, with_earlier=False)
            line = pipeline.state(stage).line
            seconds = "from an earlier run" if known else f"{time.perf_counter() - started:.1f} s"
            progress.say(f"{stage:14} {line}  ({seconds})")
            if stage == "adjustment":
                _tell_left_out(pipeline.value("adjustment").adjustment.block, progress)
    except UserError:
        if pipeline.result("features") is not None:
            write_outputs(pipeline, made)
        raise
    return write_outputs(pipeline, made)


def _tell_left_out(block: Block, progress: Run) -> None:
    """Name the photos that could not be oriented, each reason once."""
    reasons: dict[str, list[str]] = {}
    for failure in block.failures:
        reasons.setdefault(failure.reason, []).append(failure.item)
    for reason, names in reasons.items():
        progress.say(Text("Not oriented: {names}. {reason}", names=listed(names), reason=reason))


def _recipe(options: argparse.Namespace) -> Recipe:
    recipe = Recipe.load(options.recipe) if options.recipe else _recipe_of(options.source)
    if not options.recipe:
        folder = options.source.parent if options.source.name == FILE else options.source
        recipe = recipe.moved(folder, options.out)
    if options.seed is not None:
        recipe = recipe.with_seed(options.seed)
    if options.camera is not None and options.calibration is None:
        options.calibration = "fixed"
    if options.calibration is not None:
        recipe = recipe.set(f"adjustment.schur.calibration={options.calibration}")
        free = str(options.calibration != "fixed").lower()
        for name in ("incremental", "hierarchical", "given"):
            recipe = recipe.set(f"adjustment.{name}.self_calibration={free}")
    if getattr(options, "undistort", None) is not None:
        file = relative_path(options.undistort, options.out)
        recipe = recipe.set("preprocessing.undistortion=calibrated")
        recipe = recipe.set(f"preprocessing.calibrated.calibration={file}")
    if getattr(options, "orientation", None) is not None:
        recipe = recipe.set("adjustment.orientation=given")
    for assignment in options.assignments:
        recipe = recipe.set(assignment)
    return recipe


def _recipe_of(source: Path) -> Recipe:
    """Return the recipe of a project's last run, or the default one with its seed; for photos the default."""
    folder = source.parent if source.name == FILE else source
    if not (folder / FILE).is_file():
        return Recipe.default()
    last = folder / "recipe.toml"
    return Recipe.load(last) if last.is_file() else Recipe.default(read_settings(folder).seed)


def make_project(options: argparse.Namespace, seed: int, progress: Run) -> Project:
    """Make the project in ``options.out`` from photos or from another project, or change the one that is there."""
    settings: dict[str, Any] = {
        "focal_px": options.focal_px, "principal_point": options.principal_point, "distance": options.distance,
        "lens": options.lens,
    }  # fmt: skip
    settings = {k: v for k, v in settings.items() if v is not None} | {"seed": seed}
    if options.camera is not None:
        settings["calibration"] = options.camera
    if options.reference is not None:
        if not options.reference.is_file():
            raise UserError(
                Text("The reference {name} does not exist.", name=options.reference), todo="Check the path."
            )
        settings["reference"] = os.path.relpath(options.reference.resolve(), options.out.resolve())
    if (options.source / FILE).is_file() or options.source.name == FILE:
        source = Project.open(options.source, run=progress)
        if source.folder.resolve() == options.out.resolve():
            return source.change(progress, **settings, **_control(options))
        kept = {
            k: getattr(source.settings, k)
            for k in ("excluded", "focal_px", "principal_point", "lens", "distance")
        }
        if source.settings.control and options.control is None:
            options.control = source.folder / source.settings.control
        if source.settings.calibration and options.camera is None:
            settings["calibration"] = source.folder / source.settings.calibration
        made = Project.create(
            options.out,
            source.photos_folder,
            name=source.name,
            run=progress,
            **(kept | settings),
            **_control(options),
        )
        copy_known(source.folder, made.folder)
        return made
    return Project.create(options.out, options.source, run=progress, **settings, **_control(options))


def _control(options: argparse.Namespace) -> dict[str, Any]:
    return {"control": options.control} if options.control is not None else {}


def print_summary(report: dict[str, Any], folder: Path) -> None:
    """Print the figures that sum a run up."""
    images, orientation, dense = report["images"], report["orientation"], report["dense"]
    rows = [("Photos oriented", f"{images['oriented']} of {images['total']}")]
    if orientation:
        rows.append(("Reprojection RMS (per coordinate)", f"{orientation['reprojection_rms_px']:.3f} px"))
        rows.append(("Object points", f"{orientation['points']}"))
    if dense["points"]:
        rows.append(("Dense points", f"{dense['points']}"))
    rows.append(("Report", str(folder.parent.parent / "report.html")))
    for label, value in rows:
        print(f"{label:34} {value}")


def simulate(options: argparse.Namespace) -> int:
    """``graphos simulate``: photos of a theoretical model with known truth."""
    from graphos_core.simulation.photo_block import lens_camera, simulate_photos
    from graphos_core.simulation.templates import TEMPLATES

    if options.template not in TEMPLATES:
        raise UserError(unknown_name(options.template, list(TEMPLATES), "template"))
    sheet = TEMPLATES[options.template].params
    declarations = sheet.declarations()
    values = {}
    for assignment in options.assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise UserError(
                Text("“{text}” is not an assignment.", text=assignment), todo="Write PARAMETER=VALUE."
            )
        if name not in declarations:
            raise UserError(unknown_name(name, declarations, f"parameter of {options.template}"))
        values[name] = declarations[name].parse(text)
    check_writable(options.out)
    progress = console(options, options.seed or 0)
    block = simulate_photos(
        options.template, options.out, params=sheet.from_dict(values),
        camera=lens_camera(options.lens, options.width, options.height), seed=options.seed or 0, run=progress,
    )  # fmt: skip
    print(f"{len(block.names)} photos with truth in {options.out}")
    return 0


def calibrate(options: argparse.Namespace) -> int:
    """``graphos calibrate``: photos of a test field to a calibrated camera."""
    from graphos_core import calibrate_command

    return calibrate_command.calibrate(options)


def target(options: argparse.Namespace) -> int:
    """``graphos target``: a test field to print."""
    from graphos_core import calibrate_command

    return calibrate_command.target(options)


def compare_features(options: argparse.Namespace) -> int:
    """``graphos compare features``: algorithms side by side on somebody's photos."""
    from graphos_core import compare_features_command

    return compare_features_command.compare(options)


def demo_folder(options: argparse.Namespace) -> Path:
    """Return the folder of the demo's project."""
    out: Path = options.out or Path("demo")
    return out / "model"


def demo(options: argparse.Namespace) -> int:
    """``graphos demo``: simulate, run, and compare with the truth."""
    from graphos_core.demo import run_demo

    out = options.out or Path("demo")
    check_writable(out)
    progress = console(options, options.seed or 0)
    for label, value in run_demo(out, options.photos, progress):
        print(f"{label:46} {value}")
    return 0


def has_display() -> bool:
    """Say whether a window can be opened here."""
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def list_algorithms(options: argparse.Namespace) -> int:
    """``graphos list``: algorithms by room and role."""
    for problem in registry.problems():
        print(f"Warning: {problem}", file=sys.stderr)
    default = Recipe.default()
    for stage in STAGES:
        print(stage)
        for a in registry.algorithms(stage):
            mark = "*" if a.name in default.chosen(stage, a.role) else " "
            print(f"  {mark} {a.name:14} {a.role:16} {a.label}")
    print("* chosen when nobody chooses otherwise")
    return 0


def describe(options: argparse.Namespace) -> int:
    """``graphos describe``: parameter sheet of an algorithm."""
    found = find_algorithm(options.algorithm)
    print(f"{found.stage}.{found.name}: {found.label} ({found.role}, version {found.version})")
    print(textwrap.fill(found.summary, 100))
    print(textwrap.fill(f"Source: {found.source}", 100))
    for name, d in found.params.declarations().items():
        default = "none" if d.default is None else d.default
        print(
            f"\n{name} = {default}   [{d.range_text}{', or none' if d.optional else ''}]   ({d.about.level})"
        )
        print(textwrap.fill(f"{d.about.label}: {d.about.help} {d.about.effect}", 100, initial_indent="    ",
                            subsequent_indent="    "))  # fmt: skip
    return 0


def find_algorithm(name: str) -> Algorithm:
    """Return an algorithm by ``room.name`` or by name alone.

    Raises
    ------
    UserError
        When there is none, or several of that name.
    """
    stage, dot, short = name.rpartition(".")
    if dot:
        return registry.find(stage, short)
    found = [a for a in registry.algorithms() if a.name == name]
    if len(found) == 1:
        return found[0]
    names = [f"{a.stage}.{a.name}" for a in (found or registry.algorithms())]
    raise UserError(unknown_name(name, names, "algorithm"))
