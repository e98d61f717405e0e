"""Does what is known beside control points agree with them: distances, positions and attitudes of photos."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphos_core.adjustment.georeferencing.measured_points import MeasuredPoints, photo_indices
from graphos_core.adjustment.georeferencing.suspicions import BAD_FIT, READINGS
from graphos_core.data import Array, Block, Control, Known, KnownDistance
from graphos_core.errors import UserError
from graphos_core.run import Run
from graphos_core.text import Text

USUAL_SIGMA_M = 0.01
"""Standard deviation of a distance that says none, m."""

FAR = 20.0
"""Photos that lie this many standard deviations away, in the median, are in another system."""

UNCERTAIN = 0.5
"""What is known to no better than this share of itself tells nothing about the scale."""


def compare_scales(block: Block, known: Known, points: MeasuredPoints, by_control: float, run: Run) -> None:
    """Warn where distances, or positions of photos, give the block another scale than the control points.

    Parameters
    ----------
    block : Block
        Before it is placed.
    known : Known
    points : MeasuredPoints
        In the frame of `block`.
    by_control : float
        Metres per model unit by the control points.
    run : Run
    """
    names = set(np.array(() if known.control is None else known.control.names)[points.found].tolist())
    names |= set(np.array(block.names)[np.asarray(block.oriented)].tolist())
    there = [d for d in known.distances if d.a in names and d.b in names]
    if there:
        scale = float(np.median([scale_of(d, block, known.control, points) for d in there]))
        share = min((USUAL_SIGMA_M if d.sigma is None else d.sigma) / d.metres for d in there)
        _compare(by_control, scale, 3.0 * share, "the known distances", run)
    if known.centres is not None:
        photo, use = _oriented(block, known.centres.photo)
        given, model = known.centres.xyz[use], block.centres[photo]
        if len(use) >= 3 and np.ptp(model, axis=0).any():
            share = float(np.max(known.centres.sigma[use]) / (np.linalg.norm(np.ptp(given, axis=0)) or 1e-9))
            scale = float(
                np.linalg.norm(given - given.mean(axis=0)) / np.linalg.norm(model - model.mean(axis=0))
            )
            _compare(by_control, scale, 3.0 * share, "the positions of the photos", run)


def compare_photos(block: Block, known: Known, run: Run) -> None:
    """Warn where positions or attitudes of photos lie far from those of a block that control points have placed.

    Parameters
    ----------
    block : Block
        Placed.
    known : Known
    run : Run
    """
    if known.centres is not None:
        photo, use = _oriented(block, known.centres.photo)
        apart = np.linalg.norm(block.centres[photo] - known.centres.xyz[use], axis=1)
        spread = np.linalg.norm(known.centres.sigma[use], axis=1)
        if len(use) and np.median(apart / spread) > FAR:
            run.warn(Text("The positions of the photos lie {miss:.3g} m from where the control points put the photos: they "
                          "are in another coordinate system or unit, or belong to other photos. Give both in one system, "
                          "or take the section [gnss] out.", miss=float(np.median(apart))))  # fmt: skip
    if known.attitudes is not None and not known.attitudes.boresight_free:
        photo, use = _oriented(block, known.attitudes.photo)
        given = known.attitudes.boresight @ known.attitudes.rotations[use]
        turns = block.rotations[photo] @ np.swapaxes(given, 1, 2)
        angle = np.arccos(np.clip(0.5 * (np.trace(turns, axis1=1, axis2=2) - 1.0), -1.0, 1.0))
        spread = np.linalg.norm(known.attitudes.sigma[use], axis=1)
        if len(use) and np.median(angle / spread) > FAR:
            run.warn(Text("The attitudes of the photos differ by {miss:.3g}° from those the control points give: their "
                          "order, unit or axes are others (needed are omega, phi, kappa in degrees), or a boresight is "
                          "missing.", miss=float(np.degrees(np.median(angle)))))  # fmt: skip


def _oriented(block: Block, names: Sequence[str]) -> tuple[Array, Array]:
    """Return the oriented photos (indices) of some names, and their places in `names`."""
    photo = photo_indices(block, names)
    use = np.flatnonzero(photo >= 0)
    use = use[np.asarray(block.oriented)[photo[use]]]
    return photo[use], use


def _compare(by_control: float, other: float, share: float, what: str, run: Run) -> None:
    ratio, limit = other / by_control, max(BAD_FIT, share)
    if not 0 < ratio < np.inf or limit > UNCERTAIN or abs(np.log(ratio)) < limit:
        return
    unit = next((u for f, (u, of) in READINGS.items() if of == "m" and abs(np.log(ratio / f)) < limit), "")
    reason = Text("the coordinates of the control points seem to be in {unit}, not in m", unit=unit) if unit \
        else Text("one of the two is in another unit, or wrong")  # fmt: skip
    run.warn(Text("By {what} the block is {ratio:.4g} times as large as by the control points: {reason}.", what=what,
                  ratio=ratio, reason=reason))  # fmt: skip


def scale_of(distance: KnownDistance, block: Block, control: Control | None, points: MeasuredPoints) -> float:
    """Return metres per model unit by one distance.

    Raises
    ------
    UserError
        When an end is not in the block, or the distance is none.
    """
    a, b = (_position(name, block, control, points, distance) for name in (distance.a, distance.b))
    length = float(np.linalg.norm(a - b))
    if not (np.isfinite(distance.metres) and distance.metres > 0 and length > 0):
        raise UserError(
            "The known distance gives no scale.",
            Text(
                "Between {a} and {b} it is {metres:g} m, in the model {length:g} units.",
                a=distance.a, b=distance.b, metres=distance.metres, length=length,
            ),
            "Give two different points and a distance above zero.",
            learn="adjustment/georeferencing",
        )  # fmt: skip
    return distance.metres / length


def _position(
    name: str,
    block: Block,
    control: Control | None,
    points: MeasuredPoints,
    distance: KnownDistance,
) -> Array:
    """Position of a measured point, or of the projection centre of a photo, in model units."""
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
