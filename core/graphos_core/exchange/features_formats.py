"""Keypoints, descriptors and matches of other programs, by name of the format.

- ``colmap``: COLMAP's ``database.db``.
- ``colmap-text``: ``PHOTO.txt`` for each photo and ``matches.txt``.
- ``npz``, ``csv``: plain tables, see `graphos_core.exchange.features_tables`.

``PHOTO`` is the whole name of the photo with its ending, folders joined by ``_``: ``DSC_0001.JPG.npz``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from graphos_core.data import PairMatches
from graphos_core.errors import UserError
from graphos_core.exchange.feature_records import FeatureFiles, PhotoFeatures
from graphos_core.exchange.features_colmap import (
    read_colmap_features,
    read_colmap_keypoints,
    read_colmap_matches,
    write_colmap_database,
    write_colmap_text,
)
from graphos_core.exchange.features_tables import (
    MATCHES,
    read_feature_arrays,
    read_feature_table,
    read_match_table,
    write_feature_arrays,
    write_feature_tables,
)
from graphos_core.exchange.tie_point_records import flat_name
from graphos_core.params import unknown_name
from graphos_core.text import Text

FEATURE_FORMATS = {
    "colmap": "COLMAP database.db",
    "colmap-text": "COLMAP feature files with matches.txt",
    "npz": "NPZ file for each photo with matches.csv",
    "csv": "CSV file for each photo with matches.csv",
}
"""Formats by name."""

WRITERS = {
    "colmap": write_colmap_database,
    "colmap-text": write_colmap_text,
    "npz": write_feature_arrays,
    "csv": write_feature_tables,
}

READERS = {".npz": read_feature_arrays, ".csv": read_feature_table, ".txt": read_colmap_keypoints}
"""How the features of one photo are read, by the ending of its file."""

SIDE_FILES = ("matches.txt", MATCHES)


def write_features(files: FeatureFiles, target: Path, name: str) -> tuple[Path, ...]:
    """Write features in a format; the files written.

    Raises
    ------
    UserError
        For an unknown format, or when a file cannot be written.
    """
    if name not in WRITERS:
        raise UserError(unknown_name(name, list(FEATURE_FORMATS), "feature format"))
    if name == "colmap" and not target.suffix:
        target = target / "database.db"
    return WRITERS[name](files, target)


def read_features(source: Path, photos: Sequence[str] = ()) -> FeatureFiles:
    """Read features from a database, or from a folder with a file for each photo.

    Parameters
    ----------
    source : Path
    photos : sequence of str, optional
        Names to look for in a folder; without them the files tell.

    Raises
    ------
    UserError
        When nothing is found, or a file cannot be read, with the line.
    """
    if source.is_file():
        return read_colmap_features(source)
    if (source / "database.db").is_file():
        return read_colmap_features(source / "database.db")
    if not source.is_dir():
        raise UserError(
            Text("{name} is neither a folder nor a database of features.", name=source.name),
            todo="Give a folder with a file for each photo, or a database of COLMAP.",
        )
    found = {name: file for name in photos if (file := photo_file(source, name)) is not None}
    if not photos:
        found = {
            f.stem: f for f in sorted(source.iterdir()) if f.suffix in READERS and f.name not in SIDE_FILES
        }
    if not found:
        raise UserError(
            Text("{name} has no features of these photos.", name=source.name),
            Text(
                "Expected files such as {example}.",
                example=f"{flat_name(photos[0]) if photos else 'PHOTO.JPG'}.npz",
            ),
            "Name the files after the photos.",
        )
    features = tuple(read_photo_features(file) for file in found.values())
    return FeatureFiles(tuple(found), features, tuple(_matches(source, list(found))))


def photo_file(folder: Path, name: str) -> Path | None:
    """Return the file of a photo's features in a folder: named after the photo, with or without its own ending."""
    flat = flat_name(name)
    for stem in (flat, Path(flat).stem):
        for ending in READERS:
            if (folder / f"{stem}{ending}").is_file():
                return folder / f"{stem}{ending}"
    return None


def read_photo_features(file: Path) -> PhotoFeatures:
    """Read the features of one photo."""
    return READERS[file.suffix.lower()](file)


def _matches(folder: Path, names: list[str]) -> list[PairMatches]:
    place = {flat_name(name): i for i, name in enumerate(names)}
    if (folder / "matches.txt").is_file():
        return read_colmap_matches(folder / "matches.txt", place)
    return read_match_table(folder / MATCHES, place) if (folder / MATCHES).is_file() else []
