"""Camera models, one per file: how a point in the camera frame becomes a pixel, and back.

The camera frame is x right, y down, z forward; pixels have the centre of the top-left pixel at (0, 0).
"""

from graphos_core.cameras.chain import after_correction, as_measured, pre_corrected
from graphos_core.cameras.conversion import Conversion, as_model, convert
from graphos_core.cameras.model import (
    CameraModel,
    Parameter,
    camera_model,
    camera_models,
    derivatives,
    pixel_from_ray,
    ray_from_pixel,
    values_of,
)

__all__ = [
    "CameraModel", "Conversion", "Parameter", "after_correction", "as_measured", "as_model", "camera_model", "camera_models", "convert",
    "derivatives", "pixel_from_ray", "pre_corrected", "ray_from_pixel", "values_of",
]  # fmt: skip
