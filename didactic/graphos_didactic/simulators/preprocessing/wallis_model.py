"""A photo, a shadow on it and a window: the parameters, and what the engine's filter makes of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Annotated, Literal

import numpy as np

from graphos_core.data.record import Array
from graphos_core.params import About, Params
from graphos_core.preprocessing.kernels import wallis_value
from graphos_core.preprocessing.wallis import WallisParams, local_statistics, wallis
from graphos_core.run import Run
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.kept_results import KeptResults
from graphos_didactic.simulators.pictured_plane import photo_or_simulated, rgb

LESSON = "preprocessing/wallis"
FLAT_SIZE = (360, 480)
"""Rows and columns of the picture without texture."""
FLAT_LEVEL, FLAT_NOISE = 150.0, 2.0
"""Its grey level and the standard deviation of its sensor noise."""
_ENGINE = WallisParams.declarations()


class WallisSimulatorParams(Params):
    """The filter's own parameters, the place of the window and the shadow."""

    target_mean: Annotated[float, _ENGINE["target_mean"].about] = _ENGINE["target_mean"].default
    target_std: Annotated[float, _ENGINE["target_std"].about] = _ENGINE["target_std"].default
    window: Annotated[
        int,
        About(
            label="Window",
            symbol="w",
            unit="px",
            low=3,
            high=151,
            step=2,
            learn=LESSON,
            level="novice",
            help=_ENGINE["window"].about.help,
            effect=_ENGINE["window"].about.effect,
        ),
    ] = 61
    contrast: Annotated[float, _ENGINE["contrast"].about] = _ENGINE["contrast"].default
    brightness: Annotated[float, _ENGINE["brightness"].about] = _ENGINE["brightness"].default
    x: Annotated[
        float,
        About(
            label="Window, across",
            unit="%",
            low=0,
            high=100,
            step=1,
            level="expert",
            group="Place",
            help="Where the window is, in parts of the picture's width.",
            effect="Higher: more to the right.",
        ),
    ] = 68.0
    y: Annotated[
        float,
        About(
            label="Window, down",
            unit="%",
            low=0,
            high=100,
            step=1,
            level="expert",
            group="Place",
            help="Where the window is, in parts of the picture's height.",
            effect="Higher: further down.",
        ),
    ] = 42.0
    shadow: Annotated[
        float,
        About(
            label="Shadow",
            unit="%",
            low=0,
            high=90,
            step=5,
            group="Shadow",
            help="How much light an artificial shadow takes away; without it the picture is the truth.",
            effect="Higher: darker on the right.",
            learn=LESSON,
        ),
    ] = 60.0
    shadow_x: Annotated[
        float,
        About(
            label="Shadow begins",
            unit="%",
            low=0,
            high=100,
            step=1,
            level="expert",
            group="Shadow",
            help="Where the shadow begins, in parts of the picture's width.",
            effect="Higher: a smaller part lies in shadow.",
        ),
    ] = 55.0
    picture: Annotated[Literal["photo", "flat"], About(
        label="Picture", group="Shadow", choices={"photo": "photo", "flat": "no texture"},
        help="A photo of the open project (else of the simulated block), or a surface without texture.",
        effect="No texture: the filter has nothing but noise to lift.")] = "photo"  # fmt: skip

    @property
    def engine(self) -> WallisParams:
        """The engine's own parameter sheet."""
        return WallisParams(
            target_mean=self.target_mean,
            target_std=self.target_std,
            window=self.window,
            contrast=self.contrast,
            brightness=self.brightness,
        )


@lru_cache(maxsize=4)
def _flat() -> Array:
    noise = np.random.default_rng(0).normal(size=FLAT_SIZE) * FLAT_NOISE
    return rgb(np.clip(np.rint(FLAT_LEVEL + noise), 0, 255).astype(np.uint8))


_kept = KeptResults()


