"""A picture, its scale space and its extrema: the engine's, kept while only the point is dragged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np

from graphos_core.data.record import Array
from graphos_core.features.detectors.scale_space import ScaleSpace, scale_space
from graphos_core.features.detectors.scale_space_extrema import (
    EDGE,
    GREY,
    KEPT,
    UNSTABLE,
    WEAK,
    Extrema,
    find_extrema,
    quadratic,
)
from graphos_core.preprocessing.grey import luma
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.features.scale_space_params import OCTAVES, ScaleSpaceParams
from graphos_didactic.simulators.kept_results import KeptResults
from graphos_didactic.simulators.pictured_plane import photo_or_simulated

WIDTH, HEIGHT = 256, 192
"""Size of the simulated pictures, px; the longer side of a photo."""
BLOB = (80.0, 96.0)
"""Middle of the blob whose size can be changed, px."""
OTHERS = (
    (168.0, 44.0, 2.0, 80.0),
    (212.0, 60.0, 4.0, -70.0),
    (196.0, 130.0, 9.0, 70.0),
    (150.0, 88.0, 3.0, 14.0),
)
"""Other blobs: x, y, standard deviation in px, grey levels."""
LEAST = 0.001
"""Extrema down to this response are examined, grey range 0 to 1: the engine alone looks at stronger ones only."""
WORDS = {KEPT: "keypoint", UNSTABLE: "fit does not rest", WEAK: "too weak", EDGE: "on an edge"}

_kept = KeptResults(most=3)


@dataclass(frozen=True, eq=False)
class Looked:
    """What the engine finds in the picture of a parameter sheet."""

    params: ScaleSpaceParams
    setting: Setting

    @cached_property
    def grey(self) -> Array:
        """The picture, float32 (h, w), grey 0 to 255."""
        p = self.params
        if p.picture == "photo":
            photo = photo_or_simulated(self.setting)[0]
            made: Array = _kept.get("photo", (photo,), lambda: _small(photo))
            return made
        key = (p.picture, p.size, p.stretch, p.strength, p.noise, p.seed)
        simulated: Array = _kept.get("picture", key, lambda: _simulated(p))
        return simulated

    @cached_property
    def space(self) -> ScaleSpace:
        """The engine's scale space."""
        p = self.params
        key = (self.grey, p.layers, p.sigma)
        made: ScaleSpace = _kept.get(
            "space", key, lambda: scale_space(self.grey, layers=p.layers, sigma=p.sigma, octaves=OCTAVES)
        )
        return made

    @cached_property
    def extrema(self) -> Extrema:
        """The engine's extrema with their verdicts."""
        p = self.params
        key = (self.grey, p.layers, p.sigma, p.contrast, p.edge)
        made: Extrema = _kept.get(
            "extrema", key, lambda: find_extrema(self.space, contrast=p.contrast, edge=p.edge, least=LEAST)
        )
        return made

    @property
    def strongest(self) -> float:
        """Response at which the colours of the differences end, grey range 0 to 1."""
        layers = [stack[1] for stack in self.space.differences[:4]]
        made: float = self.kept(
            "strongest", None,
            lambda: max(0.01, *(float(np.percentile(np.abs(layer), 99.7)) / GREY for layer in layers)),
        )  # fmt: skip
        return made

    def kept(self, kind: str, more: Any, make: Callable[[], Any]) -> Any:
        """Return what is made of the scale space, from what was kept if it is the same one."""
        return _kept.get(kind, (self.grey, self.params.layers, self.params.sigma, more), make)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.grey.shape[0], self.grey.shape[1]

    @property
    def octaves(self) -> int:
        """How many octaves the picture has."""
        return len(self.space.gaussians)

    @property
    def octave(self) -> int:
        """Octave looked at."""
        return (self._level - 1) // self.params.layers

    @property
    def layer(self) -> int:
        """Layer looked at, 1 to n."""
        return (self._level - 1) % self.params.layers + 1

    @property
    def _level(self) -> int:
        return min(self.params.level, self.octaves * self.params.layers)

    @property
    def at(self) -> tuple[float, float]:
        """The point, px."""
        rows, columns = self.shape
        return self.params.x / 100 * (columns - 1), self.params.y / 100 * (rows - 1)

    @cached_property
    def response(self) -> Array:
        """Scale in octaves and D at the point for every layer 1 to n of every octave, float64 (octaves n, 2)."""
        rows = []
        for octave, stack in enumerate(self.space.differences):
            values = _bilinear(stack, np.array(self.at) / self.space.pixel(octave)) / GREY
            rows += [(octave + i / self.params.layers, values[i]) for i in range(1, self.params.layers + 1)]
        return np.array(rows)

    @cached_property
    def chosen(self) -> int | None:
        """The extremum at the point: the strongest one within reach of its own size."""
        found = self.extrema
        distance = np.hypot(*(found.xy - self.at).T)
        near = np.flatnonzero(distance <= np.maximum(4.0, 0.3 * found.diameter))
        return int(near[np.abs(found.sample[near]).argmax()]) if len(near) else None

    def scale_of(self, i: int) -> float:
        """Fitted scale of an extremum in octaves."""
        found = self.extrema
        return float(found.octave[i] + (found.layer[i] + found.offset[i, 2]) / self.params.layers)

    def parabola(self, i: int) -> Array:
        """Scale in octaves and value of the fitted quadratic along the scale through an extremum's fit, (m, 2)."""
        found, n = self.extrema, self.params.layers
        stack = self.space.differences[int(found.octave[i])]
        at = [np.array([getattr(found, name)[i]]) for name in ("layer", "row", "column")]
        value, gradient, hessian = quadratic(stack, *at)
        steps = np.linspace(-1.2, 1.2, 25)
        places = np.tile(found.offset[i], (len(steps), 1))
        places[:, 2] = steps
        values = value + places @ gradient[0] + 0.5 * np.einsum("ni,ij,nj->n", places, hessian[0], places)
        return np.column_stack([found.octave[i] + (found.layer[i] + steps) / n, values])

    def neighbour(self, i: int) -> float:
        """Return the one of the 26 neighbours of an extremum's sample that comes nearest to it, grey range 0 to 1."""
        found = self.extrema
        k, r, c = (int(getattr(found, name)[i]) for name in ("layer", "row", "column"))
        cube = self.space.differences[int(found.octave[i])][k - 1 : k + 2, r - 1 : r + 2, c - 1 : c + 2]
        others = np.delete(cube.ravel(), 13) / GREY
        return float(others.max() if cube[1, 1, 1] > 0 else others.min())

    def found_size(self, i: int) -> float:
        """Return the standard deviation of the blob that an extremum belongs to, px: ``σ̂ √k``.

        A blob of deviation s has the strongest difference of blurs σ and kσ where ``σ · kσ = s²``.
        """
        return float(self.extrema.diameter[i] / 2 * 2.0 ** (0.5 / self.params.layers))

    @cached_property
    def repeated(self) -> float:
        """Share of the keypoints that the same picture with other noise has within 1.5 px and at a similar scale."""
        p = self.params.replace(seed=(self.params.seed + 1) % 9999)
        mine, other = (
            np.column_stack([seen.extrema.xy, 4.0 * np.log2(seen.extrema.diameter)])[
                seen.extrema.verdict == KEPT
            ]
            for seen in (self, Looked(p, self.setting))
        )  # 1.5 units: 1.5 px, or a scale 1.3 times as large
        if not len(mine) or not len(other):
            return 0.0
        distance = np.linalg.norm(mine[:, None] - other[None], axis=2)
        return float(np.mean(distance.min(axis=1) < 1.5))

    @property
    def on_blob(self) -> bool:
        """Whether the point is on the blob of known size."""
        distance = np.hypot(self.at[0] - BLOB[0], self.at[1] - BLOB[1])
        return self.params.picture == "blobs" and bool(distance < max(6.0, self.params.size))


