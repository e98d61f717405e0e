r"""Scale space: a photo blurred by Gaussians of growing width, octave by octave, and their differences.

Source: Lowe 2004, Distinctive image features from scale-invariant keypoints, section 3. The choices that the paper
leaves open (rounding of sizes, ends of the blur) are those of OpenCV's SIFT with precise enlargement, against which the
tests compare.
"""

from __future__ import annotations

import math

import cv2
import numpy as np

from graphos_core.data.record import Array, record

CAMERA_BLUR = 0.5
"""Blur that a sharp photo is assumed to have, px (Lowe 2004, section 3.3)."""

FIRST_PIXEL = 0.5
"""Size of a pixel of the first octave, px of the photo: the photo is enlarged twice before the first blur."""


@record
class ScaleSpace:
    r"""Octaves of blurred images; those of octave o have pixels of ``2**(o − 1)`` px of the photo.

    Attributes
    ----------
    gaussians : tuple of float32 (layers + 3, h_o, w_o)
        Grey 0 to 255; layer i is blurred by ``σ₀ 2**(i / layers)`` px of its octave.
    differences : tuple of float32 (layers + 2, h_o, w_o)
        Layer i is ``L(i + 1) − L(i)``: the difference of Gaussians, written at the narrower one.
    layers : int
        Layers per octave n.
    sigma : float
        σ₀, px of the first octave.
    """

    gaussians: tuple[Array, ...]
    differences: tuple[Array, ...]
    layers: int
    sigma: float

    def pixel(self, octave: int) -> float:
        """Size of a pixel of an octave, px of the photo."""
        return FIRST_PIXEL * 2.0**octave

    def blur(self, octave: int, layer: float) -> float:
        """Blur of a layer, also between two, px of the photo: ``σ₀ 2**(o + i/n)`` times the first pixel."""
        return FIRST_PIXEL * self.sigma * 2.0 ** (octave + layer / self.layers)


def scale_space(
    grey: Array, *, layers: int = 3, sigma: float = 1.6, octaves: int | None = None
) -> ScaleSpace:
    """Return the scale space of a photo.

    Parameters
    ----------
    grey : uint8 or float32 (h, w)
        Grey 0 to 255.
    layers : int
        Layers per octave.
    sigma : float
        Blur of the first layer, px of the photo enlarged twice.
    octaves : int, optional
        At most so many; without it until an octave is about 4 px wide.

    Returns
    -------
    ScaleSpace
    """
    base = first_image(grey, sigma)
    possible = most_octaves(*grey.shape)
    count = possible if octaves is None else max(1, min(octaves, possible))
    gaussians: list[Array] = []
    for octave in range(count):
        if octave:
            base = halved(gaussians[-1][layers])
        gaussians.append(blurred_layers(base, layers, sigma, layers + 2))
    differences = tuple(g[1:] - g[:-1] for g in gaussians)
    return ScaleSpace(gaussians=tuple(gaussians), differences=differences, layers=layers, sigma=sigma)


def most_octaves(height: int, width: int) -> int:
    """Return how many octaves a photo has: the last one is about 4 px high or wide."""
    return max(1, round(math.log2(max(min(height, width) / FIRST_PIXEL, 4.0))) - 1)


def first_image(grey: Array, sigma: float) -> Array:
    """Return the first layer: the photo enlarged twice so that pixel x lies at 2x, blurred up to `sigma`, float32.

    The enlarged photo already has twice `CAMERA_BLUR`: ``σ_d² = σ₀² − (2 · 0.5)²``.
    """
    height, width = grey.shape
    halve = np.array([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0]])
    large = cv2.warpAffine(
        grey.astype(np.float32), halve, (2 * width, 2 * height), borderMode=cv2.BORDER_REFLECT,
        flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
    )  # fmt: skip
    missing = math.sqrt(max(sigma**2 - (CAMERA_BLUR / FIRST_PIXEL) ** 2, 0.01))
    return np.asarray(cv2.GaussianBlur(large, (0, 0), missing))


