"""Filters by parts: a filter's result on a piece of a photo equals that piece of its result on the whole photo.

The live preview filters only what is seen. For that a filter says what it must know of the whole photo (a histogram,
weights), how far round a pixel it looks, and how it works on a piece once it knows that::

    @algorithm(stage="preprocessing", role="filter", …)
    @partwise(learn=_learn, apply=_apply, margin=lambda params: params.window // 2)
    def sharper(image, params, *, run): …

A filter without this is a filter all the same; it can only be previewed on the whole photo.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from graphos_core.data import Array
from graphos_core.run import Run

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Place:
    """Where a piece lies in the whole photo: its top-left pixel, and the size of the whole, px."""

    left: int
    top: int
    width: int
    height: int

    @classmethod
    def whole(cls, image: Array) -> Place:
        """Return the place of a photo in itself."""
        return cls(0, 0, image.shape[1], image.shape[0])


@dataclass(frozen=True)
class Parts:
    """How a filter works on a piece of a photo.

    Attributes
    ----------
    learn : callable
        ``learn(image, params, run) -> known``: what it must know of the whole photo; may be given the photo at a
        reduced size, then the result on a piece is an approximation.
    apply : callable
        ``apply(piece, params, known, place) -> uint8 piece``; the result is right `margin` px from the cut edges.
    margin : callable
        ``margin(params) -> int``: how far round a pixel the filter looks, px.
    reduced : callable
        ``reduced(params, factor) -> params``: parameters that do about the same on a photo `factor` times smaller.
    local : bool
        Nothing of the whole photo matters (as long as it has 8 bits): a piece is exact without `learn`.
    """

    learn: Callable[[Array, Any, Run], Any]
    apply: Callable[[Array, Any, Any, Place], Array]
    margin: Callable[[Any], int]
    reduced: Callable[[Any, float], Any]
    local: bool


_PARTS: dict[Callable[..., Any], Parts] = {}


def partwise(
    *,
    learn: Callable[[Array, Any, Run], Any],
    apply: Callable[[Array, Any, Any, Place], Array],
    margin: Callable[[Any], int] = lambda params: 0,
    reduced: Callable[[Any, float], Any] = lambda params, factor: params,
    local: bool = False,
) -> Callable[[Function], Function]:
    """Say of the decorated filter how it works on a piece of a photo; see `Parts`."""

    def say(function: Function) -> Function:
        _PARTS[function] = Parts(learn, apply, margin, reduced, local)
        return function

    return say


def parts_of(function: Callable[..., Any]) -> Parts | None:
    """Return how a filter works on a piece of a photo, or None when it did not say."""
    return _PARTS.get(function)


def odd_window(window: int, factor: float) -> int:
    """Return the window, px, that covers on a photo `factor` times smaller what `window` covers; at least 3."""
    return max(3, 2 * round(0.5 * (window / factor - 1)) + 1)
