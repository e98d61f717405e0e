"""A student's way through a lab: answers, progress that survives, and the hand-in as one HTML page."""

from __future__ import annotations

import base64
import hashlib
import json
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
import numpy as np

from graphos_core import __version__
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.errors import UserError
from graphos_core.exchange.calibration_file import read_calibration
from graphos_core.photo_files import list_photo_files
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.run import Run
from graphos_core.simulation.control_targets import CONTROL_SIGMA_PX
from graphos_core.simulation.photo_block import demo_camera, simulate_photos
from graphos_core.simulation.target_photos import simulate_target_photos, varied_camera
from graphos_core.simulation.truth import Truth, load_truth
from graphos_core.store import write_text
from graphos_core.text import Text
from graphos_didactic.lab_calibration import Bench
from graphos_didactic.lab_check import Outcome, answer_key, check, figure_of, parse_number
from graphos_didactic.lab_detectors import detector_line, measured
from graphos_didactic.lab_figures import figure_text
from graphos_didactic.labs import Lab, Step, student_seed, target_sheet

FILE = "lab.json"
SURVEY_SIGMA_M = 0.001
"""Standard deviation of a coordinate of the surveyor in labs in which control points are chosen, m."""


@dataclass
class LabSession:
    """Progress of one student in one lab.

    Attributes
    ----------
    lab : Lab
    student : str
    folder : Path
        Holds ``lab.json``, the simulated block and the project.
    answers : dict of int to str
        What was typed, by step.
    passed : set of int
        Steps that are done.
    hints : dict of int to int
        How many hints were taken, by step.
    own : dict
        In a lab with a test field: ``photos`` (folder of the student's own photos) and what is on their board; empty
        for simulated ones.
    """

    lab: Lab
    student: str
    folder: Path
    answers: dict[int, str] = field(default_factory=dict)
    passed: set[int] = field(default_factory=set)
    hints: dict[int, int] = field(default_factory=dict)
    own: dict[str, Any] = field(default_factory=dict)

    @property
    def seed(self) -> int:
        """Seed of the student's own block."""
        return student_seed(self.student, self.lab.name)

    @property
    def simulation(self) -> Path:
        """Folder of the student's block."""
        return self.folder / "simulation"

    @property
    def project_folder(self) -> Path:
        """Folder of the student's project."""
        return self.folder / "project"

    @property
    def current(self) -> int:
        """First step that is not done; the number of steps when all are."""
        return next((i for i in range(len(self.lab.steps)) if i not in self.passed), len(self.lab.steps))

    def prepare(self, run: Run) -> None:
        """Make the student's own photo block and the project for it, unless they are there.

        Raises
        ------
        UserError
            When the folder cannot be written.
        Stopped
        """
        if self.lab.target:
            self._prepare_bench(run)
            self.save()
            return
        if self.truth() is None:
            block = self.lab.block
            simulate_photos(
                block["template"], self.simulation, width=block["width"], height=block["height"],
                photos=block["photos"], seed=self.seed, run=run,
            )  # fmt: skip
        if not (self.project_folder / "project.toml").exists():
            control = self._control()
            Project.create(
                self.project_folder, self.simulation / "photos", name=f"{self.lab.title} ({self.student})", run=run,
                control=control if control.exists() else None, reference="../simulation/truth/mesh.ply", seed=0,
            )  # fmt: skip
        self.save()

    def _control(self) -> Path:
        """Return the control point file; where the student chooses, it is a surveyor's, and all are check points."""
        control = self.simulation / "control.csv"
        if not any(step.kind == "choose" for step in self.lab.steps) or not control.exists():
            return control
        return surveyed_control(control, self.simulation / "surveyed.csv", self.seed)

    def _prepare_bench(self, run: Run) -> None:
        if self.own or (self.simulation / "truth" / "calibration.toml").exists():
            return
        target = self.lab.target
        simulate_target_photos(
            target_sheet(target), self.simulation,
            varied_camera(demo_camera(target["width"], target["height"]), self.seed),
            photos=target["photos"], seed=self.seed, run=run,
        )  # fmt: skip

    def bench(self) -> Bench | None:
        """Return where the student calibrates; None in a lab without a test field."""
        if not self.lab.target:
            return None
        if self.own:
            target = TargetParams.from_dict({k: v for k, v in self.own.items() if k != "photos"})
            return Bench(self.folder, Path(self.own["photos"]), target, None)
        truth = self.simulation / "truth" / "calibration.toml"
        camera = read_calibration(truth)[0] if truth.exists() else None
        return Bench(self.folder, self.simulation / "photos", target_sheet(self.lab.target), camera)

    def truth(self) -> Truth | None:
        """Return the truth of the student's block; None before it was made."""
        return load_truth(self.simulation) if (self.simulation / "truth" / "cameras.json").exists() else None

    def answer(self, index: int, text: str, pipeline: Pipeline | None, run: Run | None = None) -> Outcome:
        """Judge and keep an answer; progress is saved at once."""
        outcome = check(self.lab.steps[index], text, pipeline, self.truth(), self.bench(), run)
        guess = self._prediction(index)
        if guess is not None and outcome.passed:
            outcome = Outcome(
                True, Text("{result} You predicted {guess:g}.", result=outcome.text, guess=guess)
            )
        self.answers[index] = text
        if outcome.passed:
            self.passed.add(index)
        self.save()
        return outcome

    def _prediction(self, index: int) -> float | None:
        """Return what was predicted earlier for the figure of a step that shows it now."""
        steps = self.lab.steps
        if steps[index].kind == "predict" or not steps[index].figure:
            return None
        earlier = (i for i in range(index) if steps[i].kind == "predict" and i in self.passed)
        found = [i for i in earlier if steps[i].figure == steps[index].figure]
        return parse_number(self.answers.get(found[-1], "")) if found else None

    def keep(self, index: int, text: str) -> None:
        """Keep what was typed; an answer changed after its check has to be checked again, predictions stay."""
        before = self.answers.get(index, "")
        if text == before or (self.lab.steps[index].kind == "predict" and index in self.passed):
            return
        self.answers[index] = text
        self.passed.discard(index)
        self.save()

    def hint(self, index: int) -> str:
        """Return the next hint of a step and remember that it was taken."""
        available = self.lab.steps[index].hints
        if not available:
            return "There is no hint for this step."
        taken = min(self.hints.get(index, 0) + 1, len(available))
        self.hints[index] = taken
        self.save()
        return available[taken - 1]

    def save(self) -> None:
        """Write the progress."""
        document = {
            "lab": self.lab.name,
            "student": self.student,
            "answers": {str(k): v for k, v in self.answers.items()},
            "passed": sorted(self.passed),
            "hints": {str(k): v for k, v in self.hints.items()},
            "own": self.own,
        }
        write_text(self.folder / FILE, json.dumps(document, indent=1, ensure_ascii=False))

    @classmethod
    def resume(cls, lab: Lab, folder: Path) -> LabSession:
        """Read the progress from a folder.

        Raises
        ------
        UserError
            When it is of another lab or damaged.
        """
        try:
            document = json.loads((folder / FILE).read_text("utf-8"))
            if document["lab"] != lab.name:
                raise ValueError(f"it belongs to the lab {document['lab']}")
            count = len(lab.steps)
            return cls(
                lab, str(document["student"]), folder,
                {int(k): str(v) for k, v in document["answers"].items() if 0 <= int(k) < count},
                {int(i) for i in document["passed"] if 0 <= int(i) < count},
                {int(k): int(v) for k, v in document["hints"].items()}, dict(document.get("own", {})),
            )  # fmt: skip
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as problem:
            raise UserError(
                Text("The progress in {folder} cannot be read.", folder=folder), f"{problem}.",
                "Start the lab in another folder.",
            ) from problem  # fmt: skip


