"""Pairs of photos taken near each other, by the GNSS positions they carry."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from graphos_core.data import Array, Features, PairSelection, PhotoSet
from graphos_core.errors import UserError
from graphos_core.features.pairs.choosing import LESSON, best_partners, selection
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

EQUATOR_M, FLATTENING = 6_378_137.0, 1.0 / 298.257223563
"""Ellipsoid of WGS 84."""


class PositionsParams(Params):
    """Parameters of pairs by position."""

    nearest: Annotated[
        int,
        About(
            label="Nearest photos",
            symbol="k",
            unit="photos",
            low=1,
            high=1000,
            step=1,
            help="Each photo is matched with so many of the nearest.",
            effect="Higher: more pairs, strips hold together better. Lower: faster.",
            learn=LESSON,
            level="novice",
        ),
    ] = 10
    distance: Annotated[
        float | None,
        About(
            label="Largest distance",
            symbol="d",
            unit="m",
            low=0.0,
            low_open=True,
            high=1e6,
            step=10.0,
            help="Photos farther apart than this are not matched; automatic: no limit.",
            effect="Higher: more pairs. Lower: fewer; a photo with no other inside it is matched with none.",
            learn=LESSON,
            level="student",
        ),
    ] = None


@algorithm(
    stage="features",
    role="pairs",
    name="positions",
    label="Nearest by GNSS position",
    source="Spatial matching by k nearest camera positions on the ellipsoid WGS 84",
    learn=LESSON,
)
def positions(
    photos: PhotoSet, features: Sequence[Features], params: PositionsParams, *, run: Run
) -> PairSelection:
    """Match each photo with the nearest ones by the positions in their EXIF headers; the score is the distance in m.

    A photo without position is matched with every other and named, so that it is not lost.

    Parameters
    ----------
    photos : PhotoSet
    features : sequence of Features
        Only their number matters.
    params : PositionsParams
    run : Run

    Raises
    ------
    UserError
        When fewer than two photos carry a position.
    """
    place = geocentric(photos)
    known = np.asarray(np.isfinite(place).all(axis=1))
    if known.sum() < 2:
        raise UserError(
            Text(
                "{count} of {total} photos carry a GNSS position.", count=int(known.sum()), total=len(place)
            ),
            "Neighbours by position need them.",
            "Choose another way to find pairs, such as multi-scale.",
            LESSON,
        )
    apart = np.linalg.norm(place[:, None] - place[None, :], axis=2)
    near = np.where(np.isfinite(apart) & (apart <= (params.distance or np.inf)), -apart, -np.inf)
    chosen = best_partners(near, params.nearest) | ~known[:, None]
    return selection(chosen, apart, _said(photos, known, params))


def geocentric(photos: PhotoSet) -> Array:
    """Return geocentric positions (n, 3) of the photos, m; NaN where latitude or longitude is missing.

    A missing altitude counts as the mean of those that are known.
    """
    values = np.array(
        [(p.exif.latitude_deg, p.exif.longitude_deg, p.exif.altitude_m) for p in photos.photos],
        dtype=np.float64,
    ).reshape(-1, 3)
    latitude, longitude = np.radians(values[:, :2]).T
    known = np.isfinite(values[:, 2])
    height = np.where(known, values[:, 2], values[known, 2].mean() if known.any() else 0.0)
    square = FLATTENING * (2.0 - FLATTENING)
    normal = EQUATOR_M / np.sqrt(1.0 - square * np.sin(latitude) ** 2)
    return np.column_stack([
        (normal + height) * np.cos(latitude) * np.cos(longitude),
        (normal + height) * np.cos(latitude) * np.sin(longitude),
        (normal * (1.0 - square) + height) * np.sin(latitude),
    ])  # fmt: skip


def _said(photos: PhotoSet, known: Array, params: PositionsParams) -> str:
    without = [photo.name for photo, has in zip(photos.photos, known, strict=True) if not has]
    if not without:
        template = "Each photo with the {k} nearest by GNSS position"
        template += ", at most {d:g} m apart." if params.distance else "."
        return Text(template, k=params.nearest, d=params.distance)
    return Text(
        "Each photo with the {k} nearest by GNSS position; without position and so with every other: {names}.",
        k=params.nearest, names=", ".join(without),
    )  # fmt: skip
