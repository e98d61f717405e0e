"""Which circle is which: neighbours are joined into a lattice, and the lattice is laid over the board."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.data.record import Array

NEAR = 0.3
"""How far a circle may lie from its predicted place, in distances to the neighbour."""
SEEDS = 12
COMPLETE = 0.95
"""Share of the board's circles that must have been found."""
SQUARE_STEPS = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
HEXAGONAL_STEPS = np.array([[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]])


@dataclass(frozen=True)
class Lattice:
    """Points with whole-number coordinates in a lattice of their own.

    Attributes
    ----------
    index : int64 (k,)
        Which of the points given.
    cell : int64 (k, 2)
        Lattice coordinates; steps to neighbours are `SQUARE_STEPS` or `HEXAGONAL_STEPS`, turning the way x to y turns.
    """

    index: Array
    cell: Array


@dataclass(frozen=True)
class Laid:
    """A lattice laid over the board.

    Attributes
    ----------
    point : int32 (m,)
        Point of the board.
    index : int64 (m,)
        Which of the points given.
    mirrored : bool
        Whether the board is the mirror image of its description.
    """

    point: Array
    index: Array
    mirrored: bool


def board_cells(target: TargetParams, mirrored: bool = False) -> Array:
    """Return the lattice coordinates (n, 2) of a board's circles; neighbours differ by the steps of its lattice."""
    row, column = (a.ravel() for a in np.mgrid[: target.rows, : target.columns])
    shifted = (row + mirrored) % 2
    if target.layout == "asymmetric":  # a square lattice turned by 45°: its steps lead to the next row
        x = 2 * column + shifted + mirrored
        return np.column_stack([(x + row) // 2, (row - x) // 2])
    if target.layout == "hexagonal":  # steps: along the row, and 60° down
        return np.column_stack([column - (row - shifted) // 2, row])
    return np.column_stack([column, row])


def join(xy: Array, hexagonal: bool) -> Lattice:
    """Join points into the largest lattice that can be grown from one of them.

    From a seed with a full ring of neighbours, every neighbour's place is predicted by the steps that led to the point
    and taken when a point is near it; the steps follow the perspective from point to point.

    Parameters
    ----------
    xy : float64 (k, 2)
    hexagonal : bool
        Six neighbours instead of four.
    """
    empty = Lattice(np.zeros(0, np.int64), np.zeros((0, 2), np.int64))
    if len(xy) < 7:
        return empty
    best = empty
    middle = np.median(xy, axis=0)
    tried = 0
    for seed in np.argsort(((xy - middle) ** 2).sum(axis=1)):
        if seed in best.index:
            continue
        steps = _ring(xy, int(seed), hexagonal)
        if steps is None:
            continue
        grown = _grow(xy, int(seed), steps, hexagonal)
        if len(grown.index) > len(best.index):
            best = grown
        tried += 1
        if tried >= SEEDS or len(best.index) > 0.5 * len(xy):
            break
    return best


def _ring(xy: Array, seed: int, hexagonal: bool) -> Array | None:
    """Return the steps (2, 2) to the first and the second neighbour, or None where there is no full ring."""
    offset = xy - xy[seed]
    distance = np.hypot(*offset.T)
    near = np.argsort(distance)[1 : (7 if hexagonal else 5)]
    ring = offset[near]
    for v in ring:  # a lattice has every neighbour twice: there and on the other side
        if np.hypot(*(ring + v).T).min() > NEAR * np.hypot(*v):
            return None
    angles = np.arctan2(ring[:, 1], ring[:, 0])
    order = np.argsort(angles)
    a, b = ring[order[0]], ring[order[1]]
    if a[0] * b[1] - a[1] * b[0] <= 0:
        return None
    return np.array([a, b])


def _grow(xy: Array, seed: int, steps: Array, hexagonal: bool) -> Lattice:
    moves = HEXAGONAL_STEPS if hexagonal else SQUARE_STEPS
    cell_of: dict[tuple[int, int], int] = {(0, 0): seed}
    steps_at = {(0, 0): steps}
    taken = {seed}
    queue = deque([(0, 0)])
    while queue:
        cell = queue.popleft()
        local = steps_at[cell]
        here = xy[cell_of[cell]]
        for move in moves:
            there = (cell[0] + int(move[0]), cell[1] + int(move[1]))
            if there in cell_of:
                continue
            step = move @ local
            gap = np.hypot(*(xy - (here + step)).T)
            nearest = int(gap.argmin())
            if gap[nearest] > NEAR * np.hypot(*step) or nearest in taken:
                continue
            cell_of[there] = nearest
            taken.add(nearest)
            steps_at[there] = _updated(local, move, xy[nearest] - here)
            queue.append(there)
    cells = np.array(list(cell_of), dtype=np.int64)
    return Lattice(np.array(list(cell_of.values()), dtype=np.int64), cells)


def _updated(local: Array, move: Array, seen: Array) -> Array:
    """Return the steps changed as little as possible so that `move` leads where it was seen to lead."""
    change = seen - move @ local
    return local + np.outer(move, change) / float(move @ move)


def lay_over(target: TargetParams, lattice: Lattice, xy: Array) -> Laid | None:
    """Find the turn and shift of the lattice that lay it over the board; None where they do not fit each other.

    Where the board looks the same after a turn, the one is taken whose rows run most to the right. A shifted grid
    with an even number of rows comes in two forms, mirror images of each other: the one that fits better is taken.

    Parameters
    ----------
    target : TargetParams
    lattice : Lattice
    xy : float64 (k, 2)
        All points.
    """
    best: tuple[int, bool, float] | None = None
    laid: Laid | None = None
    if len(lattice.index) == 0:
        return None
    for mirrored in (False, True) if target.layout != "symmetric" else (False,):
        points = target.points(mirrored)[:, :2]
        wanted = board_cells(target, mirrored)
        place = {(int(a), int(b)): i for i, (a, b) in enumerate(wanted)}
        for turn in _turns(target.layout == "hexagonal"):
            cells = lattice.cell @ turn
            for shift in _shifts(wanted, cells):
                point = np.array([place.get((int(a), int(b)), -1) for a, b in cells + shift])
                hit = np.flatnonzero(point >= 0)
                if len(hit) < COMPLETE * len(wanted):
                    continue
                index = lattice.index[hit]
                rank = (len(hit), not mirrored, _rightward(points[point[hit]], xy[index]))
                if best is None or rank > best:
                    best, laid = rank, Laid(point[hit].astype(np.int32), index, mirrored)
    return laid


def extent(lattice: Lattice, layout: str) -> tuple[int, int]:
    """Return columns and rows of whatever grid the lattice is; (0, 0) of nothing."""
    if len(lattice.cell) == 0:
        return 0, 0
    found = []
    for turn in _turns(layout == "hexagonal"):
        cells = lattice.cell @ turn
        row = cells.sum(axis=1) if layout == "asymmetric" else cells[:, 1]
        counts = np.bincount(row - row.min())
        spread = float(np.abs(counts - np.median(counts)).sum())
        found.append((spread, -int(np.median(counts)), len(counts)))
    _, columns, rows = min(found)
    return -columns, rows


def _turns(hexagonal: bool) -> list[Array]:
    """Return the turns (2, 2) of a lattice into itself, without mirroring; a row vector of a cell times the turn."""
    quarter = np.array([[0, 1], [-1, 1]]) if hexagonal else np.array([[0, 1], [-1, 0]])
    turns = [np.eye(2, dtype=np.int64)]
    for _ in range(5 if hexagonal else 3):
        turns.append(turns[-1] @ quarter)
    return turns


def _shifts(wanted: Array, cells: Array) -> list[Array]:
    """Return the shifts that put the bounding boxes of both over each other, and one step around."""
    middle = np.round(0.5 * (wanted.min(axis=0) + wanted.max(axis=0) - cells.min(axis=0) - cells.max(axis=0)))
    return [middle.astype(np.int64) + np.array([i, j]) for i in (-1, 0, 1) for j in (-1, 0, 1)]


def _rightward(board: Array, xy: Array) -> float:
    """Return how much the rows of the board run to the right: the cosine of their mean direction."""
    affine = np.linalg.lstsq(board - board.mean(axis=0), xy - xy.mean(axis=0), rcond=None)[0]
    return round(float(affine[0, 0] / np.hypot(*affine[0])), 6)
