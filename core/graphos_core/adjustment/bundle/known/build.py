"""From what a person knows to what the adjustment takes: measured points join the block, the rest become groups."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from graphos_core.adjustment.bundle.known import shapes
from graphos_core.adjustment.bundle.known.group import Extra, Group
from graphos_core.adjustment.bundle.known.photos import Attitudes, Positions, Rig
from graphos_core.adjustment.bundle.known.points import Coordinates, Distances
from graphos_core.adjustment.georeferencing.measured_points import intersect_measured, photo_indices
from graphos_core.data import Array, Block, Control, Known, KnownDistance, KnownRig
from graphos_core.run import Run
from graphos_core.text import Text

FIRST_NAMED = -2
"""Measured point i has the track −2 − i while a block is adjusted."""


@dataclass(frozen=True)
class Defaults:
    """A priori standard deviations where nobody gave any.

    Attributes
    ----------
    control_m : float
        Of control coordinates and distances, m.
    measured_px : float
        Of a measured image point per coordinate, px.
    threshold_px : float
        A measurement further than this from the intersected point takes no part, px.
    use_control : bool
        False leaves control coordinates out: their points only check.
    """

    control_m: float = 0.01
    measured_px: float = 0.5
    threshold_px: float = 10.0
    use_control: bool = True


@dataclass(frozen=True)
class Observed:
    """What is known, as the adjustment of a block takes it.

    Attributes
    ----------
    block : Block
        With fixed control points at their given coordinates.
    groups : tuple of Group
    fixed_points : bool (p,)
        Control points held fixed.
    """

    block: Block
    groups: tuple[Group, ...]
    fixed_points: Array


def join_measured(block: Block, known: Known, defaults: Defaults) -> Block:
    """Add measured points to a block; `named_points` finds them again.

    Points measured in one photo join only when they are control points; points that are switched off do not.

    Parameters
    ----------
    block : Block
        Placed in the frame of what is known.
    known : Known
    defaults : Defaults
    """
    control, measured = known.control, known.measured
    if control is None or measured is None or not len(measured.point):
        return block
    found = intersect_measured(  # what it says was said when the block was placed
        block, control, measured, threshold_px=defaults.threshold_px, min_angle=0.0, run=Run()
    )
    off = np.zeros(len(control.names), dtype=bool) if control.off is None else np.asarray(control.off)
    known_xyz = np.isfinite(control.xyz).all(axis=1)
    single = ~found.found & known_xyz & ~control.check & (found.photos >= 1) & defaults.use_control
    joins = np.flatnonzero((found.found | single) & ~off)
    place = np.full(len(control.names), -1)
    place[joins] = len(block.points) + np.arange(len(joins))
    photo = photo_indices(block, measured.photo)
    use = (photo >= 0) & (place[measured.point] >= 0) & ~found.left_out
    use[use] &= np.asarray(block.oriented)[photo[use]]
    xyz = np.where(found.found[joins, None], found.xyz[joins], control.xyz[joins])
    sigma = np.full(len(measured.point), np.nan) if measured.sigma_px is None else np.array(measured.sigma_px)
    sigma[~np.isfinite(sigma)] = defaults.measured_px
    ties = np.ones(len(block.obs_xy)) if block.obs_sigma_px is None else block.obs_sigma_px
    return _sorted(replace(
        block, points=np.vstack([block.points, xyz]),
        colours=np.vstack([block.colours, np.full((len(joins), 3), 255, dtype=np.uint8)]),
        point_track=np.concatenate([block.point_track, (FIRST_NAMED - joins).astype(np.int32)]),
        obs_photo=np.concatenate([block.obs_photo, photo[use].astype(np.int32)]),
        obs_point=np.concatenate([block.obs_point, place[measured.point[use]].astype(np.int32)]),
        obs_xy=np.vstack([block.obs_xy, measured.xy[use]]),
        obs_sigma_px=np.concatenate([ties, sigma[use]]),
    ))  # fmt: skip


def is_measured(block: Block) -> Array:
    """Say which points (bool (p,)) `join_measured` added."""
    return np.asarray(block.point_track <= FIRST_NAMED)


def named_points(block: Block, known: Known) -> dict[str, int]:
    """Return name → index of the measured points among the block's points."""
    if known.control is None:
        return {}
    index = np.flatnonzero(is_measured(block))
    return {known.control.names[FIRST_NAMED - int(block.point_track[i])]: int(i) for i in index}


