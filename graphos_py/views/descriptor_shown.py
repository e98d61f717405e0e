"""What the descriptor view is given of a keypoint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data.record import Array
from graphos_core.features.descriptor import Described
from graphos_py.views import descriptor_panels as panels


@dataclass(frozen=True)
class Shown:
    """A keypoint as it is shown.

    Attributes
    ----------
    title : str
        Which photo and which keypoint; a second line says where it lies.
    descriptor : uint8 or float32 (d,)
        As it was stored and compared.
    described : Described or None
        Patch and gradients around it; None where they could not be cut.
    metric : {"l2", "hamming"}
    """

    title: str
    descriptor: Array
    described: Described | None
    metric: str = "l2"

    @property
    def binary(self) -> bool:
        """Whether the bytes hold bits."""
        return self.metric == "hamming"

    @property
    def grid(self) -> Array:
        """The numbers or bits in rows."""
        make = panels.bit_grid if self.binary else panels.number_grid
        return make(self.descriptor)

    @property
    def norms(self) -> Array:
        """Length of every row of numbers."""
        return np.asarray(np.linalg.norm(self.grid, axis=1))
