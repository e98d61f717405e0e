"""Small blocks for simulators: adjusted by the engine, with everything its equations say, and seen in space."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.covariance import Cofactors, cofactors
from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.known.group import Group
from graphos_core.adjustment.bundle.problem import Freedom, Problem, make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.adjustment.bundle.robust import ROBUST
from graphos_core.cameras import camera_model, pixel_from_ray, ray_from_pixel
from graphos_core.data import Adjustment, Block, Camera
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import look_at
from graphos_didactic.scene import AnyMark, Dash, Line, Points, Polygon, Role

SYMBOLS = {
    "focal_px": "f",
    "x0": "x0",
    "y0": "y0",
    "k1": "k1",
    "k2": "k2",
    "k3": "k3",
    "p1": "p1",
    "p2": "p2",
}
POSE = ("ω", "φ", "κ", "X", "Y", "Z")
PLAIN = Rules(ROBUST["none"].code, 1.0, True)


@dataclass(frozen=True, eq=False)
class Equations:
    """The normal equations of a block at its present values: problem and cofactors.

    Attributes
    ----------
    problem : Problem
    cofactors : Cofactors
    """

    problem: Problem
    cofactors: Cofactors

    def of_photo(self, photo: int) -> slice:
        """Columns of the rotation and the projection centre of a photo."""
        first = int(self.problem.layout.photo_column[photo])
        return slice(first, first + int(self.problem.layout.pose[photo]))

    @cached_property
    def of_camera(self) -> dict[str, int]:
        """Column of every free parameter of the first camera, by name."""
        layout = self.problem.layout
        names = camera_model(self.problem.block.cameras[0].model).names
        first, count = int(layout.camera_column[0]), int(layout.free_count[0])
        return {names[layout.free_index[0, i]]: first + i for i in range(count)}

    @property
    def determined(self) -> bool:
        """Whether nothing but the datum is open."""
        return not self.cofactors.singular

    @cached_property
    def correlations(self) -> Array:
        """Correlations of all reduced unknowns, float64 (u, u); NaN where not determined."""
        q = self.cofactors.reduced
        if not self.determined:
            return np.full_like(q, np.nan)
        sigma = np.sqrt(np.maximum(q.diagonal(), 1e-300))
        return np.asarray(np.clip(q / sigma[:, None] / sigma, -1.0, 1.0))


def equations(
    block: Block, freedom: Freedom, groups: Sequence[Group] = (), datum: str = "inner"
) -> Equations:
    """Return the equations of a block at its present values, without moving anything."""
    problem = make_problem(block, freedom, groups)
    system = ReducedSystem(problem, PLAIN, 1)
    with system.working():
        found = cofactors(system, problem.scene, "minimal" if datum == "minimal" else "inner")
    return Equations(problem, found)


def solved(
    block: Block, freedom: Freedom, options: Options | None = None, groups: Sequence[Group] = ()
) -> tuple[Adjustment, Equations]:
    """Adjust a block and return the equations of the last iteration too."""
    adjustment = adjust_block(block, freedom, options or Options(statistics=False), groups)
    return adjustment, equations(adjustment.block, freedom, groups)


def observer(orbit: float, middle: Array, distance: float, height: float = 0.5) -> Callable[[Array], Array]:
    """Return a camera of the engine that looks at `middle` from an orbit angle, degrees: points to its picture.

    Parameters
    ----------
    orbit : float
    middle : float64 (3,)
    distance : float
    height : float
        Sine of the angle above the horizon.
    """
    camera = Camera(model="pinhole", width=400, height=300, values=np.array([440.0, 0.0, 0.0]))
    angle, flat = np.radians(orbit), np.sqrt(1.0 - height**2)
    centre = middle + distance * np.array([np.sin(angle) * flat, -np.cos(angle) * flat, height])
    rotation = look_at(centre, middle)

    def seen(points: Array) -> Array:
        return pixel_from_ray(
            camera, (np.asarray(points, dtype=np.float64).reshape(-1, 3) - centre) @ rotation.T
        )

    return seen


def pyramid(
    panel: str, thing: str, role: Role, photo: tuple[Camera, Array, Array], length: float,
    seen: Callable[[Array], Array], *, dash: Dash = "solid",
) -> list[AnyMark]:  # fmt: skip
    """Draw a photo as a pyramid from its projection centre to its format, `length` long, with its upper edge marked.

    Parameters
    ----------
    panel, thing, role : str
    photo : (Camera, float64 (3, 3), float64 (3,))
        Camera, ``cam_from_world`` and projection centre.
    length : float
    seen : callable
        From space (n, 3) to the panel (n, 2).
    dash : Dash
    """
    camera, rotation, centre = photo
    w, h = camera.width - 0.5, camera.height - 0.5
    corners = np.array([[-0.5, -0.5], [w, -0.5], [w, h], [-0.5, h]])
    rays = ray_from_pixel(camera, corners)
    screen = centre + length * (rays / rays[:, 2:]) @ rotation
    edges = np.full((12, 3), np.nan)
    edges[0::3], edges[1::3] = centre, screen
    flat = np.full((12, 2), np.nan)
    good = np.isfinite(edges[:, 0])
    flat[good] = seen(edges[good])
    top = seen(screen[:2])
    return [
        Polygon(panel=panel, thing=thing, role=role, xy=seen(screen), fill=0.14, width=1.2, dash=dash),
        Line(panel=panel, thing=thing, role=role, xy=flat, width=0.9, dash=dash),
        Line(panel=panel, thing=thing, role=role, xy=top, width=3.0),
        Points(panel=panel, thing=thing, role=role, xy=seen(centre[None]), size=5.0),
    ]
