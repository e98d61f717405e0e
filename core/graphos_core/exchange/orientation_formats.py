"""Orientation formats of every program by name: reading, writing, recognising."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from graphos_core.data import Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Read, Written
from graphos_core.exchange.bundler import read_bundler, write_bundler
from graphos_core.exchange.camera_texts import is_photomodeler_export
from graphos_core.exchange.colmap import write_colmap
from graphos_core.exchange.colmap_binary import read_colmap_binary, write_colmap_binary
from graphos_core.exchange.colmap_lines import parse_model
from graphos_core.exchange.colmap_model import block_from_model, colmap_camera
from graphos_core.exchange.dbat import read_photomodeler_export
from graphos_core.exchange.metashape import read_metashape, write_metashape
from graphos_core.exchange.micmac import PREFIX, read_micmac, write_micmac
from graphos_core.exchange.nvm import read_nvm, write_nvm
from graphos_core.exchange.orientation_table import read_orientation_table, write_orientation_table
from graphos_core.exchange.patb import read_patb, write_patb
from graphos_core.exchange.text_files import read_bytes
from graphos_core.params import unknown_name
from graphos_core.text import Text


@dataclass(frozen=True)
class OrientationOptions:
    """What some formats need besides the file.

    Attributes
    ----------
    camera : Camera or None
        Camera of all photos, for formats without cameras.
    order, angle_unit : str
        Of written tables; keys of `graphos_core.exchange.attitudes.ORDERS` and ``UNITS``.
    transposed : bool or None
        Matrices of PAT-B: see `graphos_core.exchange.patb.read_patb`.
    """

    camera: Camera | None = None
    order: str = "omega phi kappa"
    angle_unit: str = "deg"
    transposed: bool | None = None


@dataclass(frozen=True)
class OrientationFormat:
    """A kind of orientation file.

    Attributes
    ----------
    name, label : str
    folder : bool
        Whether it is a folder of files.
    cameras, points : bool
        Whether it holds cameras, and object points with their image points.
    read, write : callable
    written : bool
        False for a format that is only read; `write` then says so.
    """

    name: str
    label: str
    folder: bool
    cameras: bool
    points: bool
    read: Callable[[Path, OrientationOptions], Read]
    write: Callable[[Block, Path, OrientationOptions], Written]
    written: bool = True


def _needed(options: OrientationOptions) -> Camera:
    if options.camera is None:
        raise UserError(
            "The format holds no cameras.", "Orientations alone do not make a block.",
            "Give the camera of the photos: --camera FILE.",
        )  # fmt: skip
    return options.camera


def _only_read(_block: Block, _path: Path, _options: OrientationOptions) -> Written:
    raise UserError(
        "This format is only read here.",
        "Its files hold settings of a project besides the orientations.",
        "Choose another format.",
    )


def _write_colmap_text(block: Block, folder: Path, _options: OrientationOptions) -> Written:
    """Write the text model, and say what its cameras cost."""
    remarks, worst = [], 0.0
    for index in sorted({int(c) for c, o in zip(block.camera_of_photo, block.oriented, strict=True) if o}):
        camera = block.cameras[index]
        name, _, cost = colmap_camera(camera)
        if cost is not None and not cost.exact:
            remarks.append(cost.says(camera.label or camera.model, f"COLMAP {name}"))
            worst = max(worst, cost.max_px)
    if any(" " in name for name in block.names):
        remarks.append(
            "COLMAP's own text reader cuts names of photos at blanks: rename them, or use the binary form."
        )
    write_colmap(block, folder)
    return Written(
        tuple(folder / f"{n}.txt" for n in ("cameras", "images", "points3D")), tuple(remarks), worst
    )


ORIENTATION_FORMATS: dict[str, OrientationFormat] = {f.name: f for f in (
    OrientationFormat("colmap-text", "COLMAP model, text", True, True, True,
                      lambda path, _: block_from_model(parse_model(path)), _write_colmap_text),
    OrientationFormat("colmap-binary", "COLMAP model, binary", True, True, True,
                      lambda path, _: read_colmap_binary(path), lambda block, path, _: write_colmap_binary(block, path)),
    OrientationFormat("bundler", "Bundler (bundle.out with list.txt)", False, True, True,
                      lambda path, _: read_bundler(path), lambda block, path, _: write_bundler(block, path)),
    OrientationFormat("nvm", "VisualSFM (NVM)", False, True, True,
                      lambda path, _: read_nvm(path), lambda block, path, _: write_nvm(block, path)),
    OrientationFormat("micmac", "MicMac (folder Ori-…)", True, True, False,
                      lambda path, _: read_micmac(path), lambda block, path, _: write_micmac(block, path)),
    OrientationFormat("metashape", "Agisoft Metashape cameras (XML)", False, True, False,
                      lambda path, _: read_metashape(path), lambda block, path, _: write_metashape(block, path)),
    OrientationFormat("photomodeler", "PhotoModeler text export", False, True, True,
                      lambda path, _: read_photomodeler_export(path), _only_read, written=False),
    OrientationFormat("patb", "PAT-B orientations (.ori)", False, False, False,
                      lambda path, o: read_patb(path, _needed(o), transposed=o.transposed),
                      lambda block, path, _: write_patb(block, path)),
    OrientationFormat("table", "Table of positions and angles (CSV)", False, False, False,
                      lambda path, o: read_orientation_table(path, _needed(o)),
                      lambda block, path, o: write_orientation_table(block, path, order=o.order, angle_unit=o.angle_unit)),
)}  # fmt: skip


def orientation_format(name: str) -> OrientationFormat:
    """Return a format by name; ``colmap`` is its text form.

    Raises
    ------
    UserError
        When there is none of that name.
    """
    name = {"colmap": "colmap-text"}.get(name, name)
    if name not in ORIENTATION_FORMATS:
        raise UserError(unknown_name(name, list(ORIENTATION_FORMATS), "orientation format"))
    return ORIENTATION_FORMATS[name]


def guess_orientation_format(path: Path) -> str:
    """Return the format of a file or folder.

    Raises
    ------
    UserError
        When it does not exist or is none of the known ones.
    """
    if path.is_dir():
        for name, sign in (("colmap-binary", "images.bin"), ("colmap-text", "images.txt")):
            if (path / sign).is_file():
                return name
        if next(path.glob(f"{PREFIX}*.xml"), None) is not None:
            return "micmac"
    else:
        head = read_bytes(path)[:4000].decode("utf-8-sig", errors="replace")
        if head.startswith("NVM_V3"):
            return "nvm"
        if "Bundle file" in head[:200]:
            return "bundler"
        if "<chunk" in head or "<document" in head:
            return "metashape"
        if is_photomodeler_export(head.splitlines()):
            return "photomodeler"
        if path.suffix.casefold() == ".ori":
            return "patb"
        if path.suffix.casefold() in (".csv", ".txt", ".tsv"):
            return "table"
    raise UserError(
        Text("The format of {name} was not recognised.", name=path.name),
        Text("Known are {names}.", names=", ".join(ORIENTATION_FORMATS)), "Say which it is with --from.",
    )  # fmt: skip
