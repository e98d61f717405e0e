r"""The figures behind the analyser: texture, colour, sharpness, exposure and noise of one photo."""

from __future__ import annotations

import math

import cv2
import numpy as np

from graphos_core.data import Array, record

WORKING_PIXELS = 1_250_000
"""Texture and colour are measured at the size on which detectors work by default."""
COLOUR_PIXELS = 300_000
SPOT_SCALES = (0.8, 1.6)
"""Standard deviations of the finer Gaussian of each difference, px of the working copy."""
SPOT_CONTRAST = 2.55
"""Least difference of Gaussians, grey levels: 0.01 of the grey range, a little above what SIFT asks by default
(its contrast threshold through its layers)."""
WINDOW = 21
"""Window of local contrast, px of the working copy."""
REBLUR = 9
"""Length of the filter of the blur measure, px."""
TILE, TILES = 256, 3
"""Sharpness and noise are measured in TILES × TILES tiles of so many pixels in full resolution."""
PRINT_SIDE = 32


@record
class PhotoFigures:
    """Figures of one photo.

    Attributes
    ----------
    width, height : int
        Px.
    spots : int
        Strong spots of the working copy, see `strong_spots`.
    contrast : float
        Median of the local standard deviation, grey levels.
    hue_dispersion, saturation_dispersion : float
        Circular variance of the hue, 0 to 1, and coefficient of variation of the saturation; 0 without colour.
    blur : float
        0 (sharp) to 1, see `blur_by_reblurring`.
    motion : float
        By how much the most blurred direction exceeds the one across it.
    motion_direction : float
        Radians, from x towards y, 0 to π, in steps of π/4.
    black, white : float
        Share of pixels at 0 and 255.
    mean : float
        Mean grey value.
    noise : float
        Standard deviation of the noise, grey levels.
    fingerprint : float32 (1024,)
        Reduced photo without mean and of norm 1; zeros for a photo of one colour.
    """

    width: int
    height: int
    spots: int
    contrast: float
    hue_dispersion: float
    saturation_dispersion: float
    blur: float
    motion: float
    motion_direction: float
    black: float
    white: float
    mean: float
    noise: float
    fingerprint: Array


def working_copy(grey: Array) -> Array:
    """Return the grey photo reduced to `WORKING_PIXELS`, never enlarged."""
    height, width = grey.shape
    factor = math.sqrt(height * width / WORKING_PIXELS)
    if factor <= 1.0:
        return grey
    return cv2.resize(
        grey, (max(1, round(width / factor)), max(1, round(height / factor))), interpolation=cv2.INTER_AREA
    )


def strong_spots(grey: Array) -> int:
    """Count local extrema of differences of Gaussians that exceed `SPOT_CONTRAST`, at two scales.

    It is what SIFT (Lowe 2004, section 3) starts from, without its pyramid: how much a detector can find.

    Parameters
    ----------
    grey : uint8 (h, w)
    """
    values = grey.astype(np.float32)
    around = np.ones((3, 3), np.uint8)
    count = 0
    for sigma in SPOT_SCALES:
        difference = cv2.GaussianBlur(values, (0, 0), sigma * 2 ** (1 / 3)) - cv2.GaussianBlur(
            values, (0, 0), sigma
        )
        highest = (difference > SPOT_CONTRAST) & (difference >= cv2.dilate(difference, around))
        lowest = (difference < -SPOT_CONTRAST) & (difference <= cv2.erode(difference, around))
        count += int(np.count_nonzero(highest) + np.count_nonzero(lowest))
    return count


def local_contrast(grey: Array) -> float:
    """Return the median standard deviation of windows of `WINDOW` px, grey levels."""
    values = grey.astype(np.float32)
    mean = cv2.boxFilter(values, -1, (WINDOW, WINDOW))
    square = cv2.sqrBoxFilter(values, cv2.CV_32F, (WINDOW, WINDOW))
    return float(math.sqrt(max(float(np.median((square - mean * mean)[::4, ::4])), 0.0)))


def colour_dispersion(image: Array) -> tuple[float, float]:
    r"""Return the dispersion coefficients of hue and saturation in HSV.

    Hue is an angle, so its dispersion is the circular variance ``1 − |Σ w e^{iH}| / Σ w`` (Fisher 1993, Statistical
    Analysis of Circular Data, section 2.3), each pixel weighted by its chroma w = S·V, because grey pixels have no
    hue. Saturation has the coefficient of variation ``σ_S / μ_S``. A regular sample of about `COLOUR_PIXELS` pixels is taken.

    Parameters
    ----------
    image : uint8 (h, w) or (h, w, 3) RGB
    """
    if image.ndim == 2:
        return 0.0, 0.0
    step = max(1, int(math.sqrt(image.shape[0] * image.shape[1] / COLOUR_PIXELS)))
    sample = np.ascontiguousarray(image[::step, ::step])
    hue, saturation, value = cv2.split(cv2.cvtColor(sample, cv2.COLOR_RGB2HSV_FULL))
    weight = np.bincount(
        hue.ravel(), weights=cv2.multiply(saturation, value, scale=1 / 255).ravel(), minlength=256
    )
    total = float(weight.sum())
    angle = np.arange(256) * (2.0 * np.pi / 256.0)
    circular = 1.0 - abs(np.sum(weight * np.exp(1j * angle))) / total if total > 0 else 0.0
    mean, std = (float(x[0, 0]) for x in cv2.meanStdDev(saturation))
    return float(circular), std / mean if mean > 0 else 0.0


