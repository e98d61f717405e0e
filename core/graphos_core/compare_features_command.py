"""``graphos compare features``: algorithms side by side on somebody's photos."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from graphos_core.data import PhotoSet
from graphos_core.errors import UserError
from graphos_core.features_comparison.compare import compare_features
from graphos_core.features_comparison.disturbances import DISTURBANCES
from graphos_core.features_comparison.page import comparison_text, write_comparison
from graphos_core.features_comparison.truth import read_homography
from graphos_core.features_comparison.variants import PRESETS, variants
from graphos_core.images import read_photo_set
from graphos_core.outputs import check_writable
from graphos_core.params import unknown_name
from graphos_core.pipeline import use_threads
from graphos_core.run import ConsoleRun, Run
from graphos_core.text import Text

USUAL = ("sift", "akaze", "orb", "brisk", "fast", "harris", "foerstner", "moravec")
"""What is compared when nobody said what."""


def compare(options: argparse.Namespace) -> int:
    """Compare algorithms, print the table and write the files."""
    names, assignments = chosen(options.algorithms, options.preset, options.assignments)
    found = variants(names, assignments, options.seed or 0)
    against = disturbances(options.against)
    homography = read_homography(options.homography) if options.homography is not None else None
    check_writable(options.out)
    run = ConsoleRun(sys.stderr, threads=options.threads, seed=options.seed or 0)
    use_threads(run.threads)
    photos = photos_in_order(options.photos, run)
    for failure in photos.failures:
        run.warn(f"{failure.item} is not used: {failure.reason}")
    comparison = compare_features(photos, found, run=run, homography=homography, against=against)
    write_comparison(comparison, options.out)
    run.say("")
    print(comparison_text(comparison))
    print(f"\nWritten: {options.out / 'comparison.html'}")
    return 0


def chosen(
    algorithms: str | None, preset: str | None, assignments: Sequence[str]
) -> tuple[Sequence[str], Sequence[str]]:
    """Return detectors and assignments: those of a preset, then those that were named.

    Raises
    ------
    UserError
        For an unknown preset.
    """
    if preset is not None and preset not in PRESETS:
        raise UserError(unknown_name(preset, list(PRESETS), "preset"))
    names, settings = PRESETS[preset] if preset is not None else ((), ())
    named = algorithms.split(",") if algorithms is not None else ([] if preset is not None else USUAL)
    return (*names, *named), (*settings, *assignments)


def disturbances(text: str | None) -> tuple[str, ...]:
    """Return the names of disturbances: of a list with commas, or all.

    Raises
    ------
    UserError
        For an unknown one.
    """
    if text is None:
        return ()
    names = list(DISTURBANCES) if text.strip() == "all" else [n.strip() for n in text.split(",") if n.strip()]
    for name in names:
        if name not in DISTURBANCES:
            raise UserError(unknown_name(name, [*DISTURBANCES, "all"], "disturbance"))
    return tuple(names)


def photos_in_order(paths: Sequence[Path], run: Run) -> PhotoSet:
    """Read photos, a folder's by name and named files in the order in which they are named.

    Raises
    ------
    UserError
        When none is usable.
    """
    if len(paths) == 1 and paths[0].is_dir():
        return read_photo_set(paths[0], run=run)
    for path in paths:
        if path.is_dir():
            raise UserError(
                Text("{name} is a folder.", name=path),
                "A folder stands alone; it cannot be mixed with photos.",
                "Name one folder, or the photos.",
            )
    photos = read_photo_set(paths, run=run)
    place = {str(path.resolve()): i for i, path in enumerate(paths)}
    return replace(photos, photos=tuple(sorted(photos.photos, key=lambda p: place[p.path])))
