r"""CLAHE: histogram equalisation tile by tile, with limited contrast."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from graphos_core.data import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.grey import eight_bit, luma
from graphos_core.preprocessing.luminance import Levels, histogram, levels_of, on_luminance
from graphos_core.preprocessing.luminance_kernels import interpolate_tables
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "preprocessing/clahe"


class ClaheParams(Params):
    """Parameters of CLAHE."""

    clip: Annotated[
        float,
        About(
            label="Contrast limit",
            symbol="k",
            low=1.0,
            high=100.0,
            step=0.5,
            help="No grey value counts more than k times its share in an even histogram; this limits the slope.",
            effect="Higher: more contrast, also of noise. 1: hardly any change.",
            learn=LESSON,
            level="novice",
        ),
    ] = 1.5
    tiles: Annotated[
        int,
        About(
            label="Tiles",
            symbol="n",
            unit="tiles",
            low=1,
            high=64,
            step=1,
            help="The photo is divided into n × n tiles, each with a histogram of its own.",
            effect="Higher: more local. 1: one histogram for the whole photo.",
            learn=LESSON,
            level="novice",
        ),
    ] = 8


@dataclass(frozen=True)
class Tables:
    """Tables of the tiles, uint8 (n, n, 256), and the size of the photo they were made of, px."""

    levels: Levels
    tables: Array
    width: int
    height: int


def _learn(image: Array, params: ClaheParams, run: Run) -> Tables:
    levels = levels_of(image)
    grey = np.ascontiguousarray(luma(eight_bit(image, levels)))
    height, width = grey.shape
    n = params.tiles
    rows, columns = math.ceil(height / n), math.ceil(width / n)
    # tiles are of one size: what the last ones lack is mirrored
    index_y = _mirrored(height, rows * n)
    index_x = _mirrored(width, columns * n)
    tables = np.empty((n, n, 256), np.uint8)
    for i in range(n):
        strip = grey[index_y[i * rows : (i + 1) * rows]]
        for j in range(n):
            tile = np.ascontiguousarray(strip[:, index_x[j * columns : (j + 1) * columns]])
            tables[i, j] = clipped_table(histogram(tile), params.clip)
    return Tables(levels, tables, width, height)


def clipped_table(counts: Array, clip: float) -> Array:
    """Return the new value of each grey value, uint8 (256,), from the frequencies (256,) of a tile.

    What exceeds the limit ``k·N/256`` is cut off and spread over all values evenly.
    """
    total = int(counts.sum())
    limit = max(int(clip * total / 256), 1)
    excess = int(np.maximum(counts - limit, 0).sum())
    spread = np.minimum(counts, limit) + excess // 256
    rest = excess % 256
    if rest:
        spread[np.arange(rest) * max(256 // rest, 1)] += 1
    return np.clip(np.rint(np.cumsum(spread) * np.float32(255.0 / total)), 0, 255).astype(np.uint8)


def _mirrored(length: int, wanted: int) -> Array:
    steps = np.arange(wanted)
    period = max(1, 2 * (length - 1))
    steps = steps % period
    return np.minimum(steps, period - steps)


def _apply(image: Array, params: ClaheParams, known: Tables, place: Place) -> Array:
    n = params.tiles
    tile_width, tile_height = math.ceil(place.width / n), math.ceil(place.height / n)
    return on_luminance(
        image,
        known.levels,
        lambda grey: interpolate_tables(grey, known.tables, place.left, place.top, tile_width, tile_height),
    )


@algorithm(
    stage="preprocessing",
    role="filter",
    name="clahe",
    label="CLAHE",
    source="Pizer et al. 1987, Adaptive histogram equalization and its variations; "
    "Zuiderveld 1994, Contrast limited adaptive histogram equalization (Graphics Gems IV)",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply)
def clahe(image: Array, params: ClaheParams, *, run: Run) -> Array:
    r"""Equalise the histogram of every tile, the slope limited, and blend between the middles of the tiles.

    In a tile of N pixels no grey value may count more than k·N/256; what exceeds this is spread evenly over all
    values, so that the slope of the mapping, and with it the gain of noise, stays below about k. Each pixel is
    mapped by the four nearest tiles' tables, weighted bilinearly. Of a colour photo the luma is equalised and the
    hue kept.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, 3) RGB
    params : ClaheParams
    run : Run

    Returns
    -------
    uint8, of the shape of `image`
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
