"""Affine simulation: a camera on a hemisphere above a wall, and what ASIFT simulates to match its photo."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.features.detectors.affine_simulation import (
    fully_inside,
    keypoints_in_photo,
    simulate,
    views,
)
from graphos_core.features.detectors.sift import sift
from graphos_core.features.matchers.mutual import mutual
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.affine_drawing import (
    LEFT,
    count_marks,
    dome_marks,
    handle_marks,
    match_marks,
    photo_marks,
    tilt_marks,
    view_marks,
)
from graphos_didactic.simulators.features.affine_model import Simulated
from graphos_didactic.simulators.features.affine_params import LESSON, AffineParams
from graphos_didactic.simulators.features.affine_tasks import PREDICTION, affine_task
from graphos_didactic.simulators.observed_space import space_panel
from graphos_didactic.simulators.pictured_pair import HEIGHT, WIDTH

THINGS = {
    "camera": "camera B, and what it sees",
    "alone": "camera A, and SIFT alone",
    "wall": "the wall",
    "views": "simulated views: larger the more true matches they have",
    "nearest": "the simulated view that is nearest to photo B",
    "matches": "matches",
    "true": "true matches",
    "false": "false matches",
    "together": "all simulated views together",
}
STEPS = (
    Step("SIFT alone", "Photo A is matched with photo B as it is."),
    Step("Views", "Photo A is compressed by t along several directions: that is how it looks from beside."),
    Step("Each view", "SIFT on each of them, matched with photo B: only views near the true one match."),
    Step("Together", "All matches, mapped back into photo A; a place found several times counts once."),
)
PRESETS = (
    Preset("side", "From the side", "SIFT alone finds next to nothing, the views nearby find many.", {}),
    Preset("front", "Nearly from the front", "Up to some 40° SIFT needs no help.", {"tilt": 25.0}),
    Preset("above", "From above", "Other directions of tilt are simulated as well: drag camera B around.",
           {"tilt": 58.0, "swing": 95.0}),
    Preset("two", "Two tilts only", "The nearest simulated tilt is too small: what is left defeats SIFT.",
           {"tilt": 70.0, "tilts": 2}),
    Preset("grazing", "Grazing", "What is compressed eight times is gone from the photo: no simulation brings it back.",
           {"tilt": 82.0, "tilts": 4}, "degenerate"),
    Preset("photo", "Your photo", "A photo of the open project on the wall.", {"tilt": 55.0, "swing": 0.0}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="affine",
    title="Affine simulation",
    summary="Why a detector that ignores tilt can match very oblique photos when it is shown simulated views.",
    first="Drag camera B down the hemisphere and compare the two pairs of bars.",
    source="Morel and Yu 2009; Yu and Morel 2011; González-Aguilera et al. 2018, equation 1",
    engine=(views, simulate, keypoints_in_photo, fully_inside, sift, mutual, pixel_from_ray, ray_from_pixel),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=affine_task,
    learn=LESSON,
    place=20,
)
def affine(params: AffineParams, setting: Setting) -> Scene:
    """Show the hemisphere, both photos with matches, the nearest simulated view, and the matches of each view."""
    seen = Simulated(params, setting)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    found = seen.together if last >= 3 else seen.matched[seen.nearest] if last == 2 else seen.alone
    marks: list[AnyMark] = [*dome_marks(seen, last), *photo_marks(seen), *match_marks(found)]
    if last >= 1:
        marks += view_marks(seen)
    if last >= 2:
        marks += tilt_marks(seen)
    marks += [*count_marks(seen, last), *handle_marks(seen), *_sheet(seen, last)]
    return Scene(panels=_panels(seen, last), marks=tuple(marks), things=THINGS, says=_says(seen, last))


def _panels(seen: Simulated, last: int) -> tuple[Panel, ...]:
    image = seen.views[seen.nearest].simulation.image
    shown = ("SIFT alone", "SIFT alone", "nearest view", "all views")[last]
    most = max([found.right for found in seen.matched], default=1)
    top = max(seen.together.right, seen.together.wrong, seen.alone.wrong, 4)
    widest = max(4.0, 1.1 * float(seen.remaining.max())) if len(seen.remaining) < 2 else 8.0
    return (
        space_panel("Camera B on the hemisphere", (0.0, 0.0, 0.30, 0.52)),
        Panel(name="pair", title=f"Photo A · photo B · {seen.wall[1]} · matches of {shown}", rect=(0.30, 0.0, 0.70, 0.52),
              kind="picture", x_range=(-0.5, LEFT + WIDTH - 0.5), y_range=(-0.5, HEIGHT - 0.5), equal=True, y_down=True),
        Panel(name="view", title=_view_title(seen), rect=(0.0, 0.52, 0.26, 0.48), kind="picture",
              x_range=(-0.5, image.shape[1] - 0.5), y_range=(-0.5, image.shape[0] - 0.5), equal=True, y_down=True),
        Panel(name="tilts", title="Every view", rect=(0.26, 0.52, 0.26, 0.48), x_range=(0.8, widest),
              y_range=(-0.05 * max(most, 5), 1.15 * max(most, 5)), x_label="tilt left between view and photo B",
              y_label="true matches"),
        Panel(name="counts", title="SIFT alone · all views", rect=(0.52, 0.52, 0.22, 0.48), kind="picture",
              x_range=(-0.55, 1.55), y_range=(0.0, 1.15 * top), y_label="matches"),
        Panel(name="numbers", title="Numbers", rect=(0.74, 0.52, 0.26, 0.48), kind="sheet"),
    )  # fmt: skip


def _view_title(seen: Simulated) -> str:
    tilt, longitude = seen.angles[seen.nearest]
    return f"Nearest view: t = {tilt:.2f}, φ = {np.degrees(longitude):.0f}°"


def _sheet(seen: Simulated, last: int) -> list[AnyMark]:
    p, t = seen.params, seen.true_tilt
    marks: list[AnyMark] = [
        Formula(thing="camera", tex=r"A = \lambda\, R(\psi)\, T_t\, R(\varphi)"),
        Formula(thing="camera", role="second", answer=True,
                tex=rf"t = \dfrac{{1}}{{\cos {p.tilt:.0f}^\circ}} = {t:.2f}"),
        Number(thing="alone", label="SIFT alone, true", value=seen.alone.right, unit="matches", digits=0, role="truth",
               truth=True, answer=True),
    ]  # fmt: skip
    if last >= 1:
        marks += [
            Number(thing="views", label="Simulated views", value=len(seen.views), unit="", digits=0),
            Number(thing="nearest", label="Tilt left to the nearest", value=float(seen.remaining[seen.nearest]), unit="",
                   role="accent", answer=True),
        ]  # fmt: skip
    if last >= 2:
        marks.append(Number(thing="nearest", label="nearest view, true", value=seen.matched[seen.nearest].right,
                            unit="matches", digits=0, role="truth", truth=True, answer=True))  # fmt: skip
    if last >= 3:
        marks += [
            Number(thing="together", label="all views, true", value=seen.together.right, unit="matches", digits=0,
                   role="truth", truth=True, answer=True),
            Number(thing="together", label="all views, false", value=seen.together.wrong, unit="matches", digits=0,
                   role="error", truth=True, answer=True),
            Sentence(thing="views", text="Each place of photo A counts once."),
        ]  # fmt: skip
    return marks


def _says(seen: Simulated, last: int) -> str:
    p, alone = seen.params, seen.alone
    start = f"From {p.tilt:.0f}° beside the normal (t = {seen.true_tilt:.2f}) SIFT alone finds {alone.right} true matches"
    if last == 0:
        return f"{start} and {alone.wrong} false ones."
    if last < 3:
        return f"{start}; the nearest of {len(seen.views)} views leaves a tilt of {seen.remaining[seen.nearest]:.2f}."
    return f"{start}, with {len(seen.views)} simulated views {seen.together.right}; {seen.together.wrong} are false."
