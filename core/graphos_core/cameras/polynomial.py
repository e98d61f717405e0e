r"""General polynomials of degree 3 to 7 in x and y, without the terms that f, x0, y0 and the rotation make."""

from __future__ import annotations

from typing import Any

from graphos_core.cameras.ebner import BASE, LEFT_OUT, coefficient
from graphos_core.cameras.model import CameraModel, Equations, Parameter
from graphos_core.cameras.sheet import INTERIOR, on_sensor
from graphos_core.text import Text

DEGREES = range(3, 8)


def powers(degree: int) -> list[tuple[int, int]]:
    """Return the exponents (i, j) of ξ^i η^j of total degree 3 to `degree`."""
    return [(total - j, j) for total in range(3, degree + 1) for j in range(total + 1)]


def parameters(degree: int) -> tuple[Parameter, ...]:
    """Return the sheet: interior, base length, six terms up to degree 2, then every term from degree 3."""
    low = tuple(coefficient(f"e{i}", Text("Linear and quadratic {i}", i=i)) for i in range(1, 7))
    high = tuple(
        Parameter(
            f"{axis}{i}{j}",
            f"{axis}_{{{i}{j}}}",
            Text("Term {i}, {j} in {direction}", i=i, j=j, direction=direction),
            "px",
            "polynomial",
            0.5,
        )
        for axis, direction in (("c", "x"), ("d", "y"))
        for i, j in powers(degree)
    )
    return (*INTERIOR, BASE, *low, *high)


def equations_of(degree: int) -> Equations:
    """Return the equations for one degree."""

    def equations(p: Any, u: Any, v: Any) -> tuple[Any, Any]:
        x, y = u * p.focal_px / p.base_px, v * p.focal_px / p.base_px
        dx = p.e1 * x + p.e2 * y - 2 * p.e3 * x * x + p.e4 * x * y + p.e5 * y * y
        dy = -p.e1 * y + p.e2 * x + p.e3 * x * y - 2 * p.e4 * y * y + p.e6 * x * x
        for i, j in powers(degree):
            dx += getattr(p, f"c{i}{j}") * x**i * y**j
            dy += getattr(p, f"d{i}{j}") * x**i * y**j
        ideal_x, ideal_y = on_sensor(p, u, v)
        return ideal_x + dx, ideal_y + dy

    return equations


MODELS = tuple(
    CameraModel(
        name=f"polynomial{degree}",
        label=Text("Polynomial of degree {degree}", degree=degree),
        parameters=parameters(degree),
        direction="ideal → measured",
        source="Pierrot-Deseilligny and Clery 2011, Apero, an open source bundle adjustment software, general "
        "polynomial models; terms up to degree 2 as Ebner 1976",
        formula=r"x = x_0 + f\,u + e_1 \xi + e_2 \eta - 2 e_3 \xi^2 + e_4 \xi \eta + e_5 \eta^2 + "
        rf"\sum_{{3 \leq i+j \leq {degree}}} c_{{ij}}\,\xi^i \eta^j,\quad "
        r"y = y_0 + f\,v - e_1 \eta + e_2 \xi + e_3 \xi \eta - 2 e_4 \eta^2 + e_6 \xi^2 + "
        rf"\sum_{{3 \leq i+j \leq {degree}}} d_{{ij}}\,\xi^i \eta^j,\quad \xi = \frac{{f u}}{{b}}",
        equations=equations_of(degree),
        dependences=LEFT_OUT,
    )
    for degree in DEGREES
)
