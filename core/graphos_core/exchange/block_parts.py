"""From the pieces that a file of another program holds to a `Block`, and what is said on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.exchange.camera_fit import from_foreign
from graphos_core.exchange.formulas import ForeignCamera
from graphos_core.text import Text

GREY = 128
"""Colour of points whose colour a file does not tell."""

RIGHT_ANGLE = 1e-3
"""Largest deviation of a read rotation matrix from an orthogonal one."""


@dataclass(frozen=True)
class Read:
    """A block read from a file, with what the file could not tell or had to be approximated, in sentences."""

    block: Block
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Written:
    """Files written, what the format could not express, and the largest residual of a camera, px."""

    files: tuple[Path, ...]
    remarks: tuple[str, ...] = ()
    max_px: float = 0.0


@dataclass
class Parts:
    """What has been read so far.

    Attributes
    ----------
    names, camera_of_photo, rotations, centres : lists
        One entry per photo; ``cam_from_world`` and projection centre; None where not oriented.
    points, colours : lists
    observations : list of (point, photo, x, y)
        Pixels, ours.
    """

    cameras: list[Camera] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    camera_of_photo: list[int] = field(default_factory=list)
    rotations: list[Array | None] = field(default_factory=list)
    centres: list[Array] = field(default_factory=list)
    points: list[Sequence[float]] = field(default_factory=list)
    colours: list[Sequence[int]] = field(default_factory=list)
    observations: list[tuple[int, int, float, float]] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    unit: str = "model units"

    def add_camera(self, source: ForeignCamera) -> int:
        """Convert a camera and return its index; an approximation is remarked."""
        found = from_foreign(source)
        if not found.exact:
            self.remarks.append(found.says(source.label or source.formula, found.camera.model))
        self.cameras.append(found.camera)
        return len(self.cameras) - 1

    def add_photo(self, name: str, camera: int, rotation: Array | None, centre: Array | None) -> None:
        """Add a photo; one without rotation or centre is not oriented.

        Raises
        ------
        ValueError
            When the matrix is no rotation or a number is not finite.
        """
        oriented = rotation is not None and centre is not None
        if oriented and not (np.isfinite(rotation).all() and np.isfinite(centre).all()):  # type: ignore[arg-type]
            raise ValueError("a number is not finite")
        self.names.append(name)
        self.camera_of_photo.append(camera)
        self.rotations.append(nearest_rotation(rotation) if oriented and rotation is not None else None)
        self.centres.append(np.asarray(centre, dtype=np.float64) if oriented else np.zeros(3))

    def block(self) -> Block:
        """Put the block together; a second observation of a point in one photo is left out and counted."""
        if len(set(self.names)) < len(self.names):
            raise UserError(
                "Two photos have the same name.",
                Text(
                    "{name} occurs more than once.",
                    name=next(n for n in self.names if self.names.count(n) > 1),
                ),
                "Give the photos different names before exporting.",
            )
        table = np.array(self.observations, dtype=np.float64).reshape(-1, 4)
        _, first = np.unique(table[:, :2], axis=0, return_index=True)
        if len(first) < len(table):
            self.remarks.append(Text(
                "{count} observations were left out: a point was seen twice in one photo.", count=len(table) - len(first)
            ))  # fmt: skip
        table = table[first]
        n, p = len(self.names), len(self.points)
        rotations = [np.eye(3) if r is None else r for r in self.rotations]
        colours = self.colours or [(GREY, GREY, GREY)] * p
        return Block(
            cameras=tuple(self.cameras), names=tuple(self.names),
            camera_of_photo=np.array(self.camera_of_photo, dtype=np.int32),
            oriented=np.array([r is not None for r in self.rotations], dtype=bool),
            rotations=np.array(rotations).reshape(n, 3, 3), centres=np.array(self.centres).reshape(n, 3),
            points=np.array(self.points, dtype=np.float64).reshape(p, 3),
            colours=np.array(colours, dtype=np.uint8).reshape(p, 3),
            point_track=np.full(p, -1, dtype=np.int32),
            obs_photo=table[:, 1].astype(np.int32), obs_point=table[:, 0].astype(np.int32),
            obs_xy=np.ascontiguousarray(table[:, 2:]), unit=self.unit,
        )  # fmt: skip

    def read(self) -> Read:
        """Return the block with its remarks."""
        return Read(self.block(), tuple(self.remarks))


def nearest_rotation(matrix: Array) -> Array:
    """Return the rotation nearest to a matrix (3, 3) printed with few digits.

    Raises
    ------
    ValueError
        When it is not nearly a rotation: mirrored, scaled, or not orthogonal.
    """
    u, s, vt = np.linalg.svd(np.asarray(matrix, dtype=np.float64))
    if np.abs(s - 1.0).max() > RIGHT_ANGLE or np.linalg.det(u @ vt) < 0:
        raise ValueError("a rotation matrix is not one")
    rotation: Array = u @ vt
    return rotation


def observations_of(block: Block, photo: int) -> Array:
    """Return which observations lie in a photo."""
    return np.flatnonzero(block.obs_photo == photo)


def reprojection_px(block: Block) -> Array:
    """Return the residual (m, 2), projected − measured, px; NaN where there is no image or no orientation."""
    out = np.full((len(block.obs_photo), 2), np.nan)
    for photo in np.flatnonzero(block.oriented):
        mine = observations_of(block, int(photo))
        in_camera = (block.points[block.obs_point[mine]] - block.centres[photo]) @ block.rotations[photo].T
        out[mine] = (
            pixel_from_ray(block.cameras[block.camera_of_photo[photo]], in_camera) - block.obs_xy[mine]
        )
    return out
