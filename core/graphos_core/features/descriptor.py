r"""Orientation and descriptor of a keypoint, with everything that leads to them.

Source: Lowe 2004, Distinctive image features from scale-invariant keypoints, sections 5 and 6. Numbers that the paper
leaves open are those of OpenCV's SIFT, whose descriptors the tests compare: the size of a cell (3 σ), the reach of the
orientation histogram (4.5 σ), its smoothing.

Angles run from x towards y, clockwise on the screen, as those of `graphos_core.data.Features`.
"""

from __future__ import annotations

import math

import cv2
import numpy as np

from graphos_core.data.record import Array, record
from graphos_core.features.detectors.scale_space import FIRST_PIXEL, cut_layer, layer_of, most_octaves

CELLS, DIRECTIONS = 4, 8
"""Cells along a side of the descriptor, directions in each."""
CELL = 3.0
"""Side of a cell in units of the keypoint's σ."""
LARGEST_SHARE = 0.2
"""No number of the descriptor of length 1 may be larger: non-linear changes of light (Lowe 2004, section 6.1)."""
LENGTH = 512.0
"""Length of a descriptor before it is rounded to bytes."""
ORIENTATIONS = 36
"""Bins of the orientation histogram, 10° each."""
WINDOW, REACH = 1.5, 3.0
"""σ of the orientation histogram's weight in units of the keypoint's σ; where it ends, in units of that."""
FLAT = 0.01
"""Histograms of less, in grey levels, are rounding errors of the blur: no direction, no descriptor."""
PEAK_SHARE = 0.8
"""A further peak of at least this share of the highest makes a further keypoint (Lowe 2004, section 5)."""


@record
class Described:
    r"""A keypoint's descriptor and what it is made of.

    Attributes
    ----------
    x, y, scale, angle : float
        The keypoint: place and diameter in px of the photo, direction in radians.
    octave, layer : int
        Layer of the scale space on which it is described.
    patch : float32 (p, p)
        The 4 × 4 cells of that layer turned upright (the keypoint's direction points right), grey 0 to 255; outside
        of the photo its last pixel goes on.
    magnitude, direction : float32 (p, p)
        Gradient on `patch`: grey levels per px of the patch; radians from right towards down, −π to π.
    weight : float32 (p, p)
        Gaussian weight of every pixel of the patch, with σ of half the descriptor's side.
    orientation : float64 (36,)
        Smoothed histogram of gradient directions around the keypoint; bin i is at ``2π i / 36`` from x towards y.
    peaks : float64 (k,)
        Directions of all its peaks of at least 80 % of the highest, radians, −π to π, highest first.
    raw : float64 (4, 4, 8)
        Histogram by row and column of cells and direction, weighted gradients in grey levels. Direction k is at 45° k
        from the keypoint's direction **counter-clockwise** on the screen.
    unit : float64 (4, 4, 8)
        `raw` made of length 1.
    final : float64 (4, 4, 8)
        `unit`, cut at 0.2 and made of length 1 again.
    descriptor : uint8 (128,)
        512 times `final`, rounded, at most 255; by cell rows, then columns, then directions.
    """

    x: float
    y: float
    scale: float
    angle: float
    octave: int
    layer: int
    patch: Array
    magnitude: Array
    direction: Array
    weight: Array
    orientation: Array
    peaks: Array
    raw: Array
    unit: Array
    final: Array
    descriptor: Array


def describe(
    grey: Array,
    x: float,
    y: float,
    scale: float,
    angle: float,
    *,
    side: int = 64,
    layers: int = 3,
    sigma: float = 1.6,
) -> Described:
    """Return the descriptor of one keypoint and everything that leads to it.

    Only the part of the scale space around the keypoint is computed: fast enough for a click.

    Parameters
    ----------
    grey : uint8 or float32 (h, w)
        The photo, grey 0 to 255.
    x, y : float
        Place of the keypoint, px, centre of the top-left pixel is (0, 0).
    scale : float
        Its diameter, px: twice its σ, as in `graphos_core.data.Features`.
    angle : float
        Its direction, radians from x towards y.
    side : int
        Pixels of the upright patch, along each side.
    layers, sigma
        The scale space: layers per octave and first blur.

    Returns
    -------
    Described

    Raises
    ------
    ValueError
        When the keypoint lies outside of the photo or has no size.
    """
    height, width = grey.shape
    if not (0 <= x <= width - 1 and 0 <= y <= height - 1 and scale > 0):
        raise ValueError(
            f"keypoint at ({x:g}, {y:g}) of diameter {scale:g} px in a photo of {width} × {height} px"
        )
    octave, layer = layer_of(scale / 2, layers=layers, sigma=sigma)
    if octave >= most_octaves(height, width):
        octave, layer = most_octaves(height, width) - 1, layers
    pixel = FIRST_PIXEL * 2.0**octave
    own = scale / 2 / pixel
    reach = (descriptor_radius(own) + 2) * pixel
    image, at = cut_layer(grey, (x, y), reach, octave, layer, layers=layers, sigma=sigma)
    raw = descriptor_histogram(image, at, own, angle)
    unit, final = normalised(raw)
    orientation = orientation_histogram(image, at, own)
    patch = upright_patch(image, at, own, angle, side)
    magnitude, direction = gradients(patch)
    return Described(
        x=x, y=y, scale=scale, angle=angle, octave=octave, layer=layer, patch=patch, magnitude=magnitude,
        direction=direction, weight=_weight(side), orientation=orientation, peaks=orientation_peaks(orientation),
        raw=raw, unit=unit, final=final, descriptor=to_bytes(final),
    )  # fmt: skip


