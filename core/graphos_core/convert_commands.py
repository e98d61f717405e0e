"""``graphos convert camera|orientation|tiepoints|features|formats``: between this program's files and those of others."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from graphos_core.errors import UserError
from graphos_core.text import Text

if TYPE_CHECKING:
    from graphos_core.data import Camera
    from graphos_core.exchange.formulas import Format

KINDS = ("camera", "orientation", "tiepoints", "features", "formats")


def add_convert(words: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the word ``convert`` to the command line."""
    convert = words.add_parser(
        "convert", help="camera, orientation or tie points to another program's format"
    )
    kinds = convert.add_subparsers(dest="kind", metavar="|".join(KINDS), required=True)
    camera = _kind(kinds, "camera", "calibration of a camera, with what the conversion costs in px")
    camera.add_argument(
        "--size", type=_size, metavar="WIDTH,HEIGHT", help="format in px, for files that do not tell it"
    )
    camera.add_argument("--pixel-mm", type=float, help="pixel size in mm, for formats in millimetres")
    camera.add_argument("--model", default="", help="camera model of this program between the two")
    orientation = _kind(
        kinds, "orientation", "orientations with cameras and points where the format has them"
    )
    orientation.add_argument("--camera", type=Path, help="camera file, for formats without cameras")
    orientation.add_argument("--angles", default="omega phi kappa", metavar="ORDER", help="order of written angles: "
                             "'omega phi kappa', 'phi omega kappa' or 'yaw pitch roll'")  # fmt: skip
    orientation.add_argument(
        "--angle-unit", choices=("deg", "gon", "rad"), default="deg", help="unit of written angles"
    )
    _kind(kinds, "tiepoints", "tie points: image points and which belong together")
    _kind(kinds, "features", "keypoints, descriptors and matches of a project, a folder or a database")
    kinds.add_parser("formats", help="list the formats and what each can hold")


def _kind(
    kinds: argparse._SubParsersAction[argparse.ArgumentParser], name: str, what: str
) -> argparse.ArgumentParser:
    parser = kinds.add_parser(name, help=what)
    parser.add_argument("source", type=Path, metavar="IN", help="file or folder to read")
    parser.add_argument("target", type=Path, metavar="OUT", help="file or folder to write")
    parser.add_argument("--to", required=True, metavar="FORMAT", help="see graphos convert formats")
    parser.add_argument(
        "--from", default="", dest="of", metavar="FORMAT", help="format of IN (default: recognised)"
    )
    return parser


