"""Declarations of the controls that many simulators have: view, noise, photo, exaggeration."""

from __future__ import annotations

from graphos_core.params import About


def orbit_about() -> About:
    """Return the declaration of the observer's place around the scene."""
    return About(label="View from", unit="°", low=-180, high=180, step=5, group="Drawing", level="expert",
                 help="Direction from which the space is seen.",
                 effect="Larger: the observer walks to the right.")  # fmt: skip


def seed_about(what: str = "Seed of the simulated measuring errors.") -> About:
    """Return the declaration of a seed."""
    return About(label="Noise", symbol="seed", unit="number", low=0, high=9999, step=1, group="Drawing",
                 level="student", help=what, effect="Another number: other errors, same size.")  # fmt: skip


def photo_about(where: str, effect: str = "On: the photos show it.") -> About:
    """Return the declaration of the switch that puts a photo into the scene."""
    return About(label="Show a photo", unit="", group="Drawing", level="student", help=where, effect=effect)


def noise_about(high: float, learn: str) -> About:
    """Return the declaration of the standard deviation of an image coordinate."""
    return About(label="Image precision", symbol=r"\sigma", unit="px", low=0, high=high, step=0.1,
                 group="Measurement", help="Standard deviation of a measured image coordinate.",
                 effect="Larger: all errors grow with it.", learn=learn)  # fmt: skip
