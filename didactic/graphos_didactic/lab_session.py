"""A student's way through a lab: answers, progress that survives, and the hand-in as one HTML page."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2

from graphos_core import __version__
from graphos_core.errors import UserError
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.run import Run
from graphos_core.simulation.photo_block import simulate_photos
from graphos_core.simulation.truth import Truth, load_truth
from graphos_core.store import write_text
from graphos_core.text import Text
from graphos_didactic.lab_check import Outcome, answer_key, check, figure_of, parse_number
from graphos_didactic.lab_figures import figure_text
from graphos_didactic.labs import Lab, Step, student_seed

FILE = "lab.json"


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
    """

    lab: Lab
    student: str
    folder: Path
    answers: dict[int, str] = field(default_factory=dict)
    passed: set[int] = field(default_factory=set)
    hints: dict[int, int] = field(default_factory=dict)

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
        if self.truth() is None:
            block = self.lab.block
            simulate_photos(
                block["template"], self.simulation, width=block["width"], height=block["height"],
                photos=block["photos"], seed=self.seed, run=run,
            )  # fmt: skip
        if not (self.project_folder / "project.toml").exists():
            control = self.simulation / "control.csv"
            Project.create(
                self.project_folder, self.simulation / "photos", name=f"{self.lab.title} ({self.student})", run=run,
                control=control if control.exists() else None, reference="../simulation/truth/mesh.ply", seed=0,
            )  # fmt: skip
        self.save()

    def truth(self) -> Truth | None:
        """Return the truth of the student's block; None before it was made."""
        return load_truth(self.simulation) if (self.simulation / "truth" / "cameras.json").exists() else None

    def answer(self, index: int, text: str, pipeline: Pipeline) -> Outcome:
        """Judge and keep an answer; progress is saved at once."""
        outcome = check(self.lab.steps[index], text, pipeline, self.truth())
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
                {int(k): int(v) for k, v in document["hints"].items()},
            )  # fmt: skip
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as problem:
            raise UserError(
                Text("The progress in {folder} cannot be read.", folder=folder), f"{problem}.",
                "Start the lab in another folder.",
            ) from problem  # fmt: skip


def hand_in(session: LabSession, pipeline: Pipeline) -> str:
    """Return the hand-in: one HTML page with answers, comparison of predictions, figures, parameters and version."""
    truth = session.truth()
    rows = [_row(session, i, step, pipeline, truth) for i, step in enumerate(session.lab.steps)]
    template = (resources.files("graphos_resources") / "labs" / "hand_in.html.j2").read_text("utf-8")
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    from graphos_core.report import data_hash
    from graphos_core.report.model_picture import report_pictures

    return environment.from_string(template).render(
        lab=session.lab, student=session.student, seed=session.seed, rows=rows, version=__version__,
        data=data_hash(pipeline.photos), recipe=pipeline.recipe.to_toml(), pictures=report_pictures(pipeline),
        done=len(session.passed), total=len(session.lab.steps),
    )  # fmt: skip


def key_page(session: LabSession, pipeline: Pipeline) -> list[tuple[str, str]]:
    """Return the instructor's key for this student's own block."""
    return answer_key(session.lab, pipeline, session.truth())


def _row(
    session: LabSession, index: int, step: Step, pipeline: Pipeline, truth: Truth | None
) -> dict[str, Any]:
    answer = session.answers.get(index, "")
    figure = figure_of(step, pipeline, truth)
    computed = ""
    if figure is not None:
        computed = f"{figure.label}: {figure_text(figure)}"
        if step.kind == "compare" and figure.truth is not None:
            computed += f"; truth {figure.truth:.6g} {figure.unit}".rstrip()
        guess = parse_number(answer)
        if step.kind == "predict" and guess is not None:
            computed += f"; predicted {guess:g}"
    verdict = "" if step.kind == "read" else "done" if index in session.passed else "open"
    return {
        "number": index + 1, "kind": step.kind, "title": step.title, "answer": answer, "computed": computed,
        "verdict": verdict, "hints": session.hints.get(index, 0),
    }  # fmt: skip
