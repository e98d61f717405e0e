"""Parameters that every way of orienting a block has."""

from __future__ import annotations

from typing import Annotated

from graphos_core.params import About, Params


class GrowthParams(Params):
    """How a block grows: thresholds, intermediate adjustments, several blocks."""

    min_points: Annotated[
        int,
        About(
            label="Fewest common points",
            symbol="n_{min}",
            unit="points",
            low=6,
            high=1000,
            step=1,
            group="Adding photos",
            help="Points that must agree before a photo is added to the block.",
            effect="Higher: safer, but weakly connected photos stay out.",
            learn="adjustment/orientation",
        ),
    ] = 20
    resection_px: Annotated[
        float,
        About(
            label="Resection threshold",
            unit="px",
            low=0.5,
            high=100,
            step=0.5,
            group="Adding photos",
            help="Largest distance of a point that agrees with the orientation of a new photo.",
            effect="Higher: tolerates a badly known principal distance, but also wrong matches.",
            learn="adjustment/orientation",
        ),
    ] = 8.0
    reprojection_px: Annotated[
        float,
        About(
            label="Outlier threshold",
            symbol="e_{max}",
            unit="px",
            low=0.3,
            high=50,
            step=0.5,
            group="Points",
            help="Largest distance between a measured image point and its projected object point.",
            effect="Higher: more observations, and more wrong ones among them.",
            learn="adjustment/outliers",
        ),
    ] = 3.0
    min_angle_deg: Annotated[
        float,
        About(
            label="Smallest intersection angle",
            symbol=r"\gamma_{min}",
            unit="°",
            low=0.01,
            high=60,
            step=0.5,
            group="Points",
            help="A point is kept when two of its rays meet at this angle or a larger one.",
            effect="Higher: fewer points, each more certain in depth.",
            learn="adjustment/base-and-angle",
        ),
    ] = 1.5
    adjust_growth: Annotated[
        float,
        About(
            label="Adjust after growth by",
            unit="%",
            low=1,
            high=200,
            step=5,
            group="Intermediate adjustment",
            level="expert",
            help="The block is adjusted when it has grown by this share of photos; small blocks after every photo.",
            effect="Higher: faster, but errors pile up between adjustments.",
            learn="adjustment/bundle",
        ),
    ] = 20.0
    self_calibration: Annotated[
        bool,
        About(
            label="Calibrate while orienting",
            group="Intermediate adjustment",
            help="Whether the principal distance and radial distortion are estimated once there are enough photos.",
            effect="Off: the calibration stays as given; right for a calibrated camera.",
            learn="adjustment/self-calibration",
        ),
    ] = True
    component: Annotated[
        int,
        About(
            label="Which block",
            low=1,
            high=1000,
            step=1,
            group="Several blocks",
            level="expert",
            help="Photos that cannot be connected make blocks of their own; this one becomes the main block, "
            "1 for the largest.",
            effect="2: the second largest block is the result, the others are kept beside it.",
            learn="adjustment/orientation",
        ),
    ] = 1
