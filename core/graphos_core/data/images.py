"""Photos as they came from the camera."""

from __future__ import annotations

from pathlib import Path

from graphos_core.data.cameras import Camera
from graphos_core.data.record import record
from graphos_core.errors import ItemFailure


@record
class Exif:
    """What the photo says about itself; None where it says nothing.

    Attributes
    ----------
    make, model : str
        Camera maker and model, empty where missing.
    focal_mm, focal_35mm : float or None
        Focal length, and its 35 mm equivalent, in mm.
    taken : str
        Date and time as written, empty where missing.
    latitude_deg, longitude_deg, altitude_m : float or None
        GNSS position of the camera.
    orientation : int
        EXIF orientation flag 1 to 8; 1 where missing. Pixels are always read upright.
    """

    make: str = ""
    model: str = ""
    focal_mm: float | None = None
    focal_35mm: float | None = None
    taken: str = ""
    latitude_deg: float | None = None
    longitude_deg: float | None = None
    altitude_m: float | None = None
    orientation: int = 1


@record
class Photo:
    """One photo.

    Attributes
    ----------
    name : str
        Path below the photo folder, with forward slashes; unique in the set.
    path : str
        Where it is on this machine; not stored in keys.
    width, height : int
        Upright size in pixels.
    bits : int
        8 or 16 bits per channel, as they are read.
    channels : int
        1 (grey), 3 (colour), or the number of bands.
    camera : int
        Index into `PhotoSet.cameras`.
    digest : str
        SHA-256 of the file.
    exif : Exif
    hidden : int
        Pixels without a value: fully transparent, NaN or no-data.
    remarks : tuple of str
        What was done so that the file can be used, and what is strange about it, one sentence each.
    """

    name: str
    path: str
    width: int
    height: int
    bits: int
    channels: int
    camera: int
    digest: str
    exif: Exif
    hidden: int = 0
    remarks: tuple[str, ...] = ()

    @property
    def file(self) -> Path:
        """Path of the file."""
        return Path(self.path)


@record
class PhotoSet:
    """The photos of a project, their cameras, and the files that could not be used.

    Attributes
    ----------
    photos : tuple of Photo
        Sorted by name.
    cameras : tuple of Camera
    failures : tuple of ItemFailure
        Unreadable files and duplicates, with reasons.
    """

    photos: tuple[Photo, ...]
    cameras: tuple[Camera, ...]
    failures: tuple[ItemFailure, ...] = ()
