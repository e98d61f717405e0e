"""Orientation that goes on from a given one: of an earlier run, or read from another program's file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np

from graphos_core.adjustment.orientation.components import grow_blocks, main_block
from graphos_core.adjustment.orientation.groups import groups_of
from graphos_core.adjustment.orientation.growing import GrowingBlock, Oriented
from graphos_core.adjustment.orientation.growth import Growth
from graphos_core.adjustment.orientation.parameters import GrowthParams
from graphos_core.data import Array, Block, Camera, PairMatches, PhotoSet, Tracks
from graphos_core.errors import UserError
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text


class GivenParams(GrowthParams):
    """Parameters of the orientation that starts from a given one."""

    add_photos: Annotated[
        bool,
        About(
            label="Add the other photos",
            help="Whether photos that are not in the given orientation are oriented too.",
            effect="Off: the block has only the given photos.",
            learn="adjustment/orientation",
        ),
    ] = True
    given_calibration: Annotated[
        bool,
        About(
            label="Take its calibration",
            help="Whether the cameras start with the calibration that comes with the orientation.",
            effect="Off: they start with that of the project.",
            learn="adjustment/self-calibration",
        ),
    ] = True


@algorithm(
    stage="adjustment",
    role="orientation",
    name="given",
    label="From a given orientation",
    source="spatial intersection of all tracks from the given orientation, then as the incremental one",
    learn="adjustment/orientation",
)
def orient_from_given(
    photos: PhotoSet,
    tracks: Tracks,
    pairs: Sequence[PairMatches],
    params: GivenParams,
    *,
    run: Run,
    given: Block | None = None,
) -> Block:
    """Take the orientation of photos as given, intersect all tracks anew, adjust, and add the photos that are missing.

    Photos are recognised by their names, or by their file names where those are unique. The block stays in the frame
    and unit of the given orientation where at least three photos hold it.

    Parameters
    ----------
    photos : PhotoSet
    tracks : Tracks
    pairs : sequence of PairMatches
    params : GivenParams
    run : Run
    given : Block
        Only its cameras, names and exterior orientations are used.

    Raises
    ------
    UserError
        Without a given orientation, when it has less than two of the photos, or when it does not fit the tracks.
    """
    if given is None:
        raise UserError(
            "There is no given orientation to start from.",
            "The project holds none.",
            "Import an orientation or choose one of an earlier run, or choose the incremental orientation.",
            learn="adjustment/orientation",
        )
    mine, theirs = matched_photos(photos, given)
    groups = groups_of(photos, pairs)
    everybody = tuple(range(len(photos.photos)))

    def grown(group: tuple[int, ...]) -> Growth:
        cameras = given_cameras(photos, given, mine, theirs) if params.given_calibration else photos.cameras
        block = GrowingBlock(
            replace(photos, cameras=cameras), tracks, params.reprojection_px, float(np.radians(params.min_angle_deg))
        )  # fmt: skip
        for photo, other in zip(mine, theirs, strict=True):
            how = Oriented(int(photo), (), Text("given"), 0, np.nan)
            block.place(int(photo), given.rotations[other], given.centres[other], how)
        _check_fit(block, params.min_points)
        growth = Growth(block, group if params.add_photos else tuple(int(i) for i in mine), params, run)
        growth.take_over()
        if params.add_photos:
            growth.grow()
        return growth

    found = main_block(grow_blocks([everybody], [], grown, run), groups, params.component, (), run)
    return _in_frame_of(given, found, mine, theirs)


def matched_photos(photos: PhotoSet, given: Block) -> tuple[Array, Array]:
    """Return the photos that have a given orientation, and their indices in `given`.

    Raises
    ------
    UserError
        With less than two.
    """
    exact = {name: i for i, name in enumerate(given.names) if given.oriented[i]}
    short: dict[str, int] = {}
    for name, i in exact.items():
        key = name.rsplit("/", 1)[-1].casefold()
        short[key] = -1 if key in short else i
    found = [
        exact.get(photo.name, short.get(photo.name.rsplit("/", 1)[-1].casefold(), -1))
        for photo in photos.photos
    ]
    mine = np.array([k for k, i in enumerate(found) if i >= 0], dtype=np.int64)
    if len(mine) < 2:
        raise UserError(
            Text(
                "The given orientation has {count} of the {total} photos.", count=len(mine), total=len(found)
            ),
            Text("Its photos are called {names} …", names=", ".join(list(exact)[:3]) or Text("nothing")),
            "Choose the orientation of these photos; photos are recognised by their file names.",
        )
    return mine, np.array([found[k] for k in mine], dtype=np.int64)


def given_cameras(photos: PhotoSet, given: Block, mine: Array, theirs: Array) -> tuple[Camera, ...]:
    """Return the cameras of the photos with the given calibration, where it is for the same format."""
    cameras = list(photos.cameras)
    for photo, other in zip(
        mine[::-1], theirs[::-1], strict=True
    ):  # the first photo of a camera has the last word
        index = photos.photos[photo].camera
        theirs_now, ours = given.cameras[given.camera_of_photo[other]], photos.cameras[index]
        if (theirs_now.width, theirs_now.height) == (ours.width, ours.height):
            cameras[index] = replace(theirs_now, sigmas=None, label=ours.label or theirs_now.label)
    return tuple(cameras)


def _check_fit(block: GrowingBlock, min_points: int) -> None:
    """Intersect all tracks, and refuse an orientation with which hardly any rays meet."""
    tracks = block.tracks
    rays = np.bincount(tracks.track[block.oriented[tracks.photo] & block.valid], minlength=tracks.count)
    possible, found = int((rays >= 2).sum()), block.intersect()
    if found < max(min_points, 0.1 * possible):
        raise UserError(
            "The given orientation does not fit the photos.",
            Text("The rays of only {found} of {possible} tracks meet within {limit:g} px.", found=found,
                 possible=possible, limit=block.reprojection_px),
            "Check that it was made with these photos in full size, and its axes and angles; or raise the outlier "
            "threshold.",
        )  # fmt: skip


def _in_frame_of(given: Block, block: Block, mine: Array, theirs: Array) -> Block:
    """Return the block moved to the frame of the given orientation, where three photos not on a line hold it."""
    held = np.asarray(block.oriented)[mine]
    mine, theirs = mine[held], theirs[held]
    try:
        back = estimate_similarity(block.centres[mine], given.centres[theirs])
    except UserError:
        return block
    there = np.asarray(block.oriented)
    rotations, centres = np.array(block.rotations), np.array(block.centres)
    rotations[there] = back.rotate_camera(block.rotations[there])
    centres[there] = back.apply(block.centres[there])
    return replace(
        block, rotations=rotations, centres=centres, points=back.apply(block.points), unit=given.unit
    )
