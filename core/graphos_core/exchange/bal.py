"""Bundle Adjustment in the Large: problems of Agarwal, Snavely, Seitz and Szeliski 2010, as text.

Their camera looks along −z with y up, ``p = −P / P_z``, ``x = f (1 + k1 |p|² + k2 |p|⁴) p``, with the origin in the
image centre and y up. Ours looks along +z with y down: ``R = diag(1, −1, −1) R_bal``, and image y changes its sign.
The distortion is the same.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from graphos_core.data import Array, Block, Camera
from graphos_core.errors import UserError
from graphos_core.geometry.rotation import FLIP, matrix_from_vector

FREE = ("focal_px", "k1", "k2")
"""What a BAL problem leaves free in each camera; the principal point is fixed at (0, 0)."""


def read_bal(path: str | Path) -> Block:
    """Read a BAL problem; each photo has a camera of its own, model ``"basic"``, principal point (0, 0).

    Parameters
    ----------
    path : str or Path
        Text: ``cameras points observations``, then ``camera point x y`` per observation, then 9 numbers per camera
        (rotation vector, translation, f, k1, k2) and 3 per point.

    Returns
    -------
    Block
        Unit ``"model units"``; format 0 × 0, which BAL does not tell.

    Raises
    ------
    UserError
        When the file is not such a problem.
    """
    path = Path(path)
    try:
        numbers = np.array(path.read_text(encoding="ascii").split(), dtype=np.float64)
        n, p, m = (int(value) for value in numbers[:3])
    except (OSError, ValueError) as problem:
        raise _not_bal(path) from problem
    if min(n, p, m) < 1 or len(numbers) != 3 + 4 * m + 9 * n + 3 * p:
        raise _not_bal(path)
    observed = numbers[3 : 3 + 4 * m].reshape(m, 4)
    cameras = numbers[3 + 4 * m : 3 + 4 * m + 9 * n].reshape(n, 9)
    points = numbers[3 + 4 * m + 9 * n :].reshape(p, 3)
    photo, point = observed[:, 0].astype(np.int32), observed[:, 1].astype(np.int32)
    if photo.min() < 0 or photo.max() >= n or point.min() < 0 or point.max() >= p:
        raise _not_bal(path)
    return _block(cameras, points, photo, point, observed[:, 2:] * [1.0, -1.0])


def _block(cameras: Array, points: Array, photo: Array, point: Array, xy: Array) -> Block:
    n, p = len(cameras), len(points)
    bal = np.stack([matrix_from_vector(camera[:3]) for camera in cameras])
    order = np.lexsort((photo, point))
    return Block(
        cameras=tuple(
            Camera(model="basic", width=0, height=0, values=np.array([f, 0.0, 0.0, k1, k2]), label=f"BAL {i}")
            for i, (f, k1, k2) in enumerate(cameras[:, 6:])
        ),
        names=tuple(f"{i:04d}" for i in range(n)),
        camera_of_photo=np.arange(n, dtype=np.int32),
        oriented=np.ones(n, dtype=bool),
        rotations=FLIP @ bal,
        centres=-np.einsum("nji,nj->ni", bal, cameras[:, 3:6]),
        points=points,
        colours=np.full((p, 3), 128, dtype=np.uint8),
        point_track=np.full(p, -1, dtype=np.int32),
        obs_photo=photo[order],
        obs_point=point[order],
        obs_xy=np.ascontiguousarray(xy[order]),
    )


def _not_bal(path: Path) -> UserError:
    return UserError(
        f"{path.name} is not a BAL problem.",
        "It must hold three counts, then as many observations, cameras and points as they say.",
        "Give the decompressed text file, such as problem-49-7776-pre.txt.",
    )
