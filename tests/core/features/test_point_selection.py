"""Even selection by suppression, against truth about distances and against the published definition."""

import numpy as np
import pytest

from graphos_core.features.detectors.selection import choose

SIZE = (1000, 800)


def crowded(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Points in clusters whose strength grows towards the middle of the cluster, and a thin rest."""
    rng = np.random.default_rng(seed)
    centres = rng.uniform((100, 100), (900, 700), (6, 2))
    which = rng.integers(0, 6, 3000)
    clustered = np.clip(centres[which] + rng.normal(0, 40, (3000, 2)), 0, (999, 799))
    rest = rng.uniform((0, 0), SIZE, (600, 2))
    strength = np.r_[rng.uniform(0.3, 1.0, 3000), rng.uniform(0.0, 0.4, 600)]
    return np.vstack([clustered, rest]), strength


def nearest_distance(xy: np.ndarray) -> np.ndarray:
    apart = np.abs(xy[:, None] - xy[None]).max(axis=2)
    np.fill_diagonal(apart, np.inf)
    return apart.min(axis=1)


def occupied(xy: np.ndarray) -> float:
    cells = np.histogram2d(xy[:, 0], xy[:, 1], bins=(20, 16), range=((0, 1000), (0, 800)))[0]
    return float((cells > 0).mean())


def by_definition(xy: np.ndarray, strength: np.ndarray, count: int) -> np.ndarray:
    """Brown, Szeliski and Winder 2005, section 3: largest distances to a stronger point."""
    order = np.argsort(-strength, kind="stable")
    radius = np.full(len(xy), np.inf)
    for rank in range(1, len(order)):
        stronger = order[:rank]
        radius[order[rank]] = np.linalg.norm(xy[stronger] - xy[order[rank]], axis=1).min()
    return np.argsort(-radius, kind="stable")[:count]


@pytest.mark.parametrize("count", [60, 250])
@pytest.mark.parametrize("seed", [0, 1])
def test_suppression_spreads_points_as_its_definition_does(count: int, seed: int) -> None:
    xy, strength = crowded(seed)
    chosen = {how: choose(how, xy, np.ones(len(xy)), strength, count, SIZE) for how in ("anms", "strength")}
    exact = by_definition(xy, strength, count)
    assert all(len(np.unique(index)) == count for index in chosen.values())
    spread = {how: occupied(xy[index]) for how, index in chosen.items()}
    assert spread["anms"] > 0.9 * occupied(xy[exact])
    assert spread["anms"] > 1.5 * spread["strength"]
    assert np.median(nearest_distance(xy[chosen["anms"]])) > 0.8 * np.median(nearest_distance(xy[exact]))
    assert strength.argmax() in chosen["anms"]


def test_no_chosen_point_has_a_stronger_one_within_the_radius() -> None:
    xy, strength = crowded(2)
    index = choose("anms", xy, np.ones(len(xy)), strength, 150, SIZE)
    assert (np.diff(strength[index]) <= 0).all()  # best first
    closest = nearest_distance(xy[index]).min()
    side = np.sqrt(SIZE[0] * SIZE[1] / 150)
    assert closest > 0.4 * side
    taken = np.zeros(len(xy), dtype=bool)
    taken[index] = True
    for i in np.flatnonzero(~taken & (strength > strength[index].min())):
        near = np.abs(xy[index] - xy[i]).max(axis=1) <= 1.5 * closest
        assert (strength[index][near] >= strength[i]).any()  # whoever is missing had a stronger neighbour


def test_fewer_points_than_wanted_all_stay_and_points_at_one_place_do_not_stop_it() -> None:
    xy, strength = crowded(3)
    assert len(choose("anms", xy, strength, strength, 10_000, SIZE)) == len(xy)
    same = np.tile([[10.0, 20.0]], (500, 1))
    assert len(choose("anms", same, np.ones(500), np.arange(500.0), 100, SIZE)) == 100
