r"""Sub-pixel places of crosses, corners and circular targets, with their standard deviations.

A parametric picture of the target is fitted to the grey levels by least squares (Rohr 1992; least squares matching with
a synthetic template, Gruen 1985): an edge is the integral Φ of the Gaussian that blurs it, so

====== ============================================================================================
corner grey levels of four quadrants, ``Φ(±u) Φ(±v)``, u and v the distances from two edges
cross  ``1 − (1 − B(u)) (1 − B(v))`` with the bars ``B(u) = Φ(u + w/2) − Φ(u − w/2)``
circle ``Φ(d)``, d the distance from an ellipse (a tilted circle)
====== ============================================================================================

The grey levels are linear and eliminated (variable projection, Golub and Pereyra 1973); the residuals and the Jacobian
of the rest give the standard deviation of the place. The start comes from the point where the edges of the window meet
(Förstner and Gülch 1987), or from the moments of the disc.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from scipy.optimize import least_squares
from scipy.special import ndtr

from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.text import Text

Target = Literal["circle", "cross", "corner"]
"""Kinds of points that can be snapped to."""

Picture = Callable[[Array, Array], Array]
"""Parameters (x, y, …) and positions (n, 2) to the pictures (n, k) whose grey levels are linear."""

SMALLEST_SHARE = 0.6
"""Share of the variance of the grey levels that a target explains at least."""

LARGEST_SIGMA_PX = 0.5
SMALLEST_CONTRAST = 8.0
"""Grey levels between a target and its ground at least."""

BLUR_PX = 0.8
WIDTHS_PX = (2.0, 4.0, 8.0)
"""Widths of a bar from which the fit of a cross starts."""


@dataclass(frozen=True)
class Snap:
    """A measured place.

    Attributes
    ----------
    xy : float64 (2,)
        px, the centre of the top-left pixel of the image is (0, 0).
    sigma_px : float
        Standard deviation of the worse coordinate, px.
    """

    xy: Array
    sigma_px: float


def snap(image: Array, xy: Array, target: Target, radius: float = 12.0) -> Snap:
    """Find the target near a place.

    Parameters
    ----------
    image : uint8 (h, w) or (h, w, 3) RGB
    xy : float64 (2,)
        Approximate place, px; inside the disc of a circle, within about `radius` / 2 of a cross or corner.
    target : {"circle", "cross", "corner"}
    radius : float
        Radius of the window in which crosses and corners are sought, and largest half diameter of a circle, px.

    Returns
    -------
    Snap

    Raises
    ------
    UserError
        When there is no such target.
    """
    x, y = float(xy[0]), float(xy[1])
    if not (0 <= x <= image.shape[1] - 1 and 0 <= y <= image.shape[0] - 1):
        raise nothing(target)
    reach = int(np.ceil(2.5 * radius)) + 4
    left, top = max(round(x) - reach, 0), max(round(y) - reach, 0)
    part = image[top : round(y) + reach + 1, left : round(x) + reach + 1]
    grey = (part if part.ndim == 2 else cv2.cvtColor(part, cv2.COLOR_RGB2GRAY)).astype(np.float64)
    found = (_circle if target == "circle" else _crossing)(
        grey, np.array([x - left, y - top]), target, radius
    )
    return Snap(found.xy + np.array([left, top]), found.sigma_px)


def nothing(target: Target) -> UserError:
    """Say that there is no such target."""
    names = {"circle": "circular target", "cross": "cross", "corner": "corner"}
    return UserError(
        Text("There is no {target} here.", target=Text(names[target])),
        "The grey levels round the place do not look like one.",
        "Place the mark nearer to it, choose another kind of target, or measure by hand.",
    )


# ------------------------------------------------------------------------------------------------------- pictures


def corner_picture(values: Array, positions: Array) -> Array:
    """Return the shares (n, 4) of the four quadrants; values are x, y, two edge directions, blur."""
    u, v = _edges(values, positions)
    a, b = ndtr(u), ndtr(v)
    return np.column_stack([a * b, a * (1 - b), (1 - a) * b, (1 - a) * (1 - b)])


def cross_picture(values: Array, positions: Array) -> Array:
    """Return ground and cross (n, 2); values are x, y, two bar directions, blur, two widths."""
    (u, v), half = _edges(values, positions), 0.5 * values[5:7] / _blur(values[4])
    first, second = ndtr(u + half[0]) - ndtr(u - half[0]), ndtr(v + half[1]) - ndtr(v - half[1])
    return np.column_stack([np.ones(len(positions)), 1 - (1 - first) * (1 - second)])


def circle_picture(values: Array, positions: Array) -> Array:
    """Return ground and disc (n, 2); values are x, y, blur, and a, b, c of ``a dx² + 2 b dx dy + c dy² = 1``."""
    dx, dy = (positions - values[:2]).T
    a, b, c = values[3:6]
    form = np.sqrt(np.maximum(a * dx**2 + 2 * b * dx * dy + c * dy**2, 1e-12))
    slope = np.maximum(np.hypot(a * dx + b * dy, b * dx + c * dy) / form, 1e-12)
    return np.column_stack([np.ones(len(dx)), ndtr((1 - form) / (slope * _blur(values[2])))])


def _edges(values: Array, positions: Array) -> tuple[Array, Array]:
    """Return the distances of positions from two lines through the point, in units of the blur."""
    dx, dy = (positions - values[:2]).T
    blur = _blur(values[4])
    return tuple((np.sin(angle) * dx - np.cos(angle) * dy) / blur for angle in values[2:4])


def _blur(value: float) -> float:
    return float(np.hypot(value, 0.3))


# ------------------------------------------------------------------------------------------------------------ fits


def _fit(picture: Picture, start: Array, positions: Array, grey: Array) -> tuple[Array, Snap, float]:
    """Fit a picture; returns its parameters, the place, and the share of the variance it explains."""

    def misfit(values: Array) -> Array:
        shares = picture(values, positions)
        return shares @ np.linalg.lstsq(shares, grey, rcond=None)[0] - grey

    found = least_squares(
        misfit, start, method="lm", x_scale=np.maximum(np.abs(start), 0.1), max_nfev=60 * len(start)
    )
    unknowns = len(start) + picture(start, positions[:1]).shape[1]
    variance = 2 * found.cost / max(len(grey) - unknowns, 1)
    covariance = variance * np.linalg.pinv(found.jac.T @ found.jac)[:2, :2]
    sigma = float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))
    share = 1.0 - 2 * found.cost / max(float(((grey - grey.mean()) ** 2).sum()), 1e-9)
    return found.x, Snap(found.x[:2], sigma), share


def _crossing(grey: Array, start: Array, target: Target, radius: float) -> Snap:
    """Fit a corner or a cross, in a window that is centred on what the first fit found."""
    point, angle = _meeting(grey, start, radius, target)
    directions = [angle, angle + np.pi / 2]
    starts = (
        [[*directions, BLUR_PX]] if target == "corner" else [[*directions, BLUR_PX, w, w] for w in WIDTHS_PX]
    )
    picture = corner_picture if target == "corner" else cross_picture
    positions, levels = _window(grey, point, radius)
    fits = [_fit(picture, np.array([*point, *rest]), positions, levels) for rest in starts]
    values, _, _ = max(fits, key=lambda fit: fit[2])
    if np.hypot(*(values[:2] - start)) > radius:
        raise nothing(target)
    positions, levels = _window(grey, values[:2], radius)
    _, found, share = _fit(picture, values, positions, levels)
    return _checked(found, share, np.ptp(levels), start, radius, target)


def _circle(grey: Array, start: Array, target: Target, radius: float) -> Snap:
    """Fit an ellipse within one and a half of its diameter."""
    centre, form = _disc(grey, start, radius)
    size = float(1 / np.sqrt(np.linalg.eigvalsh(form)[0]))
    positions, levels = _window(grey, centre, size + 5.0)
    near = np.sqrt(np.einsum("ij,jk,ik->i", positions - centre, form, positions - centre))
    use = near <= 1.0 + 2.5 * np.sqrt(np.linalg.eigvalsh(form)[-1])
    begin = np.array([*centre, BLUR_PX, form[0, 0], form[0, 1], form[1, 1]])
    _, found, share = _fit(circle_picture, begin, positions[use], levels[use])
    return _checked(found, share, np.ptp(levels[use]), start, size + 1.0, target)


def _checked(found: Snap, share: float, contrast: float, start: Array, reach: float, target: Target) -> Snap:
    good = share >= SMALLEST_SHARE and found.sigma_px <= LARGEST_SIGMA_PX and contrast >= SMALLEST_CONTRAST
    if not good or not np.hypot(*(found.xy - start)) <= reach:
        raise nothing(target)
    return found


# ---------------------------------------------------------------------------------------------------------- starts


def _window(grey: Array, point: Array, radius: float) -> tuple[Array, Array]:
    """Return positions (n, 2) and grey levels (n,) of the pixels within `radius` of a point."""
    rows, columns = np.mgrid[: grey.shape[0], : grey.shape[1]]
    near = np.hypot(columns - point[0], rows - point[1]) <= radius
    return np.column_stack([columns[near], rows[near]]).astype(np.float64), grey[near]


def _meeting(grey: Array, start: Array, radius: float, target: Target) -> tuple[Array, float]:
    """Return where the edges of the window meet, and the direction of one of two perpendicular families of edges."""
    smooth = cv2.GaussianBlur(grey, (0, 0), BLUR_PX)
    gy, gx = np.gradient(smooth)
    point = start
    for _ in range(5):
        positions, across = _window(gx, point, radius)
        down = _window(gy, point, radius)[1]
        gradients = np.column_stack([across, down])
        matrix = gradients.T @ gradients
        values = np.linalg.eigvalsh(matrix)
        if len(positions) < 20 or values[0] < 0.02 * values[1] or values[1] < SMALLEST_CONTRAST**2:
            raise nothing(target)
        lines = np.einsum("ij,ij->i", gradients, positions)
        point = np.linalg.solve(matrix, gradients.T @ lines)
        if np.hypot(*(point - start)) > radius:
            raise nothing(target)
    fourfold = (across + 1j * down) ** 4 / np.maximum(np.hypot(across, down) ** 2, 1e-9)
    return point, float(np.angle(fourfold.sum()) / 4 + np.pi / 2)


def _disc(grey: Array, start: Array, radius: float) -> tuple[Array, Array]:
    """Return the centre (2,) of the disc under a place and its quadratic form (2, 2), by second moments."""
    smooth = cv2.GaussianBlur(grey, (0, 0), 0.7)
    column, row = round(float(start[0])), round(float(start[1]))
    inside = float(smooth[row, column])
    level = 0.5 * (inside + _surroundings(smooth, column, row, radius))
    mask = (smooth > level) if inside > level else (smooth < level)
    _, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)
    rows, columns = np.nonzero(labels == labels[row, column])
    edge = (rows == 0) | (columns == 0) | (rows == grey.shape[0] - 1) | (columns == grey.shape[1] - 1)
    if len(rows) < 4 or edge.any():
        raise nothing("circle")
    moments = np.cov(np.stack([columns, rows]), bias=True) + np.eye(2) / 12
    squares = np.linalg.eigvalsh(
        4 * moments
    )  # a full ellipse with half axes a, b has the variances a²/4, b²/4
    filled = len(rows) / (np.pi * np.sqrt(squares.prod()))
    if not 0.8 < filled < 1.25 or np.sqrt(squares[1]) > radius or squares[1] > 25 * squares[0]:
        raise nothing("circle")
    return np.array([columns.mean(), rows.mean()]), np.linalg.inv(4 * moments)


def _surroundings(smooth: Array, column: int, row: int, radius: float) -> float:
    """Return the grey level that differs most from the place along eight rays, the median of the rays."""
    steps, inside, found = np.arange(1, int(radius) + 4), float(smooth[row, column]), []
    for angle in np.arange(8) * np.pi / 4:
        columns = np.clip(np.round(column + steps * np.cos(angle)).astype(int), 0, smooth.shape[1] - 1)
        rows = np.clip(np.round(row + steps * np.sin(angle)).astype(int), 0, smooth.shape[0] - 1)
        along = smooth[rows, columns]
        found.append(float(along[np.argmax(np.abs(along - inside))]))
    if abs(np.median(found) - inside) < SMALLEST_CONTRAST:
        raise nothing("circle")
    return float(np.median(found))
