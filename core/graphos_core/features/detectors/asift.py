r"""ASIFT: SIFT on simulated views, for photos taken from very different directions."""

from __future__ import annotations

from graphos_core.data import Array, Features
from graphos_core.features.detectors.affine_views import WORKING_PIXELS, AffineParams, points_of_views
from graphos_core.features.detectors.assembling import assemble, working_image
from graphos_core.features.detectors.sift import SiftParams, find_sift
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/asift"


class AsiftParams(AffineParams, SiftParams):
    """Parameters of ASIFT."""


@algorithm(
    stage="features",
    role="detector",
    name="asift",
    label="ASIFT",
    source="Morel and Yu 2009, ASIFT: a new framework for fully affine invariant image comparison; "
    "Yu and Morel 2011, IPOL",
    learn=LESSON,
)
def asift(
    grey: Array, colour: Array, params: AsiftParams, *, run: Run, mask: Array | None = None
) -> Features:
    """Find SIFT points in the photo and in views of it simulated from other directions.

    The publication compares every view of one photo with every view of the other; here the views of a photo are merged
    to points with several descriptors, which any matcher compares at once.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : AsiftParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Descriptors uint8 (n, 128), each of its simulated view; features of one point have exactly the same position.
    """
    working = working_image(grey, params.reduction, WORKING_PIXELS)
    found = points_of_views(working, lambda image: find_sift(image, params), params, run=run)
    return assemble(found, working.shape, colour, params, mask)
