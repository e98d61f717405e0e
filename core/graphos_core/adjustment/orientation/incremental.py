"""Incremental orientation: a first pair, then one photo after another, adjusted as the block grows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np
from threadpoolctl import threadpool_limits

from graphos_core.adjustment.orientation.first_pair import choose_first_pairs, chosen_first_pair
from graphos_core.adjustment.orientation.groups import explain_failures, listed, photo_groups
from graphos_core.adjustment.orientation.growing import GrowingBlock
from graphos_core.adjustment.orientation.growth import Growth
from graphos_core.data import Block, PairMatches, PhotoSet, Tracks
from graphos_core.errors import ParamError, UserError
from graphos_core.params import About, Params, unknown_name
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

STARTS = 3
"""First pairs tried when most photos of the group cannot be added to the block."""


class IncrementalParams(Params):
    """Parameters of the incremental orientation."""

    first_photo: Annotated[
        str | None,
        About(
            label="First photo",
            group="First pair",
            level="expert",
            help="Name of one photo of the first pair; chosen automatically where empty.",
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
    min_points: Annotated[
        int,
        About(
            label="Fewest common points",
            symbol="n_{min}",
            unit="points",
            low=6,
            high=1000,
            step=1,
            group="Adding photos",
            help="Points that must agree before a photo is added to the block.",
            effect="Higher: safer, but weakly connected photos stay out.",
            learn="adjustment/orientation",
        ),
    ] = 20
    resection_px: Annotated[
        float,
        About(
            label="Resection threshold",
            unit="px",
            low=0.5,
            high=100,
            step=0.5,
            group="Adding photos",
            help="Largest distance of a point that agrees with the orientation of a new photo.",
            effect="Higher: tolerates a badly known principal distance, but also wrong matches.",
            learn="adjustment/orientation",
        ),
    ] = 8.0
    reprojection_px: Annotated[
        float,
        About(
            label="Outlier threshold",
            symbol="e_{max}",
            unit="px",
            low=0.3,
            high=50,
            step=0.5,
            group="Points",
            help="Largest distance between a measured image point and its projected object point.",
            effect="Higher: more observations, and more wrong ones among them.",
            learn="adjustment/outliers",
        ),
    ] = 3.0
    min_angle_deg: Annotated[
        float,
        About(
            label="Smallest intersection angle",
            symbol=r"\gamma_{min}",
            unit="°",
            low=0.01,
            high=60,
            step=0.5,
            group="Points",
            help="A point is kept when two of its rays meet at this angle or a larger one.",
            effect="Higher: fewer points, each more certain in depth.",
            learn="adjustment/base-and-angle",
        ),
    ] = 1.5
    adjust_growth: Annotated[
        float,
        About(
            label="Adjust after growth by",
            unit="%",
            low=1,
            high=200,
            step=5,
            group="Intermediate adjustment",
            level="expert",
            help="The block is adjusted when it has grown by this share of photos; small blocks after every photo.",
            effect="Higher: faster, but errors pile up between adjustments.",
            learn="adjustment/bundle",
        ),
    ] = 20.0
    self_calibration: Annotated[
        bool,
        About(
            label="Calibrate while orienting",
            group="Intermediate adjustment",
            help="Whether the principal distance and radial distortion are estimated once there are enough photos.",
            effect="Off: the calibration stays as given; right for a calibrated camera.",
            learn="adjustment/self-calibration",
        ),
    ] = True


@algorithm(
    stage="adjustment",
    role="orientation",
    name="incremental",
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
    inertia matrix. It is oriented both by space resection and by relative orientation to its best neighbour; the
    better one is kept. New points are intersected from all rays, outliers rejected, and the block adjusted.

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
        In model units; the largest group that could be oriented. The other photos are in `Block.failures`.

    Raises
    ------
    UserError
        With a single photo, without verified pairs, and when no pair has a base.
    """
    groups = _usable_groups(photos, pairs, params)
    best: Growth | None = None
    problem: UserError | None = None
    with threadpool_limits(limits=1, user_api="blas"):  # threaded BLAS changes the last bits
        for group in groups:
            if best is not None and len(group) <= best.count:
                break
            try:
                grown = _orient_group(photos, tracks, group, params, run)
            except UserError as error:
                problem = problem or error
                continue
            if best is None or grown.count > best.count:
                best = grown
        if best is None:
            assert problem is not None
            raise problem
        best.finish()
    failures = explain_failures(best.block.names, best.block.oriented.tolist(), groups, best.reasons)
    _warn_other_groups(best, groups, run)
    run.progress(best.count, len(photos.photos), "photos oriented")
    return best.block.block(failures)


