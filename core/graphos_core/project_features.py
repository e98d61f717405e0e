"""The features of a project as other programs take them."""

from __future__ import annotations

from pathlib import Path

from graphos_core.errors import UserError
from graphos_core.exchange.feature_records import FeatureFiles, PhotoFeatures
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.text import Text


def features_of_project(folder: Path) -> FeatureFiles:
    """Return keypoints, descriptors, verified matches and cameras of the last features of a project.

    Raises
    ------
    UserError
        When the project cannot be opened or has no features yet.
    """
    project = Project.open(folder)
    recipe = Recipe.load(folder / "recipe.toml") if (folder / "recipe.toml").is_file() else Recipe.default()
    pipeline = Pipeline(project, recipe)
    found = pipeline.latest("features")
    if found is None:
        raise UserError(
            Text("The project {name} has no features yet.", name=folder.name),
            todo="Run features first: graphos run PHOTOS --out FOLDER --until features.",
        )
    photos = pipeline.photos
    return FeatureFiles(
        photos=tuple(photo.name for photo in photos.photos),
        features=tuple(PhotoFeatures.of(own) for own in found.features),
        pairs=tuple(pair for pair in found.pairs if not pair.reason),
        cameras=tuple(photos.cameras[photo.camera] for photo in photos.photos),
    )