def gradients(image: Array) -> tuple[Array, Array]:
    """Return size and direction of the gradient by central differences, one-sided at the ends, float32 (h, w).

    Direction in radians from x towards y, −π to π.
    """
    down, right = np.gradient(image.astype(np.float32))
    return np.hypot(right, down), np.arctan2(down, right)


def orientation_histogram(image: Array, at: tuple[float, float], sigma: float) -> Array:
    """Return the smoothed histogram of gradient directions around a place, float64 (36,).

    Every pixel within 4.5 σ of the pixel nearest to `at` adds the size of its gradient, weighted by a Gaussian of
    1.5 σ, to one bin. The histogram is smoothed around the circle by (1, 4, 6, 4, 1) / 16.

    Parameters
    ----------
    image : float32 (h, w)
        Layer of the scale space.
    at : tuple of float
        Column and row in it.
    sigma : float
        The keypoint's σ, px of the layer.
    """
    window = WINDOW * sigma
    dx, dy, right, down = _differences_around(image, at, round(REACH * window))
    size = np.hypot(right, down) * np.exp(-(dx**2 + dy**2) / (2.0 * window**2))
    bins = np.rint(np.arctan2(down, right) * (ORIENTATIONS / (2 * math.pi))).astype(np.intp) % ORIENTATIONS
    histogram = np.bincount(bins, weights=size, minlength=ORIENTATIONS)
    kernel = zip((1, 4, 6, 4, 1), (-2, -1, 0, 1, 2), strict=True)
    return np.asarray(sum(weight / 16.0 * np.roll(histogram, shift) for weight, shift in kernel))


def orientation_peaks(histogram: Array, share: float = PEAK_SHARE) -> Array:
    """Return the directions of all peaks of at least `share` of the highest, radians −π to π, highest first.

    A parabola through a peak and its two neighbours gives its place between the bins.
    """
    before, after = np.roll(histogram, 1), np.roll(histogram, -1)
    least = max(share * float(histogram.max()), FLAT)
    peaks = np.flatnonzero((histogram > before) & (histogram > after) & (histogram >= least))
    peaks = peaks[np.argsort(-histogram[peaks], kind="stable")]
    a, b, c = before[peaks], histogram[peaks], after[peaks]
    angles = (peaks + 0.5 * (a - c) / (a - 2.0 * b + c)) * (2 * math.pi / ORIENTATIONS)
    return np.asarray((angles + math.pi) % (2 * math.pi) - math.pi)


def descriptor_radius(sigma: float) -> int:
    """Pixels around a keypoint of `sigma` that can reach its descriptor: half the diagonal of 5 × 5 cells."""
    return round(CELL * sigma * math.sqrt(2.0) * (CELLS + 1) / 2)


def descriptor_histogram(image: Array, at: tuple[float, float], sigma: float, angle: float) -> Array:
    r"""Return the histogram of gradients in 4 × 4 cells and 8 directions, float64 (4, 4, 8).

    Every pixel adds the size of its gradient, weighted by a Gaussian of two cells,
    ``exp(−(u² + v²) / (½ 4²))`` with u, v in cells from the keypoint along and across its direction, to the two
    nearest rows, columns and directions: with the share ``1 − d`` each, d the distance in bins.

    Parameters
    ----------
    image, at, sigma
        As in `orientation_histogram`.
    angle : float
        The keypoint's direction, radians from x towards y.
    """
    dx, dy, right, down = _differences_around(image, at, descriptor_radius(sigma))
    cos, sin = math.cos(angle) / (CELL * sigma), math.sin(angle) / (CELL * sigma)
    along, across = dx * cos + dy * sin, dy * cos - dx * sin
    row, column = across + (CELLS - 1) / 2, along + (CELLS - 1) / 2
    near = (np.abs(along) < (CELLS + 1) / 2) & (np.abs(across) < (CELLS + 1) / 2)
    turn = (angle - np.arctan2(down, right)) * (DIRECTIONS / (2 * math.pi))
    size = np.hypot(right, down) * np.exp(-(along**2 + across**2) / (0.5 * CELLS**2))
    return _shared_out(row[near], column[near], turn[near], size[near])


