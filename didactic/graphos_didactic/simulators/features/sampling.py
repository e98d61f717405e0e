"""Random sampling among matches (RANSAC): sample by sample, until one without a false match is as good as certain."""

from __future__ import annotations

import numpy as np

from graphos_core.features.detectors.sift import sift
from graphos_core.features.matchers.mutual import mutual
from graphos_core.features.robust.models import FundamentalModel, HomographyModel
from graphos_core.features.robust.samplers import ProgressiveSampler, UniformSampler
from graphos_core.features.robust_scores import magsac_loss, msac_loss, ransac_loss, robust_sigma
from graphos_core.geometry.consensus import samples_needed
from graphos_core.geometry.homography import transfer
from graphos_didactic.scene import AnyMark, Formula, Number, Panel, Scene, Sentence
from graphos_didactic.simulator import Preset, Setting, Step, simulator
from graphos_didactic.simulators.features.sampling_drawing import (
    LEFT,
    SHOWN,
    count_marks,
    handle_marks,
    match_marks,
    model_marks,
    photo_marks,
    probability_marks,
    probability_range,
    residual_marks,
    sample_marks,
)
from graphos_didactic.simulators.features.sampling_model import Search
from graphos_didactic.simulators.features.sampling_params import LESSON, MOST, SamplingParams
from graphos_didactic.simulators.features.sampling_tasks import PREDICTION, sampling_task
from graphos_didactic.simulators.pictured_pair import HEIGHT, WIDTH

THINGS = {
    "sample": "the present sample",
    "now": "the model of the present sample",
    "best": "the best model so far",
    "agree": "matches that agree with it, and the limit",
    "out": "matches that do not agree",
    "false": "false matches, by the truth",
    "clean": "samples without a false match",
    "needed": "needed number of samples",
    "cost": "what a residual costs",
}
STEPS = (
    Step("Sample", "As few matches as determine a model, drawn at random."),
    Step(
        "Model",
        "The engine's solution from these matches alone: where it maps the frame, or its epipolar lines.",
    ),
    Step("Vote", "All matches are asked: who agrees within the threshold?"),
    Step("Repeat", "Again and again; the best is kept. How often is told by the share that agrees."),
    Step("Fit", "The last step: a fit to all matches that agree with the best sample."),
)
PRESETS = (
    Preset("plane", "Six of ten true", "After a few samples one is clean, and nearly all true matches agree at once.", {}),
    Preset("few", "Four of ten true", "Now a clean sample is rare: drag the number of the sample, or draw the best first.",
           {"good": 0.4, "count": 60, "draw": 112, "seed": 9}),
    Preset("space", "Fundamental matrix", "In space with depth: seven matches in a sample, so many more samples.",
           {"model": "fundamental", "depth": 40.0, "draw": 60}),
    Preset("median", "Median below half", "LMedS asks for the best half, but less than half is true: it follows the false.",
           {"good": 0.35, "cost": "lmeds", "draw": 150, "count": 60}),
    Preset("flat", "Fundamental matrix of a plane", "Everything agrees, and the matrix is wrong: a plane does not determine it.",
           {"model": "fundamental", "depth": 0.0, "good": 0.9, "draw": 40}, "degenerate"),
    Preset("photo", "On two photos", "SIFT matches of two photos of a wall: false ones come from repeated structure.",
           {"source": "photo", "count": 80, "draw": 40, "threshold": 2.0}, "photo"),
)  # fmt: skip


@simulator(
    room="features",
    name="sampling",
    title="RANSAC: random samples",
    summary="How a model is found among many false matches, and how many samples that takes.",
    first="Drag the number of the sample to the left, before the plane is found.",
    source="Fischler and Bolles 1981; Torr and Zisserman 2000; Rousseeuw 1984; Chum and Matas 2005",
    engine=(
        HomographyModel, FundamentalModel, UniformSampler, ProgressiveSampler, samples_needed, ransac_loss, msac_loss,
        magsac_loss, robust_sigma, transfer, mutual, sift,
    ),
    presets=PRESETS,
    steps=STEPS,
    prediction=PREDICTION,
    challenge=sampling_task,
    learn=LESSON,
    place=40,
)  # fmt: skip
def sampling(params: SamplingParams, setting: Setting) -> Scene:
    """Show sample, model and votes in both photos, the counts, the probability of a clean sample, the residuals."""
    seen = Search(params, setting)
    last = len(STEPS) - 1 if setting.step is None else setting.step
    top, height = 1.12 * max(len(seen.model), 4), _height(seen)
    marks: list[AnyMark] = [*photo_marks(seen), *match_marks(seen, _agreeing(seen, last))]
    if seen.possible:
        marks += _model(seen, last)
    if last >= 2:
        marks += residual_marks(seen, height)
    if last >= 3:
        marks += [*count_marks(seen, top), *probability_marks(seen)]
    marks += [*handle_marks(seen, top, height), *_sheet(seen, last)]
    return Scene(panels=_panels(seen, top, height), marks=tuple(marks), things=THINGS, says=_says(seen, last))


def _height(seen: Search) -> float:
    distances = np.minimum(np.sqrt(seen.drawn.squares[seen.leader]), SHOWN - 1e-6)
    return 1.6 * max(float(np.histogram(distances, 30, (0.0, SHOWN))[0].max(initial=1)), 4.0)


def _reach(seen: Search) -> float:
    """Return how many samples the picture of the counts shows; it does not move while the sample is dragged there."""
    usual = float(np.clip(2.2 * min(seen.needed(seen.share), MOST), 60.0, MOST))
    return usual + 2.0 if seen.params.draw <= usual else MOST + 2.0


