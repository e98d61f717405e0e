"""COLMAP's binary model: ``cameras.bin``, ``images.bin``, ``points3D.bin``, little-endian (its ``doc/format.rst``)."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from graphos_core.data import Array, Block
from graphos_core.errors import UserError
from graphos_core.exchange.block_parts import Read, Written
from graphos_core.exchange.colmap_lines import Image, Model, parameter_count
from graphos_core.exchange.colmap_model import HALF, block_from_model, colmap_camera, distances_px
from graphos_core.exchange.text_files import read_bytes
from graphos_core.geometry.rotation import quaternion_from_matrix
from graphos_core.store import write_bytes
from graphos_core.text import Text

MODELS = (
    "SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "OPENCV_FISHEYE", "FULL_OPENCV", "FOV",
    "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE", "THIN_PRISM_FISHEYE", "RAD_TAN_THIN_PRISM_FISHEYE",
    "SIMPLE_DIVISION", "DIVISION", "SIMPLE_FISHEYE", "FISHEYE", "EUCM", "EQUIRECTANGULAR",
)  # fmt: skip
"""COLMAP's camera models by their number."""

NO_POINT = 2**64 - 1
"""Point of an image position that belongs to none."""


def read_colmap_binary(folder: Path) -> Read:
    """Read a binary model.

    Raises
    ------
    UserError
        When a file is missing or damaged, or a camera model is not supported.
    """
    file = _Bytes(folder / "images.bin")
    cameras, images = _cameras(_Bytes(folder / "cameras.bin")), _images(file)
    if any(image.camera not in cameras for image in images):
        raise file.damaged()
    return block_from_model(Model(cameras, images, _points(_Bytes(folder / "points3D.bin"))))


