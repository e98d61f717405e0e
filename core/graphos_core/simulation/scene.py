"""Scenes: patches with baked textures and light, as one triangle mesh that rays can be cast at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from graphos_core.data.cloud import Mesh
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.params import unknown_name
from graphos_core.run import Run, map_items
from graphos_core.simulation.patches import Patch
from graphos_core.simulation.textures import bake_albedo, bake_light, pyramid

LEVELS = 8
MAX_TEXELS = 80e6
"""Finer textures than this would take more than 350 MB; they are baked coarser instead."""
TOWARDS_SUN = np.array([-0.52, -0.66, 0.62]) / np.linalg.norm([-0.52, -0.66, 0.62])


@dataclass(frozen=True)
class Target:
    """A coded target: its name, centre (3,), outward normal (3,), diameter, metres, and whether it is a check point."""

    name: str
    xyz: Array
    normal: Array
    diameter: float
    check: bool


@dataclass(frozen=True)
class Design:
    """A scene before baking: its patches, and the middle of what is worth photographing."""

    patches: list[Patch]
    focus: Array


@dataclass(frozen=True)
class Scene:
    """A scene ready to be photographed, in metres.

    Attributes
    ----------
    name : str
    focus : float64 (3,)
        Middle of what is worth photographing; templates are placed about it.
    vertices : float64 (v, 3)
    triangles : int32 (f, 3)
        Counter-clockwise from outside.
    patch_of_triangle : int32 (f,)
    corner_st : float32 (f, 3, 2)
        Shares (0 to 1) of the patch's tile at the corners of each triangle.
    texels : uint8 (k,)
        Tiles with their coarser levels one after the other; light in square-root encoding.
    table : int64 (p, levels, 3)
        Offset, height and width of each level of each tile.
    texel_of_patch : float64 (p,)
        Size of a texel, m.
    targets : tuple of Target
    """

    name: str
    focus: Array
    vertices: Array
    triangles: Array
    patch_of_triangle: Array
    corner_st: Array
    texels: Array
    table: Array
    texel_of_patch: Array
    targets: tuple[Target, ...]

    @property
    def mesh(self) -> Mesh:
        """The surface as a record."""
        return Mesh(vertices=self.vertices, triangles=self.triangles, unit="m")

    @cached_property
    def planes(self) -> tuple[Array, Array]:
        """Planes float64 (f, 4) as ``n · X = n₄``, and the shares (s, t) of the tile float64 (f, 2, 4) affine in X."""
        corners = self.vertices[self.triangles]
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        normals = np.cross(a, b)
        square = np.maximum((normals**2).sum(axis=1, keepdims=True), 1e-30)
        # u = (b × n) · (X − X₀) / n², v = (n × a) · (X − X₀) / n² are the barycentric coordinates
        u, v = np.cross(b, normals) / square, np.cross(normals, a) / square
        st = self.corner_st.astype(np.float64)
        du, dv = st[:, 1] - st[:, 0], st[:, 2] - st[:, 0]
        slopes = du[:, :, None] * u[:, None, :] + dv[:, :, None] * v[:, None, :]
        constant = st[:, 0] - np.einsum("fkc,fc->fk", slopes, corners[:, 0])
        normals = normals / np.sqrt(square)
        planes = np.column_stack([normals, (normals * corners[:, 0]).sum(axis=1)])
        return planes, np.ascontiguousarray(np.concatenate([slopes, constant[:, :, None]], axis=2))

    @cached_property
    def caster(self) -> Any:
        """Open3D's `RaycastingScene` of the mesh."""
        return ray_caster(self.vertices, self.triangles)


def ray_caster(vertices: Array, triangles: Array) -> Any:
    """Return Open3D's `RaycastingScene` of a triangle mesh."""
    import open3d as o3d

    caster = o3d.t.geometry.RaycastingScene()
    caster.add_triangles(
        o3d.core.Tensor.from_numpy(np.ascontiguousarray(vertices, dtype=np.float32)),
        o3d.core.Tensor.from_numpy(np.ascontiguousarray(triangles, dtype=np.uint32)),
    )
    caster.test_occlusions(
        o3d.core.Tensor.from_numpy(np.ones((1, 6), np.float32))
    )  # builds the tree now: later calls may come from threads
    return caster


