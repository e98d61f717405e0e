"""Pictures of the simulator of networks: space, plan, section, correlation matrix, what each photo adds."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray
from graphos_core.data.record import Array
from graphos_didactic.scene import AnyMark, Dash, Handle, Line, Picture, Points, Polygon, Role, Words
from graphos_didactic.simulator import Setting
from graphos_didactic.simulators.adjustment.network_model import (
    CAMERA,
    DISTANCE,
    HEIGHT,
    KNOWN,
    RING,
    WIDTH,
    Network,
)
from graphos_didactic.simulators.adjustment.small_block import POSE
from graphos_didactic.simulators.observed_space import Observer, pyramid
from graphos_didactic.simulators.pictured_plane import Plane, photo_or_simulated, photograph

SYMBOLS = {"focal_px": "f", "x0": "x₀", "y0": "y₀", "k1": "k₁", "k2": "k₂", "p1": "p₁", "p2": "p₂"}
STRONG = 0.5
"""Correlations from here on are written into the matrix."""
ARM = 1.5
"""Length of a photo's arrow in the plan, m."""


def watcher(network: Network) -> Observer:
    """Return who looks at the network."""
    return Observer(np.array([0.0, 0.0, 2.2]), 11.5, network.params.orbit, height=21.0)


def space_marks(network: Network) -> list[AnyMark]:
    """Draw targets and photos as the observer sees them; photos that were rolled are dashed."""
    beside = watcher(network)
    edge = np.array([[-2.1, -1.7, 0], [2.1, -1.7, 0], [2.1, 1.7, 0], [-2.1, 1.7, 0]])
    known = np.isin(np.arange(len(network.targets)), KNOWN)
    marks: list[AnyMark] = [
        Polygon(panel="space", role="muted", xy=beside.seen(edge), fill=0.07, width=1.0),
        Points(panel="space", thing="targets", role="neutral", xy=beside.seen(network.targets[~known]), size=4.5),
        Points(panel="space", thing="known", role="truth", xy=beside.seen(network.targets[known]), size=10,
               marker="triangle"),
    ]  # fmt: skip
    stations = network.stations
    for i, name in enumerate(stations.names):
        marks += pyramid(beside, CAMERA, stations.rotations[i], stations.centres[i], thing=_thing(i), role=_role(i),
                         size=0.55, dash=_dash(i), label=name)  # fmt: skip
    return marks


def _thing(i: int) -> str:
    return "rolled" if i % 2 else "upright"


def _role(i: int) -> Role:
    return "second" if i % 2 else "first"


def _dash(i: int) -> Dash:
    return "dash" if i % 2 else "solid"


def plan_marks(network: Network) -> list[AnyMark]:
    """Draw the projection centres from above, with arrows to the upper edge of each photo."""
    marks: list[AnyMark] = [
        Points(panel="plan", thing="targets", role="neutral", xy=network.targets[:, :2], size=3.5),
        Points(panel="plan", thing="known", role="truth", xy=network.targets[list(KNOWN), :2], size=8, marker="triangle"),
    ]  # fmt: skip
    for i in range(network.params.photos):
        centre = network.stations.centres[i, :2]
        marks += [
            Line(panel="plan", thing=_thing(i), role=_role(i), xy=np.stack([centre, centre + ARM * _up(network, i)]),
                 width=2.0, arrow=True),
            Points(panel="plan", thing=_thing(i), role=_role(i), xy=centre[None], size=7,
                   marker="square" if i % 2 else "circle"),
        ]  # fmt: skip
    return marks


def _up(network: Network, i: int) -> Array:
    """Return where the upper edge of a photo points in plan, a unit vector."""
    up = -network.stations.rotations[i, 1, :2]
    return np.asarray(up / max(float(np.hypot(*up)), 1e-9))


def section_marks(network: Network) -> list[AnyMark]:
    """Draw the first photo and the targets from the side."""
    targets, centre = network.targets, network.stations.centres[0]
    foot = np.array([RING, 0.0])
    return [
        Line(panel="section", role="muted", xy=np.array([[-9.0, 0.0], [9.0, 0.0]]), width=1.0),
        Points(panel="section", thing="targets", role="neutral", xy=targets[:, [0, 2]], size=4.5),
        Line(
            panel="section",
            role="muted",
            dash="dot",
            xy=np.stack([foot, foot + np.array([0.0, DISTANCE])]),
            width=1.0,
        ),
        Line(panel="section", thing="upright", role="first", xy=np.stack([centre[[0, 2]], foot]), width=1.8),
    ]


def matrix_marks(network: Network) -> list[AnyMark]:
    """Draw the correlations of the camera parameters and of photo 1: blue negative, red positive, and as numbers."""
    found = network.equations
    columns = [found.of_camera[name] for name in network.names]
    labels = [SYMBOLS[name] for name in network.names] + list(POSE)
    columns += list(range(found.of_photo(0).start, found.of_photo(0).stop))
    values = found.correlations[np.ix_(columns, columns)]
    size = len(columns)
    marks: list[AnyMark] = [
        Picture(panel="matrix", pixels=diverging(values), extent=(-0.5, -0.5, size - 0.5, size - 0.5))
    ]
    for i, label in enumerate(labels):
        marks += [
            Words(panel="matrix", role="text", at=(-0.95, i), anchor="centre", text=label),
            Words(panel="matrix", role="text", at=(i, -0.95), anchor="centre", text=label),
        ]
        for j in range(i):
            if abs(values[i, j]) >= STRONG:
                marks.append(Words(panel="matrix", role="text", at=(j, i), anchor="centre", text=_short(values[i, j]),
                                   answer=True))  # fmt: skip
    k = len(network.names)
    pairs = [("f_z", "estimate", 0, k + 5), ("x0_phi", "error", 1, k + 1)]
    if "p1" in network.names:
        pairs.append(("x0_p1", "third", 1, network.names.index("p1")))
    for thing, role, i, j in pairs:
        for a, b in ((i, j), (j, i)):
            box = np.array(
                [[a - 0.46, b - 0.46], [a + 0.46, b - 0.46], [a + 0.46, b + 0.46], [a - 0.46, b + 0.46]]
            )
            marks.append(Polygon(panel="matrix", thing=thing, role=role, xy=box, fill=0.0, width=2.6))  # type: ignore[arg-type]
    return marks


