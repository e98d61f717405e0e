"""The ratio test: distances of true and false matches, and where to put the threshold."""

from __future__ import annotations

import numpy as np

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.features.detectors.sift import sift
from graphos_core.features.matchers.mutual import mutual, nearest_two
from graphos_core.geometry.rotation import look_at
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.ratio_test_drawing import (
    LEFT,
    curve_marks,
    distance_marks,
    handle_marks,
    histogram_edges,
    histogram_marks,
    looked_marks,
    match_marks,
    photo_marks,
)
from graphos_didactic.simulators.features.ratio_test_model import Judged
from graphos_didactic.simulators.features.ratio_test_params import FARTHEST, LESSON, RatioTestParams
from graphos_didactic.simulators.features.ratio_test_tasks import PREDICTION, ratio_test_task
from graphos_didactic.simulators.pictured_pair import HEIGHT, WIDTH

THINGS = {
    "accepted": "candidates: each feature of A with its nearest in B; lines are the accepted ones",
    "true": "true matches: within the tolerance of where the point really is",
    "false": "false matches",
    "missed": "missed: true, but rejected; and the rule by d₁ alone",
    "threshold": "the threshold, the line of the rule, and what it gives",
    "looked": "the point looked at, its nearest and its second nearest",
}
STEPS = (
    Step("Nearest", "Each feature of A takes the nearest descriptor of B; nothing is tested yet."),
    Step(
        "Two distances", "For each: how far is the nearest, and how far the second nearest, at another place?"
    ),
    Step("Threshold", "Accepted is what is clearly nearer than the second: below the line."),
    Step("Verdict", "Every threshold is a point of the curve; the truth says how good each is."),
)
PRESETS = (
    Preset("facade", "Side view", "Most false candidates have a ratio near 1; the true ones are spread.", {}),
    Preset("front", "Same place", "From the same place, with a little noise: both groups lie far apart.",
           {"tilt": 4.0, "aside": 20.0, "noise": 4.0}),
    Preset("texture", "Rich texture", "Every place is distinctive: the test is nearly perfect.",
           {"pattern": "texture", "tilt": 25.0}),
    Preset("noise", "Noisy photo", "Noise raises the distance of true matches: both groups run together.",
           {"noise": 40.0, "tilt": 20.0}),
    Preset("windows", "Equal windows", "The second nearest is the same corner of another window: the test fails.",
           {"pattern": "windows", "tilt": 20.0, "noise": 4.0, "look_x": 176.0, "look_y": 132.0}, "degenerate"),
    Preset("photo", "Your photo", "A photo of the open project on the wall, seen from the side.",
           {"pattern": "photo", "tilt": 40.0, "aside": 0.0}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="ratio_test",
    title="Ratio test",
    summary="Why a match is trusted when it is clearly nearer than the second best, and what that costs.",
    first="Drag the threshold to the right: dashed false matches come.",
    source="Lowe 2004, section 7.1",
    engine=(sift, mutual, nearest_two, pixel_from_ray, ray_from_pixel, look_at),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=ratio_test_task,
    learn=LESSON,
    place=30,
)
def ratio_test(params: RatioTestParams, setting: Setting) -> Scene:
    """Show both photos, the two distances of every candidate, their distribution, and precision over recall."""
    seen = Judged(params, setting)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    accepted = seen.accepted if last >= 2 else np.ones(len(seen.nearest), bool)
    top = _top(seen)
    marks: list[AnyMark] = [*photo_marks(seen), *match_marks(seen, accepted)]
    if last >= 1:
        marks += [*distance_marks(seen), *histogram_marks(seen, top), *looked_marks(seen)]
    if last >= 3:
        marks += curve_marks(seen)
    marks += [*handle_marks(seen, top), *_sheet(seen, last)]
    return Scene(panels=_panels(seen, top), marks=tuple(marks), things=THINGS, says=_says(seen, last))


def _top(seen: Judged) -> float:
    values = seen.nearest.ratio if seen.params.rule == "ratio" else seen.nearest.distance
    return 1.15 * max(float(np.histogram(values, histogram_edges(seen))[0].max(initial=1)), 4.0)


def _panels(seen: Judged, top: float) -> tuple[Panel, ...]:
    ratio = seen.params.rule == "ratio"
    across = (0.0, 1.0) if ratio else (0.0, FARTHEST)
    return (
        Panel(name="pair", title=f"Photo A · photo B, {seen.params.tilt:.0f}° from the side · {seen.wall[1]}",
              rect=(0.0, 0.0, 0.74, 0.52), kind="picture", x_range=(-0.5, LEFT + WIDTH - 0.5),
              y_range=(-0.5, HEIGHT - 0.5), equal=True, y_down=True),
        Panel(name="histogram", title="What is tested", rect=(0.0, 0.52, 0.37, 0.48), x_range=across,
              y_range=(0.0, top), x_label="ratio d₁ / d₂" if ratio else "distance d₁ [bytes]",
              y_label="candidates", legend="top left"),
        Panel(name="distances", title="Both distances of every candidate", rect=(0.37, 0.52, 0.37, 0.48),
              x_range=(0.0, FARTHEST), y_range=(0.0, FARTHEST), x_label="second distance d₂ [bytes]",
              y_label="first distance d₁ [bytes]", legend="top left"),
        Panel(name="numbers", title="Counts", rect=(0.74, 0.0, 0.26, 0.62), kind="sheet"),
        Panel(name="curve", title="Every threshold", rect=(0.74, 0.62, 0.26, 0.38), x_range=(0.0, 104.0),
              y_range=(0.0, 104.0), x_label="recall [%]", y_label="precision [%]", legend="top right" if seen.counts.precision < 50.0 else "bottom left"),
    )  # fmt: skip


def _sheet(seen: Judged, last: int) -> list[AnyMark]:
    k, unit = seen.looked_at, "matches"
    marks: list[AnyMark] = [
        Number(thing="accepted", label="Candidates", value=len(seen.nearest), unit=unit, digits=0)
    ]
    if last >= 1 and k is not None:
        first, second = float(seen.nearest.distance[k]), float(seen.second_distance[k])
        marks += [
            Sentence(text="The point looked at", heading=True),
            Formula(thing="looked", role="accent", tex=(
                rf"\dfrac{{d_1}}{{d_2}} = \dfrac{{{first:.0f}}}{{{second:.0f}}} = {seen.nearest.ratio[k]:.2f}")),
        ]  # fmt: skip
    if last < 2:
        return marks
    counts = seen.counts
    marks += [
        Number(thing="accepted", label="Accepted", value=counts.accepted, unit=unit, digits=0),
        Sentence(text="By the truth", heading=True, truth=True, answer=True),
        Number(thing="true", label="true, accepted", value=counts.true_accepted, unit=unit, digits=0, role="truth", truth=True,
               answer=True),
        Number(thing="false", label="false, accepted", value=counts.false_accepted, unit=unit, digits=0, role="error", truth=True,
               answer=True),
        Number(thing="missed", label="true, rejected: missed", value=counts.true_rejected, unit=unit, digits=0, role="third",
               truth=True, answer=True),
        Number(thing="false", label="false, rejected", value=counts.false_rejected, unit=unit, digits=0, truth=True, answer=True),
        Number(thing="threshold", label="Precision: true of accepted", value=counts.precision, unit="%", digits=1,
               truth=True, answer=True),
        Number(thing="threshold", label="Recall: accepted of true", value=counts.recall, unit="%", digits=1, truth=True,
               answer=True),
    ]  # fmt: skip
    return marks


def _says(seen: Judged, last: int) -> str:
    counts, total = seen.counts, len(seen.nearest)
    if not total:
        return "No features, no candidates: there is nothing to test."
    if last < 2:
        share = 100.0 * float(seen.true.mean())
        return f"{total} features of A have a nearest one in B; {share:.0f} % of these candidates are true."
    name = (
        f"ratio below {seen.params.ratio:.2f}"
        if seen.params.rule == "ratio"
        else f"distance below {seen.params.limit:.0f}"
    )
    if not counts.accepted:
        return f"With a {name} none of {total} candidates is accepted."
    return (
        f"With a {name}, {counts.accepted} of {total} candidates are accepted, {counts.precision:.0f} % of them true; "
        f"{counts.true_rejected} true ones are missed."
    )
