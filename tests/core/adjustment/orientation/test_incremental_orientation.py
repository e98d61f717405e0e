"""Incremental orientation against theoretical models: exact, noisy, with outliers, and when it cannot work."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import adjust_block
from graphos_core.adjustment.orientation.incremental import IncrementalParams, orient_incrementally
from graphos_core.adjustment.orientation.next_photo import inertia
from graphos_core.data import Array, Block, Camera, PairMatches, PhotoSet, Tracks
from graphos_core.errors import ParamError, Stopped, UserError
from graphos_core.geometry.rotation import angle_between
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_core.run import Run
from graphos_core.simulation.model import NoiseParams, TheoreticalModel, theoretical_model
from graphos_core.simulation.objects import ObjectParams, ObjectPoints, cube, sphere, terrain
from graphos_core.simulation.templates import (
    CoupleParams,
    GridParams,
    OrbitalParams,
    Stations,
    TripleParams,
    place,
)
from graphos_core.simulation.tie_points import simulated_tie_points as case
from graphos_core.store import Store

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]))
FIXED = IncrementalParams(self_calibration=False)
Case = tuple[PhotoSet, Tracks, list[PairMatches]]


class Heard(Run):
    """Remembers what it was told."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.warnings: list[str] = []
        self.blocks: list[Block] = []

    def warn(self, text: str) -> None:
        self.warnings.append(text)

    def show(self, key: str, value: Any) -> None:
        if key == "block":
            self.blocks.append(value)


def exact_model(name: str) -> TheoreticalModel:
    exact = NoiseParams(sigma_px=0.0)
    down = terrain(ObjectParams(size=40.0, count=1500, relief=4.0))
    choices: dict[str, tuple[Stations, ObjectPoints]] = {
        "couple": (place("couple", CoupleParams(base=3.0, convergence=10)), cube(ObjectParams(count=400))),
        "triple": (place("triple", TripleParams()), sphere(ObjectParams(count=600))),
        "grid": (place("grid", GridParams()), down),
        "orbital": (
            place("orbital", OrbitalParams(axis_x=9, axis_y=9, axis_z=6)),
            cube(ObjectParams(count=900)),
        ),
    }
    stations, points = choices[name]
    return theoretical_model(stations, CAMERA, points, exact, seed=1)


def noisy_model(**noise: float) -> TheoreticalModel:
    stations = place("orbital", OrbitalParams(axis_x=9, axis_y=9, axis_z=6, equators=2, per_equator=8))
    return theoretical_model(stations, CAMERA, cube(ObjectParams(count=1200)), NoiseParams(**noise), seed=3)


def compared(block: Block, model: TheoreticalModel) -> tuple[Similarity, Array, Array]:
    """Similarity to the truth, and errors of centres (n, 3), m, and rotations (n,), radians, of oriented photos."""
    oriented = np.flatnonzero(block.oriented)
    truth = model.stations
    if len(oriented) > 2:
        world = estimate_similarity(block.centres[oriented], truth.centres[oriented])
    else:
        world = estimate_similarity(block.points, model.points[block.point_track])
    centres = world.apply(block.centres[oriented]) - truth.centres[oriented]
    angles = [angle_between(world.rotate_camera(block.rotations[i]), truth.rotations[i]) for i in oriented]
    return world, centres, np.array(angles)


@pytest.mark.parametrize("template", ["couple", "triple", "grid", "orbital"])
def test_exact_observations_give_exact_orientations(template: str) -> None:
    model = exact_model(template)
    block = orient_incrementally(*case(model), FIXED, run=Run(threads=1))
    _, centres, angles = compared(block, model)
    assert block.oriented.all() and not block.failures and block.unit == "model units"
    assert np.abs(centres).max() < 1e-6
    assert angles.max() < 1e-6
    assert len(block.points) > 0.9 * len(model.points)


def test_noise_gives_errors_as_the_covariance_predicts() -> None:
    model = noisy_model(sigma_px=0.5)
    block = orient_incrementally(*case(model), FIXED, run=Run(threads=1))
    adjustment = adjust_block(block)
    world, centres, _ = compared(adjustment.block, model)
    normalised = centres / (world.scale * adjustment.sigma_centres)
    assert adjustment.sigma0_px == pytest.approx(0.5, rel=0.05)
    # the similarity on the centres is not quite the datum of the adjustment, and these are 48 errors only
    assert 0.6 < np.sqrt((normalised**2).mean()) < 1.6
    points = world.apply(adjustment.block.points) - model.points[adjustment.block.point_track]
    expected = world.scale * np.sqrt((adjustment.sigma_points**2).mean())
    assert np.sqrt((points**2).mean()) == pytest.approx(expected, rel=0.2)


