"""The options of ``graphos adjust``, ``graphos report`` and ``graphos compare``."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any


def add_report(words: Any) -> None:
    """Add the word ``report`` to the command line."""
    report = words.add_parser("report", help="the report of a run as PDF")
    report.add_argument(
        "project", type=Path, metavar="PROJECT_OR_RUN", help="folder of a project, or of one of its runs"
    )
    report.add_argument(
        "--pdf", type=Path, metavar="FILE", help="PDF file to write (default: report.pdf in that folder)"
    )
    report.add_argument("--out", type=Path, help="folder for report.html, report.json and report.pdf")


def add_compare(words: Any, common: Callable[[argparse.ArgumentParser], None]) -> None:
    """Add the word ``compare`` with its second words to the command line."""
    compare = words.add_parser(
        "compare", help="side by side: two adjustments (runs), or detectors and matchers (features)"
    )
    things = compare.add_subparsers(dest="thing", metavar="THING", required=True)
    runs = things.add_parser(
        "runs", help="two adjustments of one block: recipe, figures, cameras, photos, points"
    )
    runs.add_argument("a", type=Path, metavar="A", help="project, run (MODEL/runs/0001) or stored result")
    runs.add_argument("b", type=Path, metavar="B", help="the same; differences are B − A")
    runs.add_argument("--out", type=Path, help="folder for comparison.json and comparison.html")
    _add_compare_features(things, common)


def _add_compare_features(things: Any, common: Callable[[argparse.ArgumentParser], None]) -> None:
    features = things.add_parser("features", help="detectors and parameters on your photos: table and figure")
    features.add_argument(
        "photos", type=Path, nargs="+", metavar="PHOTOS", help="a folder of photos, or photos"
    )
    features.add_argument(
        "--algorithms", metavar="NAME,NAME…", help="detectors to compare; “graphos list” names them"
    )
    features.add_argument(
        "--homography", type=Path, metavar="FILE",
        help="homography from photo 1 to photo 2 (OpenCV XML or YAML, or nine numbers): tells which matches are right",
    )  # fmt: skip
    features.add_argument(
        "--set", action="append", default=[], metavar="ROOM.ALGORITHM.PARAMETER=VALUE[,VALUE…]", dest="assignments",
        help="a parameter, of several values each in turn; “detector” stands for every detector; may be repeated",
    )  # fmt: skip
    features.add_argument(
        "--against", metavar="NAME,NAME…",
        help="also on changed versions of the first photo: viewpoint, scale, rotation, blur, noise, light, or all",
    )  # fmt: skip
    features.add_argument("--preset", help="a ready comparison: arpenteur (SIFT, AKAZE for SURF, FAST)")
    features.add_argument(
        "--out", type=Path, required=True, help="folder for the table, the report and figures"
    )
    common(features)


def add_adjust(words: Any, common: Callable[[argparse.ArgumentParser], None]) -> None:
    """Add the word ``adjust`` to the command line."""
    from graphos_core.adjustment.bundle.sheet import CALIBRATIONS

    adjust = words.add_parser(
        "adjust", help="adjust a project or run again, with another recipe, control or calibration"
    )
    adjust.add_argument(
        "source", type=Path, metavar="PROJECT_OR_RUN",
        help="folder of a project, or of one of its runs; photos, features and orientation are taken from there",
    )  # fmt: skip
    adjust.add_argument("--out", type=Path, required=True, help="folder for results; it becomes a project")
    adjust.add_argument("--recipe", type=Path, help="recipe file (TOML); its adjustment room is used")
    adjust.add_argument(
        "--set", action="append", default=[], metavar="ROOM.ALGORITHM.PARAMETER=VALUE", dest="assignments",
        help="set a parameter of the adjustment room; may be repeated",
    )  # fmt: skip
    adjust.add_argument(
        "--control", type=Path, help="control points (CSV); measurements in NAME_measurements.csv beside it"
    )
    adjust.add_argument(
        "--calibration", choices=CALIBRATIONS, metavar="MODEL", help="what the photos calibrate: " + ", ".join(CALIBRATIONS)
    )  # fmt: skip
    common(adjust)