def observe(block: Block, known: Known, defaults: Defaults, run: Run) -> Observed:
    """Make groups of everything known about a block with measured points.

    Photos and points that something refers to but that are not there are told.
    """
    named = named_points(block, known)
    fixed = np.zeros(len(block.points), dtype=bool)
    groups: list[Group] = []
    if known.control is not None and defaults.use_control:
        coordinates, held = _coordinates(known.control, named, defaults)
        fixed[list(held)] = True
        points = np.array(block.points)
        for index, xyz in held.items():
            points[index] = xyz
        block = replace(block, points=points)
        groups += [coordinates] if coordinates is not None else []
    groups += _distances(block, known.distances, named, defaults, run)
    for shape in known.shapes:
        groups += shapes.groups_of(shape, block, named, block.unit, run)
    if known.centres is not None:
        groups += _positions(block, known, run)
    if known.attitudes is not None:
        groups += _attitudes(block, known, run)
    for rig in known.rigs:
        groups += _rig(block, rig, run)
    groups += _held_scale(block, groups)
    return Observed(block, tuple(groups), fixed)


def _sorted(block: Block) -> Block:
    order = np.lexsort((block.obs_photo, block.obs_point))
    sigma = None if block.obs_sigma_px is None else block.obs_sigma_px[order]
    return replace(block, obs_photo=block.obs_photo[order], obs_point=block.obs_point[order],
                   obs_xy=block.obs_xy[order], obs_sigma_px=sigma)  # fmt: skip


def _coordinates(
    control: Control, named: dict[str, int], defaults: Defaults
) -> tuple[Coordinates | None, dict[int, Array]]:
    """Return the weighted coordinates, and the points (index → coordinates) that are held fixed."""
    sigma = np.full(control.xyz.shape, np.nan) if control.sigma is None else np.array(control.sigma)
    sigma[np.isnan(sigma)] = defaults.control_m
    rows: list[tuple[int, int, float, float, str]] = []
    held: dict[int, Array] = {}
    for i, name in enumerate(control.names):
        if name not in named or control.check[i]:
            continue
        if np.isfinite(control.xyz[i]).all() and (sigma[i] == 0.0).all():
            held[named[name]] = control.xyz[i]
            continue
        for axis in np.flatnonzero(np.isfinite(control.xyz[i])):
            least = max(float(sigma[i, axis]), 1e-3 * defaults.control_m)
            rows.append((named[name], int(axis), float(control.xyz[i, axis]), least, f"{name} {'XYZ'[axis]}"))
    if not rows:
        return None, held
    point, axes, xyz, spread, labels = (list(column) for column in zip(*rows, strict=True))
    return Coordinates(np.array(point), np.array(axes), np.array(xyz), np.array(spread), labels), held  # fmt: skip


def _distances(
    block: Block, distances: Sequence[KnownDistance], named: dict[str, int], defaults: Defaults, run: Run
) -> list[Group]:
    of_points: list[tuple[int, int, float, float, str]] = []
    of_photos: list[tuple[int, int, float, float, str]] = []
    for d in distances:
        if d.check:
            continue
        if d.a == d.b:
            run.warn(Text("The distance from {a} to itself takes no part.", a=d.a))
            continue
        sigma = max(defaults.control_m if d.sigma is None else d.sigma, 1e-9)
        label = f"{d.a}–{d.b}"
        photos = photo_indices(block, (d.a, d.b))
        if d.a in named and d.b in named:
            of_points.append((named[d.a], named[d.b], d.metres, sigma, label))
        elif (photos >= 0).all() and np.asarray(block.oriented)[photos].all():
            of_photos.append((int(photos[0]), int(photos[1]), d.metres, sigma, label))
        else:
            run.warn(Text("The distance from {a} to {b} takes no part: its ends are not both measured in two oriented "
                          "photos.", a=d.a, b=d.b))  # fmt: skip
    out: list[Group] = []
    for rows, photo in ((of_points, False), (of_photos, True)):
        if rows:
            a, b, metres, sigma_m, labels = (list(column) for column in zip(*rows, strict=True))
            out.append(
                Distances(np.array(a), np.array(b), np.array(metres), np.array(sigma_m), labels, photo)
            )
    return out


