"""What the radiometric stretch does when nobody says: chosen from the photo's own noise and dynamics."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.data import Array, record
from graphos_core.preprocessing.kernels import statistics_rows
from graphos_core.preprocessing.noise import noise_level
from graphos_core.preprocessing.wallis import mirrored
from graphos_core.text import Text

WINDOW = 11
"""Window of the local contrast, px: about the size of the smallest keypoints' descriptors."""

WEAK = 40.0
"""A photo is equalised locally when half of its windows have a standard deviation below so many grey levels of 255;
far above what photos of one set differ by, so that they are treated alike."""

TARGET = 60.0
"""Standard deviation that windows are pulled towards, grey levels."""

NOISE_LIMIT = 12.0
"""Lifted noise may have this standard deviation, grey levels: a fifth of the target."""

LARGEST_BLUR = 1.4
"""The strongest: above it more is lost of texture than of noise (measured, see the lesson)."""


@record
class StretchChoice:
    """What the stretch does with a photo, and the figures behind it.

    Attributes
    ----------
    low, high : float
        Values that become 0 and 255, in the unit of the photo.
    noise : float
        Standard deviation of the noise, grey levels after the stretch.
    texture : float
        Median of the local standard deviations, noise taken off, grey levels after the stretch.
    blur : float
        Standard deviation of the smoothing, px; 0 for none.
    window : int
        Side of the local equalisation, px; 0 for none.
    gain : float
        Largest gain of the local equalisation.
    reason : str
        In sentences.
    """

    low: float
    high: float
    noise: float
    texture: float
    blur: float
    window: int
    gain: float
    reason: str


@dataclass(frozen=True)
class Wishes:
    """What the person decided; None is automatic."""

    clip: float
    local: bool | None
    smooth: bool | None
    window: int | None


def choose_stretch(band: Array, wishes: Wishes) -> StretchChoice:
    """Measure one band and choose stretch, smoothing and local equalisation.

    Locally equalised is what has weak texture (`WEAK`): there a few hot or cold places take most of the grey range.
    The gain that would bring the typical texture to `TARGET` lifts the noise as well; when that exceeds
    `NOISE_LIMIT`, the photo is smoothed by the Gaussian that brings it down, and the gain is limited to what the noise
    then allows. Blur and gain change steadily with the measured figures: two photos that are nearly alike are treated
    nearly alike, else their keypoints would not match.

    Parameters
    ----------
    band : uint8 or uint16 (h, w)
    wishes : Wishes

    Returns
    -------
    StretchChoice
    """
    values = np.sort(band[:: max(1, band.shape[0] // 1000), :: max(1, band.shape[1] // 1000)], axis=None)
    low, high = (float(v) for v in np.percentile(values, (wishes.clip, 100.0 - wishes.clip)))
    if high <= low:
        low, high = float(values[0]), float(values[-1])
    if high <= low:
        return _flat(low)
    scale = 255.0 / (high - low)
    # rounding to whole values is noise as well: 1/√12 of a step
    noise = scale * max(noise_level(band), 1.0 / math.sqrt(12.0))
    texture = math.sqrt(max(scale**2 * typical_variance(band) - noise**2, 0.0))
    local = texture < WEAK if wishes.local is None else wishes.local
    window = (wishes.window or WINDOW) if local else 0
    wanted = TARGET / max(texture, 1.0) if local else 1.0
    lifted = noise * wanted
    smooth = lifted > NOISE_LIMIT if wishes.smooth is None else wishes.smooth
    blur = needed_blur(NOISE_LIMIT / lifted if lifted > NOISE_LIMIT else 0.5) if smooth else 0.0
    left = noise * remaining_noise(blur)
    gain = max(NOISE_LIMIT / left, 1.0)
    return StretchChoice(
        low=low,
        high=high,
        noise=noise,
        texture=texture,
        blur=blur,
        window=window,
        gain=gain,
        reason=_reason(noise, texture, blur, window, gain),
    )


def typical_variance(band: Array) -> float:
    """Return the median of the variances of the windows of a band, in its unit squared."""
    band = np.ascontiguousarray(band)
    rows, columns = mirrored(band.shape, WINDOW)
    _, variance = statistics_rows(band, rows, columns, np.float32(0.0), np.float32(1.0))
    return float(np.median(variance[:: max(1, band.shape[0] // 500), :: max(1, band.shape[1] // 500)]))


def remaining_noise(blur: float) -> float:
    """Return the share of the standard deviation of white noise that a Gaussian of σ = `blur` px leaves."""
    if blur <= 0:
        return 1.0
    weights = cv2.getGaussianKernel(2 * math.ceil(4.0 * blur) + 1, blur)[:, 0]
    return float((weights**2).sum())


def needed_blur(share: float) -> float:
    """Return the σ, px, of the Gaussian that leaves a share of the noise, at most `LARGEST_BLUR`; by bisection."""
    if remaining_noise(LARGEST_BLUR) >= share:
        return LARGEST_BLUR
    low, high = 0.0, LARGEST_BLUR
    for _ in range(20):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if remaining_noise(middle) < share else (middle, high)
    return 0.5 * (low + high)


def _flat(value: float) -> StretchChoice:
    reason = Text("All pixels have the same value: there is nothing to stretch.")
    return StretchChoice(
        low=value, high=value, noise=0.0, texture=0.0, blur=0.0, window=0, gain=1.0, reason=reason
    )


def _reason(noise: float, texture: float, blur: float, window: int, gain: float) -> str:
    if not window:
        text = "Its texture ({texture:.1f} grey levels in a typical window) is strong enough as it is"
    else:
        text = (
            "Its texture is weak ({texture:.1f} grey levels in a typical window): a few extreme places take most of "
            "the range, so windows of {window} px are equalised, by at most {gain:.0f} times"
        )
    text += "; noise {noise:.2f} grey levels"
    text += ", smoothed by {blur:.1f} px before." if blur else "."
    return Text(text, noise=noise, texture=texture, blur=blur, window=window, gain=gain)
