"""What the pipeline computes, step by step: each step has a key made of its inputs and a function that computes it.

A stage (a room) has one to three steps, so changing a parameter repeats only what depends on it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from graphos_core.data import Block, Cloud, Features, Finding
from graphos_core.errors import UserError
from graphos_core.matching_inputs import given_for_matching, keypoints_key, matches_key, takes
from graphos_core.number_format import format_value
from graphos_core.project_file import KNOWN
from graphos_core.registry import Stage
from graphos_core.run import Run
from graphos_core.seen_photos import (
    SeenMasks,
    block_reader,
    given_as_seen,
    photo_grey_and_colour,
    pointless_warnings,
    seen_known,
    seen_masks_key,
    undistortion_key,
)
from graphos_core.text import Text

if TYPE_CHECKING:
    from graphos_core.pipeline import Pipeline


@dataclass(frozen=True)
class Step:
    """One step.

    Attributes
    ----------
    name : str
        Folder in the store.
    stage : Stage
    after : str
        Step whose result it takes; empty for the photos themselves.
    roles : tuple of str
        Roles whose algorithms and parameters are part of its key.
    compute : callable
        ``compute(pipeline, folder, run) -> value``; files that belong to the result go into `folder`.
    inputs : callable
        Further parts of the key beside algorithms, parameters, seed and the step before.
    line : callable
        One line about the value for the ribbon.
    """

    name: str
    stage: Stage
    after: str
    roles: tuple[str, ...]
    compute: Callable[[Pipeline, Path, Run], Any]
    line: Callable[[Any], str]
    inputs: Callable[[Pipeline], Any] = lambda pipeline: None


def _images(pipeline: Pipeline, folder: Path, run: Run) -> Any:
    from graphos_core.images_step import compute_images

    return compute_images(pipeline, folder, run)


def _keypoints(pipeline: Pipeline, folder: Path, run: Run) -> tuple[Features, ...]:
    from graphos_core.features.stage import detect_all

    algorithm, params = pipeline.recipe.algorithm("features", "detector")
    names, masks = [photo.name for photo in pipeline.photos.photos], SeenMasks(pipeline)
    read = partial(photo_grey_and_colour, pipeline)
    found = tuple(detect_all(len(names), read, algorithm, params, run, masks, names))
    empty = [name for name, features in zip(names, found, strict=True) if len(features.xy) == 0]
    for warning in pointless_warnings(empty, masks.covered):
        run.warn(warning)
    return found


def _pairs(pipeline: Pipeline, folder: Path, run: Run) -> Any:
    algorithm, params = pipeline.recipe.algorithm("features", "pairs")
    return algorithm.function(pipeline.photos, pipeline.value("keypoints"), params, run=run)


def _positions(pipeline: Pipeline) -> Any:
    """Where the photos say they were taken, which the choice of pairs may depend on."""
    return [
        [photo.exif.latitude_deg, photo.exif.longitude_deg, photo.exif.altitude_m]
        for photo in pipeline.photos.photos
    ]


def _matches(pipeline: Pipeline, folder: Path, run: Run) -> Any:
    from graphos_core.features.stage import match_all
    from graphos_core.results import FeaturesResult

    photos, given = pipeline.photos, given_for_matching(pipeline)
    features: tuple[Features, ...] = pipeline.value("keypoints")
    cameras = [photos.cameras[p.camera] for p in photos.photos]
    pairs = match_all(
        features, cameras, pipeline.recipe.algorithm("features", "matcher"),
        pipeline.recipe.algorithm("features", "verification"), run, pipeline.value("pairs").pairs.tolist(),
        pipeline.recipe.algorithm("features", "thinning"), given, [photo.name for photo in photos.photos],
    )  # fmt: skip
    builder, params = pipeline.recipe.algorithm("features", "tracks")
    tracks = builder.function(features, pairs, params, run=run)
    return FeaturesResult(features=(), pairs=tuple(pairs), tracks=tracks)


def _orientation(pipeline: Pipeline, folder: Path, run: Run) -> Block:
    algorithm, params = pipeline.recipe.algorithm("adjustment", "orientation")
    matched = pipeline.value("matches")
    more = {"given": given_as_seen(pipeline)} if takes(algorithm, "given") else {}
    block: Block = algorithm.function(pipeline.photos, matched.tracks, matched.pairs, params, run=run, **more)
    return block


def _given(pipeline: Pipeline) -> Any:
    algorithm, _ = pipeline.recipe.algorithm("adjustment", "orientation")
    return pipeline.project.settings.orientation if takes(algorithm, "given") else None


def _georeference(pipeline: Pipeline, folder: Path, run: Run) -> Any:
    from graphos_core.results import PlacedBlock

    algorithm, params = pipeline.recipe.algorithm("adjustment", "georeferencing")
    block, georeference = algorithm.function(
        pipeline.value("orientation"), seen_known(pipeline), params, run=run
    )
    return PlacedBlock(block=block, georeference=georeference)


def _adjustment(pipeline: Pipeline, folder: Path, run: Run) -> Any:
    from graphos_core.adjustment.bundle.tie_weights import with_scale_sigma
    from graphos_core.adjustment.georeferencing.similarity import in_its_frame, placed_again
    from graphos_core.results import AdjustmentResult

    algorithm, params = pipeline.recipe.algorithm("adjustment", "bundle")
    placed = pipeline.value("georeference")
    block = with_scale_sigma(placed.block, pipeline.value("matches").tracks, pipeline.value("keypoints"))
    known = in_its_frame(seen_known(pipeline), placed.georeference)
    adjusted = algorithm.function(block, known, params, run=run)
    placing = tuple(
        Finding(
            severity="warning", what=line, learn="adjustment/georeferencing",
            why="Found while the block was placed, before it was adjusted; what else is wrong may follow from it.",
        )
        for line in pipeline.about("georeference").get("warnings", [])
    )  # fmt: skip
    adjusted = replace(adjusted, findings=(*placing, *adjusted.findings))
    return AdjustmentResult(
        adjustment=adjusted, georeference=placed_again(adjusted, placed.georeference, known)
    )


def _known(pipeline: Pipeline) -> Any:
    from graphos_core.exchange.known import known_tables

    settings = pipeline.project.settings
    digests = []
    pattern = "control*" if settings.control else "control_distances*"
    for path in sorted(pipeline.project.folder.glob(pattern)):
        digests.append([path.name, file_digest(path)])
    for path in (pipeline.project.folder / KNOWN, *known_tables(pipeline.project.folder / KNOWN)):
        if path.is_file():
            digests.append([path.name, file_digest(path)])
    return {"control": digests, "distance": settings.distance}


def _depth(pipeline: Pipeline, folder: Path, run: Run) -> Any:
    algorithm, params = pipeline.recipe.algorithm("dense", "depth")
    block = pipeline.value("adjustment").adjustment.block
    more = {"mask": SeenMasks(pipeline)} if takes(algorithm, "mask") else {}
    return tuple(algorithm.function(block, block_reader(pipeline.photos), params, run=run, **more))


def _cloud(pipeline: Pipeline, folder: Path, run: Run) -> Cloud:
    algorithm, params = pipeline.recipe.algorithm("dense", "fusion")
    block = pipeline.value("adjustment").adjustment.block
    cloud: Cloud = algorithm.function(
        block, pipeline.value("depth"), block_reader(pipeline.photos), params, run=run
    )
    return cloud


def _quality(pipeline: Pipeline, folder: Path, run: Run) -> Any:
    from graphos_core.quality.stage import assess

    return assess(pipeline, run)


def _reference(pipeline: Pipeline) -> Any:
    path = pipeline.project.reference_path()
    if path is None:
        return None
    if not path.is_file():
        raise UserError(Text("The reference {name} does not exist.", name=path.name),
                        todo="Choose the reference file again.")  # fmt: skip
    return file_digest(path)


def file_digest(path: Path) -> str:
    """Return the SHA-256 of a file; it is read again only when its size or time of change differ."""
    found = path.stat()
    return _digest(str(path), found.st_size, found.st_mtime_ns)


@lru_cache(maxsize=64)
def _digest(path: str, size: int, changed: int) -> str:
    with Path(path).open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _count(number: int) -> str:
    return format_value(int(number))


def _images_line(found: Any) -> str:
    if found.undistorted:
        n = _count(len(found.undistorted))
        return (Text("{n} photos undistorted and filtered", n=n) if found.files
                else Text("{n} photos undistorted", n=n))  # fmt: skip
    return (
        Text("{n} photos filtered", n=_count(len(found.files))) if found.files else Text("photos as they are")
    )


def _features_line(found: Any) -> str:
    good = sum(1 for pair in found.pairs if not pair.reason)
    return Text("{pairs} pairs · {tracks} tracks", pairs=_count(good), tracks=_count(found.tracks.count))


def _adjustment_line(found: Any) -> str:
    a = found.adjustment
    return Text(
        "{oriented} of {total} photos · σ0 {sigma0:.2f} px",
        oriented=int(a.block.oriented.sum()), total=len(a.block.names), sigma0=a.sigma0_px,
    )  # fmt: skip


STEPS: dict[str, Step] = {
    step.name: step
    for step in (
        Step("images", "preprocessing", "", ("undistortion", "filter"), _images, _images_line, undistortion_key),
        Step("keypoints", "features", "images", ("detector",), _keypoints,
             lambda v: Text("{n} keypoints", n=_count(sum(len(f.xy) for f in v))), keypoints_key),
        Step("pairs", "features", "keypoints", ("pairs",), _pairs,
             lambda v: Text("{n} of {total} pairs", n=_count(len(v.pairs)), total=_count(v.possible)), _positions),
        Step("matches", "features", "pairs", ("matcher", "verification", "thinning", "tracks"), _matches,
             _features_line, matches_key),
        Step("orientation", "adjustment", "matches", ("orientation",), _orientation,
             lambda v: Text("{n} of {total} photos oriented", n=int(v.oriented.sum()), total=len(v.names)), _given),
        Step("georeference", "adjustment", "orientation", ("georeferencing",), _georeference,
             lambda v: Text("placed by {method}", method=v.georeference.method), _known),
        Step("adjustment", "adjustment", "georeference", ("bundle",), _adjustment, _adjustment_line),
        Step("depth", "dense", "adjustment", ("depth",), _depth,
             lambda v: Text("{n} depth maps", n=_count(len(v))), seen_masks_key),
        Step("cloud", "dense", "depth", ("fusion",), _cloud, lambda v: Text("{n} points", n=_count(len(v.points)))),
        Step("quality", "quality", "cloud", ("registration", "comparison"), _quality,
             lambda v: Text("{n} points compared", n=_count(len(v.comparison.distances))) if v.comparison
             else Text("internal figures"), _reference),
    )
}  # fmt: skip
"""Every step by name, in order."""


def steps_of(stage: Stage) -> list[Step]:
    """Return the steps of a stage in order."""
    return [step for step in STEPS.values() if step.stage == stage]
