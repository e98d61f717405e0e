"""Calibrate a camera with photos of a flat test field: detect, orient, adjust, look for what is wrong."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.calibration.board import BoardShape, free_board
from graphos_core.adjustment.calibration.detection import detect_target
from graphos_core.adjustment.calibration.eccentricity import diameter_from_areas, eccentricity
from graphos_core.adjustment.calibration.findings import look_for_problems
from graphos_core.adjustment.calibration.observed import TargetObservations, nothing
from graphos_core.adjustment.calibration.start import board_pose, find_focal, start_camera
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.cameras import camera_model
from graphos_core.data import Adjustment, Array, Block, Camera, PhotoSet
from graphos_core.data.record import record
from graphos_core.errors import ItemFailure, UserError
from graphos_core.params import About, unknown_name
from graphos_core.run import Run
from graphos_core.text import Text

FEWEST_PHOTOS = 3
"""Photos of one camera with fewer than this cannot calibrate it."""
ROUNDS = 6


class CalibrateParams(TargetParams):
    """Parameters of the calibration with a test field."""

    calibration: Annotated[str, About(
        label="Camera model", help="Which parameters the camera gets.",
        effect="More parameters fit better and are known worse.", group="Camera",
        learn="adjustment/self-calibration",
    )] = "basic"  # fmt: skip
    free: Annotated[str, About(
        label="Also free", help="Parameters that are estimated beside the usual ones of the model, with commas between.",
        level="expert", group="Camera",
    )] = ""  # fmt: skip
    fix: Annotated[str, About(
        label="Held fixed", help="Parameters that keep their start value (0 for distortion), with commas between.",
        level="expert", group="Camera",
    )] = ""  # fmt: skip
    rejection: Annotated[float | None, About(
        label="Rejection limit", symbol="q", unit="σ", low=2.5, high=100, step=0.5,
        help="Points with residuals longer than this many robust standard deviations are removed; empty: none is.",
        effect="Higher: more points are kept, also wrong ones.", group="Outliers", learn="adjustment/robust",
    )] = 5.0  # fmt: skip
    free_board: Annotated[bool, About(
        label="Board not flat",
        help="The points of the board are unknowns too (free network, datum by inner constraints); the board gives "
        "approximate values and the scale.",
        effect="On: a warped or badly printed board does no harm; needs photos that are tilted and rolled.",
        group="Board", learn="adjustment/self-calibration",
    )] = False  # fmt: skip


@record
class Calibration:
    """A calibration with a test field.

    Attributes
    ----------
    adjustment : Adjustment
        Block of all photos in which the target was found; its points are the board's, its cameras calibrated.
    observations : tuple of TargetObservations
        Of every photo, in order; those not used have a reason.
    sigma_detection : float64 (m,)
        Standard deviation of each observation of the adjusted block as the detection gives it, px.
    board : BoardShape or None
        How flat the board is, where it could be determined.
    rejected : int
        Points that were removed as outliers.
    circle_mm : float
        Diameter of the circles that was used; 0 for other targets.
    dictionary : str
        Dictionary of the markers; empty for other targets.
    findings : tuple of str
        What to know, the gravest first.
    """

    adjustment: Adjustment
    observations: tuple[TargetObservations, ...]
    sigma_detection: Array
    board: BoardShape | None
    rejected: int
    circle_mm: float
    dictionary: str
    findings: tuple[str, ...]


def calibrate_camera(photos: PhotoSet, params: CalibrateParams, *, run: Run) -> Calibration:
    """Calibrate all cameras of a set of photos that show a flat test field.

    The target's points are measured in every photo; the principal distance and the orientation of every photo are
    found from the flat board; then interior and exterior orientations are adjusted together with the board's points
    held fixed (Zhang 2000, A flexible new technique for camera calibration; Luhmann et al. 2020, section 7.3), or with
    the board's points free.

    Raises
    ------
    UserError
        When the target is not found, photos are too few, or the camera model does not exist.
    Stopped
    """
    names = free_names(params)
    found, target = detect_target(photos.photos, params, run=run)
    found = _enough_photos(photos, found)
    mirrored = any(o.mirrored for o in found if o)
    board = target.points(mirrored)
    block, poses_failed = _start(photos, params, found, board, run)
    found = [nothing(o.photo, poses_failed.get(o.photo, "")) if o.photo in poses_failed else o for o in found]
    _ready(block, run)
    circle = 0.0
    result = _adjust(block, params, run)
    if params.target == "circles":
        result, circle = _without_eccentricity(result, params, found, run)
    result, rejected = _without_outliers(result, params, run)
    shape = None
    if not target.symmetric_twice and len(result.block.points) == len(board):
        freed = free_board(result, interior(result.block, names), run)
        if freed is not None:
            shape = freed[1]
            result = freed[0] if params.free_board else result
    if params.free_board and shape is None:
        raise UserError(
            "The points of this board cannot be free.",
            Text("The board looks the same after half a turn, so a point cannot be recognised in every photo.")
            if target.symmetric_twice else Text("Too few photos show all of it from different directions."),
            "Use a board whose numbers of columns and rows are odd and even, or ArUco markers; or leave it flat.",
            learn="adjustment/self-calibration",
        )  # fmt: skip
    sigma = _sigma_of(result.block, found)
    findings = look_for_problems(result, sigma, shape, rejected, params.free_board)
    for line in findings:
        run.warn(line)
    return Calibration(
        adjustment=result, observations=tuple(found), sigma_detection=sigma, board=shape, rejected=rejected,
        circle_mm=1000.0 * circle, dictionary=target.dictionary, findings=tuple(findings),
    )  # fmt: skip


def _enough_photos(photos: PhotoSet, found: list[TargetObservations]) -> list[TargetObservations]:
    """Leave out cameras with too few photos; refuse when none is left."""
    camera = np.array([p.camera for p in photos.photos])
    good = np.array([bool(o) for o in found])
    counts = np.bincount(camera[good], minlength=len(photos.cameras))
    if counts.max() < FEWEST_PHOTOS:
        each = ", ".join(f"{c.label or 'camera'}: {n}" for c, n in zip(photos.cameras, counts, strict=True))
        raise UserError(
            Text("There are too few photos of the target: {n}, at least {least} of one camera are needed.",
                 n=int(counts.max()), least=FEWEST_PHOTOS),
            Text("Photos with the target by camera: {each}.", each=each) if len(counts) > 1 else
            Text("It was found in {good} of {all} photos.", good=int(good.sum()), all=len(found)),
            "Take ten or more, tilted by 30 to 45° to all sides, some of them rolled by 90°, the board filling the photo.",
            learn="adjustment/calibrate",
        )  # fmt: skip
    return [
        o if not o or counts[c] >= FEWEST_PHOTOS
        else nothing(o.photo, Text("only {n} photos are of this camera or size ({label}), {least} are needed",
                                   n=int(counts[c]), label=photos.cameras[c].label, least=FEWEST_PHOTOS))
        for o, c in zip(found, camera, strict=True)
    ]  # fmt: skip


def _start(
    photos: PhotoSet, params: CalibrateParams, found: list[TargetObservations], board: Array, run: Run
) -> tuple[Block, dict[str, str]]:
    """Return the block with approximate values, and the photos that could not be oriented with reasons."""
    used = [i for i, o in enumerate(found) if o]
    cameras: list[Camera] = [start_camera(camera, params.calibration) for camera in photos.cameras]
    for c in sorted({photos.photos[i].camera for i in used}):
        mine = [i for i in used if photos.photos[i].camera == c]
        cameras[c] = find_focal(cameras[c], [(board[found[i].point], found[i].xy) for i in mine])
        run.check()
    poses = {
        i: board_pose(cameras[photos.photos[i].camera], board[found[i].point], found[i].xy) for i in used
    }
    failed: dict[str, str] = {
        found[i].photo: Text("its orientation was not found") for i, pose in poses.items() if pose is None
    }
    kept = [i for i in used if poses[i] is not None]
    if not kept:
        raise UserError(
            "The photos could not be oriented.",
            Text("The camera model {model} does not fit them even roughly.", model=params.calibration),
            "Take another camera model, or give the principal distance with --focal-px.", learn="adjustment/calibrate",
        )  # fmt: skip
    n = len(photos.photos)
    rotations, centres, oriented = np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3)), np.zeros(n, dtype=bool)
    for i in kept:
        pose = poses[i]
        assert pose is not None
        rotations[i], centres[i], oriented[i] = pose.rotation, pose.centre, True
    photo = np.concatenate([np.full(len(found[i].point), i) for i in kept])
    point = np.concatenate([found[i].point for i in kept])
    order = np.lexsort((photo, point))
    failures = [ItemFailure(o.photo, o.reason) for o in found if not o]
    failures += [ItemFailure(name, why) for name, why in failed.items()]
    return Block(
        cameras=tuple(cameras), names=tuple(p.name for p in photos.photos),
        camera_of_photo=np.array([p.camera for p in photos.photos], np.int32), oriented=oriented,
        rotations=rotations, centres=centres, points=board, colours=np.full((len(board), 3), 128, np.uint8),
        point_track=np.arange(len(board), dtype=np.int32), obs_photo=photo[order].astype(np.int32),
        obs_point=point[order].astype(np.int32), obs_xy=np.concatenate([found[i].xy for i in kept])[order], unit="m",
        failures=tuple(failures),
    ), failed  # fmt: skip


def _ready(block: Block, run: Run) -> None:
    n = int(block.oriented.sum())
    run.say(Text("The target was measured in {n} of {total} photos: {points} points.", n=n,
                 total=len(block.names), points=len(block.obs_xy)))  # fmt: skip


def free_names(params: CalibrateParams) -> tuple[str, ...]:
    """Return the names of the parameters that are estimated, in the order of the model.

    Raises
    ------
    UserError
        When the model or a parameter does not exist.
    """
    model = camera_model(params.calibration)
    free = {p.name for p in model.parameters if p.default == "free"}
    for text, change in ((params.free, free.add), (params.fix, free.discard)):
        for name in (part.strip() for part in text.split(",") if part.strip()):
            if name not in model.names:
                raise UserError(unknown_name(name, list(model.names), f"parameter of the model {model.name}"))
            change(name)
    return tuple(name for name in model.names if name in free)


def interior(block: Block, names: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """Return what is free of each camera: `names` of those that have photos."""
    used = {int(c) for c in np.unique(block.camera_of_photo[block.oriented])}
    return tuple(names if c in used else () for c in range(len(block.cameras)))


def _adjust(block: Block, params: CalibrateParams, run: Run) -> Adjustment:
    """Adjust in two steps: poses and principal distance first, then everything."""
    fixed = np.ones(len(block.points), dtype=bool)
    rough = Options(max_iterations=30, tolerance=1e-4, statistics=False, robust="huber", scale_px=3.0)
    first = adjust_block(
        block, Freedom(interior=interior(block, ("focal_px",) if "focal_px" in free_names(params) else ()), fixed_points=fixed), rough, run=run
    )  # fmt: skip
    return _exact(first.block, params, run)


def _exact(block: Block, params: CalibrateParams, run: Run) -> Adjustment:
    freedom = Freedom(
        interior=interior(block, free_names(params)), fixed_points=np.ones(len(block.points), dtype=bool)
    )
    return adjust_block(block, freedom, Options(max_iterations=200, tolerance=1e-12), run=run)


def _without_eccentricity(
    result: Adjustment, params: CalibrateParams, found: list[TargetObservations], run: Run
) -> tuple[Adjustment, float]:
    """Take the eccentricity of the ellipses off the observations and adjust again; the diameter used, m."""
    block = result.block
    index = np.flatnonzero(block.oriented)
    cameras = [block.cameras[block.camera_of_photo[i]] for i in index]
    poses = [(block.rotations[i], block.centres[i]) for i in index]
    board = block.points
    diameter = (
        1e-3 * params.circle_mm if params.circle_mm is not None
        else diameter_from_areas(cameras, poses, board, [found[i] for i in index])
    )  # fmt: skip
    xy = np.array(block.obs_xy)
    for i, camera, pose in zip(index, cameras, poses, strict=True):
        mine = block.obs_photo == i
        xy[mine] -= eccentricity(camera, pose, board[block.obs_point[mine]], diameter)
    return _exact(replace(block, obs_xy=xy), params, run), diameter


def _without_outliers(result: Adjustment, params: CalibrateParams, run: Run) -> tuple[Adjustment, int]:
    """Remove points that are longer than the limit, and photos that lose half of theirs, and adjust again."""
    rejected = 0
    if params.rejection is None:
        return result, 0
    for _ in range(ROUNDS):
        block = result.block
        length = np.hypot(*result.residuals.T)
        # of a circular normal distribution the median length is 1.1774 standard deviations of a coordinate
        spread = max(float(np.median(length)) / 1.1774, 1e-6)
        keep: Array = np.asarray(length <= params.rejection * spread)
        if keep.all():
            break
        rejected += int((~keep).sum())
        result = _exact(
            replace(block, obs_photo=block.obs_photo[keep], obs_point=block.obs_point[keep], obs_xy=block.obs_xy[keep]),
            params, run,
        )  # fmt: skip
    return result, rejected


def _sigma_of(block: Block, found: list[TargetObservations]) -> Array:
    """Return the detection's standard deviation of each observation of the block."""
    sigma = np.empty(len(block.obs_xy))
    track = block.point_track[block.obs_point]
    for i, observed in enumerate(found):
        mine = np.flatnonzero(block.obs_photo == i)
        if len(mine):
            place = np.searchsorted(observed.point, track[mine])
            sigma[mine] = observed.sigma[place]
    return sigma
