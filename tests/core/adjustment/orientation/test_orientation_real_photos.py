"""The door in Lund: photos to oriented block, against its reference orientation."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.orientation.incremental import IncrementalParams, orient_incrementally
from graphos_core.data import Array, Block, PairMatches, PhotoSet, Tracks
from graphos_core.exchange.colmap import read_colmap
from graphos_core.features.stage import detect_all, match_all
from graphos_core.geometry.rotation import angle_between
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.images import read_photo_set, read_pixels
from graphos_core.registry import find
from graphos_core.run import Run

pytestmark = pytest.mark.data
RUN = Run(threads=2)


@pytest.fixture(scope="module")
def door(data_dir: Path) -> tuple[PhotoSet, Tracks, list[PairMatches]]:
    """Photos, tracks and pairs, with 3000 points per photo to be quick."""
    photos = read_photo_set(data_dir / "lund_door" / "images", run=RUN)

    def read(index: int) -> tuple[Array, Array]:
        colour = read_pixels(photos.photos[index])
        return cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), colour

    sift, mutual, usac, tracks = (find("features", name) for name in ("sift", "mutual", "usac", "tracks"))
    features = detect_all(
        len(photos.photos), read, sift, sift.params().replace(maximum=3000, reduction=2.0), RUN
    )
    cameras = [photos.cameras[photo.camera] for photo in photos.photos]
    pairs = match_all(features, cameras, (mutual, mutual.params()), (usac, usac.params()), RUN)
    return photos, tracks.function(features, pairs, tracks.params(), run=RUN), pairs


def test_the_door_agrees_with_its_reference(
    door: tuple[PhotoSet, Tracks, list[PairMatches]], data_dir: Path
) -> None:
    block = orient_incrementally(*door, IncrementalParams(), run=RUN)
    adjustment = adjust_block(block, Freedom(interior=(("focal_px", "k1", "k2"),)))
    truth = read_colmap(data_dir / "lund_door" / "colmap_ground_truth")
    assert block.oriented.all() and not block.failures
    assert adjustment.rms_px < 0.5
    assert_agrees(adjustment.block, truth)


def assert_agrees(block: Block, truth: Block) -> None:
    """Centres within 0.5 % of the extent, rotations within 0.2°, principal distance within 1 %."""
    theirs = [truth.names.index(Path(name).name) for name in block.names]
    world = estimate_similarity(block.centres, truth.centres[theirs])
    errors = np.linalg.norm(world.apply(block.centres) - truth.centres[theirs], axis=1)
    extent = np.linalg.norm(np.ptp(truth.centres, axis=0))
    assert errors.max() < 0.005 * extent
    angles = [
        angle_between(world.rotate_camera(r), truth.rotations[i])
        for r, i in zip(block.rotations, theirs, strict=True)
    ]
    assert np.degrees(max(angles)) < 0.2
    assert block.cameras[0].focal_px == pytest.approx(truth.cameras[0].focal_px, rel=0.01)


def test_photos_of_something_else_stay_out_and_are_named(
    door: tuple[PhotoSet, Tracks, list[PairMatches]],
) -> None:
    photos, tracks, pairs = door
    stranger = 5
    keep = tracks.photo != stranger
    without = replace(
        tracks,
        photo=tracks.photo[keep],
        feature=tracks.feature[keep],
        track=tracks.track[keep],
        xy=tracks.xy[keep],
    )
    linked = [pair for pair in pairs if stranger not in (pair.a, pair.b)]
    block = orient_incrementally(photos, without, linked, IncrementalParams(), run=RUN)
    assert np.flatnonzero(~block.oriented).tolist() == [stranger]
    assert [failure.item for failure in block.failures] == [photos.photos[stranger].name]
