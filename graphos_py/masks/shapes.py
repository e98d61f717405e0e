"""What can be done to the polygons of a photo: hit, move, insert, delete, copy; plain functions without widgets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from graphos_core.data import Photo
from graphos_core.masks import PhotoMask, Polygon, polygon_inside, rasterised


class Grip(NamedTuple):
    """A corner of a polygon: their indices."""

    polygon: int
    corner: int


def corner_at(polygons: Sequence[Polygon], x: float, y: float, reach: float) -> Grip | None:
    """Return the nearest corner within `reach` px of the photo."""
    found, best = None, reach
    for index, polygon in enumerate(polygons):
        away = np.hypot(*(np.array(polygon.points) - [x, y]).T)
        corner = int(np.argmin(away))
        if away[corner] <= best:
            found, best = Grip(index, corner), float(away[corner])
    return found


def edge_at(polygons: Sequence[Polygon], x: float, y: float, reach: float) -> Grip | None:
    """Return the corner after which the nearest edge within `reach` px begins."""
    found, best = None, reach
    for index, polygon in enumerate(polygons):
        a = np.array(polygon.points)
        along = np.roll(a, -1, axis=0) - a
        share = ((np.array([x, y]) - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-12)
        away = np.hypot(*(a + np.clip(share, 0, 1)[:, None] * along - [x, y]).T)
        corner = int(np.argmin(away))
        if away[corner] <= best:
            found, best = Grip(index, corner), float(away[corner])
    return found


def polygon_at(polygons: Sequence[Polygon], x: float, y: float) -> int:
    """Return the last polygon that holds a position; −1 for none."""
    for index in range(len(polygons) - 1, -1, -1):
        moved = [(px - x, py - y) for px, py in polygons[index].points]
        if polygon_inside(moved, 1, 1)[0, 0]:
            return index
    return -1


def with_corner(polygon: Polygon, corner: int, x: float, y: float) -> Polygon:
    """Return the polygon with a corner moved."""
    points = list(polygon.points)
    points[corner] = (x, y)
    return replace(polygon, points=tuple(points))


def with_new_corner(polygon: Polygon, after: int, x: float, y: float) -> Polygon:
    """Return the polygon with one more corner on the edge after a corner."""
    points = [*polygon.points[: after + 1], (x, y), *polygon.points[after + 1 :]]
    return replace(polygon, points=tuple(points))


def without_corner(polygon: Polygon, corner: int) -> Polygon | None:
    """Return the polygon without a corner; None where less than three would be left."""
    points = polygon.points[:corner] + polygon.points[corner + 1 :]
    return replace(polygon, points=points) if len(points) >= 3 else None


def moved(polygon: Polygon, dx: float, dy: float) -> Polygon:
    """Return the polygon moved."""
    return replace(polygon, points=tuple((x + dx, y + dy) for x, y in polygon.points))


def copied_to_all(
    masks: Mapping[str, PhotoMask], source: str, photos: Iterable[Photo]
) -> tuple[dict[str, PhotoMask], int, int]:
    """Return the masks with the polygons of one photo added to all of its size; how many got them and how many not."""
    listed = {photo.name: photo for photo in photos}
    own, made, given, other = listed[source], dict(masks), 0, 0
    for name, photo in listed.items():
        if name == source:
            continue
        if (photo.width, photo.height) != (own.width, own.height):
            other += 1
            continue
        before = made.get(name, PhotoMask())
        new = tuple(p for p in masks[source].polygons if p not in before.polygons)
        made[name] = replace(before, polygons=(*before.polygons, *new))
        given += 1
    return made, given, other


def masked_share(polygons: Sequence[Polygon], width: int, height: int, side: int = 800) -> float:
    """Return the share of a photo that polygons take away, counted in a picture of at most `side` px."""
    scale = min(1.0, side / max(width, height))
    small = [
        replace(p, points=tuple(((x + 0.5) * scale - 0.5, (y + 0.5) * scale - 0.5) for x, y in p.points))
        for p in polygons
    ]
    free = rasterised(small, max(1, round(width * scale)), max(1, round(height * scale)))
    return 1.0 - float(free.mean())
