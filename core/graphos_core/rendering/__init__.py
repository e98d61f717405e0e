"""Pictures of clouds and values without a screen: point splatter, lines, photo quads, colour maps.

Used by the 3D view, by tests and by the report. Importing this package does not import numba; the first
`render_cloud` does.
"""

from graphos_core.rendering.camera import ViewCamera
from graphos_core.rendering.colour_maps import colour_table, colours_of_values
from graphos_core.rendering.pyramids import Quads, camera_pyramids
from graphos_core.rendering.render import (
    Frame,
    Lines,
    PreparedCloud,
    prepare_cloud,
    render_cloud,
    render_frame,
)

__all__ = [
    "Frame",
    "Lines",
    "PreparedCloud",
    "Quads",
    "ViewCamera",
    "camera_pyramids",
    "colour_table",
    "colours_of_values",
    "prepare_cloud",
    "render_cloud",
    "render_frame",
]
