"""COLMAP's tie points: feature files with ``matches.txt``, and the verified matches of its database."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import numpy as np

from graphos_core.data import Array
from graphos_core.exchange.text_files import bad_line, finite, not_such, read_lines
from graphos_core.exchange.tie_point_records import Key, TiePoints, flat_name, join, pairs_of
from graphos_core.store import write_text
from graphos_core.text import Text

HALF = 0.5
SCALE_PX = 1.0
"""Scale written for points whose detector is not known, px."""

PAIR_BASE = 2147483647
"""COLMAP's pair number is ``image1 · this + image2`` (``src/colmap/scene/database.cc``)."""


def write_colmap_points(points: TiePoints, folder: Path) -> tuple[Path, ...]:
    """Write a feature file per photo, descriptors zero, and ``matches.txt``; errors as the writer of files."""
    t = points.tracks
    files = []
    for i, name in enumerate(points.photos):
        mine = np.flatnonzero(t.photo == i)
        zeros = " 0" * 128
        lines = [f"{x + HALF!r} {y + HALF!r} {SCALE_PX} 0{zeros}" for x, y in t.xy[mine].tolist()]
        files.append(folder / f"{flat_name(name)}.txt")
        write_text(files[-1], "\n".join([f"{len(mine)} 128", *lines]) + "\n")
    out = []
    for (a, b), rows in sorted(pairs_of(points).items()):
        out += [
            f"{points.photos[a]} {points.photos[b]}",
            *(f"{t.feature[i]} {t.feature[j]}" for i, j in rows),
            "",
        ]
    files.append(folder / "matches.txt")
    write_text(files[-1], "\n".join(out) + "\n")
    return tuple(files)


def read_colmap_points(folder: Path) -> TiePoints:
    """Read ``matches.txt`` and the feature files it names; errors as `graphos_core.exchange.tie_points`."""
    matches = folder / "matches.txt"
    names: dict[str, int] = {}
    positions: list[Array] = []
    pairs: list[tuple[Key, Key]] = []
    pair: tuple[int, int] | None = None
    for n, line in enumerate(read_lines(matches), 1):
        words = line.split()
        if not words:
            pair = None
        elif pair is None:
            if len(words) != 2:
                raise bad_line(matches, n, line, "the names of two photos")
            for word in words:
                if word not in names:
                    names[word] = len(names)
                    positions.append(_features(folder / f"{flat_name(word)}.txt"))
            pair = (names[words[0]], names[words[1]])
        else:
            try:
                i, j = (int(word) for word in words)
                a, b = positions[pair[0]][i], positions[pair[1]][j]
            except (ValueError, IndexError):
                raise bad_line(matches, n, line, "the numbers of two features") from None
            pairs.append(((pair[0], float(a[0]), float(a[1])), (pair[1], float(b[0]), float(b[1]))))
    return join(tuple(names), pairs)


def _features(path: Path) -> Array:
    rows = []
    for n, line in enumerate(read_lines(path)[1:], 2):
        if line.strip():
            try:
                rows.append([v - HALF for v in finite(line.split()[:2])])
            except ValueError:
                raise bad_line(path, n, line, "a feature: x y scale orientation …") from None
    return np.array(rows).reshape(-1, 2)


def read_colmap_database(path: Path) -> TiePoints:
    """Read verified matches (two-view geometries) and keypoints of COLMAP's database, which is opened read-only."""
    try:
        with sqlite3.connect(f"file:{path.resolve().as_posix()}?mode=ro", uri=True) as database:
            names = dict(database.execute("SELECT image_id, name FROM images ORDER BY image_id"))
            raw = {i: (rows, columns, blob) for i, rows, columns, blob in
                   database.execute("SELECT image_id, rows, cols, data FROM keypoints")}  # fmt: skip
            verified = list(
                database.execute("SELECT pair_id, rows, data FROM two_view_geometries WHERE rows > 0")
            )
    except sqlite3.Error as problem:
        raise not_such(
            path, "a database of COLMAP", Text("The database says: {why}.", why=problem)
        ) from problem
    try:
        place = {number: i for i, number in enumerate(names)}
        xy = {i: np.frombuffer(blob, dtype=np.float32).reshape(rows, columns)[:, :2].astype(np.float64) - HALF
              for i, (rows, columns, blob) in raw.items()}  # fmt: skip
        pairs: list[tuple[Key, Key]] = []
        for number, rows, blob in verified:
            first, second = divmod(int(number), PAIR_BASE)
            for i, j in np.frombuffer(blob, dtype=np.uint32).reshape(rows, 2).tolist():
                a, b = xy[first][i], xy[second][j]
                pairs.append(
                    ((place[first], float(a[0]), float(a[1])), (place[second], float(b[0]), float(b[1])))
                )
    except (ValueError, KeyError, IndexError, TypeError) as problem:
        raise not_such(
            path, "a database of COLMAP", "Its keypoints and matches do not belong together."
        ) from problem
    return join(tuple(names.values()), pairs)
