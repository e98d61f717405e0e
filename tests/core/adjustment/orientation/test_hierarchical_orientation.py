"""Hierarchical orientation against theoretical models, and beside the incremental one."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.orientation.growing import GrowingBlock, Oriented
from graphos_core.adjustment.orientation.hierarchical import HierarchicalParams, orient_hierarchically
from graphos_core.adjustment.orientation.merging import find_joint, join
from graphos_core.data import Camera
from graphos_core.geometry.rotation import angle_between, matrix_from_vector
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_core.run import Run
from graphos_core.simulation.model import NoiseParams, TheoreticalModel, theoretical_model
from graphos_core.simulation.objects import ObjectParams, terrain
from graphos_core.simulation.templates import GridParams, place
from graphos_core.simulation.tie_points import simulated_tie_points

CAMERA = Camera(model="basic", width=1600, height=1200, values=np.array([1500.0, 799.5, 599.5, -0.06, 0.02]))
FIXED = HierarchicalParams(self_calibration=False)


def strips(**noise: float) -> TheoreticalModel:
    ground = terrain(ObjectParams(size=60.0, count=2500, relief=4.0))
    stations = place("grid", GridParams(strips=3, per_strip=6))
    return theoretical_model(stations, CAMERA, ground, NoiseParams(**noise), seed=1)


def test_exact_observations_give_exact_orientations_by_a_tree_of_clusters() -> None:
    model = strips(sigma_px=0.0)
    said: list[str] = []

    class Heard(Run):
        def say(self, text: str) -> None:
            said.append(text)

    block = orient_hierarchically(*simulated_tie_points(model), FIXED, run=Heard(threads=1))
    assert block.oriented.all()
    world = estimate_similarity(block.centres, model.stations.centres)
    np.testing.assert_allclose(world.apply(block.centres), model.stations.centres, atol=1e-6)
    turns = [
        angle_between(world.rotate_camera(r), t)
        for r, t in zip(block.rotations, model.stations.rotations, strict=True)
    ]
    assert max(turns) < 1e-7
    assert sum("joined" in text for text in said) >= 2
    tree = block.tree
    assert tree is not None and sorted(tree.photo) == list(range(18))
    place_of = {int(photo): i for i, photo in enumerate(tree.photo)}
    assert all(
        place_of[parent] < place_of[int(p)]
        for p, on in zip(tree.photo, tree.on, strict=True)
        for parent in on
    )
    assert sum(not on for on in tree.on) == 1


def test_noise_and_wrong_matches_are_survived_with_the_same_bits_for_any_threads() -> None:
    model = strips(sigma_px=0.3, outlier_share=0.05)
    one, two = (
        orient_hierarchically(*simulated_tie_points(model), HierarchicalParams(), run=Run(threads=t, seed=2))
        for t in (1, 2)
    )
    assert one.oriented.all()
    world = estimate_similarity(one.centres, model.stations.centres)
    assert np.abs(world.apply(one.centres) - model.stations.centres).max() < 0.05
    assert np.array_equal(one.centres, two.centres) and np.array_equal(one.points, two.points)


def test_two_clusters_are_joined_by_the_similarity_between_them() -> None:
    model = strips(sigma_px=0.0)
    photos, tracks, _ = simulated_tie_points(model)
    empty = GrowingBlock(photos, tracks, 3.0, 0.01)
    truth = Similarity(2.5, matrix_from_vector(np.array([0.3, -1.2, 0.4])), np.array([5.0, -3.0, 8.0]))
    clusters = []
    for members, world in ((range(9), None), (range(9, 18), truth.inverse())):
        block = empty.fresh()
        for i in members:
            rotation, centre = model.stations.rotations[i], model.stations.centres[i]
            if world is not None:
                rotation, centre = world.rotate_camera(rotation), world.apply(centre[None])[0]
            block.place(i, rotation, centre, Oriented(i, (), "given", 0, 0.0))
        block.intersect()
        clusters.append(block)
    a, b = clusters
    wrong = np.flatnonzero(a.known & b.known)[:15]
    b.points[wrong] += 1.0
    joint = find_joint(a, b, min_points=20, threshold_px=8.0, seed=0)
    assert joint and abs(joint.similarity.scale - 2.5) < 1e-6
    join(a, b, joint)
    np.testing.assert_allclose(a.centres, model.stations.centres, atol=1e-5)
    assert a.oriented.all() and a.tree[9].on and "9 and 9" in a.tree[9].method
