"""Pictures of the simulator of affine simulation: hemisphere, photos, the nearest simulated view, matches of each."""

from __future__ import annotations

import numpy as np

from graphos_core.data.record import Array
from graphos_core.geometry.rotation import look_at, matrix_from_vector
from graphos_didactic.scene import AnyMark, Bars, Handle, Line, Picture, Points, Polygon, Words
from graphos_didactic.simulators.features.affine_model import Matched, Simulated
from graphos_didactic.simulators.observed_space import Observer, pyramid
from graphos_didactic.simulators.pictured_pair import CAMERA, HEIGHT, WIDTH

GAP = 16
"""Between both photos, px."""
LEFT = WIDTH + GAP
"""Where photo B begins, px."""


def watcher(seen: Simulated) -> Observer:
    """Return who looks at the hemisphere."""
    return Observer(np.array([0.0, 0.0, 0.3]), 4.0, seen.params.orbit, 26.0, 640.0)


def on_dome(tilt: float, swing: Array | float) -> Array:
    """Return places on the hemisphere of radius 1, float64 (n, 3): X to the right of the wall's picture, Y up in it."""
    theta, phi = np.radians(tilt), np.radians(np.atleast_1d(np.asarray(swing, dtype=float)))
    flat = np.sin(theta) * np.stack([np.cos(phi), np.sin(phi)], axis=1)
    return np.concatenate([flat, np.full((len(phi), 1), np.cos(theta))], axis=1)


def dome_marks(seen: Simulated, last: int) -> list[AnyMark]:
    """Draw the wall below the hemisphere, camera B on it, and from where photo A is simulated."""
    view, p = watcher(seen), seen.params
    around = np.linspace(0, 360, 61)
    half = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * (0.42, 0.315, 1.0)
    marks: list[AnyMark] = [
        Polygon(panel="space", thing="wall", role="muted", xy=view.seen(half), fill=0.2, width=1.4)
    ]
    for tilt in (30.0, 60.0, 89.9):
        marks.append(Line(panel="space", role="grid", xy=view.seen(on_dome(tilt, around)), width=1.2))
    for swing in (0.0, 90.0):
        arc = np.concatenate([on_dome(t, swing) for t in np.linspace(-89.9, 89.9, 41)])
        marks.append(Line(panel="space", role="grid", xy=view.seen(arc), width=1.2))
    if last >= 1:
        marks += _stations(seen, view, last)
    centre = on_dome(p.tilt, p.swing)[0]
    rotation = look_at(centre, np.zeros(3), np.array([0.0, 1.0, 0.0]))
    rotation = matrix_from_vector(np.array([0.0, 0.0, np.radians(p.roll)])) @ rotation
    marks.append(Line(panel="space", thing="camera", role="second", xy=view.seen(np.stack([centre, np.zeros(3)])),
                      dash="dash", width=1.4))  # fmt: skip
    marks += pyramid(
        view, CAMERA, rotation, centre, thing="camera", role="second", size=0.26, label="B", dash="dash"
    )
    marks += pyramid(view, CAMERA, look_at(np.array([0.0, 0.0, 1.0]), np.zeros(3), np.array([0.0, 1.0, 0.0])),
                     np.array([0.0, 0.0, 1.0]), thing="alone", role="first", size=0.2, label="A")  # fmt: skip
    return marks


def _stations(seen: Simulated, view: Observer, last: int) -> list[AnyMark]:
    """Draw where each simulated view is taken from, twice: an affine camera does not tell which side it came from."""
    marks: list[AnyMark] = []
    for i, (tilt, longitude) in enumerate(seen.angles):
        theta = float(np.degrees(np.arccos(1.0 / tilt)))
        swing = float(np.degrees(longitude))
        places = view.seen(on_dome(theta, np.array([swing, swing + 180.0])))
        right = seen.matched[i].right if last >= 2 else 0
        size = 4.5 + 1.6 * float(np.sqrt(right))
        marks.append(
            Points(panel="space", thing="views", role="truth" if right else "neutral", xy=places, size=size)
        )
        if i == seen.nearest and last >= 1:
            marks.append(
                Points(
                    panel="space", thing="nearest", role="accent", xy=places, size=size + 8.0, marker="ring"
                )
            )
    return marks


def photo_marks(seen: Simulated) -> list[AnyMark]:
    """Show photo A and photo B beside each other."""
    return [
        Picture(panel="pair", pixels=seen.photo_a, extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)),
        Picture(
            panel="pair", pixels=seen.photo_b, extent=(LEFT - 0.5, -0.5, LEFT + WIDTH - 0.5, HEIGHT - 0.5)
        ),
    ]


