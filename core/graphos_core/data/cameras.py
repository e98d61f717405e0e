"""A camera with its calibration."""

from __future__ import annotations

from graphos_core.data.record import Array, record


@record
class Camera:
    """One camera (body, lens, zoom, format): its model and the values of its parameters.

    Attributes
    ----------
    model : str
        Name of the camera model, see `graphos_core.cameras.model`.
    width, height : int
        Format in pixels of the full photo.
    values : float64 (k,)
        Parameters in the order of the model; principal distance and principal point in px, distortion
        coefficients in normalised units.
    sigmas : float64 (k,) or None
        Their standard deviations; 0 where a parameter was held fixed; None before adjustment.
    label : str
        Name for people: ``"Nikon D60, 29 mm"``.
    pixel_pitch_mm : float or None
        Size of a pixel on the sensor, where known.
    focal_estimated : bool
        True while the principal distance is a guess and neither given, from EXIF, nor adjusted.
    focal_source : str
        Where the principal distance came from, in words.
    before : tuple of Camera
        Fixed pre-corrections, applied to measured pixels in this order: each takes away the distortion of its model
        and keeps its principal distance and principal point (`graphos_core.cameras.chain`). The camera's own model
        describes what is left.
    """

    model: str
    width: int
    height: int
    values: Array
    sigmas: Array | None = None
    label: str = ""
    pixel_pitch_mm: float | None = None
    focal_estimated: bool = False
    focal_source: str = ""
    before: tuple[Camera, ...] = ()

    @property
    def focal_px(self) -> float:
        """Principal distance in px: the first parameter of every model."""
        return float(self.values[0])
