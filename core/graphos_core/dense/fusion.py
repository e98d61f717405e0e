"""One coloured cloud with normals from all depth maps: each point once, averaged over the maps that show it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from graphos_core.data import Array, Block, Cloud, DepthMap
from graphos_core.dense.coarse_to_fine import step_of_inverse_depth
from graphos_core.dense.consistency import ROWS_PER_CALL, InverseMap, gather
from graphos_core.dense.consistency_kernels import fuse_rows, plane_rows
from graphos_core.dense.neighbours import choose_neighbours
from graphos_core.dense.undistort import Undistortion, View, undistort, undistortion
from graphos_core.errors import UserError
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.roles import Reader
from graphos_core.run import Run, each
from graphos_core.text import Text


class FusionParams(Params):
    """How depth maps become one cloud."""

    least_views: Annotated[int, About(
        label="Least photos", symbol="v", unit="photos", low=1, high=20, step=1, level="novice", group="Fusion",
        help="In how many depth maps a point must be seen.",
        effect="Higher: cleaner cloud with more holes. Lower: more complete, more wrong points.",
        learn="dense/fusion")] = 2  # fmt: skip
    agreement_px: Annotated[float, About(
        label="Merging distance", symbol="\\tau", unit="px", low=0.1, high=10, step=0.1, group="Fusion",
        help="How much parallax two depths may differ and still be the same point.",
        effect="Higher: more is merged, fewer double points. Lower: surfaces close to each other stay apart.",
        learn="dense/fusion")] = 0.7  # fmt: skip
    every: Annotated[int, About(
        label="Thinning", symbol="t", unit="px", low=1, high=16, step=1, level="novice", group="Fusion",
        help="One point is made per square of this side in the depth map.",
        effect="Higher: fewer points, smaller files. Lower: denser cloud.")] = 1  # fmt: skip
    normal_window: Annotated[int, About(
        label="Normal window", symbol="w_n", unit="px", low=3, high=21, step=2, level="expert", group="Normals",
        help="Side of the window of the depth map to which a plane is fitted for the normal.",
        effect="Higher: smoother normals. Lower: normals follow fine relief and noise.")] = 7  # fmt: skip


MERGED_WITH = 20
"""Largest number of other maps that a map is merged with."""


@algorithm(
    stage="dense",
    role="fusion",
    name="consistent",
    label="Fusion of consistent depths",
    source="Merrell et al. 2007, Real-time visibility-based fusion of depth maps, section 3, confidence left out",
    learn="dense/fusion",
)
def consistent(
    block: Block, maps: Sequence[DepthMap], read: Reader, params: FusionParams, *, run: Run
) -> Cloud:
    """Merge depth maps into one coloured cloud with normals.

    Map by map, each pixel that no earlier point contains is looked up in the other maps; the depths that agree are
    averaged along the ray of the pixel, and their pixels count as done.

    Parameters
    ----------
    block : Block
    maps : sequence of DepthMap
    read : Reader
        For the colours.
    params : FusionParams
    run : Run

    Returns
    -------
    Cloud
        In the frame and unit of the block; `Cloud.views` counts the maps that were averaged.

    Raises
    ------
    UserError
        When there is no depth map, or no point is seen often enough.
    Stopped
        When the person asked to stop.
    """
    inverse = _inverse_maps(block, maps)
    order = {int(m.photo): i for i, m in enumerate(maps)}
    partners = {p.photo: p.neighbours for p in choose_neighbours(block, MERGED_WITH)}
    done = [np.zeros(m.depth.shape, np.bool_) for m in maps]
    ways: dict[tuple[int, int], Undistortion] = {}
    parts = []
    for i in each(run, range(len(maps)), "depth maps fused"):
        others = [order[p] for p in partners.get(maps[i].photo, ()) if p in order]
        merged, views = _merge(inverse, done, i, others, params, run)
        parts.append(_points(block, maps[i], inverse[i], merged, views, read, ways, params, run))
    points, colours, normals, views = (np.concatenate([p[k] for p in parts]) for k in range(4))
    if len(points) == 0:
        raise UserError(
            Text("The depth maps gave no point."),
            Text("No depth is confirmed by {views} photos.", views=params.least_views),
            Text("Lower “Least photos”, raise “Merging distance”, or take photos with more overlap."),
            "dense/fusion",
        )
    return Cloud(points=points, colours=colours, normals=normals, views=views, unit=block.unit)


def _inverse_maps(block: Block, maps: Sequence[DepthMap]) -> list[InverseMap]:
    if not maps:
        raise UserError(
            Text("There is no depth map to fuse."), todo=Text("Run the estimation of depth maps first.")
        )
    views = {m.photo: _view(block, m) for m in maps}
    out = []
    for m in maps:
        inverse = np.where(np.isfinite(m.depth) & (m.depth > 0), 1.0 / m.depth, 0.0).astype(np.float32)
        known = inverse[inverse > 0]
        others = [views[n] for n in m.neighbours if n in views]
        middle = float(np.median(known)) if known.size else 1.0
        pixel = step_of_inverse_depth(views[m.photo], others, 1 / middle, 1 / middle, 1.0) if others else 0.0
        out.append(InverseMap(views[m.photo], inverse, pixel))
    return out


def _view(block: Block, m: DepthMap) -> View:
    blank = np.broadcast_to(np.uint8(0), m.depth.shape)
    return View(m.photo, blank, m.focal_px, m.cx, m.cy, block.rotations[m.photo], block.centres[m.photo])


def _merge(
    inverse: list[InverseMap], done: list[Array], i: int, others: list[int], params: FusionParams, run: Run
) -> tuple[Array, Array]:
    """Return merged inverse depth (h, w) and number of maps (h, w) of map i; marks what is done in the others."""
    own = inverse[i]
    if not others:
        alone = (own.inverse_depth > 0) & ~done[i] & (params.least_views <= 1)
        return np.where(alone, own.inverse_depth, 0.0).astype(np.float32), alone.astype(np.uint8)
    o = gather(own, [inverse[j] for j in others])
    others_done = np.zeros(o.depths.shape, np.bool_)
    for k, j in enumerate(others):
        others_done[k, : o.sizes[k, 0], : o.sizes[k, 1]] = done[j]
    merged, views = np.zeros(own.inverse_depth.shape, np.float32), np.zeros(own.inverse_depth.shape, np.uint8)
    for top in range(0, len(merged), ROWS_PER_CALL):
        run.check()
        bottom = min(top + ROWS_PER_CALL, len(merged))
        fuse_rows(
            own.inverse_depth, done[i], top, bottom, o.a, o.b, o.back_a, o.back_b, o.depths, others_done,
            o.sizes, o.reaches, params.agreement_px * own.pixel, params.least_views, merged, views,
        )  # fmt: skip
    for k, j in enumerate(others):
        done[j] = others_done[k, : o.sizes[k, 0], : o.sizes[k, 1]].copy()
    return merged, views


def _points(
    block: Block,
    depth_map: DepthMap,
    own: InverseMap,
    merged: Array,
    views: Array,
    read: Reader,
    ways: dict[tuple[int, int], Undistortion],
    params: FusionParams,
    run: Run,
) -> tuple[Array, Array, Array, Array]:
    """Return points, colours, normals and view counts of one merged map."""
    chosen = merged > 0
    if params.every > 1:
        grid = np.zeros_like(chosen)
        grid[:: params.every, :: params.every] = True
        chosen &= grid
    y, x = np.nonzero(chosen)
    w = merged[y, x].astype(np.float64)
    view = own.view
    rays = np.stack([(x - view.cx) / view.focal_px, (y - view.cy) / view.focal_px, np.ones(len(x))], axis=1)
    points = (rays / w[:, None]) @ view.rotation + view.centre
    normals = _normals(own, x, y, params.normal_window // 2, run) @ view.rotation
    camera = int(block.camera_of_photo[depth_map.photo])
    key = (camera, max(depth_map.depth.shape))
    if key not in ways:
        ways[key] = undistortion(block.cameras[camera], key[1])
    picture = undistort(read(depth_map.photo), ways[key])
    colours = picture[y, x] if picture.ndim == 3 else np.repeat(picture[y, x, None], 3, axis=1)
    return points, colours.astype(np.uint8), normals.astype(np.float32), views[y, x]


def _normals(own: InverseMap, x: Array, y: Array, r: int, run: Run) -> Array:
    """Return unit normals towards the camera, in the camera frame; float64 (n, 3), zeros where unknown.

    A plane n·X = 1 has the inverse depth w = n·K⁻¹(x, y, 1)ᵀ, so n = Kᵀ(a, b, c) of the fit w = a x + b y + c.
    """
    plane = np.zeros((*own.inverse_depth.shape, 3))
    for top in range(0, len(plane), ROWS_PER_CALL):
        run.check()
        plane_rows(own.inverse_depth, top, min(top + ROWS_PER_CALL, len(plane)), r, 3.0 * own.pixel, plane)
    a, b, c = plane[y, x].T
    n = np.stack([a, b, c - a * x - b * y], axis=1) @ own.view.matrix
    length = np.linalg.norm(n, axis=1, keepdims=True)
    return -n / np.where(length > 0, length, 1.0)
