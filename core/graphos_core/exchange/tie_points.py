"""Tie points of other programs: image points and which of them show the same object point.

- ``table``: CSV ``point,photo,x [px],y [px]``.
- ``colmap``: a folder with a feature file per photo (``PHOTO.txt``: position, scale, orientation, 128 descriptor values)
  and ``matches.txt``, as COLMAP's ``feature_importer`` and ``matches_importer`` take them; or its ``database.db``.
- ``micmac``: a folder ``Homol`` with ``PastisA/B.txt`` per pair, four numbers per line; text, not ``.dat``.
- ``bundler``: the view lists of a bundle file, read only: written together with the orientation.
"""

from __future__ import annotations

import csv
import io
import sqlite3
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from graphos_core.data import Array, Tracks
from graphos_core.errors import UserError
from graphos_core.exchange.bundler import read_bundler
from graphos_core.exchange.text_files import bad_line, finite, not_such, read_lines
from graphos_core.params import unknown_name
from graphos_core.store import write_text
from graphos_core.text import Text

TIE_POINT_FORMATS = {
    "table": "CSV: point, photo, x, y in px",
    "colmap": "COLMAP feature files with matches.txt; reads database.db",
    "micmac": "MicMac Homol folder, text",
    "bundler": "Bundler bundle.out (only read)",
}
"""Formats by name."""

HALF = 0.5
PREFIX = "Pastis"
SCALE_PX = 1.0
"""Scale written for points whose detector is not known, px."""

PAIR_BASE = 2147483647
"""COLMAP's pair number is ``image1 · this + image2`` (``src/colmap/scene/database.cc``)."""


@dataclass(frozen=True)
class TiePoints:
    """Tie points with the photos they were measured in.

    Attributes
    ----------
    photos : tuple of str
        Names; `Tracks.photo` counts in them.
    tracks : Tracks
        Positions in px of the full photo, centre of the top-left pixel at (0, 0).
    remarks : tuple of str
    """

    photos: tuple[str, ...]
    tracks: Tracks
    remarks: tuple[str, ...] = ()


def read_tie_points(path: Path, name: str = "") -> TiePoints:
    """Read tie points; `name` empty to recognise the format.

    Raises
    ------
    UserError
        When the file or folder cannot be read, with the line.
    """
    name = name or _guess(path)
    if name == "table":
        return _read_table(path)
    if name == "micmac":
        return _read_micmac(path)
    if name == "bundler":
        block = read_bundler(path).block
        return from_observations(block.names, block.obs_point, block.obs_photo, block.obs_xy, block.colours)
    if name == "colmap":
        database = path / "database.db" if path.is_dir() else path
        return _read_database(database) if database.is_file() else _read_colmap_text(path)
    raise UserError(unknown_name(name, list(TIE_POINT_FORMATS), "tie point format"))


def _guess(path: Path) -> str:
    if path.is_dir():
        return "micmac" if any(p.is_dir() and p.name.startswith(PREFIX) for p in path.iterdir()) else "colmap"
    if path.suffix == ".db":
        return "colmap"
    return "bundler" if path.suffix == ".out" else "table"


def write_tie_points(points: TiePoints, path: Path, name: str) -> tuple[Path, ...]:
    """Write tie points; the files written.

    Raises
    ------
    UserError
        When a file cannot be written, or the format is only read.
    """
    if name == "table":
        return _write_table(points, path)
    if name == "micmac":
        return _write_micmac(points, path)
    if name == "colmap":
        return _write_colmap(points, path)
    if name == "bundler":
        raise UserError(
            "Bundler keeps tie points inside its bundle file.", "They are written together with the orientation.",
            "Use graphos convert orientation … --to bundler.",
        )  # fmt: skip
    raise UserError(unknown_name(name, list(TIE_POINT_FORMATS), "tie point format"))