def blob_scale(size: float, layers: int, sigma: float) -> float:
    """Return where on the scale, in octaves, a blob of standard deviation `size` px has its extremum."""
    unit = ScaleSpace(gaussians=(), differences=(), layers=layers, sigma=sigma)
    return float(np.log2(size / 2.0 ** (0.5 / layers) / unit.blur(0, 0.0)))


def _small(photo: Array) -> Array:
    grey = luma(photo)
    factor = WIDTH / max(grey.shape)
    size = (max(16, round(grey.shape[1] * factor)), max(16, round(grey.shape[0] * factor)))
    return np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA)).astype(np.float32)


def _simulated(p: ScaleSpaceParams) -> Array:
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype(np.float64)
    grey = np.full((HEIGHT, WIDTH), 110.0)
    if p.picture == "edges":
        grey += p.strength * ((x > 80) & (x < 190)) / 1.5 - 40.0 * (y - 0.35 * x > 80)
        grey = cv2.GaussianBlur(grey, (0, 0), 0.7)
    else:
        long = p.size * p.stretch
        turned = np.radians(35.0)
        u, v = x - BLOB[0], y - BLOB[1]
        u, v = u * np.cos(turned) + v * np.sin(turned), v * np.cos(turned) - u * np.sin(turned)
        grey += p.strength * np.exp(-0.5 * ((u / long) ** 2 + (v / p.size) ** 2))
        for column, row, size, level in OTHERS:
            grey += level * np.exp(-0.5 * ((x - column) ** 2 + (y - row) ** 2) / size**2)
    grey += p.noise * np.random.default_rng(p.seed).normal(size=grey.shape)
    return np.clip(grey, 0.0, 255.0).astype(np.float32)


def _bilinear(stack: Array, at: Array) -> Array:
    """Return the values of a stack (k, h, w) at (column, row), float64 (k,)."""
    column, row = np.clip(at, 0.0, (stack.shape[2] - 1.001, stack.shape[1] - 1.001))
    c, r = int(column), int(row)
    u, v = column - c, row - r
    cut = stack[:, r : r + 2, c : c + 2].astype(np.float64)
    return np.asarray(np.einsum("kij,i,j->k", cut, [1 - v, v], [1 - u, u]))
