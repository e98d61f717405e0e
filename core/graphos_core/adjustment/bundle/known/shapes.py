"""Planes, lines and axes from a `KnownShape` and where its points are now."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.known.group import Extra, Group
from graphos_core.adjustment.bundle.known.points import Coordinates, Directions, Flat
from graphos_core.data import Array, Block, KnownShape
from graphos_core.errors import UserError
from graphos_core.run import Run
from graphos_core.text import Text

NEEDED = {
    "horizontal plane": 2,
    "plane": 4,
    "line": 3,
    "vertical line": 2,
    "x axis": 2,
    "y axis": 2,
    "z axis": 2,
}
"""Fewest points with which a shape says something."""


def groups_of(shape: KnownShape, block: Block, named: dict[str, int], unit: str, run: Run) -> list[Group]:
    """Return the group of a shape, or nothing where too few of its points are measured, which is told.

    Raises
    ------
    UserError
        For an unknown kind.
    """
    if shape.kind not in NEEDED:
        raise UserError(
            Text("“{kind}” is not a shape.", kind=shape.kind), todo=f"Choose one of: {', '.join(NEEDED)}."
        )
    here = [name for name in dict.fromkeys(shape.points) if name in named]
    given = shape.kind == "horizontal plane" and shape.value is not None
    if len(here) < (1 if given else NEEDED[shape.kind]):
        run.warn(Text("“{name}” takes no part: {count} of its points are measured, {need} are needed.",
                      name=shape.name or shape.kind, count=len(here), need=NEEDED[shape.kind]))  # fmt: skip
        return []
    point = np.array([named[name] for name in here], dtype=np.int64)
    xyz = np.asarray(block.points[point])
    title = shape.name or shape.kind
    if given:
        sigma = np.full(len(point), shape.sigma)
        labels = [f"{title}: {name}" for name in here]
        z = np.full(len(point), float(shape.value or 0.0))
        return [Coordinates(point, np.full(len(point), 2), z, sigma, labels, unit, "planes")]
    if shape.kind.endswith("axis"):
        return [_axis(shape, point, here, title, unit)]
    return [_flat(shape, point, xyz, here, title, unit)]


def _axis(shape: KnownShape, point: Array, here: list[str], title: str, unit: str) -> Directions:
    along = "xyz".index(shape.kind[0])
    others = [axis for axis in range(3) if axis != along]
    pairs = len(point) - 1
    return Directions(
        a=np.repeat(point[0], 2 * pairs),
        b=np.repeat(point[1:], 2),
        axis=np.tile(others, pairs),
        sigma=np.full(2 * pairs, shape.sigma),
        labels=[f"{title}: {here[0]}–{name} {'XYZ'[axis]}" for name in here[1:] for axis in others],
        unit=unit,
    )


def _flat(shape: KnownShape, point: Array, xyz: Array, here: list[str], title: str, unit: str) -> Flat:
    origin = xyz.mean(axis=0)
    normals = 2 if "line" in shape.kind else 1
    tilts = shape.kind in ("plane", "line")
    if tilts:
        frame = np.linalg.svd(xyz - origin, full_matrices=True)[2][::-1]  # smallest extent first
    else:
        frame = np.eye(3)[[0, 1, 2]] if normals == 2 else np.eye(3)[[2, 0, 1]]
    extras: list[Extra] = []
    for i in range(normals):
        extras.append(Extra(f"{title}: offset {i + 1}", 0.0, unit))
        if tilts:
            extras += [Extra(f"{title}: slope {i + 1}.{j + 1}", 0.0, "") for j in range(3 - normals)]
    axes = [""] if normals == 1 else [" 1", " 2"]
    return Flat(
        point=point, origin=origin, frame=np.ascontiguousarray(frame), normals=normals, tilts=tilts, given=False,
        sigma=np.full(normals * len(point), shape.sigma),
        labels=[f"{title}: {name}{axis}" for name in here for axis in axes], extras=tuple(extras),
        kind="planes" if normals == 1 else "lines", unit=unit,
    )  # fmt: skip