def from_observations(
    photos: tuple[str, ...],
    point: Array,
    photo: Array,
    xy: Array,
    colours: Array | None = None,
    lost: int = 0,
) -> TiePoints:
    """Return tie points from observations; points seen once or twice in one photo are left out and counted.

    Parameters
    ----------
    photos : tuple of str
    point, photo : int (m,)
    xy : float64 (m, 2)
    colours : uint8 (p, 3) or None
    lost : int
        Points that were left out before.
    """
    keys, point = np.unique(np.asarray(point), return_inverse=True)
    pairs, count = np.unique(np.column_stack([point, photo]), axis=0, return_counts=True)
    twice = np.zeros(len(keys), dtype=bool)
    twice[pairs[count > 1, 0]] = True
    rays = np.bincount(pairs[:, 0], minlength=len(keys)) if len(pairs) else np.zeros(len(keys), dtype=int)
    good = (rays >= 2) & ~twice
    number = np.cumsum(good) - 1
    keep = good[point] if len(point) else np.zeros(0, dtype=bool)
    track, photo, xy = number[point[keep]], np.asarray(photo)[keep], np.asarray(xy, dtype=np.float64)[keep]
    order = np.lexsort((photo, track))
    feature = np.zeros(len(track), dtype=np.int32)
    for i in range(len(photos)):
        mine = np.flatnonzero(photo[order] == i)
        feature[mine] = np.arange(len(mine))
    found = int(good.sum())
    conflicts = int(twice.sum()) + lost
    tracks = Tracks(
        photo=photo[order].astype(np.int32), feature=feature, track=track[order].astype(np.int32),
        xy=np.ascontiguousarray(xy[order]).reshape(-1, 2),
        colour=np.full((found, 3), 128, dtype=np.uint8) if colours is None else np.asarray(colours)[keys[good]],
        count=found, conflicts=conflicts,
    )  # fmt: skip
    remarks = []
    if conflicts:
        remarks.append(
            Text("{count} points were left out: they have two positions in one photo.", count=conflicts)
        )
    single = int((rays == 1).sum())
    if single:
        remarks.append(Text("{count} points were left out: they are seen in one photo only.", count=single))
    return TiePoints(tuple(photos), tracks, tuple(remarks))


def _read_table(path: Path) -> TiePoints:
    lines = read_lines(path)
    rows = list(csv.reader(io.StringIO("\n".join(lines))))
    head = [cell.casefold().split("[")[0].strip() for cell in rows[0]] if rows else []
    if not {"point", "photo", "x", "y"} <= set(head):
        raise not_such(
            path, "a table of tie points", "Its first line must name the columns point, photo, x, y."
        )
    at = [head.index(name) for name in ("point", "photo", "x", "y")]
    numbers: dict[str, int] = {}
    photos: dict[str, int] = {}
    point, photo, xy = [], [], []
    for n, row in enumerate(rows[1:], 2):
        if not any(row) or row[0].startswith("#"):
            continue
        try:
            name, where, x, y = (row[i].strip() for i in at)
            xy.append(finite([x, y]))
        except (IndexError, ValueError):
            raise bad_line(path, n, ",".join(row), "point, photo and two numbers") from None
        point.append(numbers.setdefault(name, len(numbers)))
        photo.append(photos.setdefault(where, len(photos)))
    return from_observations(
        tuple(photos), np.array(point, dtype=int), np.array(photo, dtype=int), np.array(xy).reshape(-1, 2)
    )


def _write_table(points: TiePoints, path: Path) -> tuple[Path, ...]:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["point", "photo", "x [px]", "y [px]"])
    t = points.tracks
    for track, photo, (x, y) in zip(t.track.tolist(), t.photo.tolist(), t.xy.tolist(), strict=True):
        writer.writerow([track, points.photos[photo], repr(x), repr(y)])
    write_text(path, out.getvalue())
    return (path,)


Key = tuple[int, float, float]


