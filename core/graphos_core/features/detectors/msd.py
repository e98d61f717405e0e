r"""MSD: patches that are unlike all others around them, with the SIFT descriptor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from graphos_core.data import Array, Features
from graphos_core.features.detectors.assembling import FoundPoints, assemble, working_image
from graphos_core.features.detectors.point_params import PointParams
from graphos_core.features.detectors.self_dissimilarity import (
    circle_directions,
    maxima,
    possible_levels,
    pyramid,
    refined,
    saliency,
)
from graphos_core.features.detectors.sift import hellinger
from graphos_core.features.detectors.sift_description import sift_descriptors, sift_directions
from graphos_core.params import About
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/msd"


class MsdParams(PointParams):
    """Parameters of maximal self-dissimilarity."""

    maximum: Annotated[int, PointParams.declarations()["maximum"].about] = 16_384
    patch_radius: Annotated[
        int,
        About(
            label="Patch radius",
            symbol="r_p",
            unit="px",
            low=1,
            high=7,
            step=1,
            help="A patch has 2 r_p + 1 pixels along each side, on every level of the pyramid.",
            effect="Higher: larger structures, fewer points, slower. Lower: finer ones, more noise.",
            learn=LESSON,
            level="student",
        ),
    ] = 3
    search_radius: Annotated[
        int,
        About(
            label="Search radius",
            symbol="r_s",
            unit="px",
            low=1,
            high=20,
            step=1,
            help="A patch is compared with all patches shifted by up to r_s px in x and y.",
            effect="Higher: a point must be unlike more of its surroundings; time grows with the square. "
            "Lower: repeated structure is taken for distinctive.",
            learn=LESSON,
            level="student",
        ),
    ] = 5
    nms_radius: Annotated[
        int,
        About(
            label="Non-maximum radius",
            unit="px",
            low=1,
            high=50,
            step=1,
            help="A point must be the most dissimilar one of so many pixels to each side.",
            effect="Higher: fewer points, farther apart. Lower: more, also side by side.",
            learn=LESSON,
            level="student",
        ),
    ] = 5
    nms_scale_radius: Annotated[
        int,
        About(
            label="Non-maximum levels",
            unit="levels",
            low=0,
            high=5,
            step=1,
            help="A point must also be the most dissimilar one of so many levels to either side.",
            effect="Higher: each structure gives one point. 0: it may give one on every level.",
            learn=LESSON,
            level="student",
        ),
    ] = 0
    threshold: Annotated[
        float,
        About(
            label="Saliency threshold",
            symbol=r"\lambda_0",
            unit="grey level²",
            low=0.0,
            high=20_000.0,
            step=25.0,
            help="Mean squared difference that a point's nearest patches must exceed.",
            effect="Higher: fewer points, of strong contrast only. Lower: more points, also in noise.",
            learn=LESSON,
            level="novice",
        ),
    ] = 20.0
    neighbours: Annotated[
        int,
        About(
            label="Nearest patches",
            symbol="k",
            unit="patches",
            low=1,
            high=32,
            step=1,
            help="So many of the most similar patches are averaged.",
            effect="Higher: less noise, edges pass more easily. 1: one similar patch is enough to reject a point.",
            learn=LESSON,
            level="student",
        ),
    ] = 4
    scale_factor: Annotated[
        float,
        About(
            label="Scale factor",
            symbol="f",
            low=1.05,
            high=3.0,
            step=0.05,
            help="Each level of the pyramid is smaller than the one before by this factor.",
            effect="Higher: scale is sampled coarsely, faster. Lower: finely, slower.",
            learn=LESSON,
            level="student",
        ),
    ] = 1.25
    scales: Annotated[
        int | None,
        About(
            label="Levels",
            symbol="n",
            unit="levels",
            low=1,
            high=40,
            step=1,
            help="Levels of the pyramid; automatic: as many as hold a patch with its search area.",
            effect="Higher: large structures too. 1: one size only.",
            learn=LESSON,
            level="student",
        ),
    ] = None
    orientation: Annotated[
        Literal["gradients", "dissimilarity", "upright"],
        About(
            label="Orientation",
            help="What turns the descriptor.",
            effect="Gradients: peaks of their histogram, as in SIFT. Dissimilarity: towards the most similar patches, "
            "as in the publication. Upright: photos that are not turned match better.",
            choices={
                "gradients": "gradients",
                "dissimilarity": "dissimilarity",
                "upright": "upright",
            },
            learn=LESSON,
            level="student",
        ),
    ] = "gradients"
    descriptor_size: Annotated[
        float,
        About(
            label="Descriptor size",
            symbol="c",
            low=0.2,
            high=3.0,
            step=0.1,
            help="Diameter 2σ of the described blob in units of the patch; a SIFT descriptor is 6 diameters wide.",
            effect="Higher: more surroundings, more distinctive, fails at edges of objects. Lower: fewer.",
            learn=LESSON,
            level="expert",
        ),
    ] = 0.7
    hellinger: Annotated[
        bool,
        About(
            label="RootSIFT",
            help="Compare square roots of the normalised descriptors (Hellinger distance).",
            effect="On: large bins weigh less, usually more correct matches. Off: descriptors as Lowe made them.",
            learn=LESSON,
            level="student",
        ),
    ] = True


@algorithm(
    stage="features",
    role="detector",
    name="msd",
    label="MSD",
    source="Tombari and Di Stefano 2014, Interest points via maximal self-dissimilarities; "
    "descriptor: Lowe 2004, section 6",
    learn=LESSON,
)
def msd(grey: Array, colour: Array, params: MsdParams, *, run: Run, mask: Array | None = None) -> Features:
    """Find patches that are unlike everything around them, at all scales, and describe them as SIFT does.

    The photo may be reduced first (`graphos_core.features.detectors.assembling`).

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : MsdParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        ``scale`` is the diameter of the described blob, ``descriptor_size`` times the side of the patch;
        ``response`` the saliency, squared grey values; descriptors uint8 (n, 128).
    """
    working = working_image(grey, params.reduction)
    return assemble(find_msd(working, params, run=run), working.shape, colour, params, mask)


def find_msd(image: Array, params: MsdParams, *, run: Run) -> FoundPoints:
    """Return the described points of one image, in its pixels, level by level.

    Parameters
    ----------
    image : uint8 (h, w)
    params : MsdParams
    run : Run
    """
    run.check()
    none = FoundPoints(np.zeros((0, 2)), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros((0, 128), np.uint8))
    return FoundPoints.joined(
        [none, *(_described(level, params) for level in detected_levels(image, params))]
    )


@dataclass(frozen=True)
class LevelPoints:
    """Points of one level of the pyramid.

    Attributes
    ----------
    image : uint8 (h, w)
        The level.
    pixels : int (n, 2)
        Column and row of the maxima.
    xy : float64 (n, 2)
        The same, refined, px of the level.
    response : float32 (n,)
        Saliency, squared grey values.
    factors : float64 (2,)
        Size of a pixel of the level in x and y, px of the photo: the exact ratio of the sizes, where the reference
        takes the power of the scale factor and places points of coarse levels up to some px aside.
    """

    image: Array
    pixels: Array
    xy: Array
    response: Array
    factors: Array


def detected_levels(image: Array, params: MsdParams) -> list[LevelPoints]:
    """Return the points of every level that has any.

    Parameters
    ----------
    image : uint8 (h, w)
    params : MsdParams
    """
    radii = (params.patch_radius, params.search_radius)
    possible = possible_levels(image.shape, *radii, params.scale_factor)
    count = possible if params.scales is None else params.scales
    images = pyramid(image, params.scale_factor, count) if count else []
    levels = [saliency(level, *radii, params.neighbours) for level in images]
    found = []
    for index, level in enumerate(images):
        pixels = maxima(
            levels, index, params.threshold, params.nms_radius, params.nms_scale_radius, params.scale_factor
        )
        xy, good = refined(levels[index], pixels)
        factors = np.array([image.shape[1] / level.shape[1], image.shape[0] / level.shape[0]])
        outer = (xy + 0.5) * factors
        good &= (outer >= 0).all(axis=1) & (outer < (image.shape[1], image.shape[0])).all(axis=1)
        pixels, xy = pixels[good], xy[good]
        found.append(LevelPoints(level, pixels, xy, levels[index][pixels[:, 1], pixels[:, 0]], factors))
    return [level for level in found if len(level.pixels)]


def _described(level: LevelPoints, params: MsdParams) -> FoundPoints:
    """Orient and describe the points of one level, all of one size in it."""
    xy = level.xy
    sigma = params.descriptor_size * (2 * params.patch_radius + 1) / 2
    if params.orientation == "gradients":
        index, angle = sift_directions(level.image, xy, sigma)
    else:
        index = np.arange(len(xy))
        angle = np.zeros(len(xy))
        if params.orientation == "dissimilarity":
            angle = circle_directions(level.image, level.pixels, params.patch_radius, params.search_radius)
    descriptors = sift_descriptors(level.image, xy[index], angle, sigma)
    return FoundPoints(
        xy=(xy[index] + 0.5) * level.factors - 0.5,
        scale=np.full(len(index), 2 * sigma * np.sqrt(level.factors.prod())),
        angle=angle,
        response=level.response[index].astype(np.float64),
        descriptors=hellinger(descriptors) if params.hellinger else descriptors,
    )