@dataclass(frozen=True, eq=False)
class Filtered:
    """The pictures of a parameter sheet."""

    params: WallisSimulatorParams
    setting: Setting

    @cached_property
    def truth(self) -> Array:
        """The picture without the artificial shadow, uint8 (h, w, 3)."""
        if self.params.picture == "flat":
            return _flat()
        photo = photo_or_simulated(self.setting)[0]
        made: Array = _kept.get("truth", (photo,), lambda: rgb(photo).copy())
        return made

    @cached_property
    def before(self) -> Array:
        """The picture in shadow from `shadow_x` on, with a soft edge, uint8 (h, w, 3)."""
        made: Array = _kept.get(
            "before", (self.truth, self.params.shadow, self.params.shadow_x), self._shaded
        )
        return made

    def _shaded(self) -> Array:
        width = self.truth.shape[1]
        into = np.clip((np.arange(width) - self.params.shadow_x / 100 * width) / (0.02 * width) + 0.5, 0, 1)
        light = (1.0 - self.params.shadow / 100 * into).astype(np.float32)
        return (self.truth * light[None, :, None]).astype(np.uint8)

    @cached_property
    def after(self) -> Array:
        """The engine's result, uint8 (h, w)."""
        return _filter(self.before, self.params.engine)

    @cached_property
    def ideal(self) -> Array:
        """The engine's result for the picture without shadow, uint8 (h, w)."""
        return _filter(self.truth, self.params.engine)

    @cached_property
    def statistics(self) -> tuple[Array, Array]:
        """The engine's local mean and standard deviation, float32 (h, w), grey levels."""
        key = (self.before, self.params.window)
        made: tuple[Array, Array] = _kept.get("statistics", key, lambda: local_statistics(*key))
        return made

    @cached_property
    def window_grey(self) -> Array:
        """Grey levels before the filter in the window, float32."""
        return grey_levels(self.cut(self.before))

    @cached_property
    def row_grey(self) -> Array:
        """Grey levels before the filter along the row of the window's centre, float32 (w,)."""
        row = self.centre[0]
        return grey_levels(self.before[row : row + 1])[0]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.truth.shape[0], self.truth.shape[1]

    @property
    def centre(self) -> tuple[int, int]:
        """Row and column of the window's centre."""
        rows, columns = self.shape
        row, column = round(self.params.y / 100 * (rows - 1)), round(self.params.x / 100 * (columns - 1))
        return row, column

    @property
    def half(self) -> int:
        """Pixels of the window beside its centre."""
        return self.params.window // 2

    @property
    def mean(self) -> float:
        """Mean in the window, grey levels."""
        return float(self.statistics[0][self.centre])

    @property
    def std(self) -> float:
        """Standard deviation in the window, grey levels."""
        return float(self.statistics[1][self.centre])

    def cut(self, image: Array) -> Array:
        """Return the part of an image that lies in the window, without what sticks out."""
        row, column = self.centre
        return image[
            max(0, row - self.half) : row + self.half + 1, max(0, column - self.half) : column + self.half + 1
        ]

    def value(self, grey: float) -> float:
        """Return what the engine makes of a grey value at the window's centre, before it is cut to 0 … 255."""
        return filtered_value(self.params, grey, self.mean, self.std)

    @property
    def gain(self) -> float:
        """Factor of the engine's straight line."""
        return self.value(1.0) - self.value(0.0)

    @property
    def cut_off(self) -> float:
        """Part of the pixels of the whole result that are 0 or 255, %."""
        return 100.0 * float(np.mean((self.after == 0) | (self.after == 255)))


def _filter(picture: Array, params: WallisParams) -> Array:
    made: Array = _kept.get("filter", (picture, params), lambda: wallis(picture, params, run=Run(threads=1)))
    return made


def grey_levels(image: Array) -> Array:
    """Return the grey levels on which the engine's filter works, float32 (h, w): means of windows of one pixel."""
    return local_statistics(np.ascontiguousarray(image), 1)[0]


def filtered_value(params: WallisSimulatorParams, grey: float, mean: float, std: float) -> float:
    """Return the engine's filter for one grey value in a window of given mean and standard deviation."""
    p = params
    targets = np.array([p.target_mean, p.target_std, p.contrast, p.brightness, 0.0, np.inf], dtype=np.float32)
    single = np.float32
    return float(wallis_value(single(grey), single(mean), single(std) * single(std), targets))
