"""What every camera model declares, and the list of models.

A model is one file with a `CameraModel`: a parameter sheet and its equations in plain Python. From the equations
`graphos_core.cameras.generator` writes the compiled kernel with analytic derivatives; the two simplest models have a
kernel written by hand, which is inlined into the loops of the adjustment. An inlined kernel has the signature::

    kernel(values, x, y, z, pixel, d_point, d_values) -> bool

with ``values`` float64 (k,), the point (x, y, z) in the camera frame, and three outputs: ``pixel`` (2,),
``d_point`` (2, 3) = ∂pixel/∂(x, y, z), ``d_values`` (2, ≥ k) = ∂pixel/∂values. It returns False for a point that has
no image (behind the camera); the outputs are then undefined. A generated entry does the same with bare pointers
(`graphos_core.cameras.entry`). `graphos_core.cameras.kernels.project` dispatches on `CameraModel.code` inside compiled
code.

An adjustment compares with a measured position, and two kinds of model have a kernel of its own for that, found by
`CameraModel.residual_code`; on entry ``pixel`` holds the measured position, and what it holds on return minus the
measured position is the residual in px, whose derivatives are given:

- backward models: the residual in the corrected picture, f·(ideal − corrected measured position), as programs with such
  models take it (DBAT, PhotoModeler);
- the panorama: the position one turn more or less when the measured one lies beyond the seam.

For all others `residual_code` is `code`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.params import unknown_name
from graphos_core.text import Text

MODULES = (
    "pinhole", "basic", "radial", "brown", "complete", "brown_backward", "ebner", "polynomial",
    "fisheye_equidistant", "fisheye_equisolid", "opencv", "spherical",
)  # fmt: skip
"""Files of the models, in the order in which people are shown them."""

Equations = Callable[[Any, Any, Any], tuple[Any, Any]]
"""``(values by name, a, b) -> (c, d)`` in +, −, ·, / and powers, so that it takes numbers, arrays and symbols."""


@dataclass(frozen=True)
class Parameter:
    """One parameter of a camera model.

    Attributes
    ----------
    name, symbol, label, unit : str
        ``"focal_px"``, ``"f"``, ``"Principal distance"``, ``"px"``.
    group : str
        ``"interior"``, ``"radial"``, ``"decentring"``, ``"affinity"`` …
    usual : float
        Size that is common in practice: range of a slider, step of a test.
    default : {"free", "fixed", "prior", "constant"}
        What a self-calibration does with it unless the person says otherwise. A constant is part of the formula (a
        length by which coordinates are divided) and is never estimated.
    prior_sigma : float or None
        Standard deviation, in `unit`, of the prior that holds it when it is free with a prior.
    reason : str
        Why it is not simply free.
    same_as : str or None
        Name by which other models call the same quantity; None for the same name, empty when no other model has it.
    """

    name: str
    symbol: str
    label: str
    unit: str
    group: str
    usual: float = 0.0
    default: str = "free"
    prior_sigma: float | None = None
    reason: str = ""
    same_as: str | None = None

    @property
    def meaning(self) -> str:
        """Name of the quantity, the same in every model that has it; empty when this model alone has it."""
        return self.name if self.same_as is None else self.same_as


@dataclass(frozen=True)
class CameraModel:
    """A camera model.

    Attributes
    ----------
    name, label : str
    parameters : tuple of Parameter
        In the order of `Camera.values`; the first three are always ``focal_px``, ``x0``, ``y0``.
    direction : str
        ``"ideal → measured"``: the formula gives the measured position from the ideal one.
    source : str
        Author, year, section.
    formula : str
        In mathtext.
    projection : {"central", "equidistant", "equisolid", "spherical"}
        How an undistorted ray becomes a position (u, v), see `graphos_core.cameras.projections`.
    equations : callable or None
        Forward models: ``(p, u, v)`` → pixel (x, y), from the ideal position. Backward models: ``(p, x, y)`` → ideal
        position (u, v), from the pixel. None where the kernel is written by hand.
    backward : bool
        Whether the equations go from the measured to the ideal position.
    dependences : tuple of str
        Sentences: which terms are left out or held against f, x0, y0 and the rotation, and why.
    inlined : int or None
        Number of the kernel that is inlined into its callers; None for a generated kernel.
    """

    name: str
    label: str
    parameters: tuple[Parameter, ...]
    direction: str
    source: str
    formula: str
    projection: str = "central"
    equations: Equations | None = None
    backward: bool = False
    dependences: tuple[str, ...] = ()
    inlined: int | None = None

    @property
    def code(self) -> int:
        """Number by which compiled code finds the kernel, for int64 only.

        A small number for an inlined kernel, else the address of the compiled entry in this process: never store it.
        The kernel is compiled when its code is first asked for.
        """
        return _entry_address(self.name, "entry") if self.inlined is None else self.inlined

    @property
    def residual_code(self) -> int:
        """As `code`, for a comparison with a measured position: see the head of this module."""
        special = self.backward or self.projection == "spherical"
        return _entry_address(self.name, "residual_entry") if special else self.code

    @property
    def wide(self) -> bool:
        """Whether rays are unit directions whose z may be 0 or negative, because the field exceeds 180°."""
        return self.projection != "central"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in order."""
        return tuple(parameter.name for parameter in self.parameters)

    def index(self, name: str) -> int:
        """Position of a parameter in `Camera.values`."""
        return self.names.index(name)


