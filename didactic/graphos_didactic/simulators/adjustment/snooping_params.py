"""The parameters of the simulator of data snooping."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

PHOTOS, POINTS = 4, 9
LARGEST_PX = 30.0
"""Largest blunder in each coordinate, px."""
LESSON = "adjustment/data-snooping"


def _which(label: str, high: int, group: str, what: str) -> About:
    return About(
        label=label, unit="number", low=1, high=high, step=1, group=group, level="student",
        help=f"Which {what} the wrong observation belongs to.", effect=f"Another number: another {what}.", learn=LESSON,
    )  # fmt: skip


def _size(label: str, symbol: str, group: str) -> About:
    return About(
        label=label, symbol=symbol, unit="px", low=-LARGEST_PX, high=LARGEST_PX, step=0.5, group=group, level="novice",
        help="Blunder of the measured place, beside its noise.", effect="Away from 0: a larger blunder.", learn=LESSON,
    )  # fmt: skip


class SnoopingParams(Params):
    """Four photos of nine points; two observations, A and B, can be dragged away from where they belong."""

    a_x: Annotated[float, _size("Blunder A, x", r"\nabla_A", "Observation A")] = 6.0
    a_y: Annotated[float, _size("Blunder A, y", r"\nabla_A", "Observation A")] = 0.5
    a_photo: Annotated[int, _which("Photo", PHOTOS, "Observation A", "photo")] = 2
    a_point: Annotated[int, _which("Point", POINTS, "Observation A", "point")] = 5
    b_x: Annotated[float, _size("Blunder B, x", r"\nabla_B", "Observation B")] = 0.0
    b_y: Annotated[float, _size("Blunder B, y", r"\nabla_B", "Observation B")] = 0.0
    b_photo: Annotated[int, _which("Photo", PHOTOS, "Observation B", "photo")] = 3
    b_point: Annotated[int, _which("Point", POINTS, "Observation B", "point")] = 5
    photos: Annotated[
        int,
        About(
            label="Photos",
            unit="photos",
            low=1,
            high=PHOTOS + 1,
            low_open=True,
            high_open=True,
            step=1,
            group="Block",
            level="novice",
            help="How many photos take part.",
            effect="More: larger redundancy numbers, smaller blunders are found.",
            learn="adjustment/redundancy",
        ),
    ] = 3
    removed: Annotated[
        int,
        About(
            label="Remove the worst",
            unit="times",
            low=-1,
            high=4,
            low_open=True,
            high_open=True,
            step=1,
            group="Test",
            level="novice",
            help="How often the observation with the largest w above the limit is removed and all is adjusted again.",
            effect="Larger: data snooping goes on.",
            learn=LESSON,
        ),
    ] = 0
    alpha: Annotated[
        float,
        About(
            label="Error probability",
            symbol=r"\alpha",
            unit="probability",
            low=0.0001,
            high=0.1,
            step=0.001,
            group="Test",
            help="How often the test accuses a good observation.",
            effect="Larger: lower limit, more innocent observations are accused.",
            learn=LESSON,
        ),
    ] = 0.001
    power: Annotated[
        float,
        About(
            label="Power",
            symbol=r"1-\beta",
            unit="probability",
            low=0.5,
            high=0.99,
            step=0.05,
            group="Test",
            help="How surely a blunder of the minimal detectable size is found.",
            effect="Larger: a larger minimal detectable bias.",
            learn="adjustment/minimal-detectable-bias",
        ),
    ] = 0.8
    test: Annotated[
        Literal["w", "tau"],
        About(
            label="Test",
            group="Test",
            choices={"w": "Baarda's w", "tau": "Pope's τ"},
            help="By the standard deviation that was claimed, or by the one that was found.",
            effect="Pope's τ: the level does not matter, but a blunder hides itself in it.",
            learn="adjustment/pope-tau",
        ),
    ] = "w"
    sigma_px: Annotated[
        float,
        About(
            label="Noise",
            symbol=r"\sigma",
            unit="px",
            low=0.1,
            high=3,
            step=0.1,
            group="Block",
            help="Standard deviation of a measured image coordinate, also the claimed one.",
            effect="Larger: only larger blunders are found.",
            learn="adjustment/sigma0",
        ),
    ] = 0.5
    seed: Annotated[
        int,
        About(
            label="Noise",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Block",
            help="Seed of the measuring errors.",
            effect="Another number: other errors, same size.",
        ),
    ] = 1
    exaggeration: Annotated[
        int,
        About(
            label="Residuals drawn",
            unit="times",
            low=1,
            high=100,
            step=1,
            group="Drawing",
            help="How much larger than true residuals and blunders are drawn in the photos.",
            effect="Larger: longer arrows; the numbers stay.",
        ),
    ] = 30
    photo: Annotated[
        bool,
        About(
            label="Show the photos",
            group="Drawing",
            help="Lay a photo on the ground below the points.",
            effect="On: the photos show it.",
        ),
    ] = False
