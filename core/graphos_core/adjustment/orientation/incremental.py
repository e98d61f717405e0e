"""Incremental orientation: a first pair, then one photo after another, adjusted as the block grows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from graphos_core.adjustment.orientation.components import grow_blocks, main_block
from graphos_core.adjustment.orientation.first_pair import (
    FirstPair,
    choose_first_pairs,
    chosen_first_pair,
    partners,
)
from graphos_core.adjustment.orientation.groups import groups_of
from graphos_core.adjustment.orientation.growing import GrowingBlock
from graphos_core.adjustment.orientation.growth import Growth
from graphos_core.adjustment.orientation.parameters import GrowthParams
from graphos_core.data import Block, PairMatches, PhotoSet, Tracks
from graphos_core.errors import ParamError, UserError
from graphos_core.params import About, unknown_name
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

STARTS = 3
"""First pairs tried when most photos of the group cannot be added to the block."""


class IncrementalParams(GrowthParams):
    """Parameters of the incremental orientation."""

    first_photo: Annotated[
        str | None,
        About(
            label="First photo",
            group="First pair",
            level="expert",
            help="Name of one photo of the first pair; chosen automatically where empty. Without a second photo its "
            "best partner is taken.",
            effect="A pair with many common points and a good intersection angle gives a firm start.",
            learn="adjustment/first-pair",
        ),
    ] = None
    second_photo: Annotated[
        str | None,
        About(
            label="Second photo",
            group="First pair",
            level="expert",
            help="Name of the other photo of the first pair; chosen automatically where empty.",
            effect="A pair with many common points and a good intersection angle gives a firm start.",
            learn="adjustment/first-pair",
        ),
    ] = None
    first_angle_deg: Annotated[
        float,
        About(
            label="Smallest angle of the first pair",
            symbol=r"\gamma_0",
            unit="°",
            low=0.1,
            high=90,
            step=0.5,
            group="First pair",
            level="expert",
            help="Smallest admissible median intersection angle of the rays of the first pair.",
            effect="Higher: a firmer start, but fewer pairs qualify.",
            learn="adjustment/base-and-angle",
        ),
    ] = 2.0


@algorithm(
    stage="adjustment",
    role="orientation",
    name="incremental",
    version=2,
    label="Incremental orientation",
    source="Pierrot-Deseilligny and Cléry 2011 (order of the photos); Nistér 2004 (five points); "
    "Schönberger and Frahm 2016 (rejection and re-intersection)",
    learn="adjustment/orientation",
)
def orient_incrementally(
    photos: PhotoSet, tracks: Tracks, pairs: Sequence[PairMatches], params: IncrementalParams, *, run: Run
) -> Block:
    """Orient the photos one after another, starting from the pair with many points and good intersection angles.

    Each next photo is the one whose tie points with the block have the largest smallest eigenvalue of their
    inertia matrix. It is oriented by space resection and, where that convinces less, by relative orientation to its
    best neighbour. New points are intersected from all rays and outliers rejected; the photo and its neighbours are
    adjusted each time, the whole block when it has grown by a share.

    Parameters
    ----------
    photos : PhotoSet
    tracks : Tracks
    pairs : sequence of PairMatches
        Verified pairs: they tell which photos hang together.
    params : IncrementalParams
    run : Run

    Returns
    -------
    Block
        In model units, with the tree of who was oriented on whom. Photos that could not be connected with it are in
        `Block.failures`, and those that make a block of their own in `Block.others`.

    Raises
    ------
    UserError
        With a single photo, without verified pairs, and when no pair has a base.
    """
    chosen = _chosen_photos(photos, params)
    groups = groups_of(photos, pairs)
    if chosen:
        together = [group for group in groups if set(chosen) <= set(group)]
        if not together:
            raise UserError(
                Text(
                    "{photos} cannot start the block.",
                    photos=" and ".join(photos.photos[i].name for i in chosen),
                ),
                "No verified matches connect them.",
                "Choose photos that overlap, or leave the choice to the program.",
            )
        groups = together + [group for group in groups if group not in together]

    def grown(group: tuple[int, ...]) -> Growth:
        here = chosen if set(chosen) <= set(group) else ()
        return _orient_group(photos, tracks, group, here, params, run)

    growths = grow_blocks(groups, pairs, grown, run)
    return main_block(growths, groups, params.component, chosen, run)


def _chosen_photos(photos: PhotoSet, params: IncrementalParams) -> tuple[int, ...]:
    """Return the photos that a person named for the first pair: none, one or two."""
    names = [photo.name for photo in photos.photos]
    chosen = [name for name in (params.first_photo, params.second_photo) if name]
    for name in chosen:
        if name not in names:
            raise ParamError("first_photo", unknown_name(name, names, "photo"))
    if len(chosen) == 2 and chosen[0] == chosen[1]:
        raise ParamError("second_photo", Text("First pair: needs two different photos"))
    return tuple(names.index(name) for name in chosen)


def _starts(
    block: GrowingBlock, group: tuple[int, ...], chosen: tuple[int, ...], params: IncrementalParams, run: Run
) -> list[FirstPair]:
    """Return the pairs to start from, best first."""
    angle = float(np.radians(params.first_angle_deg))
    if len(chosen) == 2:
        return [chosen_first_pair(block, *chosen, min_angle=angle, seed=run.seed)]
    among = partners(block, group, params.min_points, chosen)
    return choose_first_pairs(block, among, min_points=params.min_points, min_angle=angle, run=run)


def _orient_group(
    photos: PhotoSet,
    tracks: Tracks,
    group: tuple[int, ...],
    chosen: tuple[int, ...],
    params: IncrementalParams,
    run: Run,
) -> Growth:
    """Orient one group, from other first pairs too when the first leads to less than half of the photos."""
    empty = GrowingBlock(photos, tracks, params.reprojection_px, float(np.radians(params.min_angle_deg)))
    best: Growth | None = None
    attempts = 0
    for pair in _starts(empty, group, chosen, params, run):
        if best is not None and (best.block.oriented[pair.a] and best.block.oriented[pair.b]):
            continue
        growth = Growth(empty.fresh(), group, params, run)
        growth.start(pair)
        growth.grow()
        attempts += 1
        if best is None or growth.count > best.count:
            best = growth
        if 2 * best.count >= len(group) or attempts == STARTS:
            break
    assert best is not None
    return best
