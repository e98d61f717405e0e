"""Depth maps of all photos by multi-view matching, with the agreement between them checked."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Array, Block, DepthMap
from graphos_core.dense.coarse_to_fine import Matching, Surface, estimate, step_of_inverse_depth
from graphos_core.dense.consistency import InverseMap, consistent_views
from graphos_core.dense.consistency_kernels import remove_speckles
from graphos_core.dense.neighbours import Neighbourhood, choose_neighbours
from graphos_core.dense.undistort import Undistortion, View, grey_view, undistortion
from graphos_core.errors import UserError
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.roles import MaskReader, Reader
from graphos_core.run import Run, each, map_items
from graphos_core.text import Text


class MultiViewParams(Params):
    """How depth maps are made."""

    image_size: Annotated[int, About(
        label="Picture size", symbol="s", unit="px", low=200, high=6000, step=100, level="novice", group="Size",
        help="Longer side of the pictures that are matched; larger photos are reduced to it.",
        effect="Higher: finer detail and more points, time and memory grow with its square. Lower: faster, smoother.",
        learn="dense/multiview")] = 1200  # fmt: skip
    neighbours: Annotated[int, About(
        label="Neighbours", symbol="n", unit="photos", low=1, high=10, step=1, group="Size",
        help="Photos with which each photo is matched, chosen by common points, intersection angle and scale.",
        effect="Higher: safer where things hide each other, slower. Lower: faster, more gaps behind edges.",
        learn="dense/multiview")] = 4  # fmt: skip
    cost: Annotated[Literal["zncc", "census"], About(
        label="Similarity", group="Matching",
        help="How two small windows are compared: by correlation of grey values, or by which pixels are brighter "
        "than the centre.",
        effect="Correlation is more precise; census bears reflections and different exposure better.",
        choices={"zncc": "Correlation (ZNCC)", "census": "Census"}, learn="dense/multiview")] = "zncc"  # fmt: skip
    window: Annotated[int, About(
        label="Window", symbol="w", unit="px", low=3, high=15, step=2, group="Matching",
        help="Side of the compared windows; an even number counts as the next odd one.",
        effect="Higher: less noise on weak texture, fine detail and edges are lost. Lower: finer, noisier.",
        learn="dense/multiview")] = 5  # fmt: skip
    noise: Annotated[float, About(
        label="Image noise", symbol="\\sigma_g", unit="grey levels", low=0.1, high=20, step=0.5, level="expert",
        group="Matching",
        help="Grey value differences of this size count as noise and not as texture.",
        effect="Higher: weak texture is trusted less and bridged by smoothness. Lower: weak texture is used.",
        )] = 2.0  # fmt: skip
    p1: Annotated[float, About(
        label="Small-step penalty", symbol="P_1", unit="of the largest cost", low=0, high=2, step=0.01,
        group="Smoothness", help="Penalty when the depth changes by one step from pixel to pixel.",
        effect="Higher: smoother slopes, rounded detail. Lower: rougher surface.", learn="dense/sgm")] = 0.06  # fmt: skip
    p2: Annotated[float, About(
        label="Jump penalty", symbol="P_2", unit="of the largest cost", low=0, high=10, step=0.1,
        group="Smoothness", help="Penalty when the depth jumps by more than one step.",
        effect="Higher: fewer outliers, thin things disappear. Lower: sharper edges, more outliers.",
        learn="dense/sgm")] = 0.6  # fmt: skip
    edge_grey: Annotated[float, About(
        label="Edge contrast", symbol="g", unit="grey levels", low=1, high=255, step=1, level="expert",
        group="Smoothness", help="Grey value difference between two pixels at which the jump penalty is halved.",
        effect="Higher: jumps are penalised everywhere alike. Lower: depth may jump more easily at image edges.",
        learn="dense/sgm")] = 12.0  # fmt: skip
    levels: Annotated[int, About(
        label="Pyramid levels", symbol="L", unit="levels", low=1, high=7, step=1, level="expert", group="Depths",
        help="Sizes of the picture, each half of the one before; all depths are tried on the smallest only.",
        effect="Higher: faster, small things in front may be lost. Lower: slower, every depth is tried in finer "
        "pictures.")] = 4  # fmt: skip
    step_px: Annotated[float, About(
        label="Step", symbol="\\Delta", unit="px", low=0.1, high=2, step=0.1, level="expert", group="Depths",
        help="Distance of two tried depths, as parallax in the neighbour with the longest base.",
        effect="Higher: faster, less precise. Lower: slower, narrower search on the finer levels.")] = 0.5  # fmt: skip
    most_depths: Annotated[int, About(
        label="Most depths", symbol="D", unit="depths", low=16, high=1024, step=16, level="expert", group="Depths",
        help="Largest number of depths tried on the smallest picture; the step grows where it needs more.",
        effect="Higher: deep scenes are sampled finely, slower. Lower: faster.")] = 256  # fmt: skip
    local_depths: Annotated[int, About(
        label="Local depths", symbol="d", unit="depths", low=4, high=64, step=4, level="expert", group="Depths",
        help="Depths tried for each pixel of the finer levels, round the depth found before.",
        effect="Higher: edges recover better, slower. Lower: faster, follows the coarse surface.")] = 16  # fmt: skip
    consistent_views: Annotated[int, About(
        label="Confirming photos", symbol="c", unit="photos", low=0, high=10, step=1, level="novice",
        group="Checking", help="In how many other depth maps a depth must be found again.",
        effect="Higher: fewer wrong points, more holes. Lower: more complete, more wrong points.",
        learn="dense/consistency")] = 1  # fmt: skip
    consistency_px: Annotated[float, About(
        label="Agreement", symbol="\\tau", unit="px", low=0.1, high=10, step=0.1, group="Checking",
        help="How much parallax two depths of the same point may differ.",
        effect="Higher: more complete, noisier. Lower: only well determined points stay.",
        learn="dense/consistency")] = 0.7  # fmt: skip
    least_score: Annotated[float, About(
        label="Least similarity", symbol="\\rho_0", unit="1", low=0, high=1, step=0.05, group="Checking",
        help="Depths whose windows are less alike than this are dropped.",
        effect="Higher: only well textured parts stay. Lower: weakly textured parts stay too.")] = 0.3  # fmt: skip
    speckle: Annotated[int, About(
        label="Smallest part", symbol="a", unit="px", low=0, high=10000, step=10, level="expert", group="Checking",
        help="Separate parts of the depth map with fewer pixels are dropped.",
        effect="Higher: fewer floating specks, small things disappear. Lower: everything stays.")] = 60  # fmt: skip

    def matching(self) -> Matching:
        """Return what one photo needs to know, in the units of the kernels."""
        return Matching(
            window=self.window | 1,
            census=self.cost == "census",
            noise=self.noise,
            p1=round(self.p1 * 1000.0),
            p2=round(self.p2 * 1000.0),
            edge_grey=self.edge_grey,
            levels=self.levels,
            step_px=self.step_px,
            most_depths=self.most_depths,
            local_depths=self.local_depths,
        )


CHECKED_WITH = 10
"""Largest number of other maps in which a depth is looked up."""


@algorithm(
    stage="dense",
    role="depth",
    name="multiview",
    label="Multi-view semi-global matching",
    source="Hirschmüller 2008, Stereo processing by semiglobal matching and mutual information; "
    "Collins 1996, space sweep",
    learn="dense/multiview",
)
def multiview(
    block: Block, read: Reader, params: MultiViewParams, *, run: Run, mask: MaskReader | None = None
) -> tuple[DepthMap, ...]:
    """Match every photo with its best neighbours and keep the depths that other photos confirm.

    For each photo: similarity of small windows along inverse depth, averaged over the better half of the
    neighbours; semi-global aggregation over eight directions; coarse to fine; then the maps are compared with
    each other.

    Parameters
    ----------
    block : Block
        Adjusted.
    read : Reader
    params : MultiViewParams
    run : Run
        Shows each finished, unchecked map as ``"depth_map"``.
    mask : MaskReader, optional
        Masked pixels get no depth and give no photo support.

    Returns
    -------
    tuple of DepthMap
        One per photo that has neighbours, in the order of the photos.

    Raises
    ------
    UserError
        When no photo has a neighbour.
    Stopped
        When the person asked to stop.
    """
    places = choose_neighbours(block, params.neighbours)
    _warn_left_out(block, places, run)
    photos = [place.photo for place in places]
    views = _read_views(block, read, mask, params.image_size, photos, run)
    job = partial(_match_photo, views=views, how=params.matching(), run=run)
    surfaces = map_items(run, job, places, "depth maps")
    return _checked(block, places, views, surfaces, params, run)


def _warn_left_out(block: Block, places: list[Neighbourhood], run: Run) -> None:
    matched = {place.photo for place in places}
    left_out = [block.names[i] for i in np.flatnonzero(block.oriented) if int(i) not in matched]
    if not places:
        raise UserError(
            Text("No photo has a neighbour to be matched with."),
            Text(
                "Dense matching needs oriented photos that share object points under an intersection angle."
            ),
            Text("Orient at least two overlapping photos first."),
            "dense/multiview",
        )
    if left_out:
        run.warn(
            Text("No depth map for {names}: too few object points in common.", names=", ".join(left_out))
        )


def _read_views(
    block: Block, read: Reader, mask: MaskReader | None, side: int, photos: list[int], run: Run
) -> dict[int, View]:
    """Return the reduced distortion-free grey picture of each photo that is matched or a neighbour."""
    views: dict[int, View] = {}
    ways: dict[int, Undistortion] = {}
    for photo in each(run, photos, "photos"):
        camera = int(block.camera_of_photo[photo])
        if camera not in ways:
            ways[camera] = undistortion(block.cameras[camera], side)
        free = mask(photo) if mask is not None else None
        views[photo] = grey_view(block, photo, read(photo), ways[camera], free)
    return views


def _match_photo(place: Neighbourhood, *, views: dict[int, View], how: Matching, run: Run) -> Surface:
    """Match one photo; independent of all others."""
    view = views[place.photo]
    others = [views[n] for n in place.neighbours if n in views]
    surface = estimate(view, others, place.near, place.far, how, run=run)
    run.show(
        "depth_map",
        _depth_map(place, view, surface.inverse_depth, surface.score),
    )
    return surface


def _depth_map(place: Neighbourhood, view: View, inverse_depth: Array, score: Array) -> DepthMap:
    with np.errstate(divide="ignore"):
        depth = np.where(inverse_depth > 0.0, np.float32(1.0) / inverse_depth, np.float32(np.nan))
    return DepthMap(
        photo=place.photo,
        depth=depth.astype(np.float32),
        confidence=score,
        focal_px=view.focal_px,
        cx=view.cx,
        cy=view.cy,
        neighbours=place.neighbours,
    )


def _checked(
    block: Block,
    places: list[Neighbourhood],
    views: dict[int, View],
    surfaces: list[Surface],
    params: MultiViewParams,
    run: Run,
) -> tuple[DepthMap, ...]:
    """Return the maps without what other maps do not confirm."""
    maps = {
        place.photo: _trusted(place, views, surface, params)
        for place, surface in zip(places, surfaces, strict=True)
    }
    partners = {p.photo: p.neighbours for p in choose_neighbours(block, CHECKED_WITH)}
    check = partial(_confirm, maps=maps, partners=partners, params=params, run=run)
    kept = map_items(run, check, [place.photo for place in places], "depth maps checked")
    return tuple(
        _depth_map(place, views[place.photo], inverse, surface.score)
        for place, inverse, surface in zip(places, kept, surfaces, strict=True)
    )


def _trusted(
    place: Neighbourhood, views: dict[int, View], surface: Surface, params: MultiViewParams
) -> InverseMap:
    """Return the map without depths of low score, at the end of their range or outside the range of depths."""
    view = views[place.photo]
    others = [views[n] for n in place.neighbours if n in views]
    pixel = step_of_inverse_depth(view, others, place.near, place.far, 1.0)
    inverse = surface.inverse_depth.copy()
    inverse[surface.edge | (surface.score < params.least_score)] = 0.0
    inverse[(inverse < 1.0 / place.far) | (inverse > 1.0 / place.near)] = 0.0
    return InverseMap(view, inverse, pixel)


def _confirm(
    photo: int,
    *,
    maps: dict[int, InverseMap],
    partners: dict[int, tuple[int, ...]],
    params: MultiViewParams,
    run: Run,
) -> Array:
    own = maps[photo]
    inverse = own.inverse_depth.copy()
    if params.consistent_views > 0:
        others = [maps[p] for p in partners[photo] if p in maps]
        count = consistent_views(own, others, params.consistency_px, run)
        inverse[count < min(params.consistent_views, len(others))] = 0.0
    run.check()
    remove_speckles(inverse, own.pixel, params.speckle)
    return inverse
