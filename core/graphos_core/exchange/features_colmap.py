"""COLMAP's features and matches: its database, and text files as its importers take them.

Keypoints of COLMAP have (0.5, 0.5) in the centre of the top-left pixel and, as scale, σ of the blob, half of the
diameter used here. Its descriptors are bytes of length about 512, as here. The database is written in the form of
version 3.9, which newer versions bring to their own when they open it (``src/colmap/scene/database_sqlite.cc``).
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from graphos_core.data import Array, Camera, PairMatches
from graphos_core.errors import UserError
from graphos_core.exchange.colmap_model import colmap_camera
from graphos_core.exchange.feature_records import FeatureFiles, PhotoFeatures, plain_pair
from graphos_core.exchange.text_files import bad_line, finite, not_such, read_lines
from graphos_core.exchange.tie_point_records import flat_name
from graphos_core.exchange.tie_points_colmap import HALF, PAIR_BASE
from graphos_core.store import cannot_write, write_text
from graphos_core.text import Text

FORM = 3900
"""``user_version`` of the database."""

CAMERA_NUMBERS = {
    "SIMPLE_PINHOLE": 0, "PINHOLE": 1, "SIMPLE_RADIAL": 2, "RADIAL": 3, "OPENCV": 4, "OPENCV_FISHEYE": 5,
    "FULL_OPENCV": 6, "SIMPLE_RADIAL_FISHEYE": 8, "RADIAL_FISHEYE": 9, "THIN_PRISM_FISHEYE": 10,
}  # fmt: skip
"""COLMAP's numbers of camera models (``src/colmap/sensor/models.h``)."""

CONFIGURATIONS = {"essential": 2, "fundamental": 3, "homography": 6}
"""Kinds of two-view geometries: calibrated, uncalibrated, planar or panoramic."""

SHIFT = np.array([[1.0, 0.0, HALF], [0.0, 1.0, HALF], [0.0, 0.0, 1.0]])

TABLES = (
    "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, model INTEGER NOT NULL, width INTEGER NOT "
    "NULL, height INTEGER NOT NULL, params BLOB, prior_focal_length INTEGER NOT NULL)",
    "CREATE TABLE images (image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, name TEXT NOT NULL UNIQUE, camera_id INTEGER "
    "NOT NULL, CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647), FOREIGN KEY(camera_id) REFERENCES "
    "cameras(camera_id))",
    "CREATE UNIQUE INDEX index_name ON images(name)",
    "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB, "
    "FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE)",
    "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB, "
    "FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE)",
    "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB)",
    "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL, cols INTEGER NOT NULL, "
    "data BLOB, config INTEGER NOT NULL, F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB)",
)


def write_colmap_database(files: FeatureFiles, path: Path) -> tuple[Path, ...]:
    """Write a new database; verified matches become two-view geometries with their matrices.

    Raises
    ------
    UserError
        When it exists already, cannot be written, or the cameras are not known.
    """
    if not files.cameras:
        raise UserError(
            "A database of COLMAP needs the cameras of the photos.",
            "These features come without cameras.",
            "Convert from a project, or write text files.",
        )
    if path.exists():
        raise UserError(Text("{name} exists already.", name=path.name), todo="Choose another name.")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with sqlite3.connect(path) as database:
            for table in TABLES:
                database.execute(table)
            database.execute(f"PRAGMA user_version = {FORM}")
            _write_photos(database, files)
            _write_pairs(database, files.pairs)
        database.close()
    except (OSError, sqlite3.Error) as problem:
        path.unlink(missing_ok=True)
        raise cannot_write(path, OSError(str(problem))) from problem
    return (path,)


def _write_photos(database: sqlite3.Connection, files: FeatureFiles) -> None:
    known: dict[int, int] = {}
    for i, (name, features) in enumerate(zip(files.photos, files.features, strict=True)):
        camera = files.cameras[i]
        if id(camera) not in known:
            known[id(camera)] = len(known) + 1
            database.execute(
                "INSERT INTO cameras VALUES (?, ?, ?, ?, ?, ?)", _camera_row(known[id(camera)], camera)
            )
        database.execute("INSERT INTO images VALUES (?, ?, ?)", (i + 1, name, known[id(camera)]))
        table = np.column_stack([features.xy + HALF, features.scale / 2.0, features.angle]).astype("<f4")
        database.execute("INSERT INTO keypoints VALUES (?, ?, ?, ?)", (i + 1, *table.shape, table.tobytes()))
        if _is_sift(features):
            found = np.ascontiguousarray(features.descriptors)
            database.execute(
                "INSERT INTO descriptors VALUES (?, ?, ?, ?)", (i + 1, *found.shape, found.tobytes())
            )


