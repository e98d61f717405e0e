"""Parameters and pieces of equations that several camera models share, so that no formula is written twice."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from graphos_core.cameras.model import Parameter
from graphos_core.text import Text

INTERIOR = (
    Parameter("focal_px", "f", Text("Principal distance"), "px", "interior", 1000.0),
    Parameter("x0", "x_0", Text("Principal point x"), "px", "interior", 10.0),
    Parameter("y0", "y_0", Text("Principal point y"), "px", "interior", 10.0),
)

DECENTRING = (
    Parameter("p1", "p_1", Text("Decentring distortion 1"), "", "decentring", 5e-4),
    Parameter("p2", "p_2", Text("Decentring distortion 2"), "", "decentring", 5e-4),
)

SQUARE = Text(
    "Pixels of a digital sensor are square and at right angles; free it for scanned film or resampled photos."
)

AFFINITY = (
    Parameter("b1", "b_1", Text("Affinity"), "", "affinity", 1e-3, "fixed", 1e-4, SQUARE),
    Parameter("b2", "b_2", Text("Shear"), "", "affinity", 1e-3, "fixed", 1e-4, SQUARE),
)

RADIAL_FIXED_AGAINST_F = Text(
    "The radial polynomial has no linear term: that is the principal distance f, the scale at the principal point."
)
AFFINITY_FIXED_AGAINST_F_AND_ROTATION = Text(
    "Affinity and shear act on x alone: the same scale in x and y is f, a turn of both axes is the rotation kappa."
)
DECENTRING_AND_PRINCIPAL_POINT = Text(
    "Decentring p1, p2 goes with the principal point x0, y0 and a tilt of the photo: without rolled and convergent "
    "photos they cannot be told apart."
)


def radial_parameters(*usual: float) -> tuple[Parameter, ...]:
    """Return the sheet of k1, k2 … with their usual sizes."""
    return tuple(
        Parameter(f"k{i}", f"k_{i}", Text("Radial distortion {i}", i=i), "", "radial", size)
        for i, size in enumerate(usual, 1)
    )


def fixed(reason: Text, *parameters: Parameter) -> tuple[Parameter, ...]:
    """Return the same parameters, held fixed by default for a reason."""
    return tuple(replace(parameter, default="fixed", reason=reason) for parameter in parameters)


def radial(u: Any, v: Any, *k: Any) -> tuple[Any, Any]:
    """Return the radial displacement (u, v)·(k1 r² + k2 r⁴ + …) of Brown 1971."""
    r2 = u * u + v * v
    factor = 0
    for coefficient in reversed(k):
        factor = r2 * (coefficient + factor)
    return u * factor, v * factor


def decentring(u: Any, v: Any, p1: Any, p2: Any) -> tuple[Any, Any]:
    """Return the decentring displacement of Brown 1966: p1 (r² + 2u²) + 2 p2 uv, p2 (r² + 2v²) + 2 p1 uv."""
    r2 = u * u + v * v
    return p1 * (r2 + 2 * u * u) + 2 * p2 * u * v, p2 * (r2 + 2 * v * v) + 2 * p1 * u * v


def on_sensor(p: Any, u: Any, v: Any, b1: Any = 0, b2: Any = 0) -> tuple[Any, Any]:
    """Return the pixel of a distorted position: scale f, affinity b1 and shear b2 of x, principal point."""
    return p.focal_px * (u + b1 * u + b2 * v) + p.x0, p.focal_px * v + p.y0
