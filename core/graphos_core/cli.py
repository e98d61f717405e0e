"""The command line: ``graphos WORD …``. Words are a contract; see ``graphos WORD --help``.

Exit codes: 0 done, 1 the work could not be done (the sentence says why and what to try), 2 wrong usage.
"""

from __future__ import annotations

import argparse
import sys
import traceback
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path

from graphos_core import __version__
from graphos_core.adjustment_options import add_adjust, add_compare, add_report
from graphos_core.analyse_options import add_analyse
from graphos_core.calibrate_options import add_calibrate
from graphos_core.convert_commands import add_convert, convert

LENSES = ("perspective", "fisheye-equidistant", "fisheye-equisolid", "spherical")
STAGES = ("preprocessing", "features", "adjustment", "dense", "quality")
DONE, FAILED, USAGE = 0, 1, 2


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    from graphos_core.adjustment.bundle.sheet import CALIBRATIONS

    parser = argparse.ArgumentParser(
        prog="graphos",
        description="Learning and doing photogrammetry: from photos to a measured 3D model, every step explained.",
    )
    parser.add_argument("--version", action="version", version=f"GRAPHOS-Py {__version__}")
    words = parser.add_subparsers(dest="word", metavar="WORD", required=True)

    demo = words.add_parser(
        "demo", help="simulate photos with known truth, make the model, compare with the truth"
    )
    demo.add_argument(
        "--out", type=Path, default=None, help="folder for photos and results (default: ./demo)"
    )
    demo.add_argument("--no-window", action="store_true", help="do not open the window at the end")
    demo.add_argument("--photos", type=int, default=12, help="number of photos (default 12)")
    _common(demo)

    gui = words.add_parser("gui", help="open the window")
    gui.add_argument("project", nargs="?", type=Path, help="project folder to open")

    simulate = words.add_parser("simulate", help="make photos of a theoretical model with known truth")
    simulate.add_argument("template", help="couple, triple, grid, orbital, facade or inside")
    simulate.add_argument("--out", type=Path, required=True, help="folder for photos and truth")
    simulate.add_argument("--width", type=_side, default=1600, help="photo width in px (default 1600)")
    simulate.add_argument("--height", type=_side, default=1200, help="photo height in px (default 1200)")
    simulate.add_argument(
        "--lens", choices=LENSES, default="perspective", help="kind of lens (default perspective)"
    )
    simulate.add_argument(
        "--set", action="append", default=[], metavar="PARAMETER=VALUE", dest="assignments",
        help="parameter of the template; an unknown name lists the valid ones",
    )  # fmt: skip
    _common(simulate)

    run = words.add_parser("run", help="photos or project to model and report")
    run.add_argument(
        "source", type=Path, metavar="PHOTOS_OR_PROJECT", help="folder of photos, or of a project"
    )
    run.add_argument("--out", type=Path, required=True, help="folder for results; it becomes the project")
    run.add_argument("--recipe", type=Path, help="recipe file (TOML); of a project that of its last run")
    run.add_argument(
        "--set", action="append", default=[], metavar="ROOM.ALGORITHM.PARAMETER=VALUE", dest="assignments",
        help="set a parameter, or choose an algorithm with ROOM.ROLE=ALGORITHM; may be repeated",
    )  # fmt: skip
    run.add_argument("--focal-px", type=float, help="principal distance in px")
    run.add_argument("--principal-point", type=_pair, metavar="X,Y", help="principal point in px")
    run.add_argument(
        "--orientation",
        type=Path,
        help="orientation to start from: a project, or a file or folder of another program",
    )
    run.add_argument("--lens", choices=LENSES, help="kind of lens (default perspective)")
    run.add_argument(
        "--calibration",
        choices=CALIBRATIONS,
        metavar="MODEL",
        help="what the photos calibrate: " + ", ".join(CALIBRATIONS),
    )
    run.add_argument(
        "--camera", type=Path, metavar="FILE",
        help="calibration.toml of “graphos calibrate”; held fixed unless --calibration says otherwise",
    )  # fmt: skip
    run.add_argument(
        "--control", type=Path, help="control points (CSV); measurements in NAME_measurements.csv beside it"
    )
    run.add_argument(
        "--distance", type=_distance, metavar="A,B,METRES", help="known distance between two points or photos"
    )
    run.add_argument("--reference", type=Path, help="reference cloud or mesh (PLY) for quality control")
    run.add_argument(
        "--masks", type=Path, metavar="FILE_OR_FOLDER",
        help="where nothing is measured: masks.toml, or pictures named like the photos (NAME_mask.png, masks/NAME.png)",
    )  # fmt: skip
    run.add_argument(
        "--undistort", type=Path, metavar="FILE",
        help="undistort the photos by a calibration.toml, or the cameras.toml of an earlier run",
    )  # fmt: skip
    run.add_argument("--until", choices=STAGES, default="quality", help="last stage (default quality)")
    _common(run)

    add_analyse(words, _common)
    add_calibrate(words, _common)
    add_adjust(words, _common)
    add_report(words)
    add_compare(words, _common)

    add_convert(words)
    words.add_parser("list", help="algorithms by room and role")
    describe = words.add_parser("describe", help="parameter sheet of an algorithm")
    describe.add_argument("algorithm", help="room.algorithm or algorithm, such as features.sift")
    return parser


