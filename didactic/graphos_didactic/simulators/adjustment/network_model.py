"""A ring of photos above a field of targets: how well the engine can calibrate the camera from it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.cameras import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.data import Adjustment, Camera
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import look_at, matrix_from_vector
from graphos_core.simulation.model import NoiseParams, TheoreticalModel, theoretical_model
from graphos_core.simulation.objects import imported
from graphos_core.simulation.templates import Stations
from graphos_didactic.simulators.adjustment.network_params import NetworkParams
from graphos_didactic.simulators.adjustment.small_block import Equations, equations

WIDTH, HEIGHT, FOCAL_PX = 3000, 2400, 2400.0
CAMERA = Camera(
    model="brown", width=WIDTH, height=HEIGHT,
    values=np.array([FOCAL_PX, (WIDTH - 1) / 2 + 8.0, (HEIGHT - 1) / 2 - 6.0, -0.05, 0.01, 0, 0, 2e-4, -1e-4, 0, 0]),
)  # fmt: skip
TERMS = {
    "point": ("focal_px", "x0", "y0"),
    "radial": ("focal_px", "x0", "y0", "k1", "k2"),
    "decentring": ("focal_px", "x0", "y0", "k1", "k2", "p1", "p2"),
}
DISTANCE, RING = 5.0, 0.6
"""Of the cameras from where they look, and of these places from the middle of the field, m."""
COLUMNS, ROWS = 6, 5
KNOWN = (0, COLUMNS - 1, COLUMNS * (ROWS - 1))
"""Known targets: three corners."""
WORTHLESS = 0.5 * float(np.hypot(WIDTH, HEIGHT))
"""A parameter whose σ moves the photo's corner farther than this is not determined, px."""
_CORNER = ray_from_pixel(CAMERA, np.array([[WIDTH - 0.5, HEIGHT - 0.5]]))


def field(depth: float) -> Array:
    """Return the targets, float64 (30, 3), m."""
    x, y = np.meshgrid(np.linspace(-1.8, 1.8, COLUMNS), np.linspace(-1.4, 1.4, ROWS))
    k = np.arange(COLUMNS * ROWS)
    return np.stack([x.ravel(), y.ravel(), depth * ((7 * k) % 5) / 4.0], axis=1)


def ring(params: NetworkParams, photos: int) -> Stations:
    """Return the stations of a ring of so many photos."""
    centres, rotations = [], []
    tilt, north = np.radians(params.tilt), np.array([0.0, 1.0, 0.0])
    for i in range(photos):
        azimuth = 2.0 * np.pi * i / photos
        way = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        foot = RING * way
        centre = foot + DISTANCE * (np.sin(tilt) * way + np.array([0.0, 0.0, np.cos(tilt)]))
        rotation = look_at(centre, foot, north)
        if i % 2 == 1:
            rotation = matrix_from_vector(np.array([0.0, 0.0, np.radians(params.roll)])) @ rotation
        centres.append(centre)
        rotations.append(rotation)
    names = tuple(str(i + 1) for i in range(photos))
    return Stations(names=names, rotations=np.array(rotations), centres=np.array(centres))


def corner_effects(names: tuple[str, ...], sigmas: Array) -> dict[str, float]:
    """Return how far one standard deviation of each parameter moves the photo's corner, px, by the camera model."""
    every = camera_model(CAMERA.model).names
    before, found = pixel_from_ray(CAMERA, _CORNER), {}
    for name, sigma in zip(names, sigmas, strict=True):
        values = CAMERA.values.copy()
        scale = min(1.0, 10.0 / sigma) if sigma > 0 else 1.0  # stay where the model is nearly linear
        values[every.index(name)] += sigma * scale
        moved = pixel_from_ray(replace(CAMERA, values=values), _CORNER)
        found[name] = float(np.hypot(*(moved - before)[0])) / scale
    return found


