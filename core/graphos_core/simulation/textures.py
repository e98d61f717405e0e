"""Baking: the reflectance, the relief and the light of a patch, and its coarser levels."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphos_core.data.record import Array
from graphos_core.simulation.light_kernels import light_tile
from graphos_core.simulation.patches import Patch
from graphos_core.simulation.targets import paint_target
from graphos_core.simulation.texture_kernels import halve, paint_material

SUN_LATTICE_M, SKY_LATTICE_M, SKY_RAYS = 0.012, 0.08, 48


def bake_albedo(patch: Patch, texel: float, seed: int) -> tuple[Array, Array]:
    """Return reflectance float32 (h, w, 3), 0 to 1, and relief float32 (h, w), m; row 0 is t = 0."""
    width, height = patch.size
    shape = max(2, round(height / texel)), max(2, round(width / texel))
    albedo, relief = np.empty((*shape, 3), np.float32), np.empty(shape, np.float32)
    paint_material(
        patch.material, 1000 * seed + patch.seed, patch.s0, patch.t0, texel, patch.weather, albedo, relief
    )
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
        low = lattice[it][:, js] * (1 - a)[None, :, None] + lattice[it][:, js + 1] * a[None, :, None]
        high = lattice[it + 1][:, js] * (1 - a)[None, :, None] + lattice[it + 1][:, js + 1] * a[None, :, None]
        result: Array = low * (1 - b)[:, None, None] + high * b[:, None, None]
        return result.reshape(-1, 3)

    normal = _unit(mix(normals))
    return mix(patch.grid) + 0.004 * normal, normal, shape


def _blocked(caster: Any, origins: Array, directions: Array) -> Array:
    import open3d as o3d

    rays = np.concatenate([origins, directions], axis=1).astype(np.float32)
    result: Array = caster.test_occlusions(o3d.core.Tensor(rays)).numpy()
    return result


def _sun(patch: Patch, normals: Array, spacing: float, caster: Any, sun: Array) -> Array:
    origins, normal, shape = _lattice(patch, normals, spacing)
    lit = normal @ sun > 0.0
    if lit.any():
        lit[lit] = ~_blocked(caster, origins[lit], np.broadcast_to(sun, (int(lit.sum()), 3)))
    return lit.reshape(shape).astype(np.float32)


def _sky(patch: Patch, normals: Array, spacing: float, caster: Any) -> Array:
    origins, normal, shape = _lattice(patch, normals, spacing)
    helper = np.where(np.abs(normal[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    x = _unit(np.cross(helper, normal))
    y = np.cross(normal, x)
    seen = np.zeros(len(origins))
    for k in range(SKY_RAYS):  # R2 sequence (Roberts 2018), turned a little at every point
        u = (0.5 + k * 0.7548776662466927) % 1.0
        turn = 2 * np.pi * ((k * 0.5698402909980532 + 0.618033988749895 * np.arange(len(origins))) % 1.0)
        radius = np.sqrt(u)
        out = radius * (np.cos(turn)[:, None] * x + np.sin(turn)[:, None] * y) + np.sqrt(1 - u) * normal
        seen += np.where(out[:, 2] > -0.05, ~_blocked(caster, origins, out), 0.0)
    return (seen / SKY_RAYS).reshape(shape).astype(np.float32)