def _is_sift(features: PhotoFeatures) -> bool:
    return (
        features.descriptors.dtype == np.uint8
        and features.descriptors.shape[1] == 128
        and features.metric == "l2"
    )


def _camera_row(number: int, camera: Camera) -> tuple[object, ...]:
    model, values, _ = colmap_camera(camera)
    blob = np.asarray(values, dtype="<f8").tobytes()
    return number, CAMERA_NUMBERS[model], camera.width, camera.height, blob, int(not camera.focal_estimated)


def _write_pairs(database: sqlite3.Connection, pairs: Iterable[PairMatches]) -> None:
    for pair in pairs:
        if pair.reason:
            continue
        number = (pair.a + 1) * PAIR_BASE + pair.b + 1
        data = np.ascontiguousarray(pair.matches, dtype="<u4").tobytes()
        database.execute("INSERT INTO matches VALUES (?, ?, ?, ?)", (number, len(pair.matches), 2, data))
        if pair.kind == "none":
            continue
        matrices = {"fundamental": b"", "essential": b"", "homography": b""}
        matrices[pair.kind] = _moved(pair.kind, np.asarray(pair.matrix)).astype("<f8").tobytes()
        database.execute(
            "INSERT INTO two_view_geometries VALUES (?, ?, ?, ?, ?, ?, ?, ?, NULL, NULL)",
            (number, len(pair.matches), 2, data, CONFIGURATIONS[pair.kind],
             *(matrices[kind] or None for kind in ("fundamental", "essential", "homography"))),
        )  # fmt: skip


def _moved(kind: str, matrix: Array, back: bool = False) -> Array:
    """Return a matrix for COLMAP's origin of pixels, or from it."""
    shift = np.linalg.inv(SHIFT) if back else SHIFT
    if kind == "fundamental":
        inverse = np.linalg.inv(shift)
        return np.asarray(inverse.T @ matrix @ inverse)
    return np.asarray(shift @ matrix @ np.linalg.inv(shift)) if kind == "homography" else matrix


def read_colmap_features(path: Path) -> FeatureFiles:
    """Read keypoints, descriptors and matches of a database, which is opened read-only.

    Verified matches are taken where there are any, else the candidate ones.

    Raises
    ------
    UserError
        When it is not such a database.
    """
    try:
        with sqlite3.connect(f"file:{path.resolve().as_posix()}?mode=ro", uri=True) as database:
            names = dict(database.execute("SELECT image_id, name FROM images ORDER BY name"))
            keypoints = _blobs(database, "keypoints", np.dtype("<f4"))
            descriptors = _blobs(database, "descriptors", np.dtype("u1"))
            verified = _pair_rows(database, "two_view_geometries")
            rows = verified or _pair_rows(database, "matches")
    except (sqlite3.Error, ValueError, TypeError) as problem:
        raise not_such(path, "a database of COLMAP", Text("It says: {why}.", why=problem)) from problem
    place = {number: i for i, number in enumerate(names)}
    features = tuple(
        _photo(keypoints.get(i, np.zeros((0, 4), np.float32)), descriptors.get(i)) for i in names
    )
    try:
        pairs = [plain_pair(place[i], place[j], matches) for (i, j), matches in rows.items()]
    except KeyError as problem:
        raise not_such(
            path, "a database of COLMAP", "Its matches are of photos it does not have."
        ) from problem
    _check(path, features, pairs)
    return FeatureFiles(tuple(names.values()), features, tuple(sorted(pairs, key=lambda p: (p.a, p.b))))


def _blobs(database: sqlite3.Connection, table: str, kind: np.dtype[np.generic]) -> dict[int, Array]:
    rows = database.execute(f"SELECT image_id, rows, cols, data FROM {table}")
    return {i: np.frombuffer(data, kind).reshape(n, c) for i, n, c, data in rows if data is not None}