def scene_designs() -> dict[str, Callable[[int], Design]]:
    """Return every scene by name: a function of the seed."""
    from graphos_core.simulation import courtyard, facade, landscapes

    return {
        "facade": facade.design,
        "terrain": landscapes.terrain,
        "statue": landscapes.statue,
        "courtyard": courtyard.design,
    }


def build_scene(name: str, *, seed: int = 0, texel_m: float = 0.004, run: Run | None = None) -> Scene:
    """Build a scene and bake its textures.

    Parameters
    ----------
    name : str
        ``"facade"``, ``"terrain"``, ``"statue"`` or ``"courtyard"``.
    seed : int
        Of the textures and the relief.
    texel_m : float
        Size of a texel, m; about two thirds of the ground sampling distance keeps the photos sharp without
        aliasing.
    run : Run, optional
        Told the progress; its number of threads does not change the result.

    Raises
    ------
    UserError
        When there is no scene of that name.
    Stopped
    """
    designs = scene_designs()
    if name not in designs:
        raise UserError(unknown_name(name, list(designs), "scene"))
    return bake_scene(name, designs[name](seed), seed=seed, texel_m=texel_m, run=run)


def bake_scene(
    name: str, design: Design, *, seed: int = 0, texel_m: float = 0.004, run: Run | None = None
) -> Scene:
    """Bake the textures and the light of a design; see `build_scene`."""
    patches = design.patches
    vertices, triangles, owner, shares = _assemble(patches)
    caster = ray_caster(vertices, triangles)
    coarse = np.array([patch.coarse for patch in patches])
    texels_at_1_m = sum(np.prod(patch.size) / patch.coarse**2 for patch in patches)
    texel_of_patch = max(texel_m, float(np.sqrt(texels_at_1_m / MAX_TEXELS))) * coarse
    bake = partial(_bake, patches, texel_of_patch, caster, seed)
    levels = map_items(run or Run(), bake, range(len(patches)), "textures")
    shapes = np.array([[tile.shape[:2] for tile in tiles] for tiles in levels])
    sizes = 3 * shapes.prod(axis=2).reshape(-1)
    offsets = (np.cumsum(sizes) - sizes).reshape(shapes.shape[:2])
    table = np.concatenate([offsets[..., None], shapes], axis=2).astype(np.int64)
    texels = np.concatenate([tile.reshape(-1) for tiles in levels for tile in tiles])
    return Scene(
        name, design.focus, vertices, triangles, owner, shares, texels, table, texel_of_patch,
        tuple(_targets(patches)),
    )  # fmt: skip


def _bake(patches: list[Patch], texels: Array, caster: Any, seed: int, index: int) -> list[Array]:
    """Return the tile of one patch and its coarser levels."""
    patch, texel = patches[index], float(texels[index])
    albedo, relief = bake_albedo(patch, texel, seed)
    return pyramid(bake_light(patch, albedo, relief, texel, caster, TOWARDS_SUN), LEVELS)


def _assemble(patches: list[Patch]) -> tuple[Array, Array, Array, Array]:
    vertices, triangles, owner, shares = [], [], [], []
    first = 0
    for index, patch in enumerate(patches):
        vertices.append(patch.at(patch.st))
        triangles.append(patch.triangles + first)
        owner.append(np.full(len(patch.triangles), index, np.int32))
        shares.append((patch.st / patch.size)[patch.triangles])
        first += len(patch.st)
    return (
        np.concatenate(vertices),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(owner),
        np.concatenate(shares).astype(np.float32),
    )


def _targets(patches: list[Patch]) -> list[Target]:
    found = []
    for patch in patches:
        for number, s, t, diameter in patch.targets:
            xyz = patch.at(np.array([[s, t]]))[0]
            steps = patch.at(np.array([[s + 1e-3, t], [s, t + 1e-3]])) - xyz
            normal = np.cross(steps[0], steps[1])
            normal /= np.linalg.norm(normal)
            found.append(Target(f"T{number:02d}", xyz, normal, diameter, number % 3 == 0))
    return sorted(found, key=lambda target: target.name)
