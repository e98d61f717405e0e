"""What is weak about a calibration, in words: network, coverage, board, single photos."""

from __future__ import annotations

import numpy as np

from graphos_core.adjustment.bundle.self_calibration import largest_roll
from graphos_core.adjustment.calibration.board import BoardShape
from graphos_core.data import Adjustment, Array, Block, Camera
from graphos_core.text import Text

FEW_PHOTOS = 8
WEAK_FOCAL = 0.005
"""Standard deviation of the principal distance, as a share of it, from which it counts as hardly determined."""
LITTLE_TILT = np.radians(15.0)
LITTLE_ROLL = np.radians(60.0)
WEAK_POINT_SHARE = 0.002
"""Standard deviation of the principal point in shares of the longer side from which missing roll is named."""
CELLS = (8, 6)
"""Parts of the format, along the longer and the shorter side, in which points are counted."""
LITTLE_COVERAGE = 0.7
ODD_PHOTO = 3.0
"""RMS of a photo over the median of all from which it is named."""


def look_for_problems(
    result: Adjustment, sigma: Array, shape: BoardShape | None, rejected: int, freed: bool
) -> list[str]:
    """Return what to know about a calibration, the gravest first."""
    found: list[str] = []
    if not result.converged:
        found.append(Text("The adjustment did not converge: {reason}.", reason=result.stop_reason))
    block = result.block
    used = np.unique(np.asarray(block.camera_of_photo)[np.asarray(block.oriented)])
    if len(used) > 1:
        found.append(
            Text("The photos are of {n} cameras or sizes; each is calibrated by its own photos.", n=len(used))
        )
    for c in used:
        found += _network(block, int(c))
        found += _coverage(block, int(c))
    found += _board(shape, freed)
    found += _photos(result)
    if rejected:
        found.append(
            Text("One point was removed as an outlier.") if rejected == 1
            else Text("{n} points were removed as outliers.", n=rejected)
        )  # fmt: skip
    expected = float(np.median(sigma[np.isfinite(sigma)])) if np.isfinite(sigma).any() else 0.0
    if expected > 0 and result.sigma0_px > 4.0 * expected and (shape is None or shape.agrees or freed):
        found.append(Text(
            "Residuals ({s0:.2f} px) are larger than the grey values promise ({expected:.2f} px): a richer camera "
            "model may fit better, or the photos are unsharp or shaken.", s0=result.sigma0_px, expected=expected,
        ))  # fmt: skip
    return found


def largest_tilt(block: Block, camera: int) -> float:
    """Return the largest angle between viewing axes of two photos of a camera, radians."""
    axes = block.rotations[block.oriented & (block.camera_of_photo == camera), 2]
    return float(np.arccos(np.clip(axes @ axes.T, -1.0, 1.0)).max(initial=0.0))


def depth_range(block: Block, camera: int) -> float:
    """Return the largest over the smallest depth of a measured point in the photos of a camera."""
    depth = _depths(block, camera)
    return float(depth.max() / depth.min()) if len(depth) and depth.min() > 0 else 1.0


def coverage(block: Block, camera: int) -> Array:
    """Return how many points lie in each part of the format, int64 (rows, columns)."""
    wide, high = CELLS if block.cameras[camera].width >= block.cameras[camera].height else CELLS[::-1]
    xy = block.obs_xy[block.camera_of_photo[block.obs_photo] == camera]
    size = block.cameras[camera]
    counts, _, _ = np.histogram2d(
        xy[:, 1], xy[:, 0], bins=(high, wide), range=((-0.5, size.height - 0.5), (-0.5, size.width - 0.5))
    )
    return counts.astype(np.int64)


def _depths(block: Block, camera: int) -> Array:
    mine = block.camera_of_photo[block.obs_photo] == camera
    photo, point = block.obs_photo[mine], block.obs_point[mine]
    depth: Array = ((block.points[point] - block.centres[photo]) * block.rotations[photo, 2]).sum(axis=1)
    return depth


