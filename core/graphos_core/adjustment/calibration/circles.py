"""Circles: dark discs on light ground, their centres from the gradients of their edges."""

from __future__ import annotations

import cv2
import numpy as np

from graphos_core.data.record import Array

LEAST_AREA = 20.0
"""Smallest disc, px²: below it an edge has no gradients of its own."""
LARGEST_SHARE = 0.02
"""Largest disc as a share of the photo."""
ROUNDEST = 0.12
"""How much the area may differ from that of the ellipse with the same moments."""
FLATTEST = 0.2
"""Smallest ratio of the axes of an ellipse."""
ROUGHEST = 0.05
"""Largest standard deviation of a contour from its ellipse, as a share of the radius: that of a square is 0.1."""
RING = 2.5
"""Half width of the ring of pixels round an edge that take part, px."""
PASSES = 3


def find_discs(grey: Array) -> tuple[Array, Array, Array]:
    """Find dark discs.

    Regions darker than their surroundings (mean over a window, several window sizes) whose area is that of the ellipse
    with the same second moments are discs. Their centres come from `ellipse_centre`.

    Parameters
    ----------
    grey : uint8 (h, w)

    Returns
    -------
    xy : float64 (k, 2)
        Centres of the ellipses, px.
    sigma : float64 (k,)
        Standard deviation of a coordinate, px.
    area : float64 (k,)
        px².
    """
    smooth = cv2.GaussianBlur(grey, (0, 0), 1.0)
    regions: list[tuple[Array, Array, float]] = []
    most = 0
    for window in _windows(grey.shape):
        mask = cv2.adaptiveThreshold(
            smooth, 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY_INV, window, 8
        )
        found = _regions(mask)
        if (count := _places(found)) > most:
            regions, most = found, count
    best = _measured(grey, regions)
    if not best:
        return np.zeros((0, 2)), np.zeros(0), np.zeros(0)
    centres, sigmas, areas = zip(*best, strict=True)
    return np.array(centres), np.array(sigmas), np.array(areas)


