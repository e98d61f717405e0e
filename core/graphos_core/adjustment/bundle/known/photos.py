"""Observations of photos and cameras: positions, attitudes, rigs, and prior values of camera parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from graphos_core.adjustment.bundle.kernels import Scene
from graphos_core.adjustment.bundle.known.group import Columns, Entries, Extra, chosen
from graphos_core.adjustment.bundle.known.points import NOBODY
from graphos_core.data.record import Array
from graphos_core.geometry.rotation import matrix_from_vector, skew, vector_from_matrix


def inverse_left_jacobian(vector: Array) -> Array:
    """Return J (3, 3) with ``log(exp(ω) exp(v)) ≈ v + J ω``; for ``exp(v) exp(ω)`` its transpose holds.

    Barfoot 2017, State Estimation for Robotics, section 7.1.5.
    """
    angle = float(np.linalg.norm(vector))
    k = skew(vector)
    if angle < 1e-5:
        return np.eye(3) - 0.5 * k + k @ k / 12.0
    half = 0.5 * angle
    return np.eye(3) - 0.5 * k + (1.0 / angle**2) * (1.0 - half / np.tan(half)) * (k @ k)


@dataclass(frozen=True)
class Positions:
    """Positions of photos: antenna ``C + Rᵀ l`` with the lever arm l in the camera frame.

    Attributes
    ----------
    photos : int64 (k,)
    observed, sigma : float64 (3 k,)
    lever_arm : float64 (3,)
        Given; unknown where `extras` is not empty.
    """

    photos: Array
    observed: Array
    sigma: Array
    labels: Sequence[str]
    lever_arm: Array
    extras: tuple[Extra, ...] = ()
    kind: str = "projection centres"
    unit: str = "m"
    points: ClassVar[Array] = NOBODY

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Keep what is there."""
        keep = np.flatnonzero(photo[self.photos])
        if not len(keep):
            return None
        rows = (3 * keep[:, None] + np.arange(3)).ravel()
        return replace(self, photos=self.photos[keep], observed=self.observed[rows], sigma=self.sigma[rows],
                       labels=chosen(self.labels, rows))  # fmt: skip

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the positions."""
        k = len(self.photos)
        arm = scene.extra[at.extra_value : at.extra_value + 3] if self.extras else self.lever_arm
        turned = np.transpose(scene.rotations[self.photos], (0, 2, 1))
        rows, column = 3 * np.arange(k), at.photo[self.photos]
        entries.add_blocks(rows, column, turned @ skew(arm))
        entries.add_blocks(rows, np.where(column < 0, -1, column + 3), np.broadcast_to(np.eye(3), (k, 3, 3)))
        if self.extras:
            entries.add_blocks(rows, np.full(k, at.extra), turned)
        found: Array = (scene.centres[self.photos] + turned @ arm).ravel()
        return found


@dataclass(frozen=True)
class Attitudes:
    """Attitudes of photos: ``R = B M`` with the boresight B and the measured attitude M.

    The observation is the rotation vector of ``R (B M)ᵀ`` in the axes of the body; it is zero.

    Attributes
    ----------
    photos : int64 (k,)
    measured : float64 (k, 3, 3)
        M, ``body_from_world``.
    sigma : float64 (3 k,)
        Radians.
    boresight : float64 (3, 3)
        Start value or given; unknown as ``exp(β) B`` where `extras` is not empty.
    """

    photos: Array
    measured: Array
    sigma: Array
    labels: Sequence[str]
    boresight: Array
    extras: tuple[Extra, ...] = ()
    kind: str = "attitudes"
    unit: str = "rad"
    points: ClassVar[Array] = NOBODY

    @property
    def observed(self) -> Array:
        """Differences of attitudes: 0."""
        return np.zeros(len(self.sigma))

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Keep what is there."""
        keep = np.flatnonzero(photo[self.photos])
        if not len(keep):
            return None
        rows = (3 * keep[:, None] + np.arange(3)).ravel()
        return replace(self, photos=self.photos[keep], measured=self.measured[keep], sigma=self.sigma[rows],
                       labels=chosen(self.labels, rows))  # fmt: skip

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the differences of attitudes."""
        beta = scene.extra[at.extra_value : at.extra_value + 3] if self.extras else np.zeros(3)
        turned = matrix_from_vector(beta)
        out = np.empty((len(self.photos), 3))
        own = _left_jacobian(beta)
        for i, n in enumerate(self.photos):
            difference = vector_from_matrix(
                scene.rotations[n] @ self.measured[i].T @ self.boresight.T @ turned.T
            )
            out[i] = self.boresight.T @ difference
            j = inverse_left_jacobian(difference)
            rows = np.array([3 * i])
            entries.add_blocks(rows, at.photo[[n]], (self.boresight.T @ j)[None])
            if self.extras:
                entries.add_blocks(rows, np.array([at.extra]), (-self.boresight.T @ j.T @ own)[None])
        return out.ravel()


def _left_jacobian(vector: Array) -> Array:
    return np.asarray(np.linalg.inv(inverse_left_jacobian(vector)))


@dataclass(frozen=True)
class Rig:
    """Photos of cameras that are fixed to each other: the relative orientation is the same at every moment.

    Observations, zero: the rotation vector of ``R R_refᵀ Qᵀ`` (radians) and ``R_ref (C − C_ref) − c``.

    Attributes
    ----------
    reference, other : int64 (k,)
        Photos.
    member : int64 (k,)
        Camera of the rig that `other` was taken with, counted without the reference.
    rotations, centres : float64 (c, 3, 3), (c, 3)
        Q and c of the members, start or given values; unknown as ``exp(q) Q`` and c where `extras` is not empty.
    sigma : float64 (6 k,)
    """

    reference: Array
    other: Array
    member: Array
    rotations: Array
    centres: Array
    sigma: Array
    labels: Sequence[str]
    extras: tuple[Extra, ...] = ()
    kind: str = "rig"
    unit: str = ""
    points: ClassVar[Array] = NOBODY

    @property
    def observed(self) -> Array:
        """Differences: 0."""
        return np.zeros(len(self.sigma))

    @property
    def photos(self) -> Array:
        """Photos concerned."""
        return np.unique(np.concatenate([self.reference, self.other]))

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """Keep what is there."""
        keep = np.flatnonzero(photo[self.reference] & photo[self.other])
        if not len(keep):
            return None
        rows = (6 * keep[:, None] + np.arange(6)).ravel()
        return replace(self, reference=self.reference[keep], other=self.other[keep], member=self.member[keep],
                       sigma=self.sigma[rows], labels=chosen(self.labels, rows))  # fmt: skip

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the differences of relative orientations."""
        out = np.empty((len(self.other), 6))
        for i, (a, b, c) in enumerate(zip(self.reference, self.other, self.member, strict=True)):
            place = at.extra_value + 6 * c
            free = bool(self.extras)
            q = scene.extra[place : place + 3] if free else np.zeros(3)
            centre = scene.extra[place + 3 : place + 6] if free else self.centres[c]
            relative = matrix_from_vector(q) @ self.rotations[c]
            ra, rb = scene.rotations[a], scene.rotations[b]
            difference = vector_from_matrix(rb @ ra.T @ relative.T)
            apart = ra @ (scene.centres[b] - scene.centres[a])
            out[i, :3], out[i, 3:] = difference, apart - centre
            j = inverse_left_jacobian(difference)
            turn, shift = np.array([6 * i]), np.array([6 * i + 3])
            ca, cb = at.photo[[a]], at.photo[[b]]
            ca3, cb3 = np.where(ca < 0, -1, ca + 3), np.where(cb < 0, -1, cb + 3)
            entries.add_blocks(turn, cb, j[None])
            entries.add_blocks(turn, ca, (-j.T @ relative)[None])
            entries.add_blocks(shift, ca, -skew(apart)[None])
            entries.add_blocks(shift, cb3, ra[None])
            entries.add_blocks(shift, ca3, -ra[None])
            if free:
                column = np.array([at.extra + 6 * c])
                entries.add_blocks(turn, column, (-j.T @ _left_jacobian(q))[None])
                entries.add_blocks(shift, column + 3, -np.eye(3)[None])
        return out.ravel()


@dataclass(frozen=True)
class CameraValues:
    """Prior values of camera parameters.

    Attributes
    ----------
    camera, parameter : int64 (k,)
        Index of the camera and of the parameter in its model.
    observed, sigma : float64 (k,)
        In the parameter's unit.
    """

    camera: Array
    parameter: Array
    observed: Array
    sigma: Array
    labels: Sequence[str]
    kind: str = "camera"
    unit: str = ""
    points: ClassVar[Array] = NOBODY
    photos: ClassVar[Array] = NOBODY
    extras: tuple[Extra, ...] = ()

    def restrict(self, point: Array, photo: Array) -> Self | None:
        """All of it is there."""
        return self

    def evaluate(self, scene: Scene, at: Columns, entries: Entries) -> Array:
        """Return the parameters themselves."""
        entries.add(np.arange(len(self.camera)), at.camera[self.camera, self.parameter], np.array(1.0))
        found: Array = scene.values[self.camera, self.parameter]
        return found
