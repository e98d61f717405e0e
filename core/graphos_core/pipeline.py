"""The pipeline: which results exist for a recipe, what is missing, and computing it in order.

Data flows one way: photos → preprocessed → features → matches → block → adjusted block → depth maps → cloud →
quality. Every result has a key made of everything that produced it, so a result is either exactly what the recipe
asks for, or another one; nothing is overwritten.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any, Literal

import cv2
from threadpoolctl import threadpool_limits

from graphos_core import __version__
from graphos_core.data import PhotoSet
from graphos_core.errors import UserError
from graphos_core.project import Project
from graphos_core.project_file import inside
from graphos_core.recipe import Recipe
from graphos_core.registry import STAGES, Stage
from graphos_core.run import Run
from graphos_core.seen_photos import seen_photos
from graphos_core.steps import STEPS, Step, steps_of
from graphos_core.store import content_key
from graphos_core.text import Text

Status = Literal["not yet", "next", "done", "stale", "failed"]


@dataclass(frozen=True)
class StageState:
    """Where a stage stands.

    Attributes
    ----------
    status : {"not yet", "next", "done", "stale", "failed"}
    line : str
        One line for the ribbon: ``"12 of 12 photos · σ0 0.43 px"``.
    reason : str
        Why it cannot run, what changed, or why it failed; empty when done.
    """

    status: Status
    line: str
    reason: str = ""


class Pipeline:
    """A project with a recipe.

    Parameters
    ----------
    project : Project
    recipe : Recipe
    """

    def __init__(self, project: Project, recipe: Recipe) -> None:
        self.project = project
        self.recipe = recipe
        self._keys: dict[str, str] = {}
        self._seen: tuple[bool, PhotoSet] | None = None

    @property
    def photos(self) -> PhotoSet:
        """The photos as the steps after preprocessing see them, with their cameras; see `graphos_core.seen_photos`."""
        if self._seen is None or self._seen[0] != self.has("images"):
            self._seen = (self.has("images"), seen_photos(self))
        return self._seen[1]

    def key(self, step_name: str) -> str:
        """Return the key of a step's result for this recipe."""
        if step_name not in self._keys:
            step = STEPS[step_name]
            algorithms = [
                algorithm.key(params)
                for role in step.roles
                for algorithm, params in self.recipe.algorithms(step.stage, role)
            ]
            before = self.key(step.after) if step.after else self.project.photos_key()["photos"]
            parts = {"step": step_name, "algorithms": algorithms, "seed": self.recipe.seed, "before": before}
            self._keys[step_name] = content_key({**parts, "inputs": step.inputs(self)})
        return self._keys[step_name]

    def has(self, step_name: str) -> bool:
        """Say whether the result of a step exists for this recipe."""
        return self.project.store.has(step_name, self.key(step_name))

    def value(self, step_name: str) -> Any:
        """Return the stored result of a step for this recipe.

        Raises
        ------
        UserError
            When it does not exist or cannot be read.
        """
        return self.project.store.load(step_name, self.key(step_name))

    def about(self, step_name: str) -> dict[str, Any]:
        """Return what produced the result of a step: algorithms, parameters, seconds, line, warnings."""
        return self.project.store.about(step_name, self.key(step_name))

    def result(self, stage: Stage) -> Any:
        """Return the result of a stage for exactly this recipe, or None."""
        if not all(self.has(step.name) for step in steps_of(stage)):
            return None
        return self._compose(stage, {step.name: self.key(step.name) for step in steps_of(stage)})

    def latest(self, stage: Stage) -> Any:
        """Return the result of a stage for this recipe, else the last complete one of any recipe, else None."""
        found = self.result(stage)
        if found is not None:
            return found
        last = steps_of(stage)[-1].name
        for key in reversed(self.project.store.keys(last)):
            keys = self.project.store.about(last, key).get("keys", {})
            wanted = {step.name: keys.get(step.name, "") for step in steps_of(stage)}
            if all(self.project.store.has(name, k) for name, k in wanted.items()):
                try:
                    return self._compose(stage, wanted)
                except UserError:  # damaged: the one before may be whole
                    continue
        return None

    def _compose(self, stage: Stage, keys: dict[str, str]) -> Any:
        from dataclasses import replace

        from graphos_core.results import DenseResult

        load = self.project.store.load
        if stage == "preprocessing":
            folder = self.project.store.path("images", keys["images"])
            found = load("images", keys["images"])
            return replace(found, files=tuple(str(inside(folder, name)) for name in found.files))
        if stage == "features":
            found = load("matches", keys["matches"])
            return replace(found, features=load("keypoints", keys["keypoints"]))
        if stage == "dense":
            return DenseResult(maps=load("depth", keys["depth"]), cloud=load("cloud", keys["cloud"]))
        last = steps_of(stage)[-1].name
        return load(last, keys[last])

    def state(self, stage: Stage) -> StageState:
        """Return where a stage stands; failures of the running program are known to the session, not here."""
        try:
            steps = steps_of(stage)
            if all(self.has(step.name) for step in steps):
                return StageState("done", self.about(steps[-1].name).get("line", ""))
            position = STAGES.index(stage)
            before = STAGES[position - 1] if position else None
            waiting = before is not None and not all(self.has(step.name) for step in steps_of(before))
            if self.project.store.keys(steps[-1].name):
                return StageState(
                    "stale", "parameters changed since", "Run again to see what the change does."
                )
            if before is not None and waiting:
                return StageState("not yet", Text("needs {before}", before=before), Text(
                    "{before} has to be finished first; Run does that too.", before=before.capitalize()))  # fmt: skip
            return StageState("next", "ready to run")
        except UserError as problem:
            return StageState("failed", problem.what, str(problem))

    def run(self, stage: Stage, run: Run, *, with_earlier: bool = True) -> Any:
        """Compute what is missing up to a stage and return the stage's result.

        Parameters
        ----------
        stage : Stage
        run : Run
            Its seed is set to that of the recipe.
        with_earlier : bool
            Also compute the stages before it that are missing.

        Raises
        ------
        UserError
            When the work cannot go on; what was finished before stays.
        Stopped
        """
        run.seed = self.recipe.seed
        upto = STAGES.index(stage)
        first = 0 if with_earlier else upto
        with threadpool_limits(limits=1, user_api="blas"):
            for name in STAGES[first : upto + 1]:
                for step in steps_of(name):
                    if not self.has(step.name):
                        self._compute(step, run)
        return self.result(stage)

    def _compute(self, step: Step, run: Run) -> None:
        if step.after and not self.has(step.after):
            before = STEPS[step.after].stage
            raise UserError(
                Text("{stage} cannot run yet.", stage=step.stage.capitalize()),
                Text(
                    "The results of {before} are missing or were made with other parameters.", before=before
                ),
                Text("Run {before} first.", before=before),
            )
        run.check()
        use_threads(run.threads)
        store = self.project.store
        warned, started = len(run.warnings), time.perf_counter()
        folder = store.begin(step.name)
        try:
            value = step.compute(self, folder, run)
        except BaseException:
            store.abandon(folder)
            raise
        store.save(step.name, self.key(step.name), value, {
            "step": step.name,
            "made": datetime.now(UTC).isoformat(timespec="seconds"),
            "version": __version__,
            "seconds": round(time.perf_counter() - started, 3),
            "line": step.line(value),
            "warnings": list(run.warnings[warned:]),
            "keys": {name: self.key(name) for name in STEPS if name in self._keys},
            "algorithms": {
                role: [a.key(p) for a, p in self.recipe.algorithms(step.stage, role)] for role in step.roles
            },
            "seed": self.recipe.seed,
        }, begun=folder)  # fmt: skip


def use_threads(count: int) -> None:
    """Let OpenCV and numba use `count` threads at most."""
    import numba

    cv2.setNumThreads(count)
    numba.set_num_threads(min(count, numba.config.NUMBA_NUM_THREADS))
