"""Photos of a scene: rays through the camera model's own distortion, exact per ray."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from graphos_core.cameras import camera_model, ray_from_pixel
from graphos_core.cameras.lens import within_field
from graphos_core.data.cameras import Camera
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.params import About, Params
from graphos_core.run import Run
from graphos_core.simulation.render_kernels import (
    SEVERAL,
    classify,
    expose_light,
    fine_rays,
    make_rays,
    shade_plain,
    shade_rays,
)
from graphos_core.simulation.scene import Scene

ROW_BLOCK, PIXEL_BLOCK = 384, 100_000


class SensorParams(Params):
    """What the simulated camera does to the light.

    The standard deviation of the noise at grey level g (0 to 255, before JPEG) is
    ``sqrt(read_noise² + shot_noise² · g / 255)``, independent per pixel and channel.
    """

    read_noise: Annotated[
        float,
        About(label="Read noise", symbol=r"\sigma_r", unit="grey level", low=0, high=50, step=0.1,
              help="Standard deviation of the sensor noise in the dark.", effect="Higher: grainier shadows."),
    ] = 1.0  # fmt: skip
    shot_noise: Annotated[
        float,
        About(label="Shot noise", symbol=r"\sigma_s", unit="grey level", low=0, high=50, step=0.1,
              help="Standard deviation of the photon noise at full white; it falls with the root of the light.",
              effect="Higher: grainier lights."),
    ] = 2.0  # fmt: skip
    vignetting: Annotated[
        float,
        About(label="Vignetting", unit="", low=0, high=1, step=0.05,
              help="Share of the natural fall-off of light, the fourth power of the cosine of the field angle.",
              effect="Higher: darker corners."),
    ] = 0.7  # fmt: skip
    supersampling: Annotated[
        int,
        About(label="Rays per pixel side", low=1, high=4, step=1, level="expert",
              help="Each pixel is the mean of this many rays squared.", effect="Higher: smoother edges, slower."),
    ] = 2  # fmt: skip
    jpeg_quality: Annotated[
        int,
        About(label="JPEG quality", low=50, high=100, step=1,
              help="Quality of the compression, as Pillow counts it.", effect="Higher: larger files."),
    ] = 95  # fmt: skip

    def sigma(self, grey: Array) -> Array:
        """Return the standard deviation of the noise, grey levels, at grey levels `grey`."""
        result: Array = np.sqrt(self.read_noise**2 + self.shot_noise**2 * np.asarray(grey) / 255.0)
        return result


@dataclass(frozen=True)
class RayGrid:
    """The rays of one camera, computed once and used for all its photos.

    Attributes
    ----------
    camera : Camera
    side : int
        Rays per pixel side.
    centre : float64 (h, w, 3)
        Direction of each pixel's centre, camera frame: z = 1, of wide cameras length 1.
    fine : float64 (h·side, w·side, 3)
        Directions of the subpixel samples.
    lit : bool (h, w)
        Pixels that light reaches: those in the image circle of a fish-eye, all of other cameras.
    """

    camera: Camera
    side: int
    centre: Array
    fine: Array
    lit: Array


def ray_grid(camera: Camera, side: int = 2, run: Run | None = None) -> RayGrid:
    """Return the rays of a camera by inverting its own model for every sample, to 1e-10 px.

    Raises
    ------
    UserError
        When the distortion does not map the whole format one to one.
    Stopped
    """
    x, y = np.arange(camera.width, dtype=float), np.arange(camera.height, dtype=float)
    fine_x = (np.arange(camera.width * side) + 0.5) / side - 0.5
    fine_y = (np.arange(camera.height * side) + 0.5) / side - 0.5
    centre, fine = _directions(camera, x, y, run), _directions(camera, fine_x, fine_y, run)
    lit = within_field(camera, centre)
    if not lit.all():  # beyond the image circle: any direction, nothing of it is seen
        lit &= np.isfinite(fine).all(axis=2).reshape(camera.height, side, camera.width, side).all(axis=(1, 3))
        centre[~lit] = 0.0, 0.0, 1.0
        fine[np.repeat(np.repeat(~lit, side, axis=0), side, axis=1)] = 0.0, 0.0, 1.0
    if not (np.isfinite(centre).all() and np.isfinite(fine).all() and lit.any()):
        raise UserError(
            "This camera cannot be simulated.",
            "Its distortion folds over inside the format: some pixels have no ray of their own.",
            "Take smaller distortion coefficients or a longer principal distance.",
        )
    return RayGrid(camera, side, centre, fine, lit)


def _directions(camera: Camera, x: Array, y: Array, run: Run | None) -> Array:
    out = np.empty((len(y), len(x), 3))
    for first in range(0, len(y), ROW_BLOCK):
        (run or Run()).check()
        rows = slice(first, first + ROW_BLOCK)
        pixels = np.stack(np.meshgrid(x, y[rows]), axis=-1)
        out[rows] = ray_from_pixel(camera, pixels.reshape(-1, 2)).reshape(*pixels.shape[:2], 3)
    return out


def render(
    scene: Scene, grid: RayGrid, rotation: Array, centre: Array, run: Run | None = None
) -> tuple[Array, Array]:
    """Render one view.

    The rays of the pixel centres give the depth. Where a pixel and its neighbours see one continuous surface, each of
    its subpixel rays is met with the plane of the pixel's own triangle; all other subpixel rays are cast.

    Parameters
    ----------
    scene : Scene
    grid : RayGrid
    rotation, centre : float64 (3, 3), (3,)
        ``cam_from_world`` and projection centre, m.
    run : Run, optional
        Asked now and then whether to stop.

    Returns
    -------
    light : float32 (h, w, 3)
        Linear light at the lens, without vignetting and noise.
    depth : float32 (h, w)
        z of the pixel's centre in the camera frame, of wide cameras its distance, m; NaN for the sky and beyond the
        image circle.

    Raises
    ------
    Stopped
    """
    camera = grid.camera
    rotation, centre = np.ascontiguousarray(rotation), np.ascontiguousarray(centre)
    side, shape, pixel = grid.side, (camera.height, camera.width), 1.0 / camera.focal_px
    depth, primitive = np.empty(shape, np.float32), np.empty(shape, np.uint32)
    for first in range(0, camera.height, ROW_BLOCK):
        (run or Run()).check()
        rows = slice(first, first + ROW_BLOCK)
        local = grid.centre[rows]
        rays = np.empty((local.shape[0] * local.shape[1], 6), np.float32)
        make_rays(local, rotation, centre, rays)
        hit = _cast(scene, rays)
        depth[rows], primitive[rows] = (
            hit[key].reshape(local.shape[:2]) for key in ("t_hit", "primitive_ids")
        )
    kind, light = np.empty(shape, np.uint8), np.empty((*shape, 3), np.float32)
    planes, gradients = scene.planes
    tiles = (scene.patch_of_triangle, scene.texels, scene.table, scene.texel_of_patch)
    classify(grid.centre, rotation, centre, depth, primitive, planes, scene.patch_of_triangle, pixel, kind)
    for first in range(0, camera.height, ROW_BLOCK):
        (run or Run()).check()
        rows, fine = slice(first, first + ROW_BLOCK), slice(first * side, (first + ROW_BLOCK) * side)
        shade_plain(
            grid.fine[fine], rotation, centre, kind[rows], primitive[rows], planes, gradients, *tiles, pixel, light[rows]
        )  # fmt: skip
    several = np.argwhere(kind == SEVERAL)
    for first in range(0, len(several), PIXEL_BLOCK):
        (run or Run()).check()
        where = several[first : first + PIXEL_BLOCK]
        rays = np.empty((len(where) * side**2, 6), np.float32)
        fine_rays(grid.fine, rotation, centre, where, rays)
        hit = _cast(scene, rays)
        shade_rays(
            rays, hit["t_hit"], hit["primitive_ids"], hit["primitive_uvs"], hit["primitive_normals"], where,
            scene.corner_st, *tiles, pixel, light,
        )  # fmt: skip
    depth[~(np.isfinite(depth) & grid.lit)] = np.nan
    light[~grid.lit] = 0.0
    return light, depth


def _cast(scene: Scene, rays: Array) -> dict[str, Array]:
    import open3d as o3d

    hit = scene.caster.cast_rays(o3d.core.Tensor.from_numpy(rays))
    return {key: value.numpy() for key, value in hit.items()}


def expose(light: Array, grid: RayGrid, sensor: SensorParams, rng: np.random.Generator) -> Array:
    """Return the photo uint8 (h, w, 3) that the sensor makes of the light.

    Vignetting by cos⁴ of the field angle (none for wide cameras, whose lenses are built against it), sRGB curve,
    noise as `SensorParams` says, rounding.
    """
    vignetting = 0.0 if camera_model(grid.camera.model).wide else sensor.vignetting
    noise = rng.standard_normal(light.shape, dtype=np.float32)
    out = np.empty(light.shape, np.uint8)
    expose_light(light, grid.centre, noise, vignetting, sensor.read_noise, sensor.shot_noise, out)
    return out


def jpeg_bytes(photo: Array, camera: Camera, quality: int) -> bytes:
    """Return the photo as JPEG (no chroma subsampling) with EXIF: make, model, focal lengths, orientation 1."""
    from PIL import Image

    image = Image.fromarray(photo)
    exif = image.getexif()
    pitch = camera.pixel_pitch_mm or 0.004
    focal = camera.focal_px * pitch
    diagonal = math.hypot(camera.width, camera.height) * pitch
    exif[0x010F], exif[0x0110], exif[0x0112] = "GRAPHOS", camera.label or "Simulated camera", 1
    sub: dict[int, Any] = exif.get_ifd(0x8769)
    sub[0x920A] = round(focal, 2)
    sub[0xA405] = round(focal * math.hypot(36.0, 24.0) / diagonal)
    sub[0xA002], sub[0xA003] = camera.width, camera.height
    buffer = io.BytesIO()
    image.save(buffer, "JPEG", quality=quality, subsampling=0, exif=exif)
    return buffer.getvalue()
