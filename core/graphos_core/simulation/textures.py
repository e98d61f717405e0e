"""Baking: the reflectance, the relief and the light of a patch, and its coarser levels."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data.record import Array
from graphos_core.simulation.light_kernels import light_tile, sky_rays
from graphos_core.simulation.patches import Patch
from graphos_core.simulation.targets import paint_target
from graphos_core.simulation.texture_kernels import (
    WEATHER_STEP,
    halve,
    lattice_points,
    paint_material,
    weathering,
)

SUN_LATTICE_M, SKY_LATTICE_M, SKY_RAYS = 0.012, 0.08, 48


def bake_albedo(patch: Patch, texel: float, seed: int) -> tuple[Array, Array]:
    """Return reflectance float32 (h, w, 3), 0 to 1, and relief float32 (h, w), m; row 0 is t = 0."""
    width, height = patch.size
    shape = max(2, round(height / texel)), max(2, round(width / texel))
    albedo, relief = np.empty((*shape, 3), np.float32), np.empty(shape, np.float32)
    variant = 1000 * seed + patch.seed
    tones = np.ones((shape[0] // WEATHER_STEP + 2, shape[1] // WEATHER_STEP + 2), np.float32)
    if patch.weather > 0.0:
        weathering(variant, patch.s0, patch.t0, WEATHER_STEP * texel, patch.weather, tones)
    paint_material(patch.material, variant, patch.s0, patch.t0, texel, tones, albedo, relief)
    for number, s, t, diameter in patch.targets:
        paint_target(albedo, number, s, t, diameter, texel)
        reach = int(0.75 * diameter / texel)
        i, j = int(t / texel), int(s / texel)
        relief[max(0, i - int(1.4 * reach)) : i + reach, max(0, j - reach) : j + reach] = 0.0
    return albedo, relief


def bake_light(patch: Patch, albedo: Array, relief: Array, texel: float, caster: Any, sun: Array) -> Array:
    """Return the light that leaves each texel, uint8 (h, w, 3) as ``255 √light``.

    Sun with cast shadow (a ray towards it from a lattice of `SUN_LATTICE_M`), sky weakened by what hides it
    (ambient occlusion: `SKY_RAYS` rays over the cosine-weighted hemisphere), and light back from what hides it.
    Everything is Lambertian, so the light does not depend on the viewer and can be baked.
    """
    tangents_s, tangents_t, normals = frames(patch)
    scale = max(1.0, 0.5 * patch.coarse, texel / 0.006)
    sun_lit = _sun(patch, normals, SUN_LATTICE_M * scale, caster, sun)
    sky_seen = _sky(patch, normals, SKY_LATTICE_M * scale, caster)
    h, w = relief.shape
    cell_s, part_s = _cells(patch.s_knots, w)
    cell_t, part_t = _cells(patch.t_knots, h)
    out = np.empty((h, w, 3), np.uint8)
    light_tile(albedo, relief, normals, tangents_s, tangents_t, cell_s, cell_t, part_s, part_t, sun_lit, sky_seen,
               texel, sun, out)  # fmt: skip
    return out


def pyramid(tile: Array, levels: int) -> list[Array]:
    """Return the tile and its coarser levels, each the mean of 2 × 2 texels of the level before."""
    found = [tile]
    while len(found) < levels:
        found.append(halve(found[-1]) if max(found[-1].shape[:2]) > 1 else found[-1])
    return found


def frames(patch: Patch) -> tuple[Array, Array, Array]:
    """Return unit tangents along s and t and the outward unit normals (m, n, 3) on the patch's lattice."""
    along = np.gradient(patch.grid, patch.s_knots, axis=1)
    up = np.gradient(patch.grid, patch.t_knots, axis=0)
    normals = np.cross(along, up)
    lengths = np.linalg.norm(normals, axis=2, keepdims=True)
    normals = np.where(lengths > 1e-9, normals / np.maximum(lengths, 1e-12), [0.0, 0.0, 1.0])
    return _unit(along), _unit(up), normals


def _unit(vectors: Array) -> Array:
    result: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)
    return result


def _cells(knots: Array, count: int) -> tuple[Array, Array]:
    place = (np.arange(count) + 0.5) / count * knots[-1]
    cell = np.clip(np.searchsorted(knots, place, side="right") - 1, 0, len(knots) - 2)
    return cell.astype(np.int64), (place - knots[cell]) / (knots[cell + 1] - knots[cell])


def _lattice(patch: Patch, normals: Array, spacing: float) -> tuple[Array, Array, tuple[int, int]]:
    width, height = patch.size
    shape = max(1, round(height / spacing)), max(1, round(width / spacing))
    js, a = _cells(patch.s_knots, shape[1])
    it, b = _cells(patch.t_knots, shape[0])

    def mix(lattice: Array) -> Array:
        out = np.empty((*shape, 3))
        lattice_points(lattice, js, it, a, b, out)
        return out.reshape(-1, 3)

    normal = _unit(mix(normals))
    # the bilinear lattice stands off the triangles between its knots: start above both
    cell = min(np.diff(patch.s_knots).max(), np.diff(patch.t_knots).max())
    lift = 0.004 if patch.grid.shape[:2] == (2, 2) else max(0.004, 0.08 * float(cell))
    return mix(patch.grid) + lift * normal, normal, shape


def _sun(patch: Patch, normals: Array, spacing: float, caster: Any, sun: Array) -> Array:
    import open3d as o3d

    origins, normal, shape = _lattice(patch, normals, spacing)
    lit = normal @ sun > 0.0
    rays = np.empty((int(lit.sum()), 6), np.float32)
    rays[:, :3], rays[:, 3:] = origins[lit], sun
    if len(rays):
        lit[lit] = ~caster.test_occlusions(o3d.core.Tensor.from_numpy(rays)).numpy()
    return lit.reshape(shape).astype(np.float32)


def _sky(patch: Patch, normals: Array, spacing: float, caster: Any) -> Array:
    import open3d as o3d

    origins, normal, shape = _lattice(patch, normals, spacing)
    rays = np.empty((len(origins) * SKY_RAYS, 6), np.float32)
    sky_rays(origins, normal, SKY_RAYS, rays)
    free = ~caster.test_occlusions(o3d.core.Tensor.from_numpy(rays)).numpy() & (rays[:, 5] > -0.05)
    result: Array = free.reshape(-1, SKY_RAYS).mean(axis=1).reshape(shape).astype(np.float32)
    return result