def test_outliers_are_rejected_and_good_observations_kept() -> None:
    model = noisy_model(sigma_px=0.5, outlier_share=0.08)
    block = orient_incrementally(*case(model), FIXED, run=Run(threads=1))
    kept = np.zeros((len(model.stations.names), len(model.points)), dtype=bool)
    kept[block.obs_photo, block.point_track[block.obs_point]] = True
    kept_here = kept[model.obs_photo, model.obs_point]
    assert block.oriented.all()
    rays = np.bincount(model.obs_point)[model.obs_point]  # along the one other ray an error cannot be seen
    assert kept_here[model.outlier & (rays >= 4)].mean() < 0.01
    assert kept_here[~model.outlier].mean() > 0.97
    assert np.abs(compared(block, model)[1]).max() < 0.02


def test_a_wrong_principal_distance_and_unknown_distortion_are_calibrated() -> None:
    model = noisy_model(sigma_px=0.3)
    guess = replace(CAMERA, values=np.array([1575.0, 799.5, 599.5, 0.0, 0.0]), focal_estimated=True)
    block = orient_incrementally(*case(model, guess), IncrementalParams(), run=Run(threads=1))
    assert block.oriented.all()
    assert block.cameras[0].focal_px == pytest.approx(1500.0, rel=1e-3)
    assert block.cameras[0].values[3:].tolist() == pytest.approx([-0.06, 0.02], abs=0.01)
    fixed = orient_incrementally(*case(model, guess), FIXED, run=Run(threads=1))
    assert fixed.cameras[0].focal_px == 1575.0 and fixed.cameras[0].focal_estimated


def test_the_same_seed_gives_the_same_bits_with_one_and_two_threads() -> None:
    model = noisy_model(sigma_px=0.5, outlier_share=0.05)
    one, two = (
        orient_incrementally(*case(model), IncrementalParams(), run=Run(threads=t, seed=4)) for t in (1, 2)
    )
    for name in ("rotations", "centres", "points", "obs_xy", "obs_photo"):
        assert np.array_equal(getattr(one, name), getattr(two, name)), name
    assert np.array_equal(one.cameras[0].values, two.cameras[0].values)


def test_partial_blocks_are_shown_and_stopping_stops() -> None:
    model = exact_model("orbital")
    heard = Heard(threads=1)
    orient_incrementally(*case(model), FIXED, run=heard)
    grown = [int(block.oriented.sum()) for block in heard.blocks]
    assert grown[0] == 2 and grown[-1] == 32 and grown == sorted(grown)

    class StopsAtFour(Run):
        def show(self, key: str, value: Any) -> None:
            if key == "block" and value.oriented.sum() >= 4:
                self.stop()

    with pytest.raises(Stopped):
        orient_incrementally(*case(model), FIXED, run=StopsAtFour(threads=1))


def test_the_first_pair_can_be_chosen() -> None:
    model = exact_model("grid")
    photos, tracks, pairs = case(model)
    names = [photo.name for photo in photos.photos]
    chosen = FIXED.replace(first_photo=names[5], second_photo=names[6])
    heard = Heard(threads=1)
    block = orient_incrementally(photos, tracks, pairs, chosen, run=heard)
    assert np.flatnonzero(heard.blocks[0].oriented).tolist() == [5, 6] and block.oriented.all()
    with pytest.raises(ParamError, match="Unknown photo"):
        orient_incrementally(photos, tracks, pairs, FIXED.replace(first_photo="x.jpg"), run=heard)
    with pytest.raises(ParamError, match="two different"):
        orient_incrementally(
            photos, tracks, pairs, FIXED.replace(first_photo=names[1], second_photo=names[1]), run=heard
        )