def _agreeing(seen: Search, last: int) -> np.ndarray | None:
    if last < 2 or not seen.possible:
        return None
    return seen.agreeing(seen.now if last == 2 else seen.leader)


def _model(seen: Search, last: int) -> list[AnyMark]:
    marks: list[AnyMark] = []
    if last >= 1:
        marks += model_marks(seen, seen.drawn.matrices[seen.now], "now", "second", 1.8, "dash")
    if last >= 3:
        best = seen.refined if last >= 4 else seen.drawn.matrices[seen.leader]
        marks += model_marks(seen, best, "best", "accent", 2.6, "solid")
    return [*marks, *sample_marks(seen)]


def _panels(seen: Search, top: float, height: float) -> tuple[Panel, ...]:
    name = f" · {seen.wall[1]}" if seen.photos is not None else ""
    return (
        Panel(name="pair", title=f"Photo A · photo B{name}", rect=(0.0, 0.0, 0.74, 0.52), kind="picture",
              x_range=(-0.5, LEFT + WIDTH - 0.5), y_range=(-0.5, HEIGHT - 0.5), equal=True, y_down=True),
        Panel(name="counts", title="Who agrees with each sample", rect=(0.0, 0.52, 0.37, 0.48), x_range=(0.0, _reach(seen)),
              y_range=(0.0, 1.2 * top), x_label="number of the sample", y_label="matches that agree", legend="top right"),
        Panel(name="residuals", title="Distances from the best model",
              rect=(0.37, 0.52, 0.37, 0.48), x_range=(0.0, SHOWN), y_range=(0.0, height), x_label=f"distance [px] · last class: {SHOWN:.0f} and more",
              y_label="matches", legend="top right"),
        Panel(name="numbers", title="Numbers", rect=(0.74, 0.0, 0.26, 0.62), kind="sheet"),
        Panel(name="chance", title="A clean sample by now?", rect=(0.74, 0.62, 0.26, 0.38),
              x_range=(0.0, probability_range(seen)), y_range=(0.0, 104.0), x_label="samples",
              y_label="probability [%]", legend="bottom right"),
    )  # fmt: skip


def _sheet(seen: Search, last: int) -> list[AnyMark]:
    p, m = seen.params, seen.model.sample
    marks: list[AnyMark] = [
        Number(thing="sample", label="Sample", value=p.draw, unit="", digits=0, role="second"),
        Number(thing="clean", label="false matches in it", value=_false_in_sample(seen), unit=f"of {m}", digits=0,
               role="truth", truth=True, answer=True),
    ]  # fmt: skip
    if last >= 2:
        marks.append(Number(thing="agree", label="agree with it", value=float(seen.counts[seen.now]), unit="matches",
                            digits=0, answer=True))  # fmt: skip
    if last >= 1 and not seen.drawn.matrices[seen.now].any():
        marks.append(Sentence(thing="now", role="error", text="No model: some triangles of the sample turn over."
                              if p.model == "homography" else "No model: the sample is degenerate."))  # fmt: skip
    if last < 3:
        return marks
    needed = seen.needed(seen.share)
    shown = f"{needed:.0f}" if np.isfinite(needed) else r"\infty"
    believed = float(seen.adaptive[seen.now])
    marks += [
        Number(thing="best", label="Best so far: sample", value=float(seen.leader + 1), unit="", digits=0, role="accent",
               answer=True),
        Number(thing="best", label="agree with the best", value=float(seen.counts[seen.leader]),
               unit=f"of {len(seen.model)}", digits=0, role="accent", answer=True),
        Formula(thing="needed", tex=r"n = \dfrac{\ln(1-p)}{\ln(1-w^m)}"),
        Formula(thing="needed", answer=True, role="third", tex=(
            rf"\quad = \dfrac{{\ln(1-{p.confidence:.4g})}}{{\ln(1-{seen.share:.2f}^{m})}} \rightarrow {shown}")),
        Number(thing="needed", label="Needed, by the best so far", value=believed, unit="samples", digits=0, role="third",
               answer=True),
    ]  # fmt: skip
    if last >= 4:
        marks += [
            Sentence(text="Error at check points", heading=True, truth=True, answer=True),
            Number(thing="best", label="best sample", value=seen.error(seen.drawn.matrices[seen.leader]), unit="px",
                   role="truth", truth=True, answer=True),
            Number(thing="best", label="fit to all that agree", value=seen.error(seen.refined), unit="px", role="truth",
                   truth=True, answer=True),
        ]  # fmt: skip
    return marks


def _false_in_sample(seen: Search) -> float:
    return float((~seen.good[seen.drawn.picks[seen.now]]).sum()) if seen.possible else float("nan")


def _says(seen: Search, last: int) -> str:
    p = seen.params
    if not seen.possible:
        return f"Only {len(seen.model)} matches: a sample takes {seen.model.sample}, and somebody must be left to vote."
    if last < 3:
        return f"Sample {p.draw} of {seen.model.sample} matches; {seen.counts[seen.now]} of {len(seen.model)} agree with it."
    believed = seen.adaptive[seen.now]
    after = "never be sure" if not np.isfinite(believed) else f"need {believed:.0f}"
    end = "may end" if p.draw >= believed else "goes on"
    return (
        f"After {p.draw} samples the best one has {seen.counts[seen.leader]} of {len(seen.model)} matches behind it; with "
        f"that share it would {after}, so the search {end}."
    )