def _windows(shape: tuple[int, ...]) -> list[int]:
    side = max(shape)
    return sorted({int(side * share) // 2 * 2 + 1 for share in (0.03, 0.06, 0.12, 0.25)})


def _regions(mask: Array) -> list[tuple[Array, Array, float]]:
    """Return middle, inverse second moments and smaller half axis of every region that is an ellipse."""
    contours, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    regions = []
    for contour in contours:
        moments = cv2.moments(contour)
        area = moments["m00"]
        if not LEAST_AREA <= area <= LARGEST_SHARE * mask.size:
            continue
        spread = np.array([[moments["mu20"], moments["mu11"]], [moments["mu11"], moments["mu02"]]]) / area
        small, large = np.sqrt(np.maximum(np.linalg.eigvalsh(spread), 1e-9)) * 2.0  # half axes
        if abs(area / (np.pi * small * large) - 1.0) > ROUNDEST or small < FLATTEST * large:
            continue
        hull = cv2.contourArea(cv2.convexHull(contour))
        if area < (1.0 - ROUNDEST) * hull:
            continue
        middle, shape = np.array([moments["m10"], moments["m01"]]) / area, np.linalg.inv(spread)
        if _roughness(contour, middle, shape) * small > 0.3 + ROUGHEST * small:
            continue
        regions.append((middle, shape, float(small)))
    return regions


def _places(regions: list[tuple[Array, Array, float]]) -> int:
    """Return how many different places the regions have: the two contours of a ring are one."""
    if not regions:
        return 0
    middles = np.array([middle for middle, _, _ in regions])
    reach = np.array([small for _, _, small in regions])
    first = np.ones(len(regions), dtype=bool)
    for i in np.argsort(-reach):
        if first[i]:
            near = ((middles - middles[i]) ** 2).sum(axis=1) < reach[i] ** 2
            near[i] = False
            first &= ~near
    return int(first.sum())


def _measured(grey: Array, regions: list[tuple[Array, Array, float]]) -> list[tuple[Array, float, float]]:
    """Return centre, standard deviation and area of every disc."""
    discs = []
    for middle, shape, small in regions:
        centre, sigma, area = ellipse_centre(grey, middle, shape, small)
        if np.isfinite(sigma) and np.hypot(*(centre - middle)) < 0.5 * small / FLATTEST:
            discs.append((centre, sigma, area))
    return _without_doubles(discs)


def _roughness(contour: Array, middle: Array, shape: Array) -> float:
    """Return the standard deviation of a contour's distance from its ellipse, as a share of the radius."""
    offset = contour.reshape(-1, 2) - middle
    return float(np.std(0.5 * np.sqrt(np.maximum(((offset @ shape) * offset).sum(axis=1), 0.0))))


def _without_doubles(discs: list[tuple[Array, float, float]]) -> list[tuple[Array, float, float]]:
    """Keep the surest of the ellipses in one disc: a large disc can come as a ring with two contours."""
    ranked = sorted(discs, key=lambda d: d[1])
    centres = np.array([centre for centre, _, _ in ranked]).reshape(-1, 2)
    free = np.ones(len(ranked), dtype=bool)
    kept = []
    for i, disc in enumerate(ranked):
        if free[i]:
            kept.append(disc)
            free &= np.pi * ((centres - disc[0]) ** 2).sum(axis=1) >= disc[2]
    return kept


def ellipse_centre(grey: Array, middle: Array, shape: Array, small: float) -> tuple[Array, float, float]:
    """Return the centre of an ellipse, the standard deviation of a coordinate, px, and the area, px².

    Each pixel near the edge gives the tangent line ``l = (gx, gy, −gx x − gy y)`` perpendicular to its gradient g; all
    tangents fulfil ``lᵀ C* l = 0`` with the dual conic C*, weighted with the squared gradient; its last column is the
    centre. A linear least-squares solution with its covariance (Ouellet and Hébert 2009, Precise ellipse estimation
    without contour point extraction, Machine Vision and Applications 21), repeated with the pixels near the ellipse
    that was found.

    Parameters
    ----------
    grey : uint8 (h, w)
    middle : float64 (2,)
        Centre of the region, px.
    shape : float64 (2, 2)
        Inverse second moments of the region: ``dᵀ shape d = 4`` on its edge.
    small : float
        Smaller half axis, px.
    """
    centre, sigma, area = np.asarray(middle), float("inf"), 0.0
    for _ in range(PASSES):
        fitted = _fit(grey, centre, shape, small)
        if fitted is None:
            return centre, float("inf"), 0.0
        centre, sigma, squares = fitted
        roots = np.linalg.eigvalsh(squares)
        if roots[0] <= 0.25 or roots[1] > (4.0 * small / FLATTEST) ** 2:
            return centre, float("inf"), 0.0
        shape, small = 4.0 * np.linalg.inv(squares), float(np.sqrt(roots[0]))
        area = np.pi * float(np.sqrt(roots.prod()))
    return centre, sigma, area


def _fit(grey: Array, middle: Array, shape: Array, small: float) -> tuple[Array, float, Array] | None:
    """Return centre, standard deviation and the matrix of squared half axes (2, 2) of one solution."""
    reach = int(np.ceil(2.0 * float(np.sqrt(np.linalg.inv(shape).diagonal().max())))) + 4
    x0, y0 = (round(float(m)) for m in middle)
    left, top = max(x0 - reach, 1), max(y0 - reach, 1)
    right, bottom = min(x0 + reach, grey.shape[1] - 2), min(y0 + reach, grey.shape[0] - 2)
    if right - left < 4 or bottom - top < 4:
        return None
    window = grey[top - 1 : bottom + 2, left - 1 : right + 2].astype(np.float64)
    gx = 0.5 * (window[1:-1, 2:] - window[1:-1, :-2])
    gy = 0.5 * (window[2:, 1:-1] - window[:-2, 1:-1])
    y, x = np.mgrid[top : bottom + 1, left : right + 1].astype(np.float64)
    x, y = x - middle[0], y - middle[1]
    u, v = shape[0, 0] * x + shape[0, 1] * y, shape[0, 1] * x + shape[1, 1] * y
    distance = 0.5 * np.sqrt(np.maximum(u * x + v * y, 0.0))
    ring = (np.abs(distance - 1.0) * small <= RING) & (gx * u + gy * v > 0)
    a, b = gx[ring], gy[ring]
    if len(a) < 12:
        return None
    scale = max(small, 1.0)
    c = -(a * x[ring] + b * y[ring]) / scale
    design = np.column_stack([a * a, 2 * a * b, b * b, 2 * a * c, 2 * b * c])
    try:
        cofactor = np.linalg.inv(design.T @ design)
    except np.linalg.LinAlgError:
        return None
    solution = -cofactor @ (design.T @ (c * c))
    residual = design @ solution + c * c
    variance = float((residual**2).sum()) / (len(a) - 5)
    sigma = scale * float(np.sqrt(max(0.5 * variance * (cofactor[3, 3] + cofactor[4, 4]), 0.0)))
    centre = solution[3:]
    squares = np.outer(centre, centre) - np.array([[solution[0], solution[1]], [solution[1], solution[2]]])
    return middle + scale * centre, sigma, scale**2 * squares
