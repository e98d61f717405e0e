"""The parameters that corner detectors share: sizes at which corners are sought, and how they are described."""

from __future__ import annotations

from typing import Annotated

from graphos_core.features.detectors.point_params import PointParams
from graphos_core.params import About

LESSON = "features/corners"


class CornerParams(PointParams):
    """Parameters of every corner detector."""

    levels: Annotated[
        int,
        About(
            label="Levels",
            symbol="L",
            unit="levels",
            low=1,
            high=12,
            step=1,
            help="Corners are sought in the photo and in so many sizes of it, each smaller than the one before.",
            effect="Higher: corners survive a change of distance, slower. 1: the photo only, as published.",
            learn=LESSON,
            level="student",
        ),
    ] = 6
    scale_factor: Annotated[
        float,
        About(
            label="Factor between levels",
            symbol="f",
            low=1.1,
            high=3.0,
            step=0.1,
            help="Each level is smaller than the one before by this factor.",
            effect="Higher: a larger range with few levels, gaps between them. Lower: sizes are sampled finer.",
            learn=LESSON,
            level="expert",
        ),
    ] = 1.4
    radius: Annotated[
        int,
        About(
            label="Suppression radius",
            symbol="r",
            unit="px",
            low=1,
            high=50,
            step=1,
            help="A corner must be the strongest of all pixels so far to the right, left, up and down, on its level.",
            effect="Higher: fewer corners, farther from each other. Lower: more, also several at one place.",
            learn=LESSON,
            level="student",
        ),
    ] = 3
    patch: Annotated[
        float,
        About(
            label="Descriptor patch",
            symbol="p",
            unit="px",
            low=8.0,
            high=200.0,
            step=4.0,
            help="Side of the square that the SIFT descriptor describes, pixels of the level: 4 × 4 cells.",
            effect="Higher: more distinctive, suffers more at edges of depth and from tilt. Lower: more local.",
            learn=LESSON,
            level="student",
        ),
    ] = 24.0
    upright: Annotated[
        bool,
        About(
            label="Photos are upright",
            help="Describe every corner as it stands, instead of turning its patch by the direction of its gradients.",
            effect="On: more correct matches while photos are not turned about their axis. Off: turned photos match.",
            learn=LESSON,
            level="student",
        ),
    ] = False
    hellinger: Annotated[
        bool,
        About(
            label="RootSIFT",
            help="Compare square roots of the normalised descriptors (Hellinger distance).",
            effect="On: large bins weigh less, usually more correct matches. Off: descriptors as Lowe made them.",
            learn="features/sift",
            level="student",
        ),
    ] = True
