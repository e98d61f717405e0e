"""Self-calibration: which camera parameters are unknown, and which of them the block cannot tell."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from graphos_core.adjustment.bundle.known.photos import CameraValues
from graphos_core.cameras import camera_model
from graphos_core.cameras.conversion import as_model
from graphos_core.cameras.profile import largest_effects
from graphos_core.data import Block, Camera
from graphos_core.errors import UserError
from graphos_core.params import unknown_name
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
    def parameters(self) -> str: ...


@dataclass(frozen=True)
class Calibrated:
    """What a self-calibration estimates.

    Attributes
    ----------
    interior : tuple of tuple of str
        Free parameters of each camera, as `Freedom.interior` wants them.
    priors : tuple of (int, str, float)
        Camera, parameter and standard deviation of its start value.
    """

    interior: tuple[tuple[str, ...], ...]
    priors: tuple[tuple[int, str, float], ...] = ()

    def prior_group(self, block: Block) -> tuple[CameraValues, ...]:
        """Return the start values of the cameras that took oriented photos, as observations."""
        priors = [prior for prior in self.priors if _used(block, prior[0])]
        if not priors:
            return ()
        camera = np.array([c for c, _, _ in priors])
        place = [camera_model(block.cameras[c].model).index(name) for c, name, _ in priors]
        return (CameraValues(
            camera=camera, parameter=np.array(place),
            observed=np.array([block.cameras[c].values[i] for c, i in zip(camera, place, strict=True)]),
            sigma=np.array([sigma for _, _, sigma in priors]),
            labels=[f"{block.cameras[c].label or f'Camera {c + 1}'}: {name}" for c, name, _ in priors],
        ),)  # fmt: skip

    def only(self, interior: tuple[tuple[str, ...], ...]) -> Calibrated:
        """Return it with the parameters `interior` free and no others."""
        free = {(c, name) for c, names in enumerate(interior) for name in names}
        return Calibrated(interior, tuple(prior for prior in self.priors if prior[:2] in free))

    def without(self, frozen: Collection[tuple[int, str]]) -> Calibrated:
        """Return it with some parameters (camera, name) held fixed."""
        return Calibrated(
            tuple(tuple(n for n in names if (c, n) not in frozen) for c, names in enumerate(self.interior)),
            tuple(prior for prior in self.priors if prior[:2] not in frozen),
        )


def prepare(block: Block, calibration: str, *, per_photo: bool = False) -> Block:
    """Return the block with cameras that have the model `calibration` asks for.

    Parameters
    ----------
    block : Block
    calibration : str
        ``"fixed"`` and ``"as it is"`` leave every camera its model; else the name of a model, with hyphens.
    per_photo : bool
        Whether every photo gets a camera of its own.
    """
    cameras = list(block.cameras)
    if calibration not in ("fixed", "as it is"):
        name = calibration.replace("-", "_")  # fixed corrections before the last model stay
        cameras = [replace(as_model(replace(c, before=()), name), before=c.before) for c in cameras]
    of_photo = np.asarray(block.camera_of_photo)
    if per_photo and calibration != "fixed":
        cameras = [
            replace(cameras[c], label=f"{cameras[c].label} ({name})".strip())
            for c, name in zip(of_photo, block.names, strict=True)
        ]
        of_photo = np.arange(len(block.names), dtype=np.int32)
    return replace(block, cameras=tuple(cameras), camera_of_photo=of_photo)


def free_parameters(block: Block, switches: Switches, run: Run) -> Calibrated:
    """Return which parameters of each camera are free, and with which prior.

    What a model says of its parameters holds unless the settings say otherwise; single parameters have the last word.

    Raises
    ------
    UserError
        When a single parameter does not exist, or its setting cannot be read.
    """
    single = read_settings(switches.parameters, block)
    interior, priors = [], []
    for c, camera in enumerate(block.cameras):
        point = switches.principal_point == "free"
        free: list[str] = []
        if switches.calibration != "fixed" and switches.principal_point == "automatic":
            point = largest_roll(block, c) >= ROLL
            if not point and _used(block, c) and "x0" not in single.get(c, {}):
                run.say(Text(
                    "{camera}: the principal point is held fixed; to determine it, take some photos rolled by 90°.",
                    camera=camera.label or f"Camera {c + 1}"))  # fmt: skip
        for parameter in camera_model(camera.model).parameters:
            how: str | float = parameter.default
            if parameter.name == "focal_px" and not switches.free_focal:
                how = "fixed"
            elif parameter.name in ("x0", "y0"):
                how = how if point else "fixed"
            how = single.get(c, {}).get(parameter.name, "fixed" if switches.calibration == "fixed" else how)
            if how == "prior":
                how = parameter.prior_sigma or 0.0
            if isinstance(how, float):
                priors.append((c, parameter.name, how))
            if isinstance(how, float) or how == "free":
                free.append(parameter.name)
        interior.append(tuple(free))
    return Calibrated(tuple(interior), tuple(priors))


def read_settings(text: str, block: Block) -> dict[int, dict[str, str | float]]:
    """Read settings of single parameters: ``"k2=fixed, 2.k1=free, p1=0.001"``.

    Returns
    -------
    dict
        For each camera, what becomes of some of its parameters: ``"fixed"``, ``"free"``, or a standard deviation.

    Raises
    ------
    UserError
    """
    out: dict[int, dict[str, str | float]] = {}
    for item in filter(None, (part.strip() for part in text.replace(";", ",").split(","))):
        left, equals, right = (part.strip() for part in item.partition("="))
        number, dot, name = left.rpartition(".")
        if not equals or (dot and not number.isdigit()):
            raise _bad_setting(item)
        cameras = [int(number) - 1] if dot else range(len(block.cameras))
        known = [c for c in cameras if 0 <= c < len(block.cameras)
                 and name in camera_model(block.cameras[c].model).names]  # fmt: skip
        if not known:
            names = camera_model(block.cameras[0].model).names
            raise UserError(
                unknown_name(left, list(names), "camera parameter"), learn="adjustment/self-calibration"
            )
        for c in known:
            out.setdefault(c, {})[name] = _setting(item, right)
    return out


def _setting(item: str, text: str) -> str | float:
    if text in ("fixed", "free"):
        return text
    try:
        sigma = float(text)
    except ValueError:
        sigma = np.nan
    if not (np.isfinite(sigma) and sigma > 0):
        raise _bad_setting(item)
    return sigma


def _bad_setting(item: str) -> UserError:
    return UserError(
        Text("“{item}” is not a setting of a camera parameter.", item=item[:40]),
        todo="Write NAME=fixed, NAME=free or NAME=standard deviation, separated by commas.",
        learn="adjustment/self-calibration",
    )


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
    """Return, for each parameter, how far one standard deviation moves an image point at most over the format, px.

    Only the first-order effect of the parameter itself, whatever the other unknowns do about it; infinite where the
    standard deviation is.
    """
    if camera.sigmas is None:
        return {}
    finite = np.where(np.isfinite(camera.sigmas), camera.sigmas, 0.0)
    effects = largest_effects(camera, finite)
    names = camera_model(camera.model).names
    return effects | {n: np.inf for n, s in zip(names, camera.sigmas, strict=True) if not np.isfinite(s)}


def warn_of_weak_parameters(block: Block, run: Run) -> None:
    """Warn of every parameter of the self-calibration that the block determines badly, with the reason."""
    used = np.unique(np.asarray(block.camera_of_photo)[np.asarray(block.oriented)])
    for c in used:
        camera = block.cameras[c]
        limit = WEAK_SHARE * 0.5 * float(np.hypot(camera.width, camera.height))
        effects = corner_effect_px(camera)
        for parameter in camera_model(camera.model).parameters:
            effect = effects.get(parameter.name, 0.0)
            if np.isfinite(effect) and (effect <= limit or limit == 0.0):
                continue
            run.warn(Text(
                "{camera}: the photos hardly determine {parameter} (one standard deviation moves the corner of the "
                "photo by {effect:.1f} px). Hold it fixed, or add photos that are rolled by 90° and convergent.",
                camera=camera.label or f"Camera {c + 1}", parameter=parameter.label, effect=effect,
            ))  # fmt: skip
