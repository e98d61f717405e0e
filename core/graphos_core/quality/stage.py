"""The quality step: internal figures with advice and, where there is a reference, the comparison with it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from graphos_core.data import Cloud, Georeference, Mesh
from graphos_core.exchange.ply import read_ply
from graphos_core.geometry.similarity import Similarity
from graphos_core.quality.advice import advice
from graphos_core.quality.internal import internal_figures
from graphos_core.results import QualityResult
from graphos_core.roles import ComparisonResult
from graphos_core.run import Run
from graphos_core.text import Text


def assess(pipeline: Any, run: Run) -> QualityResult:
    """Assess the model of a pipeline's recipe.

    Parameters
    ----------
    pipeline : graphos_core.pipeline.Pipeline
        With the results of all earlier steps.
    run : Run

    Raises
    ------
    UserError
        When the reference cannot be read or registered.
    Stopped
    """
    oriented = pipeline.value("adjustment")
    cloud: Cloud = pipeline.value("cloud")
    run.progress(0, 3, "quality figures")
    figures = internal_figures(oriented.adjustment, cloud, pipeline.value("matches").pairs)
    sentences: tuple[str, ...] = advice(figures, oriented.adjustment, oriented.georeference.check_rms_m)
    run.progress(1, 3, "quality figures")
    comparison = None
    path = pipeline.project.reference_path()
    if path is not None and oriented.georeference.method == "none":
        sentences = (*sentences, Text(
            "The reference was not compared: the model has no scale and position yet. Georeference it by control "
            "points first."))  # fmt: skip
    elif path is not None and not is_placed(
        oriented.georeference, pipeline.recipe.algorithm("quality", "registration")[0].name
    ):
        sentences = (*sentences, Text(
            "The reference was not compared: a known distance gives the model its scale, not its position. "
            "Georeference it by control points, or choose the registration by closest points."))  # fmt: skip
    elif path is not None:
        run.check()
        comparison = compare_with(
            cloud, read_ply(path), oriented.georeference,
            pipeline.recipe.algorithm("quality", "registration"),
            pipeline.recipe.algorithm("quality", "comparison"), run,
        )  # fmt: skip
    run.progress(3, 3, "quality figures")
    return QualityResult(figures=figures, advice=sentences, comparison=comparison)


def is_placed(georeference: Georeference, registration: str) -> bool:
    """Say whether the model is where the reference is, or is moved there by the registration."""
    return georeference.method == "control points" or registration != "placed"


def compare_with(
    cloud: Cloud,
    reference: Cloud | Mesh,
    georeference: Georeference,
    registration: tuple[Any, Any],
    comparison: tuple[Any, Any],
    run: Run,
) -> ComparisonResult:
    """Register a georeferenced cloud to a reference in the control frame and measure the distances.

    `registration` and `comparison` are an algorithm with its parameters each. The local origin that was taken off
    the control coordinates is taken off the reference as well.
    """
    local = _less_origin(reference, georeference.origin)
    method, params = registration
    start = Similarity(1.0, np.eye(3), np.zeros(3))
    placed: Similarity = method.function(cloud, local, start, params, run=run)
    normals = cloud.normals @ placed.rotation.T if len(cloud.normals) else cloud.normals
    moved = replace(
        cloud, points=placed.apply(cloud.points), normals=normals.astype(np.float32), unit=local.unit
    )
    run.check()
    measure, params = comparison
    result: ComparisonResult = measure.function(moved, local, params, run=run)
    how = Text(
        "{definition}. Placement: {registration}.", definition=result.definition, registration=method.label
    )
    return replace(result, definition=how, unit=cloud.unit)


def _less_origin(reference: Cloud | Mesh, origin: Any) -> Cloud | Mesh:
    if not np.any(origin):
        return reference
    if isinstance(reference, Mesh):
        return replace(reference, vertices=reference.vertices - origin)
    return replace(reference, points=reference.points - origin)
