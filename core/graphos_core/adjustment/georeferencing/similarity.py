"""Georeferencing by a similarity: the adjusted block keeps its shape and is moved, turned and scaled to metres."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from graphos_core.adjustment.georeferencing.measured_points import MeasuredPoints, intersect_measured
from graphos_core.data import Adjustment, Array, Control, ControlObservations, Georeference, KnownDistance
from graphos_core.errors import UserError
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

OUTLIER = 5.0
"""A control point that misses by more than this many times the point RMS of the others is named."""

ON_LINE = 1e-3
"""Control points whose second extent is less than this share of the first lie on one line."""


class SimilarityParams(Params):
    """Parameters of the similarity."""

    use: Annotated[
        Literal["auto", "control points", "known distance", "nothing"],
        About(
            label="Place by",
            help="What gives the block its scale and place.",
            effect="Control points give place, direction and scale; a known distance gives the scale only.",
            choices={
                "auto": "Whatever is there, control points first",
                "control points": "Control points",
                "known distance": "Known distance",
                "nothing": "Nothing: stay in model units",
            },
            learn="adjustment/georeferencing",
        ),
    ] = "auto"
    measurement_px: Annotated[
        float,
        About(
            label="Measurement threshold",
            unit="px",
            low=0.1,
            high=500,
            step=1,
            help="A measurement further than this from the intersected control point is left out.",
            effect="Higher: tolerates coarse pointing, but also mix-ups of points.",
            learn="adjustment/georeferencing",
        ),
    ] = 10.0
    min_angle_deg: Annotated[
        float,
        About(
            label="Smallest intersection angle",
            symbol=r"\gamma_{min}",
            unit="°",
            low=0.1,
            high=60,
            step=0.5,
            level="expert",
            help="A control point is used when two of its rays meet at this angle or a larger one.",
            effect="Higher: fewer control points, each more certain.",
            learn="adjustment/base-and-angle",
        ),
    ] = 1.0


@algorithm(
    stage="adjustment",
    role="georeferencing",
    name="similarity",
    label="Similarity",
    source="Umeyama 1991; Kraus 2007, Photogrammetry, section 4.1 (absolute orientation)",
    learn="adjustment/georeferencing",
)
def place_by_similarity(
    adjustment: Adjustment,
    control: Control | None,
    measured: ControlObservations | None,
    distance: KnownDistance | None,
    params: SimilarityParams,
    *,
    run: Run,
) -> tuple[Adjustment, Georeference]:
    """Place the block by three or more control points, or scale it by one known distance.

    Control points measured in two oriented photos or more are intersected; the similarity has the least sum of
    squared residuals over the control points, all with equal weight. Check points never take part. Without control
    points and distance the block stays as it is, in model units.

    Raises
    ------
    UserError
        With fewer than three usable control points, or control points on one line.
    """
    block = adjustment.block
    by_control = control is not None and params.use in ("auto", "control points")
    by_distance = distance is not None and params.use in ("auto", "known distance")
    points = intersect_measured(
        block, control, measured, threshold_px=params.measurement_px,
        min_angle=float(np.radians(params.min_angle_deg)), run=run,
    )  # fmt: skip
    if by_control and control is not None:
        given = np.asarray(np.isfinite(control.xyz).all(axis=1))
        usable = points.found & given & ~control.check
        if usable.sum() >= 3:
            return _by_control(adjustment, control, points, usable, run)
        if not by_distance and (given & ~control.check).any():
            raise _too_few(control, points, given)
    if by_distance and distance is not None:
        return _by_distance(adjustment, control, points, distance)
    return adjustment, _georeference("none", Similarity(1.0, np.eye(3), np.zeros(3)), control)


def transform_adjustment(adjustment: Adjustment, world_from_model: Similarity, how: str) -> Adjustment:
    """Return the adjustment moved into metres.

    Standard deviations are scaled and turned as if the three coordinates of a point were uncorrelated:
    ``σ'² = s² (R ∘ R) σ²``, with the elementwise square of the rotation. They stay relative to the datum of the
    adjustment: the uncertainty of the control points is not in them.
    """
    block, turn = adjustment.block, world_from_model.rotation**2

    def spread(sigmas: Array) -> Array:
        return world_from_model.scale * np.sqrt(sigmas**2 @ turn.T)

    oriented = np.asarray(block.oriented)
    rotations, centres = block.rotations.copy(), block.centres.copy()
    rotations[oriented] = world_from_model.rotate_camera(block.rotations[oriented])
    centres[oriented] = world_from_model.apply(block.centres[oriented])
    moved = replace(
        block, rotations=rotations, centres=centres, points=world_from_model.apply(block.points), unit="m"
    )
    return replace(
        adjustment,
        block=moved,
        sigma_centres=spread(adjustment.sigma_centres),
        sigma_points=spread(adjustment.sigma_points),
        datum=Text("{datum}; then placed by {how}", datum=adjustment.datum, how=how),
    )


def _by_control(
    adjustment: Adjustment, control: Control, points: MeasuredPoints, usable: Array, run: Run
) -> tuple[Adjustment, Georeference]:
    spread = np.linalg.svd(control.xyz[usable] - control.xyz[usable].mean(axis=0), compute_uv=False)
    if spread[1] < ON_LINE * spread[0]:
        raise UserError(
            "The block cannot be placed: its control points lie on one line.",
            "The rotation about that line is free.",
            "Measure a control point away from the line.",
            learn="adjustment/georeferencing",
        )
    world_from_model = estimate_similarity(points.xyz[usable], control.xyz[usable])
    result = _georeference("control points", world_from_model, control, points)
    _name_suspect(np.array(control.names)[usable].tolist(), points.xyz[usable], control.xyz[usable], run)
    count = int(usable.sum())
    run.say(
        Text("Placed by {count} control points, {rms:.4g} m per coordinate.", count=count, rms=result.rms_m)
    )
    how = Text("a similarity on {count} control points", count=count)
    return transform_adjustment(adjustment, world_from_model, how), result


def _name_suspect(names: list[str], model: Array, world: Array, run: Run) -> None:
    """Warn of the control point without which the others fit much better, if it misses them by far."""
    if len(names) < 5:
        return  # too little is left over to tell a wrong point from bad luck
    found = []
    for i in range(len(names)):
        others = np.delete(np.arange(len(names)), i)
        without = estimate_similarity(model[others], world[others])
        rest = without.apply(model) - world
        found.append((_rms(rest[others]), float(np.linalg.norm(rest[i])), names[i]))
    others_rms, miss, name = min(found)
    if miss > max(OUTLIER * np.sqrt(3.0) * others_rms, 1e-9):
        run.warn(
            Text(
                "Control point {name} misses by {miss:.3g} m a similarity that fits the others to {rms:.2g} m per "
                "coordinate: its coordinates or measurements may be wrong.",
                name=name,
                miss=miss,
                rms=others_rms,
            )
        )


def _by_distance(
    adjustment: Adjustment, control: Control | None, points: MeasuredPoints, distance: KnownDistance
) -> tuple[Adjustment, Georeference]:
    a, b = (_position(name, adjustment, control, points, distance) for name in (distance.a, distance.b))
    length = float(np.linalg.norm(a - b))
    if not (np.isfinite(distance.metres) and distance.metres > 0 and length > 0):
        raise UserError(
            "The known distance gives no scale.",
            Text(
                "Between {a} and {b} it is {metres:g} m, in the model {length:g} units.",
                a=distance.a,
                b=distance.b,
                metres=distance.metres,
                length=length,
            ),
            "Give two different points and a distance above zero.",
            learn="adjustment/georeferencing",
        )
    scaling = Similarity(distance.metres / length, np.eye(3), np.zeros(3))
    how = Text("the distance from {a} to {b}", a=distance.a, b=distance.b)
    return transform_adjustment(adjustment, scaling, how), _georeference("known distance", scaling, control)


def _position(
    name: str,
    adjustment: Adjustment,
    control: Control | None,
    points: MeasuredPoints,
    distance: KnownDistance,
) -> Array:
    """Position of a measured point, or of the projection centre of a photo, in model units."""
    block = adjustment.block
    if control is not None and name in control.names and points.found[control.names.index(name)]:
        return points.xyz[control.names.index(name)]
    if name in block.names and block.oriented[block.names.index(name)]:
        return block.centres[block.names.index(name)]
    raise UserError(
        Text("The known distance from {a} to {b} cannot be used.", a=distance.a, b=distance.b),
        Text("{name} is neither a point measured in two oriented photos nor an oriented photo.", name=name),
        "Measure both end points in at least two photos each, or name two oriented photos.",
        learn="adjustment/georeferencing",
    )


def _georeference(
    method: str, similarity: Similarity, control: Control | None, points: MeasuredPoints | None = None
) -> Georeference:
    """Say how the block was placed, with the residuals of all control and check points that were intersected."""
    names: tuple[str, ...] = ()
    check, residuals = np.zeros(0, dtype=bool), np.zeros((0, 3))
    if control is not None and points is not None:
        shown = np.flatnonzero(points.found & np.isfinite(control.xyz).all(axis=1))
        names = tuple(control.names[i] for i in shown)
        check = control.check[shown]
        residuals = similarity.apply(points.xyz[shown]) - control.xyz[shown]
    return Georeference(
        method=method,
        scale=similarity.scale,
        rotation=similarity.rotation,
        translation=similarity.translation,
        names=names,
        check=check,
        residuals=residuals,
        rms_m=_rms(residuals[~check]),
        check_rms_m=_rms(residuals[check]),
        origin=np.zeros(3) if control is None else control.origin,
    )


def _rms(residuals: Array) -> float:
    return float(np.sqrt((residuals**2).mean())) if len(residuals) else float("nan")


def _too_few(control: Control, points: MeasuredPoints, given: Array) -> UserError:
    kept = np.flatnonzero(given & ~control.check)
    found = int(points.found[kept].sum())
    seen = ", ".join(f"{control.names[i]} in {points.photos[i]}" for i in kept[:12])
    return UserError(
        Text(
            "The block cannot be placed: {count} control points could be computed, 3 are needed.", count=found
        ),
        Text(
            "A control point must be measured in two oriented photos or more; measured are {seen}.",
            seen=seen + (" …" if len(kept) > 12 else ""),
        ),
        "Measure at least 3 control points, not on one line, in two or more oriented photos each.",
        learn="adjustment/georeferencing",
    )
