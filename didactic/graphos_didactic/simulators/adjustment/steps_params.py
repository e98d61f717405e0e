"""The parameters of the simulator of the adjustment step by step."""

from __future__ import annotations

from typing import Annotated, Literal

from graphos_core.params import About, Params

MOST = 25
"""Iterations at most."""
LOWEST, HIGHEST = -6.0, 5.0
"""Powers of ten of the damping."""
LESSON = "adjustment/solver"


class StepsParams(Params):
    """Four photos of nine points, three of them known; everything else starts from wrong values."""

    method: Annotated[
        Literal["levenberg-marquardt", "gauss-newton", "powell"],
        About(
            label="Method",
            group="Method",
            level="novice",
            choices={
                "levenberg-marquardt": "Levenberg–Marquardt",
                "gauss-newton": "Gauss–Newton",
                "powell": "Powell's dogleg",
            },
            help="How the engine keeps a step from going too far.",
            effect="Damping bends and shortens the step, step control only shortens it, the dogleg walks within a radius.",
            learn=LESSON,
        ),
    ] = "levenberg-marquardt"
    iteration: Annotated[
        int,
        About(
            label="Iteration",
            symbol="k",
            unit="number",
            low=-1,
            high=MOST,
            low_open=True,
            step=1,
            group="Method",
            level="novice",
            help="After how many steps everything is shown; beyond the last one, the last.",
            effect="Larger: nearer to the minimum.",
            learn=LESSON,
        ),
    ] = 0
    damping: Annotated[
        float,
        About(
            label="Damping of your step",
            symbol=r"\log_{10}\lambda",
            unit="power of ten",
            low=LOWEST,
            high=HIGHEST,
            step=0.25,
            group="Method",
            level="novice",
            help="Damping λ of the step that is tried from here.",
            effect="Larger: shorter and steeper downhill. Smaller: the full Gauss–Newton step.",
            learn=LESSON,
        ),
    ] = -4.0
    start_x: Annotated[
        float,
        About(
            label="Photo 1 starts wrong, X",
            unit="m",
            low=-8,
            high=8,
            step=0.1,
            group="Start",
            level="novice",
            help="How far from its true place photo 1 starts along X.",
            effect="Away from 0: more iterations.",
            learn="adjustment/bundle",
        ),
    ] = -3.0
    start_y: Annotated[
        float,
        About(
            label="Photo 1 starts wrong, Y",
            unit="m",
            low=-8,
            high=8,
            step=0.1,
            group="Start",
            level="novice",
            help="How far from its true place photo 1 starts along Y.",
            effect="Away from 0: more iterations.",
            learn="adjustment/bundle",
        ),
    ] = 2.0
    turn: Annotated[
        float,
        About(
            label="Photo 1 starts turned",
            symbol=r"\kappa",
            unit="°",
            low=-180,
            high=180,
            step=5,
            group="Start",
            level="novice",
            help="How far photo 1 is turned about its axis of view at the start.",
            effect="Away from 0: linearisation is worse; near 180° it ends in a wrong valley.",
            learn="adjustment/bundle",
        ),
    ] = 20.0
    rough: Annotated[
        float,
        About(
            label="All else starts wrong",
            unit="m",
            low=0,
            high=3,
            step=0.1,
            group="Start",
            help="Standard deviation of the start values of all other places.",
            effect="Larger: more iterations.",
            learn="adjustment/bundle",
        ),
    ] = 0.4
    sigma_px: Annotated[
        float,
        About(
            label="Image precision",
            symbol=r"\sigma",
            unit="px",
            low=0.1,
            high=3,
            step=0.1,
            group="Measurement",
            help="Standard deviation of a measured image coordinate.",
            effect="Larger: a higher cost at the minimum.",
            learn="adjustment/sigma0",
        ),
    ] = 0.5
    seed: Annotated[
        int,
        About(
            label="Start and noise",
            symbol="seed",
            unit="number",
            low=0,
            high=9999,
            step=1,
            group="Measurement",
            help="Seed of the start values and of the measuring errors.",
            effect="Another number: another start, other errors.",
        ),
    ] = 1
    photo: Annotated[
        bool,
        About(
            label="Show the photo",
            group="Drawing",
            help="Lay a photo on the ground and show it as photo 1 sees it from where it is now.",
            effect="On: the photo moves into place while the adjustment iterates.",
        ),
    ] = False
