"""What all ways of choosing pairs share: a selection from chosen pairs, and the k best partners of each photo."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Array, Features, PairSelection

LESSON = "features/pairs"


def selection(chosen: Array, score: Array, said: str) -> PairSelection:
    """Return the pairs a < b for which `chosen` is True, with their scores.

    Parameters
    ----------
    chosen : bool (n, n)
        Either half may say yes.
    score : float (n, n)
        Symmetric.
    said : str
    """
    count = len(chosen)
    pairs = np.argwhere(np.triu(chosen | chosen.T, 1)).astype(np.int32).reshape(-1, 2)
    return PairSelection(
        pairs=pairs,
        score=score[pairs[:, 0], pairs[:, 1]].astype(np.float32),
        possible=count * (count - 1) // 2,
        said=said,
    )


def best_partners(score: Array, number: int) -> Array:
    """Return which photos are among the `number` best partners of each, bool (n, n); −∞ is no partner.

    Parameters
    ----------
    score : float (n, n)
        Larger is better; of equal ones the first photos win.
    number : int
    """
    score = np.array(score, dtype=np.float64)
    np.fill_diagonal(score, -np.inf)
    order = np.argsort(-score, axis=1, kind="stable")[:, :number]
    chosen = np.zeros(score.shape, bool)
    np.put_along_axis(chosen, order, True, axis=1)
    return chosen & np.isfinite(score)


def largest(features: Features, number: int) -> Array:
    """Return the indices of the largest points: those that a small image would still show."""
    return np.argsort(-features.scale, kind="stable")[:number]