def blur_by_reblurring(grey: Array) -> tuple[float, float, float]:
    """Return blur, motion and the direction of motion by blurring the photo once more.

    A sharp photo loses much of its variation between neighbours when it is blurred along a direction, a blurred one
    little (Crete et al. 2007, The blur effect): ``1 − Σ max(0, D − D') / Σ D`` with the differences D before and D'
    after. Taken along the rows, the columns and both diagonals; the mean over the directions is the blur. The
    sharpest tile of each row of tiles counts, so that the depth of field and empty sky do not make a photo blurred.

    Parameters
    ----------
    grey : uint8 (h, w)
        In full resolution.
    """
    measured = np.array([_directional_blur(tile) for tile in _tiles(grey)])
    order = np.argsort(measured.mean(axis=1))
    sharpest = measured[order[: max(1, len(order) // TILES)]].mean(axis=0)
    worst = int(sharpest.argmax())
    motion = float(sharpest[worst] - sharpest[(worst + 2) % 4])
    return float(sharpest.mean()), motion, worst * math.pi / 4.0


def _directional_blur(tile: Array) -> tuple[float, float, float, float]:
    """Blur along 0°, 45°, 90°, 135° (from x towards y); 1 where nothing varies."""
    values = tile.astype(np.float32)
    found = []
    for dx, dy in ((1, 0), (1, 1), (0, 1), (-1, 1)):
        line = np.zeros((REBLUR, REBLUR), np.float32)
        for k in range(REBLUR):
            offset = k - REBLUR // 2
            line[REBLUR // 2 + dy * offset, REBLUR // 2 + dx * offset] = 1.0 / REBLUR
        before, after = (_difference(x, dx, dy) for x in (values, cv2.filter2D(values, -1, line)))
        total = float(before.sum())
        found.append(1.0 - float(np.maximum(before - after, 0.0).sum()) / total if total > 0 else 1.0)
    return found[0], found[1], found[2], found[3]


def _difference(values: Array, dx: int, dy: int) -> Array:
    height, width = values.shape
    shifted = values[dy:, max(dx, 0) : width + min(dx, 0)]
    still = values[: height - dy, max(-dx, 0) : width - max(dx, 0)]
    return np.abs(shifted - still)


def noise_level(grey: Array) -> float:
    """Return the standard deviation of the noise in grey levels, in full resolution.

    Immerkær 1996, Fast noise variance estimation: the photo is convolved with a mask that structure of first and
    second degree does not pass, whose standard deviation is 6 σ. The median absolute value of the quietest third of
    the tiles is taken instead of the mean, so that texture does not count.

    Parameters
    ----------
    grey : uint8 (h, w)
    """
    mask = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)
    levels = sorted(
        float(np.abs(cv2.filter2D(tile.astype(np.float32), -1, mask)).mean()) * math.sqrt(math.pi / 2) / 6.0
        for tile in _tiles(grey)
    )
    return float(np.median(levels[: max(1, len(levels) // TILES)]))


def exposure(grey: Array) -> tuple[float, float, float]:
    """Return the shares of black (0) and white (255) pixels and the mean grey value."""
    histogram = np.bincount(grey.ravel(), minlength=256)
    return float(histogram[0] / grey.size), float(histogram[255] / grey.size), float(grey.mean())


def fingerprint(grey: Array) -> Array:
    """Return the photo reduced to 32 × 32 without its mean and of norm 1, float32 (1024,)."""
    small = (
        cv2.resize(grey, (PRINT_SIDE, PRINT_SIDE), interpolation=cv2.INTER_AREA).astype(np.float32).ravel()
    )
    small -= small.mean()
    norm = float(np.linalg.norm(small))
    return small / norm if norm > PRINT_SIDE / 2 else np.zeros_like(small)


def _tiles(grey: Array) -> list[Array]:
    """Tiles spread over the photo; the whole photo where it is small."""
    height, width = grey.shape
    rows, columns = (np.linspace(0, max(0, n - TILE), TILES).astype(int) for n in (height, width))
    places = {(int(r), int(c)) for r in rows for c in columns}
    return [grey[r : r + TILE, c : c + TILE] for r, c in sorted(places)]
