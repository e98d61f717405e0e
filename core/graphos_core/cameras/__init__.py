"""Camera models, one per file: how a point in the camera frame becomes a pixel, and back.

The camera frame is x right, y down, z forward; pixels have the centre of the top-left pixel at (0, 0).
"""

from graphos_core.cameras.model import (
    CameraModel,
    Parameter,
    camera_model,
    camera_models,
    pixel_from_ray,
    ray_from_pixel,
)

__all__ = ["CameraModel", "Parameter", "camera_model", "camera_models", "pixel_from_ray", "ray_from_pixel"]