def _short(value: float) -> str:
    return f"{value:.2f}".replace("0.", ".").replace("-", "−")


def diverging(values: Array) -> Array:
    """Return colours of values from −1 (blue) over 0 (white) to 1 (red), uint8 (n, n, 3); grey where not finite."""
    blue, white, red = np.array([33, 102, 172.0]), np.array([247, 247, 247.0]), np.array([178, 24, 43.0])
    part = np.abs(np.nan_to_num(values))[..., None]
    ends = np.where(values[..., None] < 0, blue, red)
    colours = white + part * (ends - white)
    colours[~np.isfinite(values)] = 160.0
    return np.repeat(np.repeat(colours.round().astype(np.uint8), 32, axis=0), 32, axis=1)


def growth_marks(network: Network, top: float) -> list[AnyMark]:
    """Draw what each photo adds: the corner effect of f, x₀ and p₁ for rings of different numbers of photos."""
    counts, effects = network.growing()
    marks: list[AnyMark] = []
    styles: tuple[tuple[str, str, Role, Dash], ...] = (
        ("focal_px", "f_z", "estimate", "solid"), ("x0", "x0_phi", "error", "dash"), ("p1", "x0_p1", "third", "dot"),
    )  # fmt: skip
    for name, thing, role, dash in styles:
        if name in effects:
            curve = np.stack([counts, np.where(np.isfinite(effects[name]), effects[name], 1e4)], axis=1)
            marks.append(Line(panel="growth", thing=thing, role=role, dash=dash, xy=curve, width=2.2, answer=True,
                              label=SYMBOLS[name]))  # fmt: skip
    here = float(network.params.photos)
    marks.append(
        Line(panel="growth", role="muted", dash="dashdot", width=1.2, xy=np.array([[here, 0], [here, top]]))
    )
    return marks


def handle_marks(network: Network, top: float) -> list[Handle]:
    """Return the handles: observer, tilt and depth in the section, roll in the plan, number of photos in the curve."""
    p, centre = network.params, network.stations.centres
    at = centre[1, :2] + ARM * _up(network, 1)
    level = float(np.degrees(np.arctan2(*_up(network, 1)))) + p.roll

    def turned(x: float, y: float) -> dict[str, float]:
        angle = np.degrees(np.arctan2(x - centre[1, 0], y - centre[1, 1]))
        return {"roll": float((level - angle + 180.0) % 360.0 - 180.0)}

    return [
        Handle(panel="section", name="tilt", thing="upright", label="Tilt", role="first", freedom="turn",
               at=(float(centre[0, 0]), float(centre[0, 2])), parameters=("tilt",), nudge=(0.1, 0.0),
               move=lambda x, z: {"tilt": float(np.degrees(np.arctan2(x - RING, max(z, 0.1))))}),
        Handle(panel="section", name="depth", thing="targets", label="Depth of the field", role="neutral", freedom="y",
               at=(-2.6, p.depth), parameters=("depth",), move=lambda _, z: {"depth": z}, nudge=(0.0, 0.05)),
        Handle(panel="plan", name="roll", thing="rolled", label="Roll", role="second", freedom="turn",
               at=(float(at[0]), float(at[1])), parameters=("roll",), move=turned, nudge=(0.1, -0.1)),
        Handle(panel="growth", name="photos", thing="photos", label="Photos", role="accent", freedom="x",
               at=(float(p.photos), 0.08 * top), parameters=("photos",), move=lambda x, _: {"photos": x},
               nudge=(1.0, 0.0)),
        watcher(network).orbit_handle(),
    ]  # fmt: skip


def photo_marks(network: Network, setting: Setting) -> list[AnyMark]:
    """Show what one camera sees: a photo on the field, and the targets."""
    k = min(network.params.shown, network.params.photos) - 1
    picture, _ = photo_or_simulated(setting)
    rotation, centre = network.stations.rotations[k], network.stations.centres[k]
    ground = Plane.centred(np.zeros(3), np.array([1.0, 0, 0]), np.array([0, -1.0, 0]), 4.4, picture)
    targets = pixel_from_ray(CAMERA, (network.targets - centre) @ rotation.T)
    known = np.isin(np.arange(len(targets)), KNOWN)
    return [
        Picture(panel="picture", pixels=photograph(CAMERA, rotation, centre, ground, picture, columns=360),
                extent=(-0.5, -0.5, WIDTH - 0.5, HEIGHT - 0.5)),
        Points(panel="picture", thing="targets", role="neutral", xy=targets[~known], size=5.0),
        Points(panel="picture", thing="known", role="truth", xy=targets[known], size=9.0, marker="triangle"),
    ]  # fmt: skip