def two_groups(model: TheoreticalModel, second: tuple[int, ...]) -> Case:
    """The case with every link between `second` and the other photos cut."""
    photos, tracks, pairs = case(model)
    inside = np.isin(tracks.photo, second)
    moved = np.where(inside, tracks.track + tracks.count, tracks.track)
    order = np.lexsort((tracks.photo, moved))
    cut = Tracks(
        photo=tracks.photo[order], feature=tracks.feature, track=moved[order].astype(np.int32), xy=tracks.xy[order],
        colour=np.zeros((2 * tracks.count, 3), np.uint8), count=2 * tracks.count,
    )  # fmt: skip
    kept = [p for p in pairs if (p.a in second) == (p.b in second)]
    return photos, cut, kept


def test_of_two_unrelated_groups_the_larger_is_oriented_and_the_other_named() -> None:
    model = exact_model("grid")
    second = (3, 4, 11)
    heard = Heard(threads=1)
    block = orient_incrementally(*two_groups(model, second), FIXED, run=heard)
    names = [f"{model.stations.names[i]}.jpg" for i in second]
    assert np.flatnonzero(~block.oriented).tolist() == list(second)
    assert [failure.item for failure in block.failures] == names
    assert all("another group of 3 photos" in failure.reason for failure in block.failures)
    assert len(heard.warnings) == 1 and all(name in heard.warnings[0] for name in names)


def test_of_two_unrelated_groups_each_makes_a_block_and_either_can_be_the_main_one() -> None:
    model = exact_model("grid")
    second = (3, 4, 11)
    blocks = orient_incrementally(*two_groups(model, second), FIXED, run=Run(threads=1))
    (other,) = blocks.others
    assert set(np.flatnonzero(other.oriented)) <= set(second) and other.oriented.sum() >= 2
    assert not (other.oriented & blocks.oriented).any()
    swapped = orient_incrementally(*two_groups(model, second), FIXED.replace(component=2), run=Run(threads=1))
    assert np.array_equal(swapped.oriented, other.oriented) and np.array_equal(swapped.points, other.points)
    assert np.array_equal(swapped.others[0].oriented, blocks.oriented)
    with pytest.raises(ParamError, match="there are 2"):
        orient_incrementally(*two_groups(model, second), FIXED.replace(component=3), run=Run(threads=1))


def test_the_tree_says_who_was_oriented_on_whom() -> None:
    model = exact_model("grid")
    block = orient_incrementally(*case(model), FIXED, run=Run(threads=1))
    tree = block.tree
    assert tree is not None and sorted(tree.photo) == list(range(len(block.names)))
    place_of = {int(photo): i for i, photo in enumerate(tree.photo)}
    assert tree.on[0] == () and tree.on[1] == (int(tree.photo[0]),)
    seen = np.zeros((len(block.names), len(model.points)), dtype=bool)
    seen[model.obs_photo, model.obs_point] = True
    for photo, on, points in zip(tree.photo[2:], tree.on[2:], tree.points[2:], strict=True):
        assert on and all(place_of[parent] < place_of[int(photo)] for parent in on)
        assert all((seen[photo] & seen[parent]).sum() > 0 for parent in on)
        assert 20 <= points <= seen[photo].sum()
    assert set(tree.method[2:]) <= {"space resection"} | {f"relative orientation to {n}" for n in block.names}


def test_the_tree_and_other_blocks_are_kept_in_the_store(tmp_path: Path) -> None:
    model = exact_model("grid")
    block = orient_incrementally(*two_groups(model, (3, 4, 11)), FIXED, run=Run(threads=1))
    store = Store(tmp_path)
    store.save("orientation", "k", block, {})
    back = Store(tmp_path).load("orientation", "k")
    assert back.tree.on == block.tree.on and back.tree.method == block.tree.method
    assert np.array_equal(back.others[0].points, block.others[0].points)


def test_one_photo_of_the_first_pair_can_be_chosen() -> None:
    model = exact_model("grid")
    photos, tracks, pairs = case(model)
    heard = Heard(threads=1)
    name = photos.photos[7].name
    block = orient_incrementally(photos, tracks, pairs, FIXED.replace(first_photo=name), run=heard)
    assert heard.blocks[0].oriented[7] and block.oriented.all()