@dataclass(frozen=True, eq=False)
class Network:
    """The network of a parameter sheet: Z upwards, the middle of the field at (0, 0, 0)."""

    params: NetworkParams

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknown camera parameters."""
        return TERMS[self.params.terms]

    @cached_property
    def targets(self) -> Array:
        """Targets, float64 (n, 3), m."""
        return field(self.params.depth)

    @cached_property
    def stations(self) -> Stations:
        """Where the photos are taken from."""
        return ring(self.params, self.params.photos)

    def _simulated(self, photos: int) -> TheoreticalModel:
        noise = NoiseParams(sigma_px=self.params.sigma_px, max_incidence=90.0)
        stations = self.stations if photos == self.params.photos else ring(self.params, photos)
        return theoretical_model(stations, CAMERA, imported(self.targets), noise, seed=self.params.seed)

    @cached_property
    def model(self) -> TheoreticalModel:
        """Truth and measurements."""
        return self._simulated(self.params.photos)

    def _freedom(self, model: TheoreticalModel) -> Freedom:
        return Freedom(interior=(self.names,), fixed_points=np.isin(model.point_index, KNOWN))

    @cached_property
    def equations(self) -> Equations:
        """The normal equations at the true values: precision does not depend on the noise."""
        return equations(self.model.as_block(exact_observations=True), self._freedom(self.model))

    def effects_of(self, found: Equations) -> dict[str, float]:
        """Return the corner effect of every parameter, px; NaN where it is not determined."""
        columns = [found.of_camera[name] for name in self.names]
        variances = found.cofactors.reduced.diagonal()[columns]
        if not found.determined or not (variances >= 0).all():
            return dict.fromkeys(self.names, float("nan"))
        effects = corner_effects(self.names, self.params.sigma_px * np.sqrt(variances))
        return {name: value if value < WORTHLESS else float("nan") for name, value in effects.items()}

    @cached_property
    def effects(self) -> dict[str, float]:
        """Corner effects of the whole network, px."""
        return self.effects_of(self.equations)

    @property
    def sigmas(self) -> dict[str, float]:
        """Standard deviations of the parameters; NaN where not determined."""
        q = self.equations.cofactors.reduced.diagonal()
        return {
            name: self.params.sigma_px * float(np.sqrt(q[self.equations.of_camera[name]]))
            if np.isfinite(effect) else float("nan")
            for name, effect in self.effects.items()
        }  # fmt: skip

    def correlation(self, a: str, of_photo: int | None = None, b: str = "") -> float:
        """Return the correlation of a camera parameter with another one, or with an unknown of photo 1 (0 to 5)."""
        found = self.equations
        if a not in found.of_camera or (b and b not in found.of_camera):
            return float("nan")
        other = found.of_camera[b] if b else found.of_photo(0).start + int(of_photo or 0)
        return float(found.correlations[found.of_camera[a], other])

    def growing(self) -> tuple[Array, dict[str, Array]]:
        """Return numbers of photos of the ring, and the corner effects with each of them, px."""
        counts = np.arange(3, 9)
        rows = []
        for count in counts:
            model = self._simulated(int(count))
            rows.append(
                self.effects_of(equations(model.as_block(exact_observations=True), self._freedom(model)))
            )
        return counts, {name: np.array([row[name] for row in rows]) for name in self.names}

    @cached_property
    def estimate(self) -> Adjustment | None:
        """The adjustment of the noisy measurements; None where the camera is not determined."""
        if not np.isfinite(list(self.effects.values())).all():
            return None
        return adjust_block(self.model.as_block(), self._freedom(self.model), Options(statistics=False))

    def error(self, name: str) -> float:
        """Return estimate − truth of a parameter."""
        if self.estimate is None or name not in self.names:
            return float("nan")
        i = camera_model(CAMERA.model).names.index(name)
        return float(self.estimate.block.cameras[0].values[i] - CAMERA.values[i])