def _usable_groups(
    photos: PhotoSet, pairs: Sequence[PairMatches], params: IncrementalParams
) -> list[tuple[int, ...]]:
    """Return the groups to try, largest first; only that of the chosen first pair where one is named."""
    if len(photos.photos) < 2:
        raise UserError(
            Text("Orientation needs at least two photos; found: {count}.", count=len(photos.photos)),
            "Depth comes from seeing the same point from two places.",
            "Add photos that overlap with this one.",
            learn="adjustment/overlap",
        )
    groups = photo_groups(len(photos.photos), pairs)
    if not groups:
        raise UserError(
            "No photo can be oriented.",
            "No two photos have verified matches in common.",
            "Take photos with at least 60 % overlap, or find more features and relax the matching.",
            learn="adjustment/overlap",
        )
    chosen = _chosen_pair(photos, params)
    if chosen is None:
        return groups
    together = [group for group in groups if set(chosen) <= set(group)]
    if not together:
        raise UserError(
            Text(
                "The photos {a} and {b} cannot be the first pair.",
                a=params.first_photo,
                b=params.second_photo,
            ),
            "No verified matches connect them.",
            "Choose two photos that overlap, or leave the choice to the program.",
        )
    return together


def _chosen_pair(photos: PhotoSet, params: IncrementalParams) -> tuple[int, int] | None:
    """Return the photos of the first pair where both are named."""
    names = [photo.name for photo in photos.photos]
    chosen = [name for name in (params.first_photo, params.second_photo) if name]
    if not chosen:
        return None
    for name in chosen:
        if name not in names:
            raise ParamError("first_photo", unknown_name(name, names, "photo"))
    if len(set(chosen)) != 2:
        raise ParamError("second_photo", Text("First pair: needs two different photos"))
    return names.index(chosen[0]), names.index(chosen[1])


def _orient_group(
    photos: PhotoSet, tracks: Tracks, group: tuple[int, ...], params: IncrementalParams, run: Run
) -> Growth:
    """Orient one group, from other first pairs too when the first leads to less than half of the photos."""
    min_angle = float(np.radians(params.min_angle_deg))
    first_angle = float(np.radians(params.first_angle_deg))
    empty = GrowingBlock(photos, tracks, params.reprojection_px, min_angle)
    chosen = _chosen_pair(photos, params)
    if chosen is None:
        starts = choose_first_pairs(
            empty, group, min_points=params.min_points, min_angle=first_angle, run=run
        )
    else:
        starts = [chosen_first_pair(empty, *chosen, min_angle=first_angle, seed=run.seed)]
    best: Growth | None = None
    attempts = 0
    for pair in starts:
        if best is not None and (best.block.oriented[pair.a] and best.block.oriented[pair.b]):
            continue
        growth = Growth(
            GrowingBlock(photos, tracks, params.reprojection_px, min_angle),
            group,
            min_points=params.min_points,
            resection_px=params.resection_px,
            adjust_growth=params.adjust_growth,
            self_calibration=params.self_calibration,
            run=run,
        )
        growth.start(pair)
        growth.grow()
        attempts += 1
        if best is None or growth.count > best.count:
            best = growth
        if 2 * best.count >= len(group) or attempts == STARTS:
            break
    assert best is not None
    return best


def _warn_other_groups(best: Growth, groups: list[tuple[int, ...]], run: Run) -> None:
    names, oriented = best.block.names, best.block.oriented
    for group in groups:
        if not oriented[list(group)].any():
            run.warn(
                Text(
                    "{count} photos form a group of their own and were not oriented: {names}.",
                    count=len(group),
                    names=listed([names[i] for i in group]),
                )
            )
