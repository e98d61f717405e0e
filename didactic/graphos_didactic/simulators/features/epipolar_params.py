"""The parameters of the simulator of the epipolar geometry."""

from __future__ import annotations

from typing import Annotated

from graphos_core.params import About, Params

WIDTH, HEIGHT = 1200, 900
"""Format of both cameras, px."""
WALL_Y = 4.0
"""The wall stands here, m."""
NEAR, FAR = 0.5, 60.0
"""Depths of the ray that are drawn, m."""
LESSON = "features/epipolar"


class EpipolarParams(Params):
    """Two cameras and a point, in metres: x to the right, y forward, z upwards; camera A is at height 0."""

    a_x: Annotated[
        float,
        About(
            label="Camera A, x",
            symbol="X_A",
            unit="m",
            low=-6,
            high=6,
            step=0.1,
            group="Camera A",
            level="expert",
            help="Place of camera A to the side.",
            effect="Away from camera B: longer base.",
            learn=LESSON,
        ),
    ] = -2.0
    a_y: Annotated[
        float,
        About(
            label="Camera A, y",
            symbol="Y_A",
            unit="m",
            low=-9,
            high=3,
            step=0.1,
            group="Camera A",
            level="expert",
            help="Place of camera A forward.",
            effect="Higher: nearer to the wall.",
            learn=LESSON,
        ),
    ] = -6.0
    a_turn: Annotated[
        float,
        About(
            label="Camera A turned",
            unit="°",
            low=-80,
            high=80,
            step=1,
            group="Camera A",
            help="Direction in which camera A looks; 0 is straight at the wall.",
            effect="Higher: turned to the right; its image moves to the left.",
            learn=LESSON,
        ),
    ] = 10.0
    b_x: Annotated[
        float,
        About(
            label="Camera B, x",
            symbol="X_B",
            unit="m",
            low=-6,
            high=6,
            step=0.1,
            group="Camera B",
            level="expert",
            help="Place of camera B to the side.",
            effect="Away from camera A: longer base.",
            learn=LESSON,
        ),
    ] = 2.2
    b_y: Annotated[
        float,
        About(
            label="Camera B, y",
            symbol="Y_B",
            unit="m",
            low=-9,
            high=3,
            step=0.1,
            group="Camera B",
            level="expert",
            help="Place of camera B forward.",
            effect="Higher: nearer to the wall.",
            learn=LESSON,
        ),
    ] = -5.0
    b_z: Annotated[
        float,
        About(
            label="Camera B, height",
            symbol="Z_B",
            unit="m",
            low=-3,
            high=3,
            step=0.1,
            group="Camera B",
            help="Height of camera B above camera A.",
            effect="Away from 0: the epipolar lines tilt.",
            learn=LESSON,
        ),
    ] = 0.8
    b_turn: Annotated[
        float,
        About(
            label="Camera B turned",
            unit="°",
            low=-80,
            high=80,
            step=1,
            group="Camera B",
            help="Direction in which camera B looks; 0 is straight at the wall.",
            effect="Higher: turned to the right; its image moves to the left.",
            learn=LESSON,
        ),
    ] = -18.0
    p_x: Annotated[
        float,
        About(
            label="Point, x",
            symbol="X",
            unit="m",
            low=-6,
            high=6,
            step=0.1,
            group="Point",
            level="expert",
            help="Place of the point to the side.",
            effect="Higher: to the right in both photos.",
        ),
    ] = 0.4
    p_y: Annotated[
        float,
        About(
            label="Point, y",
            symbol="Y",
            unit="m",
            low=-8,
            high=8,
            step=0.1,
            group="Point",
            level="expert",
            help="Place of the point forward.",
            effect="Higher: farther away.",
        ),
    ] = 1.0
    p_z: Annotated[
        float,
        About(
            label="Point, height",
            symbol="Z",
            unit="m",
            low=-3,
            high=3,
            step=0.1,
            group="Point",
            help="Height of the point above camera A.",
            effect="Higher: up in both photos.",
        ),
    ] = 0.7
    focal_px: Annotated[
        float,
        About(
            label="Principal distance",
            symbol="f",
            unit="px",
            low=500,
            high=3000,
            step=50,
            group="Measurement",
            help="Principal distance of both cameras.",
            effect="Longer: a smaller part is seen, larger.",
        ),
    ] = 1100.0
    noise_px: Annotated[
        float,
        About(
            label="Measuring error",
            symbol=r"\sigma",
            unit="px",
            low=0,
            high=100,
            step=1,
            group="Measurement",
            help="Standard deviation of the measured partner in photo B.",
            effect="Larger: the measured partner lies farther from the line.",
        ),
    ] = 40.0
    seed: Annotated[
        int,
        About(
            label="Noise",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Measurement",
            help="Seed of the measuring error.",
            effect="Another number: another error of the same size.",
        ),
    ] = 5
    orbit: Annotated[
        float,
        About(
            label="View from",
            unit="°",
            low=-180,
            high=180,
            step=5,
            group="Drawing",
            level="expert",
            help="Direction from which the space is drawn.",
            effect="Higher: seen more from the right.",
        ),
    ] = 25.0
    photo: Annotated[
        bool,
        About(
            label="Photo on the wall",
            group="Drawing",
            help="Hang a photo on the wall that both cameras see.",
            effect="On: both images show it.",
        ),
    ] = True
    guess_x: Annotated[
        float,
        About(
            label="Guess, x",
            unit="px",
            low=0,
            high=WIDTH - 1,
            step=1,
            group="Challenge",
            level="expert",
            help="Where you expect the partner in photo B.",
            effect="Higher: more to the right.",
        ),
    ] = 300.0
    guess_y: Annotated[
        float,
        About(
            label="Guess, y",
            unit="px",
            low=0,
            high=HEIGHT - 1,
            step=1,
            group="Challenge",
            level="expert",
            help="Where you expect the partner in photo B.",
            effect="Higher: further down.",
        ),
    ] = 450.0
    guessing: Annotated[bool, About(
        label="Show the guess", group="Challenge", level="expert", help="Show the mark for the challenge.",
        effect="On: a mark that can be dragged appears in photo B.")] = False  # fmt: skip
