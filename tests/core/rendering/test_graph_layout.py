"""Graphs are laid out so that distances on the page are those wanted, the same way every time."""

import numpy as np
from scipy.sparse.csgraph import shortest_path

from graphos_core.rendering.graph_layout import flat_layout, force_layout, way_lengths


def grid_graph(columns: int, rows: int) -> np.ndarray:
    """Return the weights of neighbours in a grid."""
    weights = np.zeros((columns * rows,) * 2)
    for i in range(columns * rows):
        for j in range(columns * rows):
            apart = abs(i % columns - j % columns) + abs(i // columns - j // columns)
            weights[i, j] = 40.0 * (apart == 1)
    return weights


def test_shortest_ways_are_those_of_scipy() -> None:
    rng = np.random.default_rng(1)
    weights = rng.integers(1, 90, (12, 12)).astype(float) * (rng.random((12, 12)) < 0.3)
    weights = np.maximum(weights, weights.T)
    np.fill_diagonal(weights, 0)
    with np.errstate(divide="ignore"):
        lengths = np.where(weights > 0, (weights.max() / weights) ** 0.25, 0)
    expected = shortest_path(lengths, directed=False)
    found = way_lengths(weights)
    linked = np.isfinite(expected)
    assert np.allclose(found[linked], expected[linked])
    assert (found[~linked] > np.median(expected[linked])).all()


def test_a_grid_is_drawn_as_a_grid() -> None:
    places = force_layout(grid_graph(4, 3))
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    neighbours = grid_graph(4, 3) > 0
    assert np.ptp(apart[neighbours]) < 0.5
    assert apart[~neighbours & ~np.eye(12, dtype=bool)].min() > apart[neighbours].max()
    assert np.array_equal(places, force_layout(grid_graph(4, 3)))


def test_strong_pairs_lie_closer_and_parts_lie_apart() -> None:
    weights = np.zeros((5, 5))
    weights[0, 1] = weights[1, 0] = 400
    weights[1, 2] = weights[2, 1] = 25
    weights[3, 4] = weights[4, 3] = 400
    places = force_layout(weights)
    apart = np.linalg.norm(places[:, None] - places[None], axis=2)
    assert apart[0, 1] < apart[1, 2]
    assert apart[:3, 3:].min() > apart[0, 1]
    assert (
        force_layout(np.zeros((1, 1))).shape == (1, 2) and np.isfinite(force_layout(np.zeros((4, 4)))).all()
    )


def test_places_in_space_are_seen_along_their_least_extent() -> None:
    rng = np.random.default_rng(2)
    plane = rng.uniform(-5, 5, (9, 2))
    tilt, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    places = np.column_stack([plane, np.zeros(9)]) @ tilt.T + 7.0
    flat = flat_layout(np.vstack([places, [np.nan] * 3]))
    assert np.isnan(flat[9]).all()
    apart = np.linalg.norm(flat[:9, None] - flat[None, :9], axis=2)
    assert np.allclose(apart, np.linalg.norm(plane[:, None] - plane[None], axis=2))
