r"""AMSD: maximal self-dissimilarity on simulated views, the detector of GRAPHOS for oblique photos."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.data import Array, Features
from graphos_core.features.detectors.affine_views import WORKING_PIXELS, AffineParams, points_of_views
from graphos_core.features.detectors.assembling import assemble, working_image
from graphos_core.features.detectors.msd import MsdParams, find_msd
from graphos_core.registry import algorithm
from graphos_core.run import Run

LESSON = "features/amsd"


class AmsdParams(AffineParams, MsdParams):
    """Parameters of affine maximal self-dissimilarity.

    Points are more, farther tilted and by strength: MSD has fewer points than SIFT in a view, and those of the coarse
    levels lie less exactly.
    """

    selection: Annotated[
        Literal["scale", "strength", "grid", "anms"], AffineParams.declarations()["selection"].about
    ] = "strength"
    tilts: Annotated[int, AffineParams.declarations()["tilts"].about] = 3
    threshold: Annotated[float, MsdParams.declarations()["threshold"].about] = 50.0
    nms_radius: Annotated[int, MsdParams.declarations()["nms_radius"].about] = 3


@algorithm(
    stage="features",
    role="detector",
    name="amsd",
    label="Affine MSD",
    source="González-Aguilera et al. 2018, GRAPHOS – open-source software for photogrammetric applications, equation 1",
    learn=LESSON,
)
def amsd(grey: Array, colour: Array, params: AmsdParams, *, run: Run, mask: Array | None = None) -> Features:
    """Find maximally self-dissimilar patches in the photo and in views of it simulated from other directions.

    Equation 1 of the source is the affine map ``A = λ R(ψ) T_t R(φ)``: tilt t and longitude φ are simulated, the
    pyramid and the orientation undo λ and ψ.

    Parameters
    ----------
    grey : uint8 (h, w)
    colour : uint8 (h, w, 3) or (h, w)
        For the colour of each point.
    params : AmsdParams
    run : Run
    mask : bool (h, w), optional
        True where points may be.

    Returns
    -------
    Features
        Descriptors uint8 (n, 128), each of its simulated view; features of one point have exactly the same position.
    """
    working = working_image(grey, params.reduction, WORKING_PIXELS)
    found = points_of_views(working, lambda image: find_msd(image, params, run=run), params, run=run)
    return assemble(found, working.shape, colour, params, mask)