def _pair_rows(database: sqlite3.Connection, table: str) -> dict[tuple[int, int], Array]:
    rows = database.execute(f"SELECT pair_id, rows, data FROM {table} WHERE rows > 0")
    return {
        (int(number) // PAIR_BASE, int(number) % PAIR_BASE): np.frombuffer(data, "<u4")
        .reshape(n, 2)
        .astype(np.int64)
        for number, n, data in rows
    }


def _photo(keypoints: Array, descriptors: Array | None) -> PhotoFeatures:
    """Return a photo's features from rows x, y; x, y, scale, orientation; or x, y and an affine shape."""
    values = keypoints.astype(np.float64)
    n, columns = values.shape
    scale, angle = np.full(n, 2.0), np.zeros(n)
    if columns == 4:
        scale, angle = 2.0 * values[:, 2], values[:, 3]
    elif columns == 6:
        a11, _, a21, _ = values[:, 2:6].T
        scale = 2.0 * np.sqrt(np.abs(values[:, 2] * values[:, 5] - values[:, 3] * values[:, 4]))
        angle = np.arctan2(a21, a11)
    found = np.zeros((n, 0), np.uint8) if descriptors is None or len(descriptors) != n else descriptors
    return PhotoFeatures(values[:, :2] - HALF, scale, _wrapped(angle), np.zeros(n), found)


def _wrapped(angle: Array) -> Array:
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def _check(path: Path, features: tuple[PhotoFeatures, ...], pairs: Iterable[PairMatches]) -> None:
    for pair in pairs:
        most = np.array([len(features[pair.a].xy), len(features[pair.b].xy)])
        if len(pair.matches) and not ((pair.matches >= 0).all() and (pair.matches.max(axis=0) < most).all()):
            raise not_such(
                path,
                "features and matches that belong together",
                "A match names a keypoint that is not there.",
            )


def write_colmap_text(files: FeatureFiles, folder: Path) -> tuple[Path, ...]:
    """Write ``PHOTO.txt`` for each photo and ``matches.txt``, as COLMAP's feature and match importers take them."""
    written = []
    for name, features in zip(files.photos, files.features, strict=True):
        own = features.descriptors if _is_sift(features) else np.zeros((len(features.xy), 128), np.uint8)
        rows = zip((features.xy + HALF).tolist(), (features.scale / 2.0).tolist(), features.angle.tolist(), own.tolist(), strict=True)  # fmt: skip
        lines = [f"{x:.4f} {y:.4f} {s:.4f} {o:.5f} {' '.join(map(str, d))}" for (x, y), s, o, d in rows]
        written.append(folder / f"{flat_name(name)}.txt")
        write_text(written[-1], "\n".join([f"{len(lines)} 128", *lines]) + "\n")
    out = []
    for pair in files.pairs:
        if not pair.reason:
            out += [
                f"{files.photos[pair.a]} {files.photos[pair.b]}",
                *(f"{i} {j}" for i, j in pair.matches.tolist()),
                "",
            ]
    written.append(folder / "matches.txt")
    write_text(written[-1], "\n".join(out) + "\n")
    return tuple(written)


def read_colmap_keypoints(path: Path) -> PhotoFeatures:
    """Read ``PHOTO.txt``: a line ``n d``, then ``x y scale orientation`` and d descriptor values per line."""
    lines = read_lines(path)
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if line.strip():
            try:
                rows.append(finite(line.split()))
                if len(rows[-1]) < 4 or len(rows[-1]) != len(rows[0]):
                    raise ValueError
            except ValueError:
                raise bad_line(path, number, line, "a feature: x y scale orientation …") from None
    table = np.array(rows, dtype=np.float64).reshape(len(rows), -1) if rows else np.zeros((0, 132))
    bytes_ = np.clip(np.rint(table[:, 4:]), 0, 255).astype(np.uint8)
    return PhotoFeatures(
        table[:, :2] - HALF, 2.0 * table[:, 2], _wrapped(table[:, 3]), np.zeros(len(table)), bytes_
    )


def read_colmap_matches(path: Path, photos: dict[str, int]) -> list[PairMatches]:
    """Read a match list: a line with two photo names, then two feature numbers per line, an empty line between pairs.

    `photos` gives the index of each flat photo name (`flat_name`).
    """
    found: list[PairMatches] = []
    pair: tuple[int, int] | None = None
    rows: list[tuple[int, int]] = []
    for number, line in enumerate([*read_lines(path), ""], 1):
        words = line.split()
        if not words:
            if pair is not None:
                found.append(plain_pair(*pair, np.array(rows, np.int64).reshape(-1, 2)))
            pair, rows = None, []
        elif pair is None:
            pair = _two_photos(line.strip(), photos)
            if pair is None:
                raise bad_line(path, number, line, "the names of two photos that have features")
        else:
            try:
                i, j = (int(word) for word in words)
            except ValueError:
                raise bad_line(path, number, line, "the numbers of two features") from None
            rows.append((i, j))
    return found


def _two_photos(line: str, photos: dict[str, int]) -> tuple[int, int] | None:
    """Return the two photos whose names, which may contain spaces, make up a line."""
    for place in (i for i, sign in enumerate(line) if sign == " "):
        first, second = flat_name(line[:place]), flat_name(line[place + 1 :].strip())
        if first in photos and second in photos:
            return photos[first], photos[second]
    return None
