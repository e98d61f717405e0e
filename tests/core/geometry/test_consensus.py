"""Number of random samples, against the printed table."""

from __future__ import annotations

import math

import numpy as np
import pytest

from graphos_core.geometry.consensus import samples_needed

SHARES = (0.05, 0.10, 0.20, 0.25, 0.30, 0.40, 0.50)
HARTLEY_ZISSERMAN_TABLE_4_3 = {
    2: (2, 3, 5, 6, 7, 11, 17),
    4: (3, 5, 9, 13, 17, 34, 72),
    7: (4, 8, 20, 33, 54, 163, 588),
    8: (5, 9, 26, 44, 78, 272, 1177),
}


@pytest.mark.parametrize("size", HARTLEY_ZISSERMAN_TABLE_4_3)
def test_numbers_are_those_of_the_printed_table(size: int) -> None:
    found = tuple(samples_needed(1.0 - outliers, size, 0.99) for outliers in SHARES)
    assert found == HARTLEY_ZISSERMAN_TABLE_4_3[size]


def test_so_many_samples_contain_a_clean_one_as_often_as_wished() -> None:
    rng = np.random.default_rng(0)
    needed = int(samples_needed(0.6, 3, 0.9))
    clean = (rng.random((4000, needed, 3)) < 0.6).all(axis=2).any(axis=1)
    assert 0.89 <= clean.mean() <= 0.95


def test_limits() -> None:
    assert samples_needed(1.0, 5, 0.99) == 1.0
    assert samples_needed(0.0, 5, 0.99) == math.inf
