"""A relief with known depth, photographed by exact rays: soft hills and a floating plate that hides some of them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Array, Block, Camera, DepthMap
from graphos_core.geometry.rotation import look_at

PLATE_HEIGHT = 0.8
PLATE_HALF = 0.9
DISTANCE = 10.0


@dataclass(frozen=True)
class Relief:
    """Photos of the relief and what is true."""

    block: Block
    photos: tuple[Array, ...]
    depths: tuple[Array, ...]
    gsd: float

    def read(self, photo: int) -> Array:
        return self.photos[photo]

    def _points(self, m: DepthMap) -> Array:
        """The true object points under the pixels of a map, float64 (h·w, 3)."""
        y, x = np.mgrid[0 : m.depth.shape[0], 0 : m.depth.shape[1]]
        rays = np.stack([(x - m.cx) / m.focal_px, (y - m.cy) / m.focal_px, np.ones(x.shape)], axis=-1)
        return hit(self.block.centres[m.photo], rays.reshape(-1, 3) @ self.block.rotations[m.photo])[0]

    def depth_of(self, m: DepthMap) -> Array:
        """The true depth of the pixels of a map."""
        points = self._points(m) - self.block.centres[m.photo]
        return (points @ self.block.rotations[m.photo][2]).reshape(m.depth.shape)

    def seen_by_others(self, m: DepthMap) -> Array:
        """In how many other photos the points under the pixels of a map can be seen."""
        points = self._points(m)
        camera = self.block.cameras[0]
        count = np.zeros(len(points), int)
        for photo in range(len(self.photos)):
            centre = self.block.centres[photo]
            pixel = pixel_from_ray(camera, (points - centre) @ self.block.rotations[photo].T)
            inside = ((pixel >= 0) & (pixel <= [camera.width - 1, camera.height - 1])).all(axis=1)
            back, _ = hit(centre, points - centre)
            open_view = np.linalg.norm(back - points, axis=1) < 1e-3
            count += (photo != m.photo) & inside & open_view
        return count.reshape(m.depth.shape)

    def height_error(self, points: Array) -> Array:
        """How far points (n, 3) lie above the hills or the plate, whichever is nearer."""
        above_hills = points[:, 2] - height(points[:, 0], points[:, 1])
        on_plate = (np.abs(points[:, :2]) < PLATE_HALF + self.gsd).all(axis=1)
        above_plate = np.where(on_plate, points[:, 2] - PLATE_HEIGHT, np.inf)
        return np.where(np.abs(above_plate) < np.abs(above_hills), above_plate, above_hills)


def height(x: Array, y: Array) -> Array:
    """Height of the hills at (x, y)."""
    return 0.25 * np.sin(1.1 * x + 0.3) * np.cos(0.9 * y) + 0.1 * np.sin(2.3 * y + x)


def hit(centre: Array, rays: Array) -> tuple[Array, Array]:
    """Intersect rays (n, 3) from `centre` with plate and hills; points (n, 3) and whether they lie on the plate."""
    t = (PLATE_HEIGHT - centre[2]) / rays[:, 2]
    on_plate = centre + t[:, None] * rays
    plate = (np.abs(on_plate[:, 0]) < PLATE_HALF) & (np.abs(on_plate[:, 1]) < PLATE_HALF)
    z = np.zeros(len(rays))
    for _ in range(16):  # slopes are far below those of the rays: a fixed point
        ground = centre + ((z - centre[2]) / rays[:, 2])[:, None] * rays
        z = height(ground[:, 0], ground[:, 1])
    return np.where(plate[:, None], on_plate, ground), plate


def texture(seed: int, size: int = 2048) -> Array:
    """Multi-octave noise as grey values, float32 (size, size, 3)."""
    rng = np.random.default_rng(seed)
    total = np.zeros((size, size, 3), np.float32)
    for octave in range(3, 10):
        cells = 2**octave
        noise = rng.standard_normal((cells, cells, 3)).astype(np.float32) * [0.6, 1.0, 0.8]
        total += cv2.resize(noise.astype(np.float32), (size, size), interpolation=cv2.INTER_CUBIC)
    total = (total - total.mean()) / total.std()
    return np.clip(128.0 + 40.0 * total, 1, 254)


@cache
def ideal_rays(camera: Camera, dx: float, dy: float) -> Array:
    """Rays through all pixels, moved by (dx, dy), in the camera frame; float64 (h·w, 3)."""
    y, x = np.mgrid[0 : camera.height, 0 : camera.width]
    return ray_from_pixel(camera, np.stack([x.ravel() + dx, y.ravel() + dy], axis=1))


def photograph(camera: Camera, rotation: Array, centre: Array, pictures: list[Array]) -> tuple[Array, Array]:
    """Return the photo uint8 (h, w, 3), two by two supersampled, and the depth of each pixel float64 (h, w)."""
    h, w = camera.height, camera.width
    total = np.zeros((h * w, 3), np.float64)
    for dx, dy in ((0, 0), (-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)):
        rays = ideal_rays(camera, dx, dy) @ rotation
        points, plate = hit(centre, rays)
        if dx == 0:
            depth = ((points - centre) @ rotation[2]).reshape(h, w)
            continue
        for surface, picture in zip((~plate, plate), pictures, strict=True):
            at = ((points[surface, :2] + 6.0) / 12.0 * picture.shape[0]).astype(np.float32)
            for start in range(0, len(at), 30000):  # remap has a limit of 32767 rows
                part = at[start : start + 30000]
                colour = cv2.remap(
                    picture, part[:, None, :], None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP
                )
                index = np.flatnonzero(surface)[start : start + 30000]
                total[index] += colour[:, 0] / 4.0
    return total.reshape(h, w, 3), depth


def make_relief(
    width: int = 480, rows: int = 2, columns: int = 3, noise: float = 1.5, seed: int = 1
) -> Relief:
    """Return a relief photographed from a grid of stations about 1.9 units apart, 10 units above it."""
    f = 1.05 * width
    h = width * 3 // 4
    camera = Camera(
        model="basic",
        width=width,
        height=h,
        values=np.array([f, width / 2 - 0.5 + 3.0, h / 2 - 0.5 - 2.0, -0.05, 0.01]),
    )
    rng = np.random.default_rng(seed)
    pictures = [texture(seed), texture(seed + 1)]
    centres, rotations, photos, depths = [], [], [], []
    for row in range(rows):
        for column in range(columns):
            centre = np.array([(column - (columns - 1) / 2) * 1.9, (row - (rows - 1) / 2) * 1.9, DISTANCE])
            rotation = look_at(
                centre, np.array([0.3 * centre[0], 0.3 * centre[1], 0.0]), np.array([0.05, 1.0, 0.0])
            )
            photo, depth = photograph(camera, rotation, centre, pictures)
            photo = np.clip(np.rint(photo + rng.normal(0.0, noise, photo.shape)), 0, 255)
            centres.append(centre)
            rotations.append(rotation)
            photos.append(photo.astype(np.uint8))
            depths.append(depth)
    block = _block(camera, np.array(rotations), np.array(centres), rng)
    return Relief(block, tuple(photos), tuple(depths), DISTANCE / f)


def _block(camera: Camera, rotations: Array, centres: Array, rng: np.random.Generator) -> Block:
    ground = rng.uniform(-4.5, 4.5, (600, 2))
    points, _ = hit(
        np.array([0.0, 0.0, DISTANCE]), np.column_stack([ground, np.zeros(600)]) - [0, 0, DISTANCE]
    )
    obs = []
    for photo, (rotation, centre) in enumerate(zip(rotations, centres, strict=True)):
        pixel = pixel_from_ray(camera, (points - centre) @ rotation.T)
        back, _ = hit(centre, points - centre)
        seen = (np.linalg.norm(back - points, axis=1) < 1e-6) & (pixel >= 0).all(axis=1)
        seen &= (pixel <= [camera.width - 1, camera.height - 1]).all(axis=1)
        obs += [(int(p), photo, *pixel[p]) for p in np.flatnonzero(seen)]
    obs.sort()
    table = np.array(obs)
    n = len(centres)
    return Block(
        cameras=(camera,),
        names=tuple(f"photo{i}" for i in range(n)),
        camera_of_photo=np.zeros(n, np.int32),
        oriented=np.ones(n, bool),
        rotations=rotations,
        centres=centres,
        points=points,
        colours=np.zeros((len(points), 3), np.uint8),
        point_track=np.full(len(points), -1, np.int32),
        obs_photo=table[:, 1].astype(np.int32),
        obs_point=table[:, 0].astype(np.int32),
        obs_xy=table[:, 2:].copy(),
        unit="m",
    )


@pytest.fixture(scope="session")
def relief() -> Relief:
    return make_relief()
