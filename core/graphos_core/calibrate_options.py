"""Options of ``graphos calibrate`` and ``graphos target``; their values are checked by the parameter sheets."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

KINDS = ("chessboard", "circles", "aruco")


def add_calibrate(words: Any, common: Callable[[argparse.ArgumentParser], None]) -> None:
    """Add ``calibrate`` and ``target`` to the words of the command line."""
    _add_target(words)
    word = words.add_parser("calibrate", help="photos of a test field to a calibrated camera and report")
    word.add_argument(
        "photos", type=Path, nargs="+", metavar="PHOTOS", help="folder of photos, or the photos themselves"
    )
    word.add_argument("--target", choices=KINDS, required=True, help="what is printed on the board")
    _board(word)
    word.add_argument("--out", type=Path, required=True, help="folder for calibration.toml and report")
    word.add_argument(
        "--calibration", metavar="MODEL", help="camera model (default basic: f, x0, y0, k1, k2); an unknown name lists all"
    )  # fmt: skip
    word.add_argument("--free", metavar="NAMES", help="parameters to free beside the usual ones: b1,b2")
    word.add_argument("--fix", metavar="NAMES", help="parameters to hold fixed: p1,p2")
    word.add_argument("--focal-px", type=float, help="principal distance to start from, px")
    word.add_argument(
        "--rejection", metavar="SIGMAS", help="points beyond so many standard deviations are removed (default 5, or none)"
    )  # fmt: skip
    word.add_argument(
        "--free-board",
        action="store_const",
        const=True,
        help="the board is not flat: its points are unknowns too",
    )
    word.add_argument("--circle-mm", metavar="D", help="diameter of the circles (default: from the photos)")
    common(word)


def _add_target(words: Any) -> None:
    word = words.add_parser("target", help="draw a test field to print, as SVG in true scale")
    word.add_argument("target", choices=KINDS, help="what is printed on the board")
    _board(word)
    word.add_argument(
        "--circle-mm", metavar="D", help="diameter of the circles (default 0.6 of their distance)"
    )
    word.add_argument("--out", type=Path, required=True, metavar="FILE.svg", help="file to write")


def _board(word: argparse.ArgumentParser) -> None:
    word.add_argument(
        "--columns", required=True, metavar="N", help="inner corners (circles, markers) along a row"
    )
    word.add_argument(
        "--rows", required=True, metavar="M", help="inner corners (circles, markers) along a column"
    )
    word.add_argument(
        "--square-mm", required=True, metavar="S",
        help="side of a square; distance of circles (asymmetric: of their rows) or of markers",
    )  # fmt: skip
    layout = word.add_mutually_exclusive_group()
    for name, text in (
        ("symmetric", "circles in rows and columns (default)"),
        ("asymmetric", "circles: every second row shifted by half the distance in a row"),
        ("hexagonal", "circles: six neighbours at the same distance"),
    ):
        layout.add_argument(f"--{name}", action="store_const", const=name, dest="layout", help=text)
    word.add_argument(
        "--dictionary", metavar="NAME", help="dictionary of the markers: DICT_5X5_100, DICT_APRILTAG_36h11 …"
    )
    word.add_argument("--marker-mm", metavar="S", help="side of a marker")
    word.add_argument(
        "--markers-only", action="store_const", const=True, help="the board is a grid of markers without chessboard"
    )  # fmt: skip