def _join(photos: tuple[str, ...], pairs: list[tuple[Key, Key]]) -> TiePoints:
    """Join pairs of image points (photo, x, y) to points seen in several photos (connected components)."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    index: dict[Key, int] = {}
    a = [index.setdefault(first, len(index)) for first, _ in pairs]
    b = [index.setdefault(second, len(index)) for _, second in pairs]
    size = len(index)
    graph = coo_matrix((np.ones(len(a)), (a, b)), shape=(size, size))
    label = connected_components(graph, directed=False)[1] if size else np.zeros(0, dtype=int)
    table = np.array(list(index), dtype=np.float64).reshape(-1, 3)
    return from_observations(photos, label, table[:, 0].astype(int), table[:, 1:])


def _read_micmac(folder: Path) -> TiePoints:
    files = sorted(folder.glob(f"{PREFIX}*/*.txt"))
    if not files:
        raise UserError(
            Text("{name} holds no tie points of MicMac in text form.", name=folder.name),
            "There is no file PastisPHOTO/PHOTO.txt in it; binary .dat files are not read.",
            "Write them as text: option ExpTxt=1 of Tapioca.",
        )  # fmt: skip
    names = sorted(
        {f.parent.name.removeprefix(PREFIX) for f in files} | {f.name.removesuffix(".txt") for f in files}
    )
    place = {name: i for i, name in enumerate(names)}
    pairs: list[tuple[Key, Key]] = []
    for file in files:
        first, second = place[file.parent.name.removeprefix(PREFIX)], place[file.name.removesuffix(".txt")]
        for n, line in enumerate(read_lines(file), 1):
            if not line.strip():
                continue
            try:
                xa, ya, xb, yb = finite(line.split()[:4])
            except ValueError:
                raise bad_line(
                    file, n, line, "four numbers: x y in the first photo, x y in the second"
                ) from None
            pairs.append(((first, xa, ya), (second, xb, yb)))
    return _join(tuple(names), pairs)


def _pairs(points: TiePoints) -> dict[tuple[int, int], list[tuple[int, int]]]:
    """Return the observations of every pair of photos that see a common point."""
    t = points.tracks
    bounds = np.searchsorted(t.track, np.arange(t.count + 1))
    found: dict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        for i in range(first, last):
            for j in range(i + 1, last):
                found[int(t.photo[i]), int(t.photo[j])].append((i, j))
    return found


def _write_micmac(points: TiePoints, folder: Path) -> tuple[Path, ...]:
    """Write both directions of every pair, as MicMac does."""
    files = []
    xy = points.tracks.xy.tolist()
    for (a, b), rows in sorted(_pairs(points).items()):
        for first, second, turned in ((a, b, False), (b, a, True)):
            path = folder / f"{PREFIX}{_flat(points.photos[first])}" / f"{_flat(points.photos[second])}.txt"
            lines = [(xy[j] + xy[i]) if turned else (xy[i] + xy[j]) for i, j in rows]
            write_text(path, "".join(" ".join(repr(v) for v in line) + "\n" for line in lines))
            files.append(path)
    return tuple(files)


def _flat(name: str) -> str:
    return name.replace("/", "_").replace("\\", "_")


def _write_colmap(points: TiePoints, folder: Path) -> tuple[Path, ...]:
    t = points.tracks
    files = []
    for i, name in enumerate(points.photos):
        mine = np.flatnonzero(t.photo == i)
        zeros = " 0" * 128
        lines = [f"{x + HALF!r} {y + HALF!r} {SCALE_PX} 0{zeros}" for x, y in t.xy[mine].tolist()]
        files.append(folder / f"{_flat(name)}.txt")
        write_text(files[-1], "\n".join([f"{len(mine)} 128", *lines]) + "\n")
    out = []
    for (a, b), rows in sorted(_pairs(points).items()):
        out += [
            f"{points.photos[a]} {points.photos[b]}",
            *(f"{t.feature[i]} {t.feature[j]}" for i, j in rows),
            "",
        ]
    files.append(folder / "matches.txt")
    write_text(files[-1], "\n".join(out) + "\n")
    return tuple(files)


def _read_colmap_text(folder: Path) -> TiePoints:
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
                    positions.append(_features(folder / f"{_flat(word)}.txt"))
            pair = (names[words[0]], names[words[1]])
        else:
            try:
                i, j = (int(word) for word in words)
                a, b = positions[pair[0]][i], positions[pair[1]][j]
            except (ValueError, IndexError):
                raise bad_line(matches, n, line, "the numbers of two features") from None
            pairs.append(((pair[0], float(a[0]), float(a[1])), (pair[1], float(b[0]), float(b[1]))))
    return _join(tuple(names), pairs)


def _features(path: Path) -> Array:
    rows = []
    for n, line in enumerate(read_lines(path)[1:], 2):
        if line.strip():
            try:
                rows.append([v - HALF for v in finite(line.split()[:2])])
            except ValueError:
                raise bad_line(path, n, line, "a feature: x y scale orientation …") from None
    return np.array(rows).reshape(-1, 2)


def _read_database(path: Path) -> TiePoints:
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
    return _join(tuple(names.values()), pairs)
