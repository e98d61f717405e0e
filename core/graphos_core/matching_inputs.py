"""What detectors and matchers may need beside photos and parameters: a given orientation, files of other programs."""

from __future__ import annotations

import hashlib
import inspect
from pathlib import Path
from typing import TYPE_CHECKING, Any

from graphos_core.data import Block
from graphos_core.errors import UserError
from graphos_core.registry import Algorithm
from graphos_core.seen_photos import cameras_key, given_as_seen, seen_masks_key
from graphos_core.text import Text

if TYPE_CHECKING:
    from graphos_core.pipeline import Pipeline


def takes(algorithm: Algorithm, keyword: str) -> bool:
    """Say whether an algorithm's function has a keyword."""
    return keyword in inspect.signature(algorithm.function).parameters


def given_for_matching(pipeline: Pipeline) -> Block | None:
    """Return the given orientation for a matcher that is guided by it, None for one that is not.

    Raises
    ------
    UserError
        When the matcher needs one and the project has none.
    """
    matcher, _ = pipeline.recipe.algorithm("features", "matcher")
    if not takes(matcher, "given"):
        return None
    given = given_as_seen(pipeline)
    if given is None:
        raise UserError(
            Text("The matcher “{name}” needs an orientation of an earlier result.", name=matcher.label),
            "It looks for the partner of a point along its epipolar line only.",
            "Run once with another matcher, then give its project as the orientation to start from.",
            matcher.learn,
        )
    return given


def keypoints_key(pipeline: Pipeline) -> Any:
    """Return what keypoints depend on beside photos and parameters: masks, and files that a detector reads."""
    files = _files(pipeline, "detector", "name")
    masks = seen_masks_key(pipeline)
    return masks if files is None else {"masks": masks, "files": files}


def matches_key(pipeline: Pipeline) -> Any:
    """Return what matches depend on beside keypoints and parameters: cameras, a given orientation, files."""
    matcher, _ = pipeline.recipe.algorithm("features", "matcher")
    parts = {"cameras": cameras_key(pipeline.photos)}
    if takes(matcher, "given"):
        parts["given"] = pipeline.project.settings.orientation
    files = _files(pipeline, "matcher", "names")
    return parts["cameras"] if len(parts) == 1 and files is None else {**parts, "files": files}


def _files(pipeline: Pipeline, role: str, keyword: str) -> str | None:
    """Return the digest of the files below the parameter ``source`` of an algorithm that reads files by photo name."""
    algorithm, params = pipeline.recipe.algorithm("features", role)
    if not takes(algorithm, keyword):
        return None
    return files_digest(Path(getattr(params, "source", "")))


def files_digest(path: Path) -> str:
    """Return a digest of names, sizes and contents of a file or of all files in a folder; empty where there is none."""
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    found = hashlib.sha256()
    for file in files:
        if file.is_file():
            found.update(file.name.encode())
            with file.open("rb") as stream:
                found.update(hashlib.file_digest(stream, "sha256").digest())
    return found.hexdigest()
