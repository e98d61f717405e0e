"""No registration: the cloud stays where control points, a known distance or the cameras placed it."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Cloud, Mesh
from graphos_core.geometry.similarity import Similarity
from graphos_core.params import Params
from graphos_core.registry import algorithm
from graphos_core.run import Run


class PlacedParams(Params):
    """Nothing to choose."""


@algorithm(
    stage="quality",
    role="registration",
    name="placed",
    label="As placed by control or cameras",
    source="An independent comparison must not be fitted to its own reference: Luhmann et al. 2020, section 7.2",
    learn="quality/registration",
)
def placed(
    cloud: Cloud, reference: Cloud | Mesh, initial: Similarity | None, params: PlacedParams, *, run: Run
) -> Similarity:
    """Keep the placement, so that errors of the orientation stay in the distances.

    Parameters
    ----------
    cloud : Cloud
    reference : Cloud or Mesh
        Not looked at.
    initial : Similarity or None
        ``reference_from_cloud``, from control points or camera centres; None: the same frame.
    params : PlacedParams
    run : Run

    Returns
    -------
    Similarity
        `initial` or the identity.
    """
    return initial if initial is not None else Similarity(1.0, np.eye(3), np.zeros(3))
