"""Keypoints and descriptors that another program found, read from its files."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Annotated

from graphos_core.data import Array, Features
from graphos_core.errors import UserError
from graphos_core.exchange.feature_records import FeatureFiles, PhotoFeatures
from graphos_core.exchange.features_formats import photo_file, read_features, read_photo_features
from graphos_core.exchange.tie_point_records import flat_name
from graphos_core.features.detectors.assembling import FoundPoints, assemble
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

LESSON = "features/imported"


class ImportedParams(PointParams):
    """Parameters of imported keypoints."""

    source: Annotated[
        str,
        About(
            label="Folder or database",
            help="Folder with a file for each photo (PHOTO.npz, PHOTO.csv or COLMAP's PHOTO.txt), or COLMAP's database.",
            effect="Another source: other keypoints.",
            learn=LESSON,
            level="novice",
        ),
    ] = ""


@algorithm(
    stage="features",
    role="detector",
    name="imported",
    label="Imported keypoints",
    source="Files of any detector; COLMAP documentation, database and feature importer (text form)",
    learn=LESSON,
)
def imported(
    grey: Array,
    colour: Array,
    params: ImportedParams,
    *,
    run: Run,
    mask: Array | None = None,
    name: str = "",
) -> Features:
    """Take the keypoints and descriptors of a photo from files.

    They count in pixels of the full photo; the reduction does not concern them. Mask and largest number hold as for
    every detector.

    Parameters
    ----------
    grey, colour : uint8 (h, w), (h, w, 3)
    params : ImportedParams
    run : Run
    mask : bool (h, w), optional
    name : str
        Of the photo.

    Raises
    ------
    UserError
        When no source is given, or it has nothing for this photo.
    """
    own = features_of(params.source, name)
    points = FoundPoints(own.xy, own.scale, own.angle, own.response, own.descriptors, own.metric)
    return assemble(points, colour.shape[:2], colour, params, mask)


def features_of(source: str, name: str) -> PhotoFeatures:
    """Return the features of one photo from a folder or database.

    Raises
    ------
    UserError
        When no source is given, or it has nothing for this photo.
    """
    if not source:
        raise UserError(
            "No source of imported keypoints is given.",
            todo="Name a folder or a database in the parameter “Folder or database”.",
            learn=LESSON,
        )
    path = Path(source).expanduser()
    file = photo_file(path, name) if path.is_dir() else None
    if file is not None:
        return read_photo_features(file)
    everything = whole_source(path)
    flat = [flat_name(photo) for photo in everything.photos]
    if flat_name(name) not in flat:
        raise UserError(
            Text("{source} has no features of {name}.", source=path.name, name=name),
            "Every photo of the project needs some.",
            "Export the features of all photos, with the names they have here.",
            LESSON,
        )
    return everything.features[flat.index(flat_name(name))]


def whole_source(path: Path) -> FeatureFiles:
    """Return everything a source holds; read again only when one of its files changed."""
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    state = tuple((f.name, f.stat().st_size, f.stat().st_mtime_ns) for f in files if f.is_file())
    return _read(path, state)


@lru_cache(maxsize=2)
def _read(path: Path, state: tuple[tuple[str, int, int], ...]) -> FeatureFiles:
    return read_features(path)
