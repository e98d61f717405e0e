"""What every group of other observations has in common, and where the unknowns it concerns stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.data.record import Array


@dataclass(frozen=True)
class Extra:
    """An unknown that a group brings with it: name, start value, unit."""

    name: str
    value: float
    unit: str


@dataclass(frozen=True)
class Columns:
    """Where unknowns stand in the reduced system; −1 where something is held fixed.

    Attributes
    ----------
    point : int64 (p,)
        Solver index of each point of the block.
    point_column : int64 (p,)
        By point of the block.
    photo : int64 (n,)
        First of the six columns of a photo.
    camera : int64 (c, k)
        Of each camera parameter; per camera as far as it is shared or used by one photo.
    extra : int
        First column of the group's own unknowns.
    extra_value : int
        Place of the group's first own unknown in `Scene.extra`.
    """

    point: Array
    point_column: Array
    photo: Array
    camera: Array
    extra: int
    extra_value: int


class Entries:
    """Collects the entries of a Jacobian; entries of fixed unknowns are left out."""

    def __init__(self) -> None:
        self._parts: list[tuple[Array, Array, Array]] = []

    def add(self, rows: Array, columns: Array, values: Array) -> None:
        """Add entries; the three arrays are broadcast against each other."""
        rows, columns, values = np.broadcast_arrays(rows, columns, values)
        free = columns >= 0
        self._parts.append((rows[free], columns[free], np.asarray(values, dtype=np.float64)[free]))

    def add_blocks(self, first_row: Array, first_column: Array, blocks: Array) -> None:
        """Add blocks (k, a, b) whose top left corners stand at ``first_row`` (k,), ``first_column`` (k,)."""
        _, a, b = blocks.shape
        columns = np.asarray(first_column)[:, None, None]
        self.add(
            np.asarray(first_row)[:, None, None] + np.arange(a)[:, None],
            np.where(columns < 0, -1, columns + np.arange(b)),
            blocks,
        )

    def arrays(self) -> tuple[Array, Array, Array]:
        """Return rows, columns and values."""
        if not self._parts:
            nothing = np.empty(0, dtype=np.int64)
            return nothing, nothing, np.empty(0)
        rows, columns, values = (np.concatenate(part) for part in zip(*self._parts, strict=True))
        return rows.astype(np.int64), columns.astype(np.int64), values


def chosen(labels: Sequence[str], index: Array) -> list[str]:
    """Return the labels of the chosen observations."""
    return [labels[int(i)] for i in index]


class Group(Protocol):
    """Observations of one kind that concern reduced unknowns only.

    Attributes
    ----------
    kind : str
        As in `ObservationGroup.kind`.
    unit : str
        Of every observation, or ``""`` where they differ.
    labels : sequence of str (k,)
    observed, sigma : float64 (k,)
        Observed values and a priori standard deviations.
    points, photos : int64
        Points and photos of the block it concerns.
    extras : tuple of Extra
        Unknowns it brings with it.
    """

    @property
    def kind(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def labels(self) -> Sequence[str]: ...
    @property
    def observed(self) -> Array: ...
    @property
    def sigma(self) -> Array: ...
    @property
    def points(self) -> Array: ...
    @property
    def photos(self) -> Array: ...
    @property
    def extras(self) -> tuple[Extra, ...]: ...

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Return the group without observations of points and photos (bool) that are not there; None if none is left."""
        ...

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the computed values (k,) and add their derivatives to `entries`, rows counted from 0."""
        ...
