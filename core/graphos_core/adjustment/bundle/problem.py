"""From a block to what the compiled loops need, and back: which unknowns are free, and where each stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from graphos_core.adjustment.bundle.kernels import Layout, Scene
from graphos_core.adjustment.bundle.known.group import Columns, Group
from graphos_core.adjustment.bundle.selection import select, usable
from graphos_core.cameras import camera_model, pre_corrected, values_of
from graphos_core.data import Array, Block
from graphos_core.errors import UserError


@dataclass(frozen=True, kw_only=True)
class Freedom:
    """Which unknowns of a block are free.

    Attributes
    ----------
    interior : tuple of tuple of str
        For each camera of the block, the names of its free parameters, such as ``("focal_px", "k1")``; cameras
        without an entry are held fixed.
    fixed_points : bool (p,) or None
        Object points held fixed (control); they may have a single ray.
    fixed_photos : bool (n,) or None
        Photos whose exterior orientation is held fixed.
    """

    interior: Sequence[Sequence[str]] = ()
    fixed_points: Array | None = None
    fixed_photos: Array | None = None


@dataclass(frozen=True)
class Problem:
    """A block in the order of the solver.

    Attributes
    ----------
    block : Block
        The block that is adjusted, without observations that cannot take part.
    layout : Layout
    scene : Scene
        Where the adjustment starts.
    order : int64 (p,)
        Block point of each solver point: points are sorted by the first photo that sees them, which keeps the
        entries of the reduced matrix that one chunk touches close together.
    observation : int64 (m,)
        Block observation of each solver observation.
    unknowns : int
        Size u of the reduced system.
    chunks : tuple of (int, int, int)
        First and last point of each chunk and the largest number of rays; depends on the block only.
    groups : tuple of Group
        Other observations than image points, as far as what they concern takes part.
    columns : tuple of Columns
        Where the unknowns of each group stand.
    """

    block: Block
    layout: Layout
    scene: Scene
    order: Array
    observation: Array
    unknowns: int
    chunks: tuple[tuple[int, int, int], ...]
    groups: tuple[Group, ...] = ()
    columns: tuple[Columns, ...] = ()

    @cached_property
    def free_points(self) -> int:
        """Number of object points that are eliminated unknowns."""
        return int(self.layout.free_point.sum())

    @property
    def fixed(self) -> Array:
        """Bool (p,): points held fixed, in the order of the solver."""
        return ~self.layout.free_point & (self.layout.point_column < 0)

    @property
    def fixed_points(self) -> Array:
        """Bool (p,): fixed points in the order of the block."""
        fixed = np.empty(len(self.order), dtype=bool)
        fixed[self.order] = self.fixed
        return fixed

    def to_block(self, scene: Scene) -> Block:
        """Return the block with the adjusted values of `scene`."""
        points = np.empty_like(scene.points)
        points[self.order] = scene.points
        cameras = tuple(
            replace(camera, values=scene.values[c, : len(camera.values)].copy())
            for c, camera in enumerate(self.block.cameras)
        )
        return replace(
            self.block, cameras=cameras, rotations=scene.rotations, centres=scene.centres, points=points
        )


def make_problem(block: Block, freedom: Freedom, groups: Sequence[Group] = ()) -> Problem:
    """Prepare the adjustment of a block.

    Parameters
    ----------
    block : Block
    freedom : Freedom
    groups : sequence of Group
        Other observations; their points and photos are indices into `block`. Points they concern become unknowns
        of the reduced system.

    Raises
    ------
    UserError
        When no observation can take part, or a camera has no parameter of a name given as free.
    """
    fixed = np.zeros(len(block.points), dtype=bool) if freedom.fixed_points is None else freedom.fixed_points
    fixed = np.asarray(fixed, dtype=bool)
    kept = np.zeros(len(block.points), dtype=bool)
    for group in groups:
        kept[group.points] = True
    whole = block
    block, points = select(block, usable(block, fixed | kept))
    if len(block.obs_xy) == 0:
        raise UserError(
            "The block has no observations to adjust.",
            "No object point is seen by two oriented photos, and none is held fixed.",
            "Orient at least two photos that share tie points.",
            learn="adjustment/overlap",
        )
    fixed, kept = fixed[points], kept[points] & ~fixed[points]
    order, start, observation = _solver_order(block)
    photo = block.obs_photo[observation].astype(np.int64)
    layout, unknowns = _layout(block, freedom, photo)
    point_column = np.where(kept[order], unknowns + 3 * (np.cumsum(kept[order]) - 1), -1)
    unknowns += 3 * int(kept.sum())
    layout = layout._replace(
        start=start, photo=photo, xy=_positions(block, observation),
        weight=_weights(block, observation), free_point=~(fixed | kept)[order],
        point_column=point_column.astype(np.int64),
    )  # fmt: skip
    used = np.bincount(photo, minlength=len(block.names)) > 0
    present, columns, extra, unknowns = _bind(whole, points, order, layout, used, groups, unknowns)
    values = np.zeros((len(block.cameras), layout.free_index.shape[1]))
    for c, camera in enumerate(block.cameras):
        values[c, : len(camera.values)] = values_of(camera)
    scene = Scene(
        values,
        np.array(block.rotations, dtype=np.float64),
        np.array(block.centres, dtype=np.float64),
        np.ascontiguousarray(block.points[order], dtype=np.float64),
        extra,
    )
    return Problem(
        block, layout, scene, order, observation, unknowns, chunks_of(start, unknowns), present, columns
    )


def _positions(block: Block, observation: Array) -> Array:
    """Return the measured positions, freed from the fixed corrections of chained camera models."""
    xy = np.ascontiguousarray(block.obs_xy[observation], dtype=np.float64)
    for c, camera in enumerate(block.cameras):
        if camera.before:
            mine = np.asarray(block.camera_of_photo)[block.obs_photo[observation]] == c
            xy[mine] = pre_corrected(camera, xy[mine])
    return xy


def _weights(block: Block, observation: Array) -> Array:
    if block.obs_sigma_px is None:
        return np.ones(len(observation))
    return np.asarray(1.0 / np.asarray(block.obs_sigma_px, dtype=np.float64)[observation] ** 2)


def _bind(
    whole: Block, points: Array, order: Array, layout: Layout, used: Array, groups: Sequence[Group], unknowns: int
) -> tuple[tuple[Group, ...], tuple[Columns, ...], Array, int]:  # fmt: skip
    """Find where the unknowns of each group stand; its own unknowns follow all others."""
    if not groups:
        return (), (), np.empty(0), unknowns
    place = np.full(len(whole.points), -1, dtype=np.int64)
    place[points[order]] = np.arange(len(order))
    column = np.full(len(whole.points), -1, dtype=np.int64)
    column[points[order]] = layout.point_column
    photo = np.where(layout.pose > 0, layout.photo_column, -1)
    camera = _camera_columns(layout)
    present: list[Group] = []
    bound: list[Columns] = []
    start: list[float] = []
    for group in groups:
        rest = group.restrict(place >= 0, used)
        if rest is None:
            continue
        present.append(rest)
        bound.append(Columns(place, column, photo, camera, unknowns, len(start)))
        unknowns += len(rest.extras)
        start += [extra.value for extra in rest.extras]
    return tuple(present), tuple(bound), np.array(start, dtype=np.float64), unknowns


def _camera_columns(layout: Layout) -> Array:
    """Return the column (c, k) of each camera parameter, −1 where it is fixed."""
    out = np.full(layout.free_index.shape, -1, dtype=np.int64)
    for c, count in enumerate(layout.free_count):
        index = layout.free_index[c, :count]
        if layout.camera_column[c] >= 0:
            out[c, index] = layout.camera_column[c] + np.arange(count)
        elif count:  # of one photo alone
            n = int(np.flatnonzero((layout.camera == c) & (layout.width > layout.pose))[0])
            out[c, index] = layout.photo_column[n] + layout.pose[n] + np.arange(count)
    return out


def _solver_order(block: Block) -> tuple[Array, Array, Array]:
    """Return the block point of each solver point, the start of its observations, and their block indices."""
    start = np.searchsorted(block.obs_point, np.arange(len(block.points) + 1))
    order = np.argsort(block.obs_photo[start[:-1]], kind="stable")
    rays = np.diff(start)[order]
    sorted_start = np.concatenate(([0], np.cumsum(rays)))
    observation = np.repeat(start[:-1][order] - sorted_start[:-1], rays) + np.arange(sorted_start[-1])
    return order, sorted_start.astype(np.int64), observation


def _layout(block: Block, freedom: Freedom, photo: Array) -> tuple[Layout, int]:
    """Assign columns to the reduced unknowns: photo by photo, then the cameras that several photos share."""
    n, c = len(block.names), len(block.cameras)
    used = np.bincount(photo, minlength=n) > 0
    camera = np.asarray(block.camera_of_photo, dtype=np.int64)
    photos_of_camera = np.bincount(camera[used], minlength=c)
    free_index, free_count = _free_parameters(block, freedom)
    free_count[photos_of_camera == 0] = 0
    fixed_photos = np.zeros(n, dtype=bool) if freedom.fixed_photos is None else freedom.fixed_photos
    pose = np.where(used & ~np.asarray(fixed_photos, dtype=bool), 6, 0).astype(np.int64)
    own = used & (photos_of_camera[camera] == 1)
    width = pose + np.where(own, free_count[camera], 0)
    photo_column = np.cumsum(width) - width
    shared = np.where(photos_of_camera > 1, free_count, 0)
    camera_column = np.where(shared > 0, width.sum() + np.cumsum(shared) - shared, -1)
    codes = np.array([camera_model(camera.model).residual_code for camera in block.cameras], dtype=np.int64)
    nothing = np.empty(0, dtype=np.int64)
    layout = Layout(
        codes, camera, nothing, nothing, np.empty((0, 2)), np.empty(0), np.empty(0, dtype=bool), nothing,
        photo_column, pose, width, camera_column.astype(np.int64), free_index, free_count,
        np.array([9 + int(free_count.max(initial=0))], dtype=np.int64),
    )  # fmt: skip
    return layout, int(width.sum() + shared.sum())


def _free_parameters(block: Block, freedom: Freedom) -> tuple[Array, Array]:
    most = max(len(camera_model(camera.model).parameters) for camera in block.cameras)
    free_index = np.zeros((len(block.cameras), most), dtype=np.int64)
    free_count = np.zeros(len(block.cameras), dtype=np.int64)
    for c, names in enumerate(freedom.interior):
        model = camera_model(block.cameras[c].model)
        known = model.names
        unknown = [name for name in names if name not in known]
        if unknown:
            raise UserError(
                f"The camera model “{model.label}” has no parameter {', '.join(unknown)}.",
                todo=f"Free some of: {', '.join(known)}.",
            )
        index = sorted(known.index(name) for name in set(names))
        free_index[c, : len(index)] = index
        free_count[c] = len(index)
    return free_index, free_count


def chunks_of(start: Array, unknowns: int) -> tuple[tuple[int, int, int], ...]:
    """Cut the points into chunks of equal work; how many depends on the size of the block, not on threads."""
    rays = np.diff(start)
    work = np.cumsum(rays.astype(np.float64) * (rays + 8))
    most = 8 if unknowns <= 150 else 4 if unknowns <= 300 else 2  # every chunk has a matrix of its own
    count = int(np.clip(work[-1] / 20000.0, 1, most))
    cuts = np.searchsorted(work, work[-1] * np.arange(1, count) / count)
    edges = [0, *(int(cut) for cut in cuts), len(rays)]
    return tuple((a, b, int(rays[a:b].max())) for a, b in pairwise(edges) if b > a)
