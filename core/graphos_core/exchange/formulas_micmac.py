"""Camera models of MicMac (Apero), convention ``eConvApero_DistM2C``: the distortion maps ideal to measured pixels.

Formulas of ``src/photogram/phgr_ebner_brown_dist.cpp``: ModRad, ModPhgrStd (Fraser), and ModUnif with general
polynomials and fish-eyes. Coefficients are in pixels (px⁻² …) around a distortion centre ``CDist``, or in units
of a scale that stands among the "états". The centre of the first pixel is taken as (0, 0), where eLiSe's interpolation
has it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from graphos_core.data import Array
from graphos_core.exchange.formulas import Format, Formula, decentring, perspective, radial, register

RADIAL = ("F", "PPx", "PPy", "CDistx", "CDisty", "R3", "R5", "R7", "R9", "R11")
FRASER = (*RADIAL, "P1", "P2", "b1", "b2")


def _ideal(values: Array, rays: Array) -> Array:
    return perspective(rays) * values[0] + values[1:3]


def _fraser(values: Array, _frame: Format, rays: Array) -> Array:
    ideal = _ideal(values, rays)
    x, y = (ideal - values[3:5]).T
    r2 = x * x + y * y
    factor = radial(r2, values[5:10])
    dx, dy = x * factor, y * factor
    if len(values) > 10:
        p1, p2, b1, b2 = values[10:14]
        tx, ty = decentring(x, y, r2, p1, p2)
        dx, dy = dx + tx + b1 * x + b2 * y, dy + ty
    return ideal + np.column_stack([dx, dy])


def _start(count: int) -> Callable[[float, Array, Format], Array]:
    def start(focal: float, principal: Array, _frame: Format) -> Array:
        return np.array([focal, *principal, *principal, *[0.0] * (count - 5)])

    return start


def _none(values: Array, _frame: Format, rays: Array) -> Array:
    return _ideal(values, rays)


def _none_start(focal: float, principal: Array, _frame: Format) -> Array:
    return np.array([focal, *principal])


register(Formula("micmac ModNoDist", ("F", "PPx", "PPy"), "ideal → measured", _none, _none_start))
register(Formula("micmac ModRad", RADIAL, "ideal → measured", _fraser, _start(10)))
register(Formula("micmac ModPhgrStd", FRASER, "ideal → measured", _fraser, _start(14)))


def fisheye_formula(*, equisolid: bool) -> Callable[[Array, Format, Array], Array]:
    """Return the fish-eye of degree 10, 5, 5 with its radial part, first decentring pair and affinity.

    values: F, PPx, PPy, CDistx, CDisty, R3 … R11 (5), P1, P2, l0, l1, and the scale S of the distortion, px.
    """

    def function(values: Array, _frame: Format, rays: Array) -> Array:
        scale_px = values[14]
        across = (_ideal(values, rays) - values[3:5]) / scale_px
        r = np.hypot(across[:, 0], across[:, 1])
        theta = np.arctan(r)
        size = 2 * np.sin(theta / 2) if equisolid else theta
        scale = np.divide(size, r, out=np.ones_like(r), where=r > 1e-12)
        x, y = across[:, 0] * scale, across[:, 1] * scale
        r2 = x * x + y * y
        factor = 1 + radial(r2, values[5:10])
        dx, dy = decentring(x, y, r2, values[10], values[11])
        l0, l1 = values[12:14]
        out = np.column_stack([y * l1 + x * (factor + l0) + dx, x * l1 + y * factor + dy])
        return out * scale_px + values[3:5]

    return function


def _fisheye_start(focal: float, principal: Array, _frame: Format) -> Array:
    return np.array([focal, *principal, *principal, *[0.0] * 9, focal])


FISHEYE = (*RADIAL, "P1", "P2", "l0", "l1", "S")
for _name, _solid in (("eModele_FishEye_10_5_5", False), ("eModele_EquiSolid_FishEye_10_5_5", True)):
    register(Formula(f"micmac {_name}", FISHEYE, "ideal → measured", fisheye_formula(equisolid=_solid),
                     _fisheye_start, constants=("S",)))  # fmt: skip


def polynomial_terms(degree: int) -> int:
    """Return the number of coefficients of a polynomial of a degree: 6 of degree 2, and 2(d + 1) for each above."""
    return degree * (degree + 3) - 4


def _polynomial(degree: int) -> Callable[[Array, Format, Array], Array]:
    def function(values: Array, _frame: Format, rays: Array) -> Array:
        ideal = _ideal(values, rays)
        scale, centre, p = values[3], values[4:6], values[6:]
        x, y = ((ideal - centre) / scale).T
        dx = p[0] * x + p[1] * y - 2 * p[2] * x * x + p[3] * x * y + p[4] * y * y
        dy = -p[0] * y + p[1] * x + p[2] * x * y - 2 * p[3] * y * y + p[5] * x * x
        at = 6
        for d in range(3, degree + 1):
            powers = [x ** (d - i) * y**i for i in range(d + 1)]
            dx = dx + sum(c * term for c, term in zip(p[at : at + d + 1], powers, strict=True))
            dy = dy + sum(c * term for c, term in zip(p[at + d + 1 : at + 2 * d + 2], powers, strict=True))
            at += 2 * (d + 1)
        return ideal + np.column_stack([dx, dy]) * scale

    return function


def _polynomial_start(degree: int) -> Callable[[float, Array, Format], Array]:
    def start(focal: float, principal: Array, frame: Format) -> Array:
        scale = float(np.hypot(frame.width, frame.height)) / 2.0
        return np.array([focal, *principal, scale, *principal, *[0.0] * polynomial_terms(degree)])

    return start


for _degree in range(2, 8):
    register(Formula(
        f"micmac eModelePolyDeg{_degree}",
        ("F", "PPx", "PPy", "S", "Cx", "Cy", *(f"p{i}" for i in range(polynomial_terms(_degree)))),
        "ideal → measured", _polynomial(_degree), _polynomial_start(_degree), constants=("S", "Cx", "Cy"),
    ))  # fmt: skip