def _held_scale(block: Block, groups: Sequence[Group]) -> list[Group]:
    """Hold the longest base where shapes or rigs have lengths as residuals but nothing gives the scale.

    Without it the block would shrink until those residuals vanish.
    """
    kinds = {group.kind for group in groups}
    heights = {
        float(z) for g in groups if isinstance(g, Coordinates) and g.kind == "planes" for z in g.observed
    }
    if (
        len(heights) > 1
        or any(_scales(group) for group in groups)
        or not {"planes", "lines", "axes", "rig"} & kinds
    ):
        return []
    photos = np.flatnonzero(block.oriented)
    centres = np.asarray(block.centres)[photos]
    a = int(np.argmax(np.linalg.norm(centres - centres.mean(axis=0), axis=1)))
    b = int(np.argmax(np.linalg.norm(centres - centres[a], axis=1)))
    length = float(np.linalg.norm(centres[a] - centres[b]))
    label = f"{block.names[photos[a]]}–{block.names[photos[b]]}"
    return [Distances(photos[[a]], photos[[b]], np.array([length]), np.array([1e-6 * length]), [label], True,
                      block.unit, "datum")]  # fmt: skip


def _scales(group: Group) -> bool:
    """Say whether a group gives the scale: given lengths and places, and rigs whose base is given."""
    if isinstance(group, Rig):
        return not group.extras and bool(np.any(group.centres))
    return group.kind in ("control coordinates", "distances", "projection centres")


def _there(block: Block, names: Sequence[str], what: str, run: Run) -> tuple[Array, Array]:
    """Return the photos (indices) that are oriented, and their places in `names`; tell the others."""
    photo = photo_indices(block, names)
    use = np.flatnonzero(photo >= 0)
    if len(use) < len(names):
        run.warn(Text("{count} {what} belong to photos that are not in the project, such as {name}.",
                      count=len(names) - len(use), what=what,
                      name=names[int(np.flatnonzero(photo < 0)[0])]))  # fmt: skip
    use = use[np.asarray(block.oriented)[photo[use]]]
    return photo[use], use


def _positions(block: Block, known: Known, run: Run) -> list[Group]:
    given = known.centres
    assert given is not None
    photos, use = _there(block, given.photo, "positions", run)
    if not len(use):
        return []
    labels = [f"{block.names[n]} {axis}" for n in photos for axis in "XYZ"]
    arm = tuple(
        Extra(f"lever arm {axis}", float(v), "m") for axis, v in zip("xyz", given.lever_arm, strict=True)
    )
    return [Positions(photos, given.xyz[use].ravel(), given.sigma[use].ravel(), labels, np.asarray(given.lever_arm),
                      arm if given.lever_arm_free else ())]  # fmt: skip


def _attitudes(block: Block, known: Known, run: Run) -> list[Group]:
    given = known.attitudes
    assert given is not None
    photos, use = _there(block, given.photo, "attitudes", run)
    if not len(use):
        return []
    labels = [f"{block.names[n]} about {axis}" for n in photos for axis in "xyz"]
    turn = tuple(Extra(f"boresight about {axis}", 0.0, "rad") for axis in "xyz")
    return [Attitudes(photos, np.asarray(given.rotations[use]), given.sigma[use].ravel(), labels,
                      np.asarray(given.boresight), turn if given.boresight_free else ())]  # fmt: skip


def _rig(block: Block, rig: KnownRig, run: Run) -> list[Group]:
    reference, other, member, labels, sigma = [], [], [], [], []
    for moment in rig.photos:
        index = [int(photo_indices(block, (name,))[0]) if name else -1 for name in moment]
        usable = [i if i >= 0 and block.oriented[i] else -1 for i in index]
        for c, n in enumerate(usable[1:]):
            if usable[0] >= 0 and n >= 0:
                reference.append(usable[0])
                other.append(n)
                member.append(c)
                labels += [f"{block.names[n]} {what}" for what in ("ω", "φ", "κ", "x", "y", "z")]
                sigma += [rig.sigma_rotation] * 3 + [rig.sigma_centre] * 3
    if not other:
        run.warn(
            Text(
                "The rig {name} takes no part: no moment has two oriented photos.",
                name=rig.name or "without name",
            )
        )
        return []
    seen = sorted(set(member))  # cameras without a photo beside the reference have no unknowns
    extras: tuple[Extra, ...] = ()
    if rig.free:
        unit = block.unit
        extras = tuple(
            Extra(f"{rig.name or 'rig'}, camera {c + 2}: {what}", start, u)
            for c in seen
            for what, start, u in [
                *((f"rotation about {a}", 0.0, "rad") for a in "xyz"),
                *((f"centre {a}", float(v), unit) for a, v in zip("xyz", rig.centres[c + 1], strict=True)),
            ]
        )
    return [Rig(np.array(reference), np.array(other), np.searchsorted(seen, member), np.asarray(rig.rotations[1:])[seen],
                np.asarray(rig.centres[1:])[seen], np.array(sigma), labels, extras)]  # fmt: skip