def surveyed_control(exact: Path, out: Path, seed: int) -> Path:
    """Write control points as a surveyor delivers them: with noise of a stated σ, all of them check points.

    The measurements in the photos, which have noise already, get their σ beside them.

    Parameters
    ----------
    exact : Path
        Exact control points with ``_measurements`` beside them.
    out : Path
        File to write, its measurements beside it.
    seed : int
        Of the surveyor's noise.
    """
    rng = np.random.default_rng([seed, 17])
    head, *rows = exact.read_text("utf-8").splitlines()
    lines = [head + ",sigma [m]"]
    for row in rows:
        name, *xyz = row.split(",")[:4]
        noisy = [
            f"{float(v) + SURVEY_SIGMA_M * e:.6f}" for v, e in zip(xyz, rng.standard_normal(3), strict=True)
        ]
        lines.append(",".join([name, *noisy, "check", f"{SURVEY_SIGMA_M:g}"]))
    write_text(out, "\n".join(lines) + "\n")
    beside = "_measurements.csv"
    head, *rows = exact.with_name(exact.stem + beside).read_text("utf-8").splitlines()
    lines = [head + ",sigma [px]", *(f"{row},{CONTROL_SIGMA_PX:g}" for row in rows)]
    write_text(out.with_name(out.stem + beside), "\n".join(lines) + "\n")
    return out


