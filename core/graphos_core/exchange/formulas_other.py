"""Camera models of Agisoft Metashape, PhotoModeler, Australis and iWitness, Bundler, VisualSFM (NVM).

- Metashape: user manual, appendix "Camera models" (1.5 and later); image centre is ``width / 2``, counted from the
  corner of the first pixel.
- PhotoModeler: millimetres from the corner of the format; y points up in the correction. Read as the Damped Bundle
  Adjustment Toolbox does, whose camera calibration reproduces sigma0 only with this sign and order.
- Australis, iWitness: Fraser 1997, Digital camera self-calibration, equations 2 to 5; millimetres from the image
  centre, y up, correction *added* to the measured position.
- Bundler: its manual, section 5: p = −P / P_z, origin in the image centre, y up.
- VisualSFM: Wu et al. 2011, Multicore bundle adjustment, measurement distortion; the file holds r f².
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from graphos_core.data import Array
from graphos_core.exchange.formulas import (
    CORNER,
    Format,
    Formula,
    decentring,
    fisheye,
    perspective,
    radial,
    register,
)


def _metashape(projection: Callable[[Array], Array]) -> Callable[[Array, Format, Array], Array]:
    def function(values: Array, frame: Format, rays: Array) -> Array:
        f, cx, cy, k1, k2, k3, k4, p1, p2, b1, b2 = values
        uv = projection(rays)
        x, y = uv[:, 0], uv[:, 1]
        r2 = x * x + y * y
        factor = 1 + radial(r2, np.array([k1, k2, k3, k4]))
        dx, dy = decentring(x, y, r2, p1, p2)
        xd, yd = x * factor + dx, y * factor + dy
        return np.column_stack(
            [
                frame.width * 0.5 + cx + xd * f + xd * b1 + yd * b2 - CORNER,
                frame.height * 0.5 + cy + yd * f - CORNER,
            ]
        )

    return function


def _metashape_start(focal: float, principal: Array, frame: Format) -> Array:
    offset = np.asarray(principal) - frame.centre
    return np.array([focal, *offset, *[0.0] * 8])


def _equidistant(rays: Array) -> Array:
    return fisheye(rays, lambda angle: angle)


def _equisolid(rays: Array) -> Array:
    return fisheye(rays, lambda angle: 2 * np.sin(angle / 2))


METASHAPE = ("f", "cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2", "b1", "b2")
"""Parameters of Metashape's frame and fish-eye cameras; b1, b2 in px."""

register(Formula("metashape frame", METASHAPE, "ideal → measured", _metashape(perspective), _metashape_start))
register(Formula("metashape equidistant_fisheye", METASHAPE, "ideal → measured", _metashape(_equidistant),
                 _metashape_start, wide=True))  # fmt: skip
register(Formula("metashape equisolid_fisheye", METASHAPE, "ideal → measured", _metashape(_equisolid),
                 _metashape_start, wide=True))  # fmt: skip


def backward_directions(x: Array, y: Array, c: float, k: Array, p: Array, b: Array) -> Array:
    """Return directions of measured positions (mm, y up, from the principal point) corrected as Fraser 1997 does."""
    r2 = x * x + y * y
    dx, dy = decentring(x, y, r2, p[0], p[1])
    factor = radial(r2, k)
    xc = x + x * factor + dx + b[0] * x + b[1] * y
    yc = y + y * factor + dy
    return np.column_stack([xc / c, -yc / c, np.ones_like(xc)])


def pitch_of(frame: Format) -> float:
    """Return the pixel size, mm; 1 where it is not known."""
    return frame.pitch_mm if frame.pitch_mm is not None else 1.0


def _photomodeler(values: Array, frame: Format, pixels: Array) -> Array:
    c, xp, yp, k1, k2, k3, p1, p2 = values
    mm = (pixels + CORNER) * pitch_of(frame)
    return backward_directions(
        mm[:, 0] - xp, yp - mm[:, 1], c, np.array([k1, k2, k3]), np.array([p1, p2]), np.zeros(2)
    )


def _photomodeler_start(focal: float, principal: Array, frame: Format) -> Array:
    pitch = pitch_of(frame)
    return np.array([focal * pitch, *((np.asarray(principal) + CORNER) * pitch), *[0.0] * 5])


def _australis(values: Array, frame: Format, pixels: Array) -> Array:
    c, xp, yp, k1, k2, k3, p1, p2, b1, b2 = values
    mm = (pixels - frame.centre) * pitch_of(frame)
    return backward_directions(mm[:, 0] - xp, -mm[:, 1] - yp, c, np.array([k1, k2, k3]), np.array([p1, p2]),
                     np.array([b1, b2]))  # fmt: skip


def _australis_start(focal: float, principal: Array, frame: Format) -> Array:
    offset = (np.asarray(principal) - frame.centre) * pitch_of(frame)
    return np.array([focal * pitch_of(frame), offset[0], -offset[1], *[0.0] * 7])


PHOTOMODELER = ("focal", "xp", "yp", "K1", "K2", "K3", "P1", "P2")
AUSTRALIS = ("c", "xp", "yp", "K1", "K2", "K3", "P1", "P2", "B1", "B2")

register(
    Formula(
        "photomodeler", PHOTOMODELER, "measured → ideal", _photomodeler, _photomodeler_start, needs_pitch=True
    )
)
register(Formula("australis", AUSTRALIS, "measured → ideal", _australis, _australis_start, needs_pitch=True))


def _bundler(values: Array, frame: Format, rays: Array) -> Array:
    f, k1, k2 = values
    uv = perspective(rays)
    factor = f * (1 + radial((uv**2).sum(axis=1), np.array([k1, k2])))
    return uv * factor[:, None] + frame.centre


def _bundler_start(focal: float, _principal: Array, _frame: Format) -> Array:
    return np.array([focal, 0.0, 0.0])


def _nvm(values: Array, frame: Format, pixels: Array) -> Array:
    f, r = values
    uv = (pixels - frame.centre) / f
    uv = uv * (1 + r * (uv**2).sum(axis=1))[:, None]
    return np.column_stack([uv, np.ones(len(uv))])


def _nvm_start(focal: float, _principal: Array, _frame: Format) -> Array:
    return np.array([focal, 0.0])


register(Formula("bundler", ("f", "k1", "k2"), "ideal → measured", _bundler, _bundler_start))
register(Formula("nvm", ("f", "r"), "measured → ideal", _nvm, _nvm_start))
