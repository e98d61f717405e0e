"""The options of ``graphos analyse``."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any


def add_analyse(words: Any, common: Callable[[argparse.ArgumentParser], None]) -> None:
    """Add the word ``analyse`` to the command line."""
    analyse = words.add_parser(
        "analyse", help="would enhancing the photos pay? texture, sharpness, exposure, noise, duplicates"
    )
    analyse.add_argument("photos", type=Path, nargs="+", metavar="PHOTOS", help="folder of photos, or files")
    analyse.add_argument("--out", type=Path, help="folder for analysis.json")
    analyse.add_argument(
        "--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
        help="set a parameter; an unknown name lists the valid ones",
    )  # fmt: skip
    common(analyse)