class _Bytes:
    """A file read from front to back; running over its end, or a number that is not finite, is damage."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.content = read_bytes(path)
        self.at = 0

    def take(self, form: str) -> tuple[int | float, ...]:
        size = struct.calcsize("<" + form)
        if self.at + size > len(self.content):
            raise self.damaged()
        values = struct.unpack_from("<" + form, self.content, self.at)
        self.at += size
        if not np.isfinite(values).all():
            raise self.damaged()
        return values

    def count(self, smallest: int) -> int:
        """Take a number of items of at least so many bytes each."""
        number = int(self.take("Q")[0])
        if number * smallest > len(self.content) - self.at:
            raise self.damaged()
        return number

    def array(self, kind: np.dtype[np.void], count: int) -> np.ndarray[tuple[int], np.dtype[np.void]]:
        values = np.frombuffer(self.content, dtype=kind, count=count, offset=self.at)
        self.at += kind.itemsize * count
        return values

    def word(self) -> str:
        end = self.content.find(b"\0", self.at)
        if end < 0:
            raise self.damaged()
        text = self.content[self.at : end].decode("utf-8", errors="replace")
        self.at = end + 1
        return text

    def damaged(self) -> UserError:
        return UserError(
            Text("{name} could not be read.", name=self.path.name),
            "It is cut off or damaged, or not a file of COLMAP.",
            "Export the model again.",
        )


def _cameras(file: _Bytes) -> dict[int, tuple[str, int, int, tuple[float, ...]]]:
    found = {}
    for _ in range(file.count(24)):
        number, model, width, height = (int(v) for v in file.take("IiQQ"))
        if not (0 <= model < len(MODELS) and 0 < width < 10**6 and 0 < height < 10**6):
            raise file.damaged()
        name = MODELS[model]
        found[number] = (name, width, height, tuple(float(v) for v in file.take("d" * parameter_count(name))))
    return found


def _images(file: _Bytes) -> list[Image]:
    kind = np.dtype([("xy", "<f8", 2), ("point", "<i8")])
    images = []
    for _ in range(file.count(64)):
        number, *pose, camera = file.take("I7dI")
        name = file.word()
        table = file.array(kind, file.count(kind.itemsize))
        if not 1e-9 < max(abs(v) for v in pose[:4]) < 1e9 or not np.isfinite(table["xy"]).all():
            raise file.damaged()
        images.append(Image(int(number), np.array(pose[:4]), np.array(pose[4:]), int(camera), name,
                            table["xy"], table["point"]))  # fmt: skip
    return images


def _points(file: _Bytes) -> dict[int, tuple[tuple[float, ...], tuple[int, ...]]]:
    found: dict[int, tuple[tuple[float, ...], tuple[int, ...]]] = {}
    for _ in range(file.count(51)):
        number, x, y, z, r, g, b, _ = file.take("QdddBBBd")
        length = file.count(8)  # the track stands in the images too
        file.at += 8 * length
        found[int(number)] = ((float(x), float(y), float(z)), (int(r), int(g), int(b)))
    return found


def write_colmap_binary(block: Block, folder: Path) -> Written:
    """Write the oriented photos of a block, its cameras and points.

    Raises
    ------
    UserError
        When a file cannot be written.
    """
    oriented = np.flatnonzero(block.oriented)
    used = sorted({int(block.camera_of_photo[photo]) for photo in oriented})
    remarks, worst = [], 0.0
    out = [struct.pack("<Q", len(used))]
    for index in used:
        camera = block.cameras[index]
        name, values, cost = colmap_camera(camera)
        if cost is not None and not cost.exact:
            remarks.append(cost.says(camera.label or camera.model, f"COLMAP {name}"))
            worst = max(worst, cost.max_px)
        out.append(struct.pack("<IiQQ", index + 1, MODELS.index(name), camera.width, camera.height))
        out.append(values.astype("<f8").tobytes())
    write_bytes(folder / "cameras.bin", b"".join(out))
    position = np.zeros(len(block.obs_photo), dtype=np.int64)
    write_bytes(folder / "images.bin", _image_bytes(block, oriented, position))
    write_bytes(folder / "points3D.bin", _point_bytes(block, position))
    return Written(
        tuple(folder / f"{n}.bin" for n in ("cameras", "images", "points3D")), tuple(remarks), worst
    )


def _image_bytes(block: Block, oriented: Array, position: Array) -> bytes:
    """Return the images; `position` takes the place of each observation in its photo."""
    kind = np.dtype([("xy", "<f8", 2), ("point", "<i8")])
    out = [struct.pack("<Q", len(oriented))]
    for photo in oriented.tolist():
        rotation = block.rotations[photo]
        pose = [*quaternion_from_matrix(rotation), *(-rotation @ block.centres[photo])]
        out.append(struct.pack("<I7dI", photo + 1, *pose, block.camera_of_photo[photo] + 1))
        out.append(block.names[photo].encode() + b"\0")
        mine = np.flatnonzero(block.obs_photo == photo)
        position[mine] = np.arange(len(mine))
        table = np.zeros(len(mine), dtype=kind)
        table["xy"], table["point"] = block.obs_xy[mine] + HALF, block.obs_point[mine] + 1
        out += [struct.pack("<Q", len(mine)), table.tobytes()]
    return b"".join(out)


def _point_bytes(block: Block, position: Array) -> bytes:
    keep = np.flatnonzero(np.asarray(block.oriented)[block.obs_photo])
    order = keep[np.argsort(block.obs_point[keep], kind="stable")]
    bounds = np.searchsorted(block.obs_point[order], np.arange(len(block.points) + 1))
    distance = distances_px(block)
    present = np.flatnonzero(np.diff(bounds) > 0)
    out = [struct.pack("<Q", len(present))]
    for i in present.tolist():
        seen = order[bounds[i] : bounds[i + 1]]
        out.append(struct.pack("<QdddBBBd", i + 1, *block.points[i], *block.colours[i].tolist(),
                               float(distance[seen].mean())))  # fmt: skip
        track = np.column_stack([block.obs_photo[seen] + 1, position[seen]]).astype("<u4")
        out += [struct.pack("<Q", len(seen)), track.tobytes()]
    return b"".join(out)
