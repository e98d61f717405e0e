"""Self-calibration: which camera parameters are unknown, and which of them the block cannot tell."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data import Block, Camera
from graphos_core.run import Run
from graphos_core.text import Text

WEAK_SHARE = 0.01
"""A parameter is weak when one standard deviation moves a corner of the photo by this share of the half diagonal."""

ROLL = np.radians(60.0)
"""Roll between two photos from which the principal point is free by itself."""

ALONG = np.radians(60.0)
"""Largest angle between viewing axes of photos whose roll is compared."""


class Switches(Protocol):
    """Which parameters the person wants free."""

    @property
    def calibration(self) -> str: ...
    @property
    def free_focal(self) -> bool: ...
    @property
    def principal_point(self) -> str: ...
    @property
    def free_k1(self) -> bool: ...
    @property
    def free_k2(self) -> bool: ...


def prepare(block: Block, calibration: str, *, per_photo: bool = False) -> Block:
    """Return the block with cameras that have the parameters `calibration` asks for.

    Parameters
    ----------
    block : Block
    calibration : {"fixed", "basic"}
        With ``"basic"`` a distortion-free camera becomes a basic one with zero distortion.
    per_photo : bool
        Whether every photo gets a camera of its own.
    """
    cameras = list(block.cameras)
    if calibration == "basic":
        cameras = [_as_basic(camera) for camera in cameras]
    of_photo = np.asarray(block.camera_of_photo)
    if per_photo and calibration != "fixed":
        cameras = [
            replace(cameras[c], label=f"{cameras[c].label} ({name})".strip())
            for c, name in zip(of_photo, block.names, strict=True)
        ]
        of_photo = np.arange(len(block.names), dtype=np.int32)
    return replace(block, cameras=tuple(cameras), camera_of_photo=of_photo)


def _as_basic(camera: Camera) -> Camera:
    if camera.model != "pinhole":
        return camera
    return replace(camera, model="basic", values=np.concatenate([camera.values, [0.0, 0.0]]), sigmas=None)


def free_parameters(block: Block, switches: Switches, run: Run) -> tuple[tuple[str, ...], ...]:
    """Return the names of the free parameters of each camera, as `Freedom.interior` wants them."""
    if switches.calibration == "fixed":
        return tuple(() for _ in block.cameras)
    free = []
    for c, camera in enumerate(block.cameras):
        point = switches.principal_point == "free"
        if switches.principal_point == "automatic":
            point = largest_roll(block, c) >= ROLL
            if not point and _used(block, c):
                run.say(Text(
                    "{camera}: the principal point is held fixed; to determine it, take some photos rolled by 90°.",
                    camera=camera.label or f"Camera {c + 1}"))  # fmt: skip
        wanted = {
            "focal_px": switches.free_focal, "x0": point, "y0": point, "k1": switches.free_k1, "k2": switches.free_k2,
        }  # fmt: skip
        free.append(tuple(name for name in camera_model(camera.model).names if wanted.get(name, False)))
    return tuple(free)


def _used(block: Block, camera: int) -> bool:
    return bool((block.oriented & (block.camera_of_photo == camera)).any())


def largest_roll(block: Block, camera: int) -> float:
    """Return the largest roll between two photos of a camera that look about the same way, radians, 0 to π.

    The roll is the twist of the relative rotation about the viewing axis; pairs whose axes differ by more than
    `ALONG` are passed over, because there the twist is not defined by the photos' own roll. Without roll the
    principal point and the tilt of the photos are correlated (Fraser 2013, Automatic camera calibration in close
    range photogrammetry, section on network geometry).
    """
    rotations = block.rotations[block.oriented & (block.camera_of_photo == camera)]
    largest = 0.0
    for i, a in enumerate(rotations):
        relative = rotations[i + 1 :] @ a.T
        along = relative[:, 2, 2] > np.cos(ALONG)
        twist = np.arctan2(relative[:, 1, 0] - relative[:, 0, 1], relative[:, 0, 0] + relative[:, 1, 1])
        largest = max(largest, float(np.abs(twist[along]).max(initial=0.0)))
    return largest


def corner_effect_px(camera: Camera) -> dict[str, float]:
    """Return, for each parameter, how far one standard deviation moves the corner of the photo, px.

    Only the first-order effect of the parameter itself, whatever the other unknowns do about it.
    """
    if camera.sigmas is None:
        return {}
    r = 0.5 * float(np.hypot(camera.width, camera.height)) / camera.focal_px
    slopes = {"focal_px": r, "x0": 1.0, "y0": 1.0, "k1": camera.focal_px * r**3, "k2": camera.focal_px * r**5}
    names = camera_model(camera.model).names
    return {name: slopes.get(name, 0.0) * float(s) for name, s in zip(names, camera.sigmas, strict=True)}


def warn_of_weak_parameters(block: Block, run: Run) -> None:
    """Warn of every parameter of the self-calibration that the block determines badly, with the reason."""
    used = np.unique(np.asarray(block.camera_of_photo)[np.asarray(block.oriented)])
    for c in used:
        camera = block.cameras[c]
        limit = WEAK_SHARE * 0.5 * float(np.hypot(camera.width, camera.height))
        for parameter in camera_model(camera.model).parameters:
            effect = corner_effect_px(camera).get(parameter.name, 0.0)
            if np.isfinite(effect) and (effect <= limit or limit == 0.0):
                continue
            run.warn(Text(
                "{camera}: the photos hardly determine {parameter} (one standard deviation moves the corner of the "
                "photo by {effect:.1f} px). Hold it fixed, or add photos that are rolled by 90° and convergent.",
                camera=camera.label or f"Camera {c + 1}", parameter=parameter.label, effect=effect,
            ))  # fmt: skip
