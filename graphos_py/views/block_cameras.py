"""The photos of a block as pyramids in a 3D view."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from graphos_core.data import Block
from graphos_py.thumbnail_pixels import thumbnail_arrays

if TYPE_CHECKING:
    from graphos_py.views.cloud_view import CloudView


def show_cameras(view: CloudView, block: Block) -> list[int]:
    """Show the oriented photos of a block as pyramids; returns their indices in the order of the pyramids."""
    oriented = [int(i) for i in np.flatnonzero(np.asarray(block.oriented))]
    names = [block.names[i] for i in oriented]
    view.set_cameras(
        np.asarray(block.rotations)[oriented],
        np.asarray(block.centres)[oriented],
        [block.cameras[int(block.camera_of_photo[i])] for i in oriented],
        names,
        thumbnail_arrays(names),
    )
    return oriented
