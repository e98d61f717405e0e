"""Features as plain tables: ``PHOTO.npz`` or ``PHOTO.csv`` for each photo, ``matches.csv`` for the pairs.

``PHOTO.npz`` holds arrays ``xy`` (n, 2) and, where known, ``scale``, ``angle``, ``response``, ``descriptors`` (n, d) and
``metric``. ``PHOTO.csv`` has the columns ``x [px], y [px]``, then the same by name, descriptors as ``d0, d1, …``.
``matches.csv`` has ``photo a, photo b, feature a, feature b``, features counted from 0. Pixels count from the centre of
the top-left pixel.
"""

from __future__ import annotations

import csv
import io
import zipfile
from pathlib import Path

import numpy as np

from graphos_core.data import Array, PairMatches
from graphos_core.exchange.feature_records import FeatureFiles, PhotoFeatures, plain_pair
from graphos_core.exchange.text_files import bad_line, finite, not_such, read_lines
from graphos_core.exchange.tie_point_records import flat_name
from graphos_core.store import write_bytes, write_text

MATCHES = "matches.csv"
HEAD = ("photo a", "photo b", "feature a", "feature b")
DIAMETER = 8.0
"""px; of points whose size is not told."""


def write_feature_arrays(files: FeatureFiles, folder: Path) -> tuple[Path, ...]:
    """Write ``PHOTO.npz`` for each photo and ``matches.csv``."""
    written = []
    for name, features in zip(files.photos, files.features, strict=True):
        stream = io.BytesIO()
        np.savez_compressed(
            stream, xy=features.xy, scale=features.scale, angle=features.angle, response=features.response,
            descriptors=features.descriptors, metric=np.array(features.metric),
        )  # fmt: skip
        written.append(folder / f"{flat_name(name)}.npz")
        write_bytes(written[-1], stream.getvalue())
    return (*written, write_match_table(files, folder))


def write_feature_tables(files: FeatureFiles, folder: Path) -> tuple[Path, ...]:
    """Write ``PHOTO.csv`` for each photo and ``matches.csv``."""
    written = []
    for name, own in zip(files.photos, files.features, strict=True):
        width = own.descriptors.shape[1]
        stream = io.StringIO()
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["x [px]", "y [px]", "scale", "angle", "response", *(f"d{i}" for i in range(width))])
        for xy, s, a, r, d in zip(
            own.xy.tolist(), own.scale, own.angle, own.response, own.descriptors.tolist(), strict=True
        ):
            table.writerow(
                [f"{xy[0]:.4f}", f"{xy[1]:.4f}", f"{s:.4f}", f"{a:.6f}", f"{r:.6g}", *(f"{v:g}" for v in d)]
            )
        written.append(folder / f"{flat_name(name)}.csv")
        write_text(written[-1], stream.getvalue())
    return (*written, write_match_table(files, folder))


def write_match_table(files: FeatureFiles, folder: Path) -> Path:
    """Write ``matches.csv``."""
    stream = io.StringIO()
    table = csv.writer(stream, lineterminator="\n")
    table.writerow(HEAD)
    for pair in files.pairs:
        if not pair.reason:
            a, b = files.photos[pair.a], files.photos[pair.b]
            table.writerows((a, b, i, j) for i, j in pair.matches.tolist())
    write_text(folder / MATCHES, stream.getvalue())
    return folder / MATCHES


def read_feature_arrays(path: Path) -> PhotoFeatures:
    """Read ``PHOTO.npz``; errors as `graphos_core.exchange.features_formats`."""
    try:
        with np.load(path, allow_pickle=False) as file:
            columns = {name: np.asarray(file[name]) for name in file.files}
        xy = np.asarray(columns.pop("xy"), dtype=np.float64)
        if xy.ndim != 2 or xy.shape[1] != 2 or not np.isfinite(xy).all():
            raise ValueError("xy is not a table of finite positions")
        metric = str(columns.pop("metric", "l2"))
        return _features(xy, columns, metric)
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as problem:
        raise not_such(path, "a file of features (NPZ with the array xy)", f"{problem}.") from problem


def read_feature_table(path: Path) -> PhotoFeatures:
    """Read ``PHOTO.csv``; errors as `graphos_core.exchange.features_formats`."""
    lines = read_lines(path)
    head = [word.strip().lower().split(" [")[0] for word in next(csv.reader(lines[:1]), [])]
    if "x" not in head or "y" not in head:
        raise not_such(path, "a table of features", "Its first line has no columns x and y.")
    rows = []
    for number, words in enumerate(csv.reader(lines[1:]), 2):
        if words:
            try:
                rows.append(finite(words))
                if len(words) != len(head):
                    raise ValueError
            except ValueError:
                raise bad_line(
                    path, number, ",".join(words), "as many numbers as there are columns"
                ) from None
    table = np.array(rows, dtype=np.float64).reshape(len(rows), len(head))
    place = {name: i for i, name in enumerate(head)}
    columns: dict[str, Array] = {
        name: table[:, place[name]] for name in ("scale", "angle", "response") if name in place
    }
    described = [i for i, name in enumerate(head) if name[:1] == "d" and name[1:].isdigit()]
    if described:
        columns["descriptors"] = table[:, described]
    return _features(table[:, [place["x"], place["y"]]], columns, "l2")


def _features(xy: Array, columns: dict[str, Array], metric: str) -> PhotoFeatures:
    n = len(xy)
    plain = {"scale": np.full(n, DIAMETER), "angle": np.zeros(n), "response": np.zeros(n)}
    for name in plain:
        if name in columns:
            plain[name] = np.asarray(columns[name], dtype=np.float64).reshape(n)
    descriptors = columns.get("descriptors", np.zeros((n, 0), np.uint8)).reshape(n, -1)
    if metric not in ("l2", "hamming"):
        raise ValueError("metric is neither l2 nor hamming")
    return PhotoFeatures(xy, **plain, descriptors=_narrow(descriptors), metric=metric)


def _narrow(descriptors: Array) -> Array:
    """Return descriptors as bytes where nothing is lost, else as float32."""
    as_bytes = descriptors.astype(np.uint8)
    return as_bytes if np.array_equal(as_bytes, descriptors) else descriptors.astype(np.float32)


def read_match_table(path: Path, photos: dict[str, int]) -> list[PairMatches]:
    """Read ``matches.csv``; `photos` gives the index of each flat photo name."""
    rows: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for number, words in enumerate(csv.reader(read_lines(path)), 1):
        if not words or (number == 1 and words[0].strip().lower() == HEAD[0]):
            continue
        try:
            a, b, i, j = (word.strip() for word in words)
            rows.setdefault((photos[flat_name(a)], photos[flat_name(b)]), []).append((int(i), int(j)))
        except (ValueError, KeyError):
            raise bad_line(
                path, number, ",".join(words), "two photos with features and two feature numbers"
            ) from None
    return [plain_pair(a, b, np.array(found, np.int64)) for (a, b), found in rows.items()]