def bin_shares(place: float, count: int, *, circular: bool = False) -> dict[int, float]:
    """Return the bins, and the share of each, to which linear interpolation gives a value at `place` in bins."""
    first = math.floor(place)
    shares = {first: 1.0 - (place - first), first + 1: place - first}
    if circular:
        return {index % count: share for index, share in shares.items()}
    return {index: share for index, share in shares.items() if 0 <= index < count}


def _shared_out(row: Array, column: Array, turn: Array, size: Array) -> Array:
    """Sum `size` into the bins around (row, column, turn) by trilinear interpolation."""
    wide = np.zeros((CELLS + 2) * (CELLS + 2) * DIRECTIONS)
    first = [np.floor(place).astype(np.intp) for place in (row, column, turn)]
    part = [place - low for place, low in zip((row, column, turn), first, strict=True)]
    for corner in range(8):
        high = corner >> 2, corner >> 1 & 1, corner & 1
        r, c, d = (low + step for low, step in zip(first, high, strict=True))
        share = [p if step else 1.0 - p for p, step in zip(part, high, strict=True)]
        index = ((r + 1) * (CELLS + 2) + c + 1) * DIRECTIONS + d % DIRECTIONS
        wide += np.bincount(index, weights=size * share[0] * share[1] * share[2], minlength=wide.size)
    return np.ascontiguousarray(wide.reshape(CELLS + 2, CELLS + 2, DIRECTIONS)[1:-1, 1:-1])


def normalised(raw: Array) -> tuple[Array, Array]:
    """Return a histogram made of length 1, and this cut at 0.2 and made of length 1 again; without texture zeros."""
    length = float(np.linalg.norm(raw))
    if length < FLAT:
        return np.zeros_like(raw), np.zeros_like(raw)
    cut = np.minimum(raw / length, LARGEST_SHARE)
    return raw / length, cut / float(np.linalg.norm(cut))


def to_bytes(final: Array) -> Array:
    """Return the 128 numbers as bytes, 512 times a histogram of length 1."""
    return np.minimum(np.rint(LENGTH * final.ravel()), 255.0).astype(np.uint8)


def upright_patch(image: Array, at: tuple[float, float], sigma: float, angle: float, side: int) -> Array:
    """Return the 4 × 4 cells of a keypoint, turned so that its direction points right, float32 (`side`, `side`)."""
    step = CELLS * CELL * sigma / side
    cos, sin = step * math.cos(angle), step * math.sin(angle)
    middle = (side - 1) / 2
    to_image = np.array([
        [cos, -sin, at[0] - middle * (cos - sin)],
        [sin, cos, at[1] - middle * (sin + cos)],
    ])  # fmt: skip
    return np.asarray(
        cv2.warpAffine(
            image, to_image, (side, side), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
            borderMode=cv2.BORDER_REPLICATE,
        )
    )  # fmt: skip


def _differences_around(
    image: Array, at: tuple[float, float], radius: int
) -> tuple[Array, Array, Array, Array]:
    """Return offsets from the pixel nearest to `at`, and grey differences to right and down, as flat arrays.

    Pixels at the ends of the image have no neighbours on both sides and are left out.
    """
    height, width = image.shape
    column, row = round(at[0]), round(at[1])
    columns = np.arange(max(1, column - radius), min(width - 1, column + radius + 1))
    rows = np.arange(max(1, row - radius), min(height - 1, row + radius + 1))
    if not (len(columns) and len(rows)):
        return (np.empty(0),) * 4
    inside = image[rows[0] - 1 : rows[-1] + 2, columns[0] - 1 : columns[-1] + 2].astype(np.float64)
    right = inside[1:-1, 2:] - inside[1:-1, :-2]
    down = inside[2:, 1:-1] - inside[:-2, 1:-1]
    dx, dy = np.meshgrid((columns - column).astype(np.float64), (rows - row).astype(np.float64))
    return dx.ravel(), dy.ravel(), right.ravel(), down.ravel()


def _weight(side: int) -> Array:
    """Gaussian weight of every pixel of an upright patch, float32 (side, side)."""
    cells = ((np.arange(side) + 0.5) / side - 0.5) * CELLS
    one = np.exp(-(cells**2) / (0.5 * CELLS**2))
    return np.outer(one, one).astype(np.float32)
