r"""Verification of a pair by a random search whose parts can be chosen: method and model by name."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Array, Camera, Candidates, Features, PairMatches
from graphos_core.features.pair_verdict import (
    VerificationParams,
    epipolar_kind,
    matched_positions,
    pair_seed,
    rejected,
)
from graphos_core.features.robust.models import EssentialModel, FundamentalModel, HomographyModel, Model
from graphos_core.features.robust.scene import flat_scene, pair_scene
from graphos_core.features.robust.search import Method, search
from graphos_core.geometry.rays import rays_of
from graphos_core.geometry.relative_orientation import RayPairs
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run


class ConsensusParams(VerificationParams):
    """Parameters of the random search."""

    method: Annotated[
        Literal["ransac", "msac", "lmeds", "prosac", "magsac"],
        About(
            label="Method",
            help="What the best sample is, and in which order samples are drawn.",
            effect="RANSAC counts what agrees; MSAC also how well; least median needs no distance but at most half wrong "
            "matches; PROSAC tries distinctive matches first; MAGSAC++ is hardly sensitive to the distance.",
            choices={
                "ransac": "RANSAC",
                "msac": "MSAC",
                "lmeds": "least median of squares",
                "prosac": "PROSAC",
                "magsac": "MAGSAC++",
            },
            learn="features/consensus",
            level="student",
        ),
    ] = "msac"
    model: Annotated[
        Literal["auto", "essential", "fundamental", "homography"],
        About(
            label="Model",
            help="Essential: principal distances are trusted (5 unknowns). Fundamental: they are not needed (7). "
            "Homography: a flat object, or a camera that only turned (8).",
            effect="Automatic: essential unless a principal distance is only estimated, and a homography where the "
            "camera only turned.",
            choices={
                "auto": "automatic",
                "essential": "essential matrix",
                "fundamental": "fundamental matrix",
                "homography": "homography",
            },
            learn="features/scenes",
            level="student",
        ),
    ] = "auto"


@algorithm(
    stage="features",
    role="verification",
    name="consensus",
    label="Random sample consensus, by parts",
    source="Fischler and Bolles 1981 (RANSAC); Torr and Zisserman 2000 (MSAC); Rousseeuw 1984 (LMedS); Chum and Matas "
    "2005 (PROSAC); Barath et al. 2020 (MAGSAC++ score); Chum et al. 2003 (local optimisation); Torr 1998 (GRIC)",
    learn="features/consensus",
)
def consensus(
    index: tuple[int, int],
    a: Features,
    b: Features,
    candidates: Candidates,
    cameras: tuple[Camera, Camera],
    params: ConsensusParams,
    *,
    run: Run,
) -> PairMatches:
    """Search the matrix that most candidate matches agree with, by a method and for a model chosen by name.

    Written in this program throughout (`graphos_core.features.robust`); `usac` leaves the search to OpenCV. PROSAC
    takes the ratio of the two nearest distances as quality; where no ratio is known it is plain RANSAC. LMedS ignores
    the distance given and says the one it estimated. With the automatic model a pair of photos between which the camera
    only turned is verified by its homography, which unlike the epipolar geometry is determined by such a pair.

    Parameters
    ----------
    index : (int, int)
        Indices of the photos.
    a, b : Features
    candidates : Candidates
    cameras : (Camera, Camera)
    params : ConsensusParams
    run : Run

    Returns
    -------
    PairMatches
        With a reason and no matches where the pair cannot be used.
    """
    kind, wide = epipolar_kind(params.model, cameras)
    if params.model == "homography" and not wide:
        kind = "homography"
    found = _verified(kind, index, a, b, candidates, cameras, params, run.seed)
    if found.reason:
        return found
    xy_a, xy_b = a.xy[found.matches[:, 0]].astype(np.float64), b.xy[found.matches[:, 1]].astype(np.float64)
    if kind == "homography":
        return replace(found, scene=flat_scene(found.matrix, xy_a, xy_b, cameras))
    scene = pair_scene(kind, found.matrix, xy_a, xy_b, cameras, pair_seed(run.seed, index))
    found = replace(found, scene=scene)
    if scene == "rotation" and params.model == "auto" and not wide:
        turned = _verified("homography", index, a, b, candidates, cameras, params, run.seed)
        return found if turned.reason else replace(turned, scene=scene)
    return found


def _verified(
    kind: str,
    index: tuple[int, int],
    a: Features,
    b: Features,
    candidates: Candidates,
    cameras: tuple[Camera, Camera],
    params: ConsensusParams,
    seed: int,
) -> PairMatches:
    xy_a, xy_b = matched_positions(a, b, candidates)
    order = np.arange(len(candidates))
    method: Method = params.method
    if method == "prosac":
        known = len(candidates) > 0 and float(np.ptp(candidates.ratio)) > 0.0
        order = np.argsort(candidates.ratio, kind="stable") if known else order
        method = "prosac" if known else "ransac"
    model, usable = _model(kind, xy_a[order], xy_b[order], cameras, params.threshold)
    order = order[usable]
    if len(order) < max(params.minimum, model.sample + 1):
        return rejected(index, candidates, params, "candidate", len(order))
    found = search(
        model, method, params.threshold, confidence=params.confidence, most=params.iterations, seed=pair_seed(seed, index)
    )  # fmt: skip
    kept = np.sort(order[found.inliers])
    if not found or len(kept) < params.minimum:
        return rejected(index, candidates, params, "verified", len(kept))
    return PairMatches(
        a=index[0], b=index[1], matches=np.ascontiguousarray(candidates.matches[kept]), candidates=len(candidates),
        kind=kind, matrix=found.matrix / np.linalg.norm(found.matrix), threshold_px=found.threshold,
        ratio=candidates.ratio[kept],
    )  # fmt: skip


def _model(
    kind: str, xy_a: Array, xy_b: Array, cameras: tuple[Camera, Camera], threshold: float
) -> tuple[Model, Array]:
    """Return the model of all matches that have a ray in both photos, and their indices."""
    if kind == "essential":
        a, b = rays_of(cameras[0], xy_a), rays_of(cameras[1], xy_b)
        usable = np.flatnonzero(a.valid & b.valid)
        return EssentialModel(RayPairs(a[usable], b[usable]), threshold), usable
    everything = np.arange(len(xy_a))
    if kind == "homography":
        return HomographyModel(xy_a, xy_b), everything
    return FundamentalModel(xy_a, xy_b), everything