def _size(text: str) -> tuple[int, int]:
    try:
        width, height = (int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError("needs two whole numbers, such as 4000,3000") from None
    if not (0 < width < 10**6 and 0 < height < 10**6):
        raise argparse.ArgumentTypeError("needs 1 to 999999 px")
    return width, height


def convert(options: argparse.Namespace) -> int:
    """Run ``graphos convert``."""
    run = {
        "camera": _camera,
        "orientation": _orientation,
        "tiepoints": _tie_points,
        "features": _features,
        "formats": _formats,
    }
    for line in run[options.kind](options):
        print(line)
    return 0


def _frame(options: argparse.Namespace) -> Format | None:
    from graphos_core.exchange.formulas import Format

    if options.pixel_mm is not None and not 0 < options.pixel_mm < 1:
        raise UserError(
            Text("A pixel size of {mm} mm is not possible.", mm=options.pixel_mm),
            todo="Give millimetres, such as 0.0048.",
        )
    if options.size is None:
        return Format(1, 1, options.pixel_mm) if options.pixel_mm is not None else None
    width, height = options.size
    return Format(width, height, options.pixel_mm)


def _camera(options: argparse.Namespace) -> list[str]:
    from graphos_core.exchange.camera_formats import convert_camera, exact

    done = convert_camera(options.source, options.target, options.to, of=options.of, frame=_frame(options),
                          model=options.model)  # fmt: skip
    lines: list[str] = [
        Text("{source} → {target}: {file}", source=done.source, target=done.target, file=done.file)
    ]
    if exact(done):
        lines.append(Text("Exact: largest difference {px:.1e} px over the format.", px=done.max_px))
    else:
        lines.append(Text(
            "Largest difference {worst:.3g} px, RMS {rms:.3g} px per coordinate, over {count} pixels of the format; "
            "{lost} have no image in the target.",
            worst=done.max_px, rms=done.rms_px, count=len(done.pixels), lost=done.without_image,
        ))  # fmt: skip
        lines += list(done.remarks)
    return lines


def _orientation(options: argparse.Namespace) -> list[str]:
    from graphos_core.exchange.attitudes import ORDERS
    from graphos_core.exchange.orientation_formats import (
        OrientationOptions,
        guess_orientation_format,
        orientation_format,
    )
    from graphos_core.params import unknown_name

    if options.angles not in ORDERS:
        raise UserError(unknown_name(options.angles, list(ORDERS), "order of angles"))
    writer = orientation_format(options.to)
    of = options.of or guess_orientation_format(options.source)
    settings = OrientationOptions(_camera_of(options.camera), options.angles, options.angle_unit)
    found = orientation_format(of).read(options.source, settings)
    made = writer.write(found.block, options.target, settings)
    block = found.block
    counts = Text("{photos} of {all} photos oriented, {points} points, {rays} observations",
                  photos=int(block.oriented.sum()), all=len(block.names), points=len(block.points),
                  rays=len(block.obs_photo))  # fmt: skip
    head = Text("{source} → {target}: {counts}; {files} files written.", source=of, target=writer.name, counts=counts,
                files=len(made.files))  # fmt: skip
    return [str(head), *found.remarks, *made.remarks]


def _camera_of(path: Path | None) -> Camera | None:
    from graphos_core.data import Camera
    from graphos_core.exchange.camera_fit import from_foreign
    from graphos_core.exchange.camera_formats import read_any_camera

    if path is None:
        return None
    found = read_any_camera(path)
    return found if isinstance(found, Camera) else from_foreign(found).camera


def _tie_points(options: argparse.Namespace) -> list[str]:
    from graphos_core.exchange.tie_points import read_tie_points, write_tie_points

    found = read_tie_points(options.source, options.of)
    files = write_tie_points(found, options.target, options.to)
    head = Text("{points} tie points, {rays} image points in {photos} photos; {files} files written.",
                points=found.tracks.count, rays=len(found.tracks.track), photos=len(found.photos), files=len(files))  # fmt: skip
    return [str(head), *found.remarks]


def _features(options: argparse.Namespace) -> list[str]:
    from graphos_core.exchange.features_formats import read_features, write_features
    from graphos_core.project_features import features_of_project
    from graphos_core.project_file import FILE

    found = (
        features_of_project(options.source)
        if (options.source / FILE).is_file()
        else read_features(options.source)
    )
    files = write_features(found, options.target, options.to)
    head = Text("{points} keypoints of {photos} photos, {matches} matches in {pairs} pairs; {files} files written.",
                points=sum(len(f.xy) for f in found.features), photos=len(found.photos),
                matches=sum(len(p.matches) for p in found.pairs), pairs=sum(1 for p in found.pairs if not p.reason),
                files=len(files))  # fmt: skip
    return [str(head), *found.remarks]


def _formats(_options: argparse.Namespace) -> list[str]:
    from graphos_core.exchange.camera_formats import CAMERA_FORMATS, OWN
    from graphos_core.exchange.features_formats import FEATURE_FORMATS
    from graphos_core.exchange.orientation_formats import ORIENTATION_FORMATS
    from graphos_core.exchange.tie_points import TIE_POINT_FORMATS

    lines = ["camera:", f"  {OWN:<14} this program (TOML)"]
    lines += [f"  {f.name:<14} {f.label}{'' if f.text else ' (only read)'}" for f in CAMERA_FORMATS.values()]
    lines.append("orientation:")
    for kind in ORIENTATION_FORMATS.values():
        holds = ", ".join(what for what, has in (("cameras", kind.cameras), ("points", kind.points)) if has)
        lines.append(
            f"  {kind.name:<14} {kind.label} — {holds or 'poses only'}{'' if kind.written else ' (only read)'}"
        )
    lines.append("tiepoints:")
    lines += [f"  {name:<14} {label}" for name, label in TIE_POINT_FORMATS.items()]
    lines.append("features:")
    return lines + [f"  {name:<14} {label}" for name, label in FEATURE_FORMATS.items()]
