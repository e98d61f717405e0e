"""A picture of a few colours, every way to grey, and what each keeps: all by the engine."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.preprocessing.decolorization import START, DecolorParams, cielab, decolor, fit_weights
from graphos_core.preprocessing.decolorization_quality import DecolorizationQuality, decolorization_quality
from graphos_core.preprocessing.grey import GreyParams, grey, luma
from graphos_core.preprocessing.kernels import polynomial_grey
from graphos_core.preprocessing.lightness import LightnessParams, lightness
from graphos_core.preprocessing.principal_component import PrincipalComponentParams, principal
from graphos_core.run import Run
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.kept_results import KeptResults
from graphos_didactic.simulators.pictured_plane import photo_or_simulated, rgb
from graphos_didactic.simulators.preprocessing.decolorization_params import DecolorizationParams

WIDTH, HEIGHT = 192, 144
"""Size of the simulated pictures, px; the longer side of a photo is `WIDTH`."""
PAIRS = 4000
"""Pairs of pixels for the quality: a ratio is known to about ± 0.01."""
HUES, LIGHTS = np.arange(0.0, 361.0, 4.0), np.arange(90.0, 19.5, -1.0)
"""Columns and rows of the plane of colours."""
WHEEL_LIGHT = 62.0
METHODS = ("luma", "lightness", "red", "green", "blue", "principal", "decolor")
LABELS = {
    "luma": "Luma", "lightness": "Lightness", "red": "Red channel", "green": "Green channel", "blue": "Blue channel",
    "principal": "Principal component", "decolor": "Contrast preserving",
}  # fmt: skip
TURNS = (0, 1, 2, 4, 8, 15)
"""Iterations after which the greys of the colours are looked at."""

_kept = KeptResults(most=3)
_run = Run(threads=1)


@dataclass(frozen=True, eq=False)
class Decolorized:
    """What the engine makes of the picture of a parameter sheet."""

    params: DecolorizationParams
    setting: Setting

    @property
    def names(self) -> str:
        """The colours that the picture has."""
        return {"two": "AB", "three": "ABC", "wheel": "ABCDEFGHIJKL", "photo": "ABC"}[self.params.picture]

    @cached_property
    def picture(self) -> Array:
        """The picture, uint8 (h, w, 3) RGB."""
        p = self.params
        if p.picture == "photo":
            photo = photo_or_simulated(self.setting)[0]
            made: Array = _kept.get("photo", (photo,), lambda: _small(photo))
            return made
        colours = (p.a_hue, p.a_light, p.b_hue, p.b_light, p.c_hue, p.c_light, p.chroma, p.noise)
        drawn: Array = _kept.get("drawn", (p.picture, *colours), lambda: _drawn(p))
        return drawn

    def grey(self, method: str) -> Array:
        """Return one way to grey, uint8 (h, w)."""
        key = (self.picture, self.params.engine if method == "decolor" else None)
        made: Array = _kept.get(
            f"grey {method}", key, lambda: _greyed(self.picture, method, self.params.engine)
        )
        return made

    def quality(self, method: str) -> DecolorizationQuality:
        """Return how much colour contrast one way to grey keeps."""
        image = self.grey(method)
        made: DecolorizationQuality = _kept.get(
            f"quality {method}",
            (self.picture, image),
            lambda: decolorization_quality(self.picture, image, pairs=PAIRS),
        )
        return made

    def ccpr(self, method: str) -> float:
        """Return the mean of the colour contrast preserving ratio, 0 to 1."""
        if method not in self._ccpr:
            self._ccpr[method] = self.quality(method).means()[0]
        return self._ccpr[method]

    @cached_property
    def _ccpr(self) -> dict[str, float]:
        return {}

    def weights(self, iterations: int) -> Array:
        """Return the nine weights after some iterations, float64 (9,)."""
        if iterations == 0:
            return START
        params = self.params.engine.replace(iterations=iterations)
        made: Array = _kept.get(
            f"weights {iterations}",
            (self.picture, params),
            lambda: fit_weights(self.picture, params, _run).copy(),
        )
        return made

    def polynomial(self, iterations: int) -> Array:
        """Return the polynomial after some iterations, not stretched, float32 (h, w), 0 to 1 at the start."""
        return np.asarray(polynomial_grey(self.picture, self.weights(iterations).astype(np.float32)))

    @cached_property
    def history(self) -> tuple[Array, Array]:
        """Iterations (m,) and greys of the colours after them (m, colours), not stretched, 0 to 100."""
        turns = [turn for turn in TURNS if turn < self.params.iterations] + [self.params.iterations]
        colours = np.ascontiguousarray(np.rint(self.colours)[None].astype(np.uint8))
        greys = [100.0 * polynomial_grey(colours, self.weights(t).astype(np.float32))[0] for t in turns]
        return np.array(turns, dtype=float), np.array(greys)

    @cached_property
    def regions(self) -> tuple[tuple[slice, slice], ...]:
        """Where each colour is plain in the picture, rows and columns."""
        rows, columns = self.picture.shape[:2]
        if self.params.picture == "wheel":
            return tuple(_sector(i) for i in range(len(self.names)))
        if self.params.picture != "photo":
            return tuple(REGIONS[name] for name in self.names)
        found = []
        for name in self.names.lower():
            x = round(getattr(self.params, f"{name}_x") / 100 * (columns - 1))
            y = round(getattr(self.params, f"{name}_y") / 100 * (rows - 1))
            found.append((slice(max(y - 2, 0), y + 3), slice(max(x - 2, 0), x + 3)))
        return tuple(found)

    @cached_property
    def colours(self) -> Array:
        """Mean colours of the regions, float64 (n, 3) RGB 0 to 255."""
        cut = [self.picture[region].reshape(-1, 3).mean(axis=0) for region in self.regions]
        return np.array(cut).reshape(-1, 3)

    @cached_property
    def on_plane(self) -> Array:
        """Hue in degrees and lightness of the colours, float64 (n, 2)."""
        lab = (
            cielab(np.rint(self.colours)[None].astype(np.uint8))[0] if len(self.colours) else np.empty((0, 3))
        )
        return np.stack([np.degrees(np.arctan2(lab[:, 2], lab[:, 1])) % 360.0, lab[:, 0]], axis=1).astype(
            float
        )

    @cached_property
    def pairs(self) -> list[tuple[str, float]]:
        """Pairs of colours and their CIELAB difference, units of L."""
        lab = cielab(self.picture)
        means = [lab[region].reshape(-1, 3).mean(axis=0) for region in self.regions]
        return [
            (self.names[j] + self.names[i], float(np.linalg.norm(means[i] - means[j])))
            for i in range(len(means)) for j in range(i)
        ]  # fmt: skip

    def kept(self, method: str) -> list[float]:
        """Return the grey difference of every pair, scaled to 0 … 100 as L is."""
        image = self.grey(method)
        means = [100.0 / 255.0 * float(image[region].mean()) for region in self.regions]
        return [abs(means[i] - means[j]) for i in range(len(means)) for j in range(i)]

    def lost(self, method: str) -> int:
        """Return how many pairs keep less than half of their difference."""
        return sum(kept < 0.5 * delta for kept, (_, delta) in zip(self.kept(method), self.pairs, strict=True))

    @cached_property
    def best(self) -> str:
        """The way to grey with the largest CCPR."""
        return max(METHODS, key=self.ccpr)


def colours_at(hue: Array, light: Array, chroma: float) -> Array:
    """Return sRGB colours of hue (degrees) and lightness, float32 (…, 3), 0 to 1; cut to what a screen can show."""
    angle = np.radians(hue)
    lab = np.stack(np.broadcast_arrays(light, chroma * np.cos(angle), chroma * np.sin(angle)), axis=-1)
    flat = lab.astype(np.float32).reshape(-1, 1, 3)
    return np.clip(cv2.cvtColor(flat, cv2.COLOR_LAB2RGB), 0.0, 1.0).reshape(lab.shape)


@lru_cache(maxsize=4)
def plane(chroma: float) -> Array:
    """Return the plane of colours, hue from left to right, lightness upwards, uint8 (rows, columns, 3)."""
    made = np.rint(255.0 * colours_at(HUES[None, :], LIGHTS[:, None], chroma)).astype(np.uint8)
    made.flags.writeable = False
    return made


def same_luma(hue: Array, level: float, chroma: float) -> Array:
    """Return the lightness at which colours of these hues have a luma of `level` (0 to 255), NaN outside."""
    lights = LIGHTS[::-1]
    values = 255.0 * luma(colours_at(hue[None, :], lights[:, None], chroma))
    found = [np.interp(level, column, lights, left=np.nan, right=np.nan) for column in values.T]
    return np.array(found)


def luma_of(hue: float, light: float, chroma: float) -> float:
    """Return the luma of one colour, 0 to 255."""
    return float(255.0 * luma(colours_at(np.array([[hue]]), np.array([[light]]), chroma))[0, 0])


def _greyed(picture: Array, method: str, params: DecolorParams) -> Array:
    if method == "decolor":
        return decolor(picture, params, run=_run)
    if method == "lightness":
        return lightness(picture, LightnessParams(), run=_run)
    if method == "principal":
        return principal(picture, PrincipalComponentParams(), run=_run)
    return grey(picture, GreyParams(weights=method), run=_run)  # type: ignore[arg-type]


def _small(photo: Array) -> Array:
    factor = WIDTH / max(photo.shape[:2])
    size = (max(16, round(photo.shape[1] * factor)), max(16, round(photo.shape[0] * factor)))
    return rgb(cv2.resize(photo, size, interpolation=cv2.INTER_AREA))


REGIONS = {
    "A": (slice(4, 24), slice(4, 40)), "B": (slice(50, 80), slice(35, 65)), "C": (slice(44, 70), slice(146, 164)),
}  # fmt: skip
"""Where the colours of the simulated pictures are plain: rows and columns."""


def _sector(i: int) -> tuple[slice, slice]:
    """Return rows and columns of the middle of sector i of the wheel of hues."""
    angle = np.radians(30.0 * i + 15.0)
    row, column = round(HEIGHT / 2 - 42 * np.sin(angle)), round(WIDTH / 2 + 42 * np.cos(angle))
    return slice(row - 3, row + 4), slice(column - 3, column + 4)


def _drawn(p: DecolorizationParams) -> Array:
    """Draw a disc and stripes of colour B on A, with a square and stripes of C; or a wheel of all hues."""
    noise = np.random.default_rng(0).normal(size=(HEIGHT, WIDTH, 3)) * p.noise
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float64)
    if p.picture == "wheel":
        hue = np.degrees(np.arctan2(HEIGHT / 2 - y, x - WIDTH / 2)) % 360.0
        ring = np.hypot(x - WIDTH / 2, y - HEIGHT / 2)
        part = np.clip((ring - 8.0) / 4.0, 0.0, 1.0) * np.clip((66.0 - ring) / 3.0, 0.0, 1.0)
        made = 255.0 * colours_at(np.floor(hue / 30.0) * 30.0, np.full_like(hue, WHEEL_LIGHT), p.chroma)
        plain = 255.0 * colours_at(np.zeros(1), np.full(1, WHEEL_LIGHT), 0.0)[0]
        made = plain + part[..., None] * (made - plain)
    else:
        index = np.zeros((HEIGHT, WIDTH), np.intp)
        index[np.hypot(x - 50, y - 65) < 30] = 1
        for left, width in ((90, 8), (106, 5), (117, 3), (124, 2), (129, 1)):
            index[20:124, left : left + width] = 1
        index[118:126, 20:80] = 1
        if p.picture == "three":
            index[36:78, 142:170] = 2
            for top, height in ((92, 8), (106, 4), (115, 2)):
                index[top : top + height, 140:180] = 2
        hues, lights = np.array([p.a_hue, p.b_hue, p.c_hue]), np.array([p.a_light, p.b_light, p.c_light])
        made = 255.0 * colours_at(hues, lights, p.chroma)[index]
    return np.clip(np.rint(made + noise), 0, 255).astype(np.uint8)