def hand_in(session: LabSession, pipeline: Pipeline | None) -> str:
    """Return the hand-in: one HTML page with answers, comparison of predictions, figures, parameters and version."""
    truth = session.truth()
    rows = [_row(session, i, step, pipeline, truth) for i, step in enumerate(session.lab.steps)]
    bench = session.bench()
    if bench is not None:
        data, recipe, pictures = _bench_parts(bench)
    else:
        from graphos_core.report import data_hash
        from graphos_core.report.model_picture import report_pictures

        assert pipeline is not None
        data, recipe = data_hash(pipeline.project.photo_set), pipeline.recipe.to_toml()
        pictures = report_pictures(pipeline)
    template = (resources.files("graphos_resources") / "labs" / "hand_in.html.j2").read_text("utf-8")
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    return environment.from_string(template).render(
        lab=session.lab, student=session.student, seed=session.seed, rows=rows, version=__version__,
        data=data, recipe=recipe, pictures=pictures,
        done=len(session.passed), total=len(session.lab.steps),
    )  # fmt: skip


def _bench_parts(bench: Bench) -> tuple[str, str, dict[str, str]]:
    """Return hash of the photos, parameters, and pictures of the hand-in of a lab with a test field."""
    digests = [hashlib.sha256(file.read_bytes()).hexdigest() for file in list_photo_files(bench.photos)]
    data = hashlib.sha256("".join(digests).encode()).hexdigest()[:16]
    recipe = "\n".join(f"{k} = {v}" for k, v in bench.target.to_dict().items() if v not in (None, ""))
    pictures = {"model": "", "model_caption": "", "residuals": ""}
    for key, name in (("model", "coverage_1.png"), ("residuals", "residuals_1.png")):
        file = bench.place("all") / "pictures" / name
        if file.is_file():
            pictures[key] = "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()
    return data, recipe, pictures


def key_page(session: LabSession, pipeline: Pipeline | None) -> list[tuple[str, str]]:
    """Return the instructor's key for this student's own block."""
    return answer_key(session.lab, pipeline, session.truth(), session.bench())


def _row(
    session: LabSession, index: int, step: Step, pipeline: Pipeline | None, truth: Truth | None
) -> dict[str, Any]:
    answer = session.answers.get(index, "")
    figure = figure_of(step, pipeline, truth, session.bench())
    computed = ""
    if figure is not None:
        computed = f"{figure.label}: {figure_text(figure)}"
        if step.kind == "compare" and figure.truth is not None:
            computed += f"; truth {figure.truth:.6g} {figure.unit}".rstrip()
        guess = parse_number(answer)
        if step.kind == "predict" and guess is not None:
            computed += f"; predicted {guess:g}"
    if step.kind == "detect" and truth is not None:
        found = measured(truth, step.detector)
        computed = str(detector_line(step.detector, found)) if found is not None else ""
    verdict = "" if step.kind == "read" else "done" if index in session.passed else "open"
    return {
        "number": index + 1, "kind": step.kind, "title": step.title, "answer": answer, "computed": computed,
        "verdict": verdict, "hints": session.hints.get(index, 0),
    }  # fmt: skip