def halved(image: Array) -> Array:
    """Return every second pixel of every second row: pixel x of the result lies at 2x."""
    height, width = image.shape
    return np.ascontiguousarray(image[: height // 2 * 2 : 2, : width // 2 * 2 : 2])


def blurred_layers(base: Array, layers: int, sigma: float, last: int) -> Array:
    """Return layers 0 to `last` of an octave, float32 (last + 1, h, w), each blurred from the one before."""
    made = np.empty((last + 1, *base.shape), np.float32)
    made[0] = base
    for i, step in enumerate(blur_steps(layers, sigma, last), start=1):
        cv2.GaussianBlur(made[i - 1], (0, 0), step, dst=made[i])
    return made


def blur_steps(layers: int, sigma: float, last: int) -> list[float]:
    """Return the blur that leads from each layer to the next, px of the octave: ``σ_i √(k² − 1)``, k = 2^(1/n)."""
    widths = sigma * 2.0 ** (np.arange(last + 1) / layers)
    return [float(step) for step in np.sqrt(widths[1:] ** 2 - widths[:-1] ** 2)]


def layer_of(blur: float, *, layers: int = 3, sigma: float = 1.6) -> tuple[int, int]:
    """Return octave and layer (1 to `layers`) whose blur is nearest, in ratio, to `blur` px of the photo.

    Smaller blurs than those of the first octave lead to its layer 0.
    """
    steps = round(layers * math.log2(max(blur, 1e-6) / (FIRST_PIXEL * sigma)))
    if steps < 1:
        return 0, 0
    return (steps - 1) // layers, (steps - 1) % layers + 1


def cut_layer(
    grey: Array,
    xy: tuple[float, float],
    reach: float,
    octave: int,
    layer: int,
    *,
    layers: int = 3,
    sigma: float = 1.6,
) -> tuple[Array, tuple[float, float]]:
    """Return one layer around a place, equal to the layer of the whole photo, without blurring the whole photo.

    Parameters
    ----------
    grey : uint8 or float32 (h, w)
    xy : tuple of float
        Place, px of the photo.
    reach : float
        So far from the place the layer is needed, px of the photo.
    octave, layer, layers, sigma
        Which layer of which scale space.

    Returns
    -------
    image : float32 (rows, columns)
        Part of the layer; at least `reach` around the place as far as the photo goes.
    at : tuple of float
        Column and row of the place in it, px of the octave.
    """
    height, width = grey.shape
    margin = reach + FIRST_PIXEL * _kernels_reach(octave, layer, layers, sigma) + 2.0 * 2.0**octave
    grid = 2**octave
    x0, y0 = (int(max(0.0, value - margin)) // grid * grid for value in xy)
    x1, y1 = (
        min(size, math.ceil(value + margin) + 1) for size, value in zip((width, height), xy, strict=True)
    )
    image = first_image(grey[min(y0, height - 1) : max(y1, 1), min(x0, width - 1) : max(x1, 1)], sigma)
    for _ in range(octave):
        image = halved(blurred_layers(image, layers, sigma, layers)[layers])
    image = blurred_layers(image, layers, sigma, layer)[layer]
    pixel = FIRST_PIXEL * 2.0**octave
    return image, ((xy[0] - x0) / pixel, (xy[1] - y0) / pixel)


def _kernels_reach(octave: int, layer: int, layers: int, sigma: float) -> float:
    """Half widths of all blurs up to a layer, added, px of the first octave; OpenCV ends a kernel at 4 σ."""
    whole = sum(4.0 * step + 1.0 for step in blur_steps(layers, sigma, layers))
    last = sum(4.0 * step + 1.0 for step in blur_steps(layers, sigma, layer)) if layer else 0.0
    return 4.0 * sigma + whole * (2**octave - 1) + last * 2**octave
