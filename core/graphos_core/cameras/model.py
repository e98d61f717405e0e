"""What every camera model declares, and the list of models.

A model is one file that holds a numba kernel and a `CameraModel`. The kernel has the signature::

    kernel(values, x, y, z, pixel, d_point, d_values) -> bool

with ``values`` float64 (k,), the point (x, y, z) in the camera frame, and three outputs: ``pixel`` (2,),
``d_point`` (2, 3) = ∂pixel/∂(x, y, z), ``d_values`` (2, k) = ∂pixel/∂values. It returns False for a point that has
no image (behind the camera); the outputs are then undefined. `graphos_core.cameras.kernels.project` dispatches on
`CameraModel.code` inside compiled code.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.params import unknown_name


@dataclass(frozen=True)
class Parameter:
    """One parameter of a camera model.

    Attributes
    ----------
    name, symbol, label, unit : str
        ``"focal_px"``, ``"f"``, ``"Principal distance"``, ``"px"``.
    group : str
        ``"interior"``, ``"radial"``, ``"decentring"`` …
    """

    name: str
    symbol: str
    label: str
    unit: str
    group: str


@dataclass(frozen=True)
class CameraModel:
    """A camera model.

    Attributes
    ----------
    name, label : str
    code : int
        Number by which compiled code finds the kernel.
    parameters : tuple of Parameter
        In the order of `Camera.values`; the first is always the principal distance ``focal_px``.
    direction : str
        ``"ideal → measured"``: the formula gives the measured position from the ideal one.
    source : str
        Author, year, section.
    formula : str
        In mathtext.
    """

    name: str
    label: str
    code: int
    parameters: tuple[Parameter, ...]
    direction: str
    source: str
    formula: str

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in order."""
        return tuple(parameter.name for parameter in self.parameters)

    def index(self, name: str) -> int:
        """Position of a parameter in `Camera.values`."""
        return self.names.index(name)


@cache
def camera_models() -> dict[str, CameraModel]:
    """Return every camera model by name."""
    from graphos_core.cameras import basic, pinhole

    return {model.name: model for model in (pinhole.MODEL, basic.MODEL)}


def camera_model(name: str) -> CameraModel:
    """Return a camera model by name.

    Raises
    ------
    UserError
        When there is none of that name.
    """
    models = camera_models()
    if name not in models:
        raise UserError(unknown_name(name, list(models), "camera model"))
    return models[name]


def pixel_from_ray(camera: Camera, points: Array) -> Array:
    """Project points of the camera frame into the photo.

    Parameters
    ----------
    camera : Camera
    points : float64 (n, 3)
        Camera frame, any unit.

    Returns
    -------
    float64 (n, 2)
        Pixels; NaN for points that have no image.
    """
    from graphos_core.cameras.kernels import project_many

    points = np.ascontiguousarray(points, dtype=np.float64).reshape(-1, 3)
    return project_many(
        camera_model(camera.model).code, np.ascontiguousarray(camera.values, dtype=np.float64), points
    )


def ray_from_pixel(camera: Camera, pixels: Array) -> Array:
    """Return the ideal direction of every pixel: the inverse of `pixel_from_ray`, solved to 1e-10 px.

    Parameters
    ----------
    camera : Camera
    pixels : float64 (n, 2)

    Returns
    -------
    float64 (n, 3)
        Directions (x/z, y/z, 1) in the camera frame; NaN where the inversion does not converge, which happens
        outside the part of the format that the distortion maps one to one.
    """
    from graphos_core.cameras.kernels import unproject_many

    pixels = np.ascontiguousarray(pixels, dtype=np.float64).reshape(-1, 2)
    return unproject_many(
        camera_model(camera.model).code, np.ascontiguousarray(camera.values, dtype=np.float64), pixels
    )