def match_marks(found: Matched) -> list[AnyMark]:
    """Draw matches as lines: true and false ones differently while the truth is shown."""
    a, b = found.a, found.b + np.array([LEFT, 0.0])
    lines = np.stack([a, b, np.full_like(a, np.nan)], axis=1)
    marks: list[AnyMark] = []
    if len(a):
        marks.append(
            Line(panel="pair", thing="matches", role="neutral", xy=lines.reshape(-1, 2)[:-1], width=0.8)
        )
    if found.right:
        xy = lines[found.true].reshape(-1, 2)[:-1]
        marks += [
            Line(panel="pair", thing="true", role="truth", xy=xy, width=1.0, truth=True),
            Points(panel="pair", thing="true", role="truth", xy=a[found.true], size=5.0, truth=True),
            Points(panel="pair", thing="true", role="truth", xy=b[found.true], size=5.0, truth=True),
        ]
    if found.wrong:
        xy = lines[~found.true].reshape(-1, 2)[:-1]
        marks += [
            Line(panel="pair", thing="false", role="error", xy=xy, width=1.6, dash="dash", truth=True),
            Points(
                panel="pair",
                thing="false",
                role="error",
                xy=a[~found.true],
                marker="cross",
                size=7.0,
                truth=True,
            ),
        ]
    return marks


def view_marks(seen: Simulated) -> list[AnyMark]:
    """Show the nearest simulated view, with those of its features that are true matches."""
    view = seen.views[seen.nearest]
    image = view.simulation.image
    height, width = image.shape
    found = seen.matched[seen.nearest]
    marks: list[AnyMark] = [
        Picture(panel="view", thing="nearest", pixels=image, extent=(-0.5, -0.5, width - 0.5, height - 0.5))
    ]
    if found.right:
        there = found.a[found.true] @ view.simulation.simulated_from_photo[:, :2].T
        xy = there + view.simulation.simulated_from_photo[:, 2]
        marks.append(Points(panel="view", thing="true", role="truth", xy=xy, size=6.0, truth=True))
    return marks


def tilt_marks(seen: Simulated) -> list[AnyMark]:
    """Draw for each view how much tilt is left and how many of its matches are true."""
    right = np.array([found.right for found in seen.matched], dtype=float)
    xy = np.stack([seen.remaining, right], axis=1)
    return [
        Points(panel="tilts", thing="views", role="truth", xy=xy, size=7.0, truth=True, answer=True),
        Points(panel="tilts", thing="nearest", role="accent", xy=xy[[seen.nearest]], size=15.0, marker="ring", truth=True,
               answer=True),
        Points(panel="tilts", thing="alone", role="first", xy=xy[:1], size=11.0, marker="square", label="photo A itself",
               truth=True, answer=True),
    ]  # fmt: skip


def count_marks(seen: Simulated, last: int) -> list[AnyMark]:
    """Draw true and false matches of SIFT alone and of all views together."""
    groups = [("alone", seen.alone, 0.0)]
    if last >= 3:
        groups.append(("together", seen.together, 1.0))
    marks: list[AnyMark] = []
    for thing, found, at in groups:
        for role, count, shift in (("truth", found.right, -0.21), ("error", found.wrong, 0.21)):
            edges = np.array([at + shift - 0.19, at + shift + 0.19])
            marks += [
                Bars(panel="counts", thing=thing, role=role, edges=edges, heights=np.array([float(count)]),  # type: ignore[arg-type]
                     fill=0.6 if role == "truth" else 0.35, truth=True, answer=thing == "together"),
                Words(panel="counts", role="text", at=(at + shift, float(count)), anchor="bottom", truth=True,
                      text=f"{count} {'true' if role == 'truth' else 'false'}", answer=thing == "together"),
            ]  # fmt: skip
    return marks


def handle_marks(seen: Simulated) -> list[AnyMark]:
    """Return the handles: camera B on the hemisphere, and the observer."""
    view, p = watcher(seen), seen.params
    at = view.seen(on_dome(p.tilt, p.swing))[0]

    def move(x: float, y: float) -> dict[str, float]:
        way = view.on_sphere(np.zeros(3), 1.0, x, y)
        tilt = float(np.degrees(np.arccos(np.clip(way[2], -1.0, 1.0))))
        swing = float(np.degrees(np.arctan2(way[1], way[0])))
        return {"tilt": tilt, "swing": swing} if tilt > 1e-6 else {"tilt": 0.0}

    return [
        Handle(panel="space", name="camera", thing="camera", label="Camera B", role="second", freedom="slide",
               at=(float(at[0]), float(at[1])), parameters=("tilt", "swing"), nudge=(4.0, 4.0), move=move),
        view.orbit_handle(),
    ]  # fmt: skip
