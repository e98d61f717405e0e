"""A complete adjustment case of the Damped Bundle Adjustment Toolbox (DBAT): what went in, with every σ."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np

from graphos_core.data import Array, Block, Camera, Control
from graphos_core.geometry.resection import Resection, refine_resection, space_resection
from graphos_core.geometry.triangulation import triangulate

PIXEL_ORIGIN = 0.5
"""What the pixel coordinates of PhotoModeler and DBAT have more than ours."""

WIDE = 0.1
"""Largest distance of a control point from its ray at the start, in principal distances: a lens not yet corrected."""


@dataclass(frozen=True)
class DbatCamera:
    r"""A camera as DBAT holds it, with the origin of millimetres in the corner of the format, x right and y down.

    With the measured position :math:`m = u\,s` in mm (u px, pixel size s), ``x = (1 + b1)(m_x − x0) + b2 (m_y − y0)``
    and ``y = m_y − y0``, models 1 and 3 correct "backward", measured to ideal (Brown 1971), with y pointing *up*::

        x' = x + x (K1 r² + K2 r⁴ + K3 r⁶) + P1 (r² + 2x²) + 2 P2 x y

    so P2 and b2 change their sign when y points down, as in `p_down`.

    Attributes
    ----------
    width, height : int
        Format, px.
    pitch_mm : float
        Pixel size, mm.
    constant_mm : float
        Camera constant, mm.
    principal_mm : float64 (2,)
        Principal point, mm.
    k : float64 (3,)
        mm⁻², mm⁻⁴, mm⁻⁶.
    p : float64 (2,)
        mm⁻¹, as DBAT stores them (y up).
    aspect : float
        b1 = 1 − ``<aspect>``: x is multiplied by 1 + b1 before the distortion.
    skew : float
        b2.
    model : int
        DBAT's number of the lens model.
    name : str
    """

    width: int
    height: int
    pitch_mm: float
    constant_mm: float
    principal_mm: Array
    k: Array
    p: Array
    aspect: float = 0.0
    skew: float = 0.0
    model: int = 3
    name: str = ""

    @property
    def p_down(self) -> Array:
        """P1, P2 (2,) for y down, mm⁻¹."""
        return np.asarray(self.p) * [1.0, -1.0]

    def ideal_mm(self, xy: Array) -> Array:
        """Return the corrected image coordinates (m, 2) of pixels (m, 2, ours), mm from the principal point, y down."""
        measured = (np.asarray(xy) + PIXEL_ORIGIN) * self.pitch_mm - self.principal_mm
        x = (1.0 + self.aspect) * measured[:, 0] - self.skew * measured[:, 1]
        y = measured[:, 1]
        p1, p2 = self.p_down
        r2 = x * x + y * y
        radial = r2 * (self.k[0] + r2 * (self.k[1] + r2 * self.k[2]))
        return np.column_stack(
            [
                x + x * radial + p1 * (r2 + 2 * x * x) + 2 * p2 * x * y,
                y + y * radial + p2 * (r2 + 2 * y * y) + 2 * p1 * x * y,
            ]
        )

    def without_distortion(self) -> Camera:
        """Return its distortion-free part as a camera of ours, model ``"pinhole"``, px."""
        centre = np.asarray(self.principal_mm) / self.pitch_mm - PIXEL_ORIGIN
        return Camera(
            model="pinhole", width=self.width, height=self.height,
            values=np.array([self.constant_mm / self.pitch_mm, *centre]),
            label=self.name, pixel_pitch_mm=self.pitch_mm, focal_source="DBAT",
        )  # fmt: skip


@dataclass(frozen=True)
class DbatCase:
    """An adjustment case.

    Attributes
    ----------
    name : str
    block : Block
        Oriented with start values; object frame less `Control.origin`; one camera, ``"pinhole"``: the
        distortion-free part of `camera`. `Block.point_track` holds the identifiers of the points.
    camera : DbatCamera
    estimated : tuple of str
        Interior unknowns: of ``cc px py as sk K1 K2 K3 P1 P2``.
    control : Control
        Control and check points; names are the identifiers.
    labels : tuple of str
        Their names for people.
    control_sigma : float64 (n, 3)
        A priori standard deviations, m; 0 for a fixed coordinate.
    control_point : int64 (n,)
        Index into `Block.points`; −1 for a point that is measured in no photo.
    obs_sigma_px : float64 (m,)
        A priori standard deviation of each observation of the block, px.
    """

    name: str
    block: Block
    camera: DbatCamera
    estimated: tuple[str, ...]
    control: Control
    labels: tuple[str, ...]
    control_sigma: Array
    control_point: Array
    obs_sigma_px: Array


@dataclass(frozen=True)
class Measured:
    """Image measurements: identifier of the point, photo (index), position (ours, px) and σ, px; m each."""

    point: Array
    photo: Array
    xy: Array
    sigma: Array


def assemble(
    name: str,
    camera: DbatCamera,
    photos: tuple[str, ...],
    measured: Measured,
    control: Control,
    labels: tuple[str, ...],
    control_sigma: Array,
    *,
    estimated: tuple[str, ...] = (),
    start: tuple[Array, Array] | None = None,
) -> DbatCase:
    """Put a case together; without `start` (rotations, centres) photos are resected from the control points.

    Points that are no control points and are seen in one photo only are left out, as DBAT's ``check_ray_count`` does.
    Control points start at their given position, others at the intersection of their rays.

    Raises
    ------
    ValueError
        When a photo cannot be resected, or a point not be intersected.
    """
    given = {int(key): i for i, key in enumerate(control.names)}
    held = {key for key, i in given.items() if not control.check[i]}
    identifiers, rays_of = np.unique(measured.point, return_counts=True)
    kept = [int(key) for key, rays in zip(identifiers, rays_of, strict=True) if rays > 1 or int(key) in held]
    place = {key: i for i, key in enumerate(kept)}
    used = np.array([int(key) in place for key in measured.point], dtype=bool)
    point = np.array([place[int(key)] for key in measured.point[used]], dtype=np.int32)
    photo, xy, sigma = measured.photo[used], measured.xy[used], measured.sigma[used]
    order = np.lexsort((photo, point))
    point, photo, xy, sigma = point[order], photo[order].astype(np.int32), xy[order], sigma[order]
    if len(set(zip(point.tolist(), photo.tolist(), strict=True))) < len(point):
        raise ValueError("a point is measured twice in one photo")
    ideal = camera.ideal_mm(xy) / camera.constant_mm
    known = {place[key]: control.xyz[given[key]] for key in held if key in place}
    if start is None:
        start = _resect(photos, point, photo, ideal, known)
    points = _intersect(camera, start, point, photo, ideal, known, len(kept))
    block = Block(
        cameras=(camera.without_distortion(),), names=photos,
        camera_of_photo=np.zeros(len(photos), dtype=np.int32), oriented=np.ones(len(photos), dtype=bool),
        rotations=start[0], centres=start[1], points=points,
        colours=np.full((len(points), 3), 128, dtype=np.uint8),
        point_track=np.array(kept, dtype=np.int32), obs_photo=photo, obs_point=point, obs_xy=xy, unit="m",
        obs_sigma_px=sigma,
    )  # fmt: skip
    return DbatCase(
        name, block, camera, estimated, replace(control, sigma=control_sigma), labels, control_sigma,
        np.array([place.get(int(key), -1) for key in control.names]), sigma,
    )  # fmt: skip


def _resect(
    photos: tuple[str, ...], point: Array, photo: Array, ideal: Array, known: dict[int, Array]
) -> tuple[Array, Array]:
    rotations, centres = [], []
    seen = np.array([int(key) in known for key in point], dtype=bool)
    for i, name in enumerate(photos):
        mine = np.flatnonzero(seen & (photo == i))
        found = _resected(np.array([known[int(k)] for k in point[mine]]), ideal[mine])
        if not found:
            raise ValueError(f"photo {name} could not be resected: {found.reason}")
        rotations.append(found.rotation)
        centres.append(found.centre)
    return np.array(rotations), np.array(centres)


def _resected(points: Array, rays: Array) -> Resection:
    """Resect one photo: from three points, or where a distorted image has no such solution from all (Terzakis 2020)."""
    found = space_resection(points, rays, WIDE, seed=0)
    if found or len(points) < 3:
        return found
    fit, vector, translation = cv2.solvePnP(
        points, np.ascontiguousarray(rays), np.eye(3), None, flags=cv2.SOLVEPNP_SQPNP
    )
    if not fit:
        return found
    return refine_resection(cv2.Rodrigues(vector)[0], translation.ravel(), points, rays, WIDE)


def _intersect(
    camera: DbatCamera, start: tuple[Array, Array], point: Array, photo: Array, ideal: Array,
    known: dict[int, Array], count: int,
) -> Array:  # fmt: skip
    bounds = np.searchsorted(point, np.arange(count + 1))
    focal = np.full(len(start[0]), camera.constant_mm / camera.pitch_mm)
    found = triangulate(bounds, photo, ideal, focal, *start)
    points = found.points.copy()
    for i in range(count):
        if i in known:
            points[i] = known[i]
        elif not found.ok[i]:
            raise ValueError("the rays of a point do not intersect")
    return points