def _common(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--threads", type=_threads, default=None, help="threads to use (default: all cores)")
    parser.add_argument("--seed", type=_seed, default=None, help="seed of every random step (default 0)")


def _threads(text: str) -> int:
    value = int(text)
    if not 1 <= value <= 1024:
        raise argparse.ArgumentTypeError("needs 1 to 1024")
    return value


def _seed(text: str) -> int:
    value = int(text)
    if not 0 <= value < 2**31:
        raise argparse.ArgumentTypeError("needs 0 to 2147483647")
    return value


def _side(text: str) -> int:
    value = int(text)
    if not 32 <= value <= 20000:
        raise argparse.ArgumentTypeError("needs 32 to 20000")
    return value


def _pair(text: str) -> tuple[float, float]:
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError("needs two numbers, such as 799.5,599.5") from None
    return x, y


def _distance(text: str) -> tuple[str, str, float]:
    try:
        a, b, metres = text.rsplit(",", 2)
        return a.strip(), b.strip(), float(metres)
    except ValueError:
        raise argparse.ArgumentTypeError("needs two names and metres, such as 101,102,2.5") from None


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    options = build_parser().parse_args(arguments)
    from graphos_core.errors import GraphosError, ParamError, Stopped

    try:
        return _dispatch(options)
    except ParamError as problem:
        print(f"graphos: {problem.message}", file=sys.stderr)
        return FAILED
    except Stopped as problem:
        print(f"graphos: {problem}", file=sys.stderr)
        return FAILED
    except GraphosError as problem:
        print(f"graphos: {problem}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("\ngraphos: Stopped; what was finished before is kept.", file=sys.stderr)
        return FAILED
    except MemoryError:
        print("graphos: The memory is not enough. Use fewer or smaller photos at once.", file=sys.stderr)
        return FAILED
    except Exception:
        traceback.print_exc()
        print("graphos: This is a fault of the program, not of your data. Results finished before are kept; please "
              "report the lines above.", file=sys.stderr)  # fmt: skip
        return FAILED


def _dispatch(options: argparse.Namespace) -> int:
    from graphos_core import adjustment_commands, commands

    if options.word == "gui":
        return open_window(options.project)
    if options.word == "demo":
        code = commands.demo(options)
        if code == DONE and not options.no_window and commands.has_display():
            return open_window(commands.demo_folder(options))
        return code
    if options.word == "convert":
        return convert(options)
    if options.word == "analyse":
        from graphos_core.analyse_command import analyse

        return analyse(options)
    if options.word == "compare":
        return (
            commands.compare_features(options)
            if options.thing == "features"
            else adjustment_commands.compare_runs(options)
        )
    function = {
        "adjust": adjustment_commands.adjust,
        "report": adjustment_commands.report,
        "simulate": commands.simulate,
        "run": commands.run,
        "calibrate": commands.calibrate,
        "target": commands.target,
        "list": commands.list_algorithms,
        "describe": commands.describe,
    }[options.word]
    return function(options)


def open_window(project: Path | None) -> int:
    """Open the application's window through its entry point, so the engine does not know the screen."""
    from graphos_core.errors import UserError

    for point in entry_points(group="graphos.applications", name="window"):
        code: int = point.load()(project)
        return code
    raise UserError(
        "The window is not installed.", todo="Install the whole distribution, not only the engine."
    )


if __name__ == "__main__":
    sys.exit(main())