@cache
def _entry_address(name: str, entry: str) -> int:
    module = import_module(f"graphos_core.cameras.generated.{name}_kernels")
    return int(getattr(module, entry).address)


@cache
def camera_models() -> dict[str, CameraModel]:
    """Return every camera model by name."""
    models: dict[str, CameraModel] = {}
    for name in MODULES:
        for model in import_module(f"graphos_core.cameras.{name}").MODELS:
            models[model.name] = model
    return models


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
    """Project points of the camera frame into the photo, through the whole chain of the camera.

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
    pixels = last_pixel_from_ray(camera, points)
    if camera.before:
        from graphos_core.cameras.chain import as_measured

        return as_measured(camera, pixels)
    return pixels


def ray_from_pixel(camera: Camera, pixels: Array) -> Array:
    """Return the ideal direction of every pixel: the inverse of `pixel_from_ray`, solved to 1e-10 px.

    Parameters
    ----------
    camera : Camera
    pixels : float64 (n, 2)

    Returns
    -------
    float64 (n, 3)
        Directions in the camera frame: (x/z, y/z, 1) for central perspective, unit vectors for `CameraModel.wide`
        models. NaN where the inversion does not converge, which happens outside the part of the format that the
        distortion maps one to one.
    """
    if camera.before:
        from graphos_core.cameras.chain import pre_corrected

        pixels = pre_corrected(camera, pixels)
    return last_ray_from_pixel(camera, pixels)


def last_pixel_from_ray(camera: Camera, points: Array) -> Array:
    """Project by the camera's own model alone, without `Camera.before`; else as `pixel_from_ray`."""
    from graphos_core.cameras.kernels import project_many

    points = np.ascontiguousarray(points, dtype=np.float64).reshape(-1, 3)
    return project_many(camera_model(camera.model).code, values_of(camera), points)


def last_ray_from_pixel(camera: Camera, pixels: Array) -> Array:
    """Invert the camera's own model alone, without `Camera.before`; else as `ray_from_pixel`."""
    from graphos_core.cameras.kernels import unproject_many, unproject_wide
    from graphos_core.cameras.projections import ideal_direction

    pixels = np.ascontiguousarray(pixels, dtype=np.float64).reshape(-1, 2)
    model, values = camera_model(camera.model), values_of(camera)
    if not model.wide:
        return unproject_many(model.code, values, pixels)
    start = ideal_direction(model.projection, (pixels - values[1:3]) / values[0])
    return unproject_wide(model.code, values, pixels, start)


def derivatives(camera: Camera, points: Array) -> tuple[Array, Array, Array]:
    """Project by the camera's own model, without `Camera.before`, and return the derivatives of the pixels.

    Parameters
    ----------
    camera : Camera
    points : float64 (n, 3)

    Returns
    -------
    pixels : float64 (n, 2)
    by_point : float64 (n, 2, 3)
        ∂pixel/∂point, px per unit of the points.
    by_values : float64 (n, 2, k)
        ∂pixel/∂values in the order of the model.
    """
    from graphos_core.cameras.kernels import differentiate_many

    points = np.ascontiguousarray(points, dtype=np.float64).reshape(-1, 3)
    return differentiate_many(camera_model(camera.model).code, values_of(camera), points)


def values_of(camera: Camera) -> Array:
    """Return the values of a camera as compiled code needs them: contiguous, as many as its model has.

    Compiled code reads and writes by position without looking, and a stored camera may come from a stranger.

    Raises
    ------
    UserError
        When the camera has more or fewer values than its model has parameters, or the model is not known.
    """
    model = camera_model(camera.model)
    values = np.ascontiguousarray(camera.values, dtype=np.float64)
    if values.shape != (len(model.parameters),):
        raise UserError(
            Text("The camera {camera} is damaged.", camera=camera.label or model.label),
            Text("The model {model} has {count} parameters, the camera {found} values.",
                 model=model.label, count=len(model.parameters), found=values.size),
            "Calibrate the camera again, or give its parameters again.",
        )  # fmt: skip
    return values