def _network(block: Block, c: int) -> list[str]:
    camera = block.cameras[c]
    found: list[str] = []
    label = camera.label or Text("The camera")
    photos = int((block.oriented & (block.camera_of_photo == c)).sum())
    tilt, roll = largest_tilt(block, c), largest_roll(block, c)
    share = _sigma(camera, 0) / camera.focal_px
    if not share <= WEAK_FOCAL:
        found.append(Text(
            "{label}: the principal distance is hardly determined (f = {f:.0f} ± {s:.0f} px). The photos look at the "
            "board from directions at most {tilt:.0f}° apart: then a longer principal distance and a greater distance "
            "from the board look the same. Tilt the board by 30 to 45° to all sides.",
            label=label, f=camera.focal_px, s=_sigma(camera, 0), tilt=np.degrees(tilt),
        ))  # fmt: skip
    elif tilt < LITTLE_TILT:
        found.append(Text(
            "{label}: the photos look at the board from directions at most {tilt:.0f}° apart; photos tilted by 30 to 45° "
            "determine the principal distance better.", label=label, tilt=np.degrees(tilt),
        ))  # fmt: skip
    weak = max(_sigma(camera, 1), _sigma(camera, 2))
    if roll < LITTLE_ROLL and weak > WEAK_POINT_SHARE * max(camera.width, camera.height):
        found.append(Text(
            "{label}: the principal point is known to {s:.1f} px only. No photo is rolled by 90° against another: a shift "
            "of the principal point and a tilt of the camera then look nearly the same.", label=label, s=weak,
        ))  # fmt: skip
    if photos < FEW_PHOTOS:
        found.append(Text("{label}: {n} photos are few; ten or more are usual.", label=label, n=photos))
    return found


def _coverage(block: Block, c: int) -> list[str]:
    counts = coverage(block, c)
    share = float((counts > 0).mean())
    if share >= LITTLE_COVERAGE:
        return []
    return [Text(
        "{label}: points cover {share:.0f} % of the format only; outside of it the distortion is extrapolated. Bring the "
        "board into the corners of the photo.", label=block.cameras[c].label or Text("The camera"), share=100 * share,
    )]  # fmt: skip


def _board(shape: BoardShape | None, freed: bool) -> list[str]:
    if shape is None or shape.agrees or freed:
        return []
    return [Text(
        "The board differs from its drawing (F = {f:.1f}, limit {limit:.1f}): {flat:.2f} mm out of the plane and "
        "{plane:.2f} mm in it (root mean square). Let the points of the board be free (--free-board).",
        f=shape.statistic, limit=shape.limit, flat=1000 * shape.flatness_m, plane=1000 * shape.in_plane_m,
    )]  # fmt: skip


def photo_rms(result: Adjustment) -> Array:
    """Return the root mean square of the residuals per coordinate of each photo, px; NaN where it has none."""
    n = len(result.block.names)
    squares = np.bincount(result.block.obs_photo, (result.residuals**2).sum(axis=1), minlength=n)
    counts = 2.0 * np.bincount(result.block.obs_photo, minlength=n)
    with np.errstate(invalid="ignore", divide="ignore"):
        rms: Array = np.sqrt(squares / counts)
    return rms


def _photos(result: Adjustment) -> list[str]:
    rms = photo_rms(result)
    limit = ODD_PHOTO * float(np.nanmedian(rms))
    odd = [n for n in np.argsort(-np.nan_to_num(rms)) if rms[n] > limit]
    return [Text(
        "{name} fits worse than the others ({rms:.2f} px, median {median:.2f} px): shaken, or the target mismeasured?",
        name=result.block.names[n], rms=float(rms[n]), median=float(np.nanmedian(rms)),
    ) for n in odd]  # fmt: skip


def _sigma(camera: Camera, index: int) -> float:
    return float(camera.sigmas[index]) if camera.sigmas is not None else float("nan")