def test_a_photo_that_shares_few_known_points_is_carried_by_one_neighbour() -> None:
    """The last photo shares a dozen points with the block, and hundreds with one photo that nobody else sees."""
    model = exact_model("grid")
    photos, tracks, pairs = case(model)
    last, neighbour = 11, 10
    seen = np.zeros((len(photos.photos), tracks.count), dtype=bool)
    seen[tracks.photo, tracks.track] = True
    known = np.flatnonzero(seen[[last, neighbour]].all(axis=0) & (seen.sum(axis=0) > 2))
    drop = (tracks.photo == last) & np.isin(tracks.track, np.flatnonzero(seen[last]))
    drop &= ~np.isin(tracks.track, known[:12])
    lonely = np.isin(tracks.track, known[12:]) & np.isin(
        tracks.photo, [last, neighbour]
    )  # tracks of this pair only
    track = np.where(lonely, tracks.track + tracks.count, tracks.track)
    keep = ~drop | lonely
    order = np.flatnonzero(keep)[np.lexsort((tracks.photo[keep], track[keep]))]
    weak = Tracks(
        photo=tracks.photo[order], feature=tracks.feature[order], track=track[order].astype(np.int32),
        xy=tracks.xy[order], colour=np.zeros((2 * tracks.count, 3), np.uint8), count=2 * tracks.count,
    )  # fmt: skip
    block = orient_incrementally(photos, weak, pairs, FIXED, run=Run(threads=1))
    assert block.oriented.all() and not block.failures
    oriented_by_few = estimate_similarity(block.centres[:last], model.stations.centres[:last])
    np.testing.assert_allclose(oriented_by_few.apply(block.centres), model.stations.centres, atol=1e-6)


def test_photos_with_too_few_or_no_matches_stay_out_with_the_reason() -> None:
    model = exact_model("grid")
    photos, tracks, pairs = case(model)
    weak, alone = 0, 11
    of_weak = np.flatnonzero(tracks.photo == weak)
    keep = (tracks.photo != alone) & ~np.isin(np.arange(len(tracks.photo)), of_weak[5:])
    fewer = replace(
        tracks,
        photo=tracks.photo[keep],
        feature=tracks.feature[keep],
        track=tracks.track[keep],
        xy=tracks.xy[keep],
    )
    pairs = [p for p in pairs if alone not in (p.a, p.b)]
    block = orient_incrementally(photos, fewer, pairs, FIXED, run=Run(threads=1))
    assert block.oriented.sum() == len(block.oriented) - 2
    reasons = {failure.item: failure.reason for failure in block.failures}
    assert "points in common with the oriented photos, 20 needed" in reasons[photos.photos[weak].name]
    assert "no verified matches with any other photo" in reasons[photos.photos[alone].name]


def standing_still() -> TheoreticalModel:
    """Four photos from one place."""
    stations = place("grid", GridParams(strips=2, per_strip=2))
    same = Stations(
        names=stations.names, rotations=stations.rotations, centres=stations.centres[[0, 0, 0, 0]]
    )
    points = terrain(ObjectParams(size=40.0, count=1500, relief=4.0))
    return theoretical_model(same, CAMERA, points, NoiseParams(sigma_px=0.3), seed=1)


def test_what_cannot_be_oriented_is_said_in_three_sentences() -> None:
    photos, tracks, _ = case(exact_model("couple"))
    single = PhotoSet(photos=photos.photos[:1], cameras=photos.cameras)
    attempts: list[tuple[Case, str]] = [
        ((single, tracks, []), "at least two photos"),
        ((photos, tracks, []), "verified matches"),
        (case(standing_still()), "one place"),
    ]
    for (some, of, linked), said in attempts:
        with pytest.raises(UserError, match=said) as refused:
            orient_incrementally(some, of, linked, FIXED, run=Run(threads=1))
        assert refused.value.what and refused.value.why and refused.value.todo


def test_inertia_prefers_spread_and_many_points_over_a_line() -> None:
    rng = np.random.default_rng(0)
    spread = rng.uniform(0, 1000, (100, 2))
    line = np.column_stack([rng.uniform(0, 1000, 1000), np.full(1000, 300.0)])
    assert inertia(spread, 1000, 1000) > inertia(spread * 0.3, 1000, 1000) > inertia(line, 1000, 1000)
    assert inertia(np.vstack([spread, spread]), 1000, 1000) == pytest.approx(2 * inertia(spread, 1000, 1000))
    assert inertia(spread[:1], 1000, 1000) == 0.0
