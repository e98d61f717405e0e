"""Absolute orientation: the oriented block keeps its shape and is moved, turned and scaled to metres."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from graphos_core.adjustment.georeferencing.agreement import compare_photos, compare_scales, scale_of
from graphos_core.adjustment.georeferencing.level import levelled
from graphos_core.adjustment.georeferencing.measured_points import (
    MeasuredPoints,
    intersect_measured,
    photo_indices,
)
from graphos_core.adjustment.georeferencing.suspicions import (
    look_like_degrees,
    name_below,
    name_suspicions,
)
from graphos_core.data import Adjustment, Array, Block, Control, Georeference, Known, KnownDistance
from graphos_core.errors import UserError
from graphos_core.geometry.similarity import Similarity, estimate_similarity
from graphos_core.params import About, Params
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

ON_LINE = 1e-3
"""Control points whose second extent is less than this share of the first lie on one line."""


IN_FRAME = ("control points", "projection centres")
"""What places a block in the frame of control points."""


class SimilarityParams(Params):
    """Parameters of the similarity."""

    use: Annotated[
        Literal["auto", "control points", "projection centres", "known distance", "nothing"],
        About(
            label="Place by",
            help="What gives the block its scale and place.",
            effect="Control points and positions of photos give place, direction and scale; a known distance the scale "
            "only; a plane or axes the direction.",
            choices={
                "auto": "Whatever is there, control points first",
                "control points": "Control points",
                "projection centres": "Positions of photos (GNSS)",
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
    version=2,
    source="Umeyama 1991; Kraus 2007, Photogrammetry, section 4.1 (absolute orientation)",
    learn="adjustment/georeferencing",
)
def place_by_similarity(
    block: Block, known: Known, params: SimilarityParams, *, run: Run
) -> tuple[Block, Georeference]:
    """Place the block by control points, by positions of photos, or level and scale it.

    Control points measured in two oriented photos or more are intersected; the similarity has the least sum of
    squared residuals over the control points, all with equal weight. Without three of them positions of three photos
    serve alike; without those, planes and axes turn the block and a known distance scales it. Check points never take
    part. What is known enters the bundle adjustment afterwards with its standard deviations; this step only gives it
    a start in the right place.

    Raises
    ------
    UserError
        With fewer than three usable control points and nothing else, or control points on one line.
    """
    control = known.control
    by_control = control is not None and params.use in ("auto", "control points")
    by_centres = known.centres is not None and params.use in ("auto", "projection centres")
    distances = tuple(d for d in known.distances if not d.check)
    by_distance = bool(distances) and params.use in ("auto", "known distance")
    points = intersect_measured(
        block, control, known.measured, threshold_px=params.measurement_px,
        min_angle=float(np.radians(params.min_angle_deg)), run=run,
    )  # fmt: skip
    if by_control and control is not None:
        given = np.asarray(np.isfinite(control.xyz).all(axis=1)) & ~_off(control)
        usable = points.found & given & ~control.check
        if usable.sum() >= 3:
            return _by_control(block, known, points, usable, run)
        some = np.isfinite(control.xyz).any(axis=1) & ~_off(control)
        if not (by_distance or by_centres) and (some & ~control.check).any():
            raise _too_few(control, points, some & ~control.check, given)
        if some.any():
            run.warn(Text("The coordinates of control points take no part, and check nothing: to place the block, 3 control "
                          "points with X, Y and Z, each measured in two oriented photos, are needed beside check points; "
                          "there are {count}.", count=int(usable.sum())))  # fmt: skip
    if by_centres:
        placed = _by_centres(block, known, points, run)
        if placed is not None:
            return placed
    if params.use in ("auto", "known distance"):
        return _levelled_and_scaled(block, known, points, distances, run)
    return block, _georeference("none", NOTHING, control)


NOTHING = Similarity(1.0, np.eye(3), np.zeros(3))
"""Leaves everything where it is."""


def transform_block(block: Block, b_from_a: Similarity, unit: str) -> Block:
    """Return the block moved by a similarity."""
    oriented = np.asarray(block.oriented)
    rotations, centres = block.rotations.copy(), block.centres.copy()
    rotations[oriented] = b_from_a.rotate_camera(block.rotations[oriented])
    centres[oriented] = b_from_a.apply(block.centres[oriented])
    return replace(
        block, rotations=rotations, centres=centres, points=b_from_a.apply(block.points), unit=unit
    )


def placed_again(adjustment: Adjustment, placed: Georeference, known: Known) -> Georeference:
    """Return how an adjusted block lies in the frame of what is known: residuals of its control and check points.

    Parameters
    ----------
    adjustment : Adjustment
        With `Adjustment.point_names`.
    placed : Georeference
        How the block was placed before it was adjusted.
    known : Known
    """
    control = known.control
    place = {name: i for i, name in enumerate(adjustment.point_names) if name}
    if control is None or not place:
        return placed
    shown = np.array([i for i, name in enumerate(control.names)
                      if name in place and np.isfinite(control.xyz[i]).all()], dtype=np.int64)  # fmt: skip
    index = np.array([place[control.names[i]] for i in shown], dtype=np.int64)
    residuals = adjustment.block.points[index] - control.xyz[shown]
    check = np.asarray(control.check)[shown]
    return replace(
        placed, names=tuple(control.names[i] for i in shown), check=check, residuals=residuals,
        rms_m=_rms(residuals[~check]), check_rms_m=_rms(residuals[check]),
    )  # fmt: skip


def _off(control: Control) -> Array:
    return np.zeros(len(control.names), dtype=bool) if control.off is None else np.asarray(control.off)


def _by_control(
    block: Block, known: Known, points: MeasuredPoints, usable: Array, run: Run
) -> tuple[Block, Georeference]:
    control = known.control
    assert control is not None
    if _on_line(control.xyz[usable]):
        raise _only_line(control.xyz[usable], points.xyz[usable])
    world_from_model = estimate_similarity(points.xyz[usable], control.xyz[usable])
    result = _georeference("control points", world_from_model, control, points)
    names = np.array(control.names)[usable].tolist()
    name_suspicions(names, points.xyz[usable], control.xyz[usable], run, origin=control.origin)
    oriented = np.asarray(block.oriented)
    compare_scales(block, known, points, world_from_model.scale, run)
    name_below(control.xyz[usable], world_from_model.apply(block.centres[oriented]), run)
    run.say(Text("Placed by {count} control points, {rms:.4g} m per coordinate.", count=int(usable.sum()),
                 rms=result.rms_m))  # fmt: skip
    moved = transform_block(block, world_from_model, "m")
    compare_photos(moved, known, run)
    return moved, result


def _on_line(xyz: Array) -> bool:
    spread = np.linalg.svd(xyz - xyz.mean(axis=0), compute_uv=False)
    return bool(spread[1] <= ON_LINE * spread[0])


def _only_line(given: Array, model: Array) -> UserError:
    """Say why control points (k, 3) lie on one line, by what they look like and where they are measured (k, 3)."""
    why, todo = "The rotation about that line is free.", "Measure a control point away from the line."
    if look_like_degrees(given):
        why = "X and Y look like degrees beside heights in metres."
        todo = "Give projected coordinates, or name the coordinate system of the table (EPSG code)."
    elif not _on_line(model):
        why = "Where they are measured in the photos they do not: an axis may be in another unit, or rows are mixed up."
        todo = "Correct the table of control points."
    return UserError("The block cannot be placed: its control points lie on one line.", why, todo,
                     learn="adjustment/georeferencing")  # fmt: skip


def _by_centres(
    block: Block, known: Known, points: MeasuredPoints, run: Run
) -> tuple[Block, Georeference] | None:
    """Place the block by the positions of three photos or more; None where there are too few, or all on one line."""
    if known.centres is None:
        return None
    photo = photo_indices(block, known.centres.photo)
    use = np.flatnonzero(photo >= 0)
    use = use[np.asarray(block.oriented)[photo[use]]]
    given = known.centres.xyz[use]
    if len(use) >= 3:
        spread = np.linalg.svd(given - given.mean(axis=0), compute_uv=False)
        if spread[1] > 1e-2 * spread[0]:
            world_from_model = estimate_similarity(block.centres[photo[use]], given)
            rest = world_from_model.apply(block.centres[photo[use]]) - given
            run.say(Text("Placed by the positions of {count} photos, {rms:.3g} m per coordinate.", count=len(use),
                         rms=_rms(rest)))  # fmt: skip
            names = [block.names[n] for n in photo[use]]
            name_suspicions(names, block.centres[photo[use]], given, run, what="positions of the photos")
            reference = _georeference("projection centres", world_from_model, known.control, points)
            return transform_block(block, world_from_model, "m"), reference
    run.warn(Text("The positions of the photos do not place the block: {count} of them are oriented, and three that "
                  "do not lie on one line are needed.", count=len(use)))  # fmt: skip
    return None


def _levelled_and_scaled(
    block: Block, known: Known, points: MeasuredPoints, distances: tuple[KnownDistance, ...], run: Run
) -> tuple[Block, Georeference]:
    turn = levelled(block, known, points, run)
    method, unit = "none" if turn is None else "planes and axes", block.unit
    world_from_model = NOTHING if turn is None else turn
    if distances:
        ratios = [scale_of(distance, block, known.control, points) for distance in distances]
        scale = float(np.median(ratios))
        world_from_model = Similarity(scale, world_from_model.rotation, scale * world_from_model.translation)
        method, unit = "known distance", "m"
    if method == "none":
        return block, _georeference("none", NOTHING, known.control)
    return transform_block(block, world_from_model, unit), _georeference(
        method, world_from_model, known.control
    )


def _georeference(
    method: str, similarity: Similarity, control: Control | None, points: MeasuredPoints | None = None
) -> Georeference:
    """Say how the block was placed, with the residuals of all control and check points that were intersected."""
    names: tuple[str, ...] = ()
    check, residuals = np.zeros(0, dtype=bool), np.zeros((0, 3))
    if control is not None and points is not None:
        shown = np.flatnonzero(points.found & np.isfinite(control.xyz).all(axis=1) & ~_off(control))
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


def _too_few(control: Control, points: MeasuredPoints, wanted: Array, given: Array) -> UserError:
    kept = np.flatnonzero(wanted)
    found = int((points.found & given)[kept].sum())
    seen = ", ".join(f"{control.names[i]} in {points.photos[i]}" for i in kept[:12])
    lacking = [control.names[i] for i in kept if not given[i]]
    why = Text(
        "A control point must be measured in two oriented photos or more; measured are {seen}.",
        seen=seen + (" …" if len(kept) > 12 else ""),
    )
    if lacking:
        why = Text("A control point that places the block needs X, Y and Z; {names} lack one.",
                   names=", ".join(lacking[:12]) + " …" * (len(lacking) > 12))  # fmt: skip
    return UserError(
        Text(
            "The block cannot be placed: {count} control points could be computed, 3 are needed.", count=found
        ),
        why,
        "Measure at least 3 control points, not on one line, in two or more oriented photos each.",
        learn="adjustment/georeferencing",
    )


def in_its_frame(known: Known, placed: Georeference) -> Known:
    """Return what is known without coordinates of control points where the block was not placed in their frame."""
    if known.control is None or placed.method in IN_FRAME:
        return known
    return replace(known, control=replace(known.control, xyz=np.full(known.control.xyz.shape, np.nan)))
