"""Coordinate systems: geographic, projected (EPSG) and local tangent frames, by PROJ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.text import Text


@dataclass(frozen=True)
class TangentFrame:
    """A frame east, north, up (m) that touches the ellipsoid WGS 84 in a point.

    Attributes
    ----------
    origin : float64 (3,)
        Latitude and longitude in degrees, ellipsoidal height in m.
    """

    origin: Array

    def from_geographic(self, degrees: Array) -> Array:
        """Return (n, 3) m of latitude, longitude (degrees) and ellipsoidal height (m) (n, 3)."""
        return np.asarray((_geocentric(degrees) - _geocentric(self.origin[None])) @ self._axes().T)

    def to_geographic(self, xyz: Array) -> Array:
        """Return latitude, longitude (degrees) and height (m) of positions (n, 3) in the frame."""
        from pyproj import Transformer

        ecef = np.asarray(xyz) @ self._axes() + _geocentric(self.origin[None])
        back = Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=False)
        return np.column_stack(back.transform(*ecef.T))

    def _axes(self) -> Array:
        """Return the unit vectors east, north, up (3, 3) in geocentric coordinates."""
        latitude, longitude = np.radians(self.origin[:2])
        sp, cp, sl, cl = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
        return np.array([[-sl, cl, 0.0], [-sp * cl, -sp * sl, cp], [cp * cl, cp * sl, sp]])


def local_tangent_frame(origin: Array) -> TangentFrame:
    """Return the tangent frame at latitude, longitude (degrees) and height (m)."""
    return TangentFrame(np.asarray(origin, dtype=np.float64))


def _geocentric(degrees: Array) -> Array:
    """Return geocentric X, Y, Z (n, 3) on WGS 84 of latitude, longitude (degrees) and height (m)."""
    from pyproj import Transformer

    forward = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=False)
    return np.column_stack(forward.transform(*np.asarray(degrees, dtype=np.float64).T))


def metric_coordinates(xyz: Array, crs: str) -> tuple[Array, TangentFrame | None]:
    """Return coordinates (n, 3) in metres: projected ones as they are, geographic ones in a tangent frame at their mean.

    Parameters
    ----------
    xyz : float64 (n, 3)
        As the system orders its axes for x and y: east, north (longitude, latitude in degrees), height in m.
    crs : str
        ``"EPSG:25832"`` and the like; empty for a local metric system.

    Raises
    ------
    UserError
        When PROJ does not know the system, or its unit is not the metre.
    """
    if not crs:
        return xyz, None
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    try:
        system = CRS.from_user_input(crs)
    except CRSError as problem:
        raise UserError(Text("The coordinate system “{crs}” is not known.", crs=crs[:40]),
                        todo="Give an EPSG code such as EPSG:25832.", learn="adjustment/georeferencing") from problem  # fmt: skip
    if system.is_geographic:
        degrees = np.asarray(xyz)[:, [1, 0, 2]]
        known = degrees[np.isfinite(degrees).all(axis=1)]
        if not len(known):
            return xyz, None
        if (np.abs(known[:, :2]) > [90.0, 360.0]).any():
            raise UserError(Text("The coordinates are no degrees, as {crs} needs.", crs=crs[:40]),
                            "A latitude is beyond 90° or a longitude beyond 360°.",
                            "Give x as longitude and y as latitude, or the system the coordinates are in.",
                            learn="adjustment/georeferencing")  # fmt: skip
        frame = local_tangent_frame(known.mean(axis=0))
        return frame.from_geographic(degrees), frame
    unit = system.axis_info[0].unit_name if system.axis_info else "metre"
    factor = system.axis_info[0].unit_conversion_factor if system.axis_info else 1.0
    if not np.isclose(factor, 1.0, atol=1e-12):
        raise UserError(Text("The coordinate system {crs} counts in {unit}.", crs=crs, unit=unit),
                        todo="Convert the coordinates to a system in metres.", learn="adjustment/georeferencing")  # fmt: skip
    return xyz, None
