"""The one mutable thing of the application: project, recipe, current results, what is selected, what runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, QTimer, Signal, Slot

from graphos_core.errors import GraphosError, ParamError, UserError
from graphos_core.params import Params
from graphos_core.registry import STAGES, Stage, candidate_stage
from graphos_core.run import Run
from graphos_core.text import Text
from graphos_py.jobs import Job, Jobs, TimeLeft
from graphos_py.loading import DRAFT, create_project, open_project, read_latest
from graphos_py.loading import load_engine as load_engine

if TYPE_CHECKING:
    from graphos_core.data import Camera, Photo
    from graphos_core.pipeline import Pipeline
    from graphos_core.project import Project
    from graphos_core.recipe import Recipe

STAGE_LABELS: dict[Stage, str] = {
    "preprocessing": "Preprocessing",
    "features": "Features",
    "adjustment": "Bundle adjustment",
    "dense": "Dense matching",
    "quality": "Quality control",
}

GIVE_UP_MS = 700
"""How long a stopped job may take before the window goes on without it."""


@dataclass(frozen=True)
class Progress:
    """How far the running stage is.

    Attributes
    ----------
    stage : Stage
    done, total : float
    what : str
        Plural of the items.
    seconds_left : float or None
    """

    stage: Stage
    done: float
    total: float
    what: str
    seconds_left: float | None


class Session(QObject):
    """Project, recipe and results, with a signal for each kind of change.

    Nothing else in the application holds state that outlives a widget. Reading and computing happen in jobs.
    """

    project_changed = Signal()
    recipe_changed = Signal(str)
    results_changed = Signal(str)
    states_changed = Signal()
    photo_selected = Signal(int)
    run_changed = Signal()
    progressed = Signal(object)
    partial = Signal(str, str, object)
    message = Signal(str, object)
    bug = Signal(object)
    photos_moved = Signal(object)
    analysis_changed = Signal()

    def __init__(self, jobs: Jobs, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.jobs = jobs
        self.project: Project | None = None
        self.recipe: Recipe | None = None
        self.pipeline: Pipeline | None = None
        self.results: dict[Stage, Any] = {}
        self.failed: dict[Stage, UserError] = {}
        self.analysis: Any = None
        self.photo = 0
        self.running: Stage | None = None
        self._job: Job | None = None
        self._goal: Stage | None = None
        self._left = TimeLeft()
        self._loading = 0
        self._giving_up = QTimer(self, singleShot=True, interval=GIVE_UP_MS)
        self._giving_up.timeout.connect(self._give_up)
        self._saving = QTimer(self, singleShot=True, interval=400)
        self._saving.timeout.connect(self.save_recipe)

    # ---------------------------------------------------------------------------------------------- project

    def engine_ready(self) -> None:
        """Start from a default recipe, so that forms can be seen before there is a project."""
        if self.recipe is None:
            from graphos_core.recipe import Recipe

            self.recipe = Recipe.default()
            for stage in STAGES:
                self.recipe_changed.emit(stage)

    def open(self, folder: Path, photos: Path | None = None) -> None:
        """Open a project in the background; `photos_moved` or `message` when that fails."""
        self._read(lambda run: open_project(folder, photos, run), self._opened)

    def create(self, folder: Path, photos: Path, **settings: Any) -> None:
        """Make a project in the background and open it."""
        self._read(lambda run: create_project(folder, photos, run, **settings), self._opened)

    def change_project(self, **settings: Any) -> None:
        """Change settings of the project (excluded photos, control, reference …) in the background."""
        project, recipe = self.project, self.recipe
        if project is not None:
            self._read(lambda run: (project.change(run, **settings), recipe), self._changed)

    def known_changed(self, project: Project) -> None:
        """Go on with the project after its control points were edited: results of now may be older ones, or none."""
        renamed, self.project = project is not self.project, project
        if self.recipe is not None:
            self._set_recipe(self.recipe)
        later = STAGES[STAGES.index("adjustment") :]
        for stage in later:
            self.failed.pop(stage, None)
        self.states_changed.emit()
        if renamed:
            self.project_changed.emit()
        if self.pipeline is not None and self.pipeline.state("adjustment").status == "done":
            self.load_results(later)

    def masks_changed(self) -> None:
        """Go on after masks were edited: results of now may be those of other masks, or none."""
        if self.recipe is not None:
            self._set_recipe(self.recipe)
        later = STAGES[STAGES.index("features") :]
        for stage in later:
            self.failed.pop(stage, None)
        self.states_changed.emit()

    def seen(self, photo: Photo) -> Photo:
        """Return a photo as results see it: undistorted where the recipe says so and the step is done."""
        if self.pipeline is None:
            return photo
        try:
            if self.pipeline.has("images"):
                return next((p for p in self.pipeline.photos.photos if p.name == photo.name), photo)
        except UserError:  # no calibration yet: the step says so itself
            pass
        return photo

    def undistortion(self) -> str:
        """Return what the photos are undistorted by, as a key; empty for photos as taken or without a calibration."""
        from graphos_core.seen_photos import undistortion_key

        try:
            made = undistortion_key(self.pipeline) if self.pipeline is not None else None
        except UserError:  # the step says so itself
            return ""
        return "" if made is None else repr(made)

    def filter_reader(self, photo: Photo) -> Callable[[], Any]:
        """Return a function that reads what the filters of a photo of the project get."""
        from graphos_core.images import read_pixels
        from graphos_core.seen_photos import filter_input

        pipeline = self.pipeline
        if pipeline is None or not self.undistortion():
            return lambda: read_pixels(photo)
        index = [p.name for p in pipeline.project.photo_set.photos].index(photo.name)
        return lambda: filter_input(pipeline, index)

    def seen_cameras(self) -> tuple[Camera, ...]:
        """Return the cameras that belong to the photos as results see them."""
        if self.project is None:
            return ()
        try:
            return self.pipeline.photos.cameras if self.pipeline else self.project.photo_set.cameras
        except UserError:
            return self.project.photo_set.cameras

    def _opened(self, opened: tuple[Any, Any]) -> None:
        self.photo = 0
        self.results.clear()
        self.set_analysis(None)
        self._changed(opened)

    def _changed(self, opened: tuple[Any, Any]) -> None:
        self.project, recipe = opened
        self.failed.clear()
        self._set_recipe(recipe)
        self.project_changed.emit()
        for failure in self.project.photo_set.failures if self.project else ():
            self.message.emit("warning", Text("{item}: {reason}", item=failure.item, reason=failure.reason))
        if self.project is not None:
            from graphos_core.images import told_remarks

            for remark in told_remarks(self.project.photo_set):
                self.message.emit("warning", remark)
        self.states_changed.emit()
        self.load_results()

    def set_analysis(self, analysis: Any) -> None:
        """Keep the verdicts of the image analyser, `graphos_py.preprocessing.analyser_page.Analysis`, or None."""
        self.analysis = analysis
        self.analysis_changed.emit()

    # ----------------------------------------------------------------------------------------------- recipe

    def set_params(self, stage: Stage, name: str, params: Params) -> None:
        """Put a parameter sheet into the recipe."""
        if self.recipe is not None and self.recipe.params(stage, name) != params:
            self._recipe_edited(stage, self.recipe.with_params(stage, name, params))

    def choose(self, stage: Stage, role: str, names: Sequence[str]) -> None:
        """Let `names` play a role."""
        if self.recipe is not None and self.recipe.chosen(stage, role) != tuple(names):
            self._recipe_edited(stage, self.recipe.choose(stage, role, names))

    def use_recipe(self, recipe: Recipe) -> None:
        """Replace the whole recipe."""
        self.failed.clear()
        self._set_recipe(recipe)
        self._saving.start()
        for stage in STAGES:
            self.recipe_changed.emit(stage)
        self.states_changed.emit()
        self.load_results()

    def _recipe_edited(self, stage: Stage, recipe: Recipe) -> None:
        for later in STAGES[STAGES.index(stage) :]:
            self.failed.pop(later, None)
        self._set_recipe(recipe)
        self._saving.start()
        self.recipe_changed.emit(stage)
        self.states_changed.emit()

    @Slot()
    def save_recipe(self) -> None:
        """Write the recipe beside the project; called a moment after every edit and on closing."""
        self._saving.stop()
        if self.project is not None and self.recipe is not None:
            try:
                self.recipe.save(self.project.folder / DRAFT)
            except UserError as problem:
                self.message.emit("error", problem)

    def _set_recipe(self, recipe: Recipe) -> None:
        from graphos_core.pipeline import Pipeline

        self.recipe = recipe
        self.pipeline = Pipeline(self.project, recipe) if self.project is not None else None

    # ---------------------------------------------------------------------------------------------- results

    def load_results(self, stages: Sequence[Stage] = STAGES) -> None:
        """Read the last complete results of stages in the background."""
        pipeline = self.pipeline
        if pipeline is None:
            return
        wanted = tuple(stages)
        job = Job(lambda run: read_latest(pipeline, wanted, run), name="results", engine=False)
        job.shown.connect(self._result_read)
        job.failed.connect(self.tell)
        job.finished.connect(self._results_read)
        self._loading += 1
        self.jobs.start(job)

    @property
    def loading(self) -> bool:
        """Whether stored results are being read."""
        return self._loading > 0

    @Slot(str, object)
    def _result_read(self, stage: str, read: list[tuple[Pipeline, Any]]) -> None:
        pipeline, result = read[-1]
        known = candidate_stage(stage)
        if self.pipeline is None or pipeline.project is not self.pipeline.project or self.running == known:
            return
        if result is not None:
            self.results[known] = result
        else:
            self.results.pop(known, None)
        self.results_changed.emit(stage)

    @Slot()
    def _results_read(self) -> None:
        self._loading -= 1
        for stage in STAGES:
            if stage not in self.results:
                self.results_changed.emit(stage)
        self.states_changed.emit()

    # ------------------------------------------------------------------------------------------------- runs

    def run(self, goal: Stage) -> None:
        """Run everything up to `goal` that is not there yet, stage by stage so each can be seen at once."""
        if self.pipeline is None or self.running is not None:
            return
        self._goal = goal
        self._next_stage()

    def run_all(self) -> None:
        """Run all five steps."""
        self.run(STAGES[-1])

    def stop(self) -> None:
        """Ask the running stage to stop."""
        self._goal = None
        if self._job is not None:
            self._job.stop()
            self._giving_up.start()
            self.run_changed.emit()

    @Slot()
    def _give_up(self) -> None:
        """Wait no longer for a stopped job that is inside one long call; it ends by itself, and nobody listens."""
        if self.stopping:
            self._job = None
            self._on_stopped()

    def _is_old(self) -> bool:
        """Whether the signal comes from a job that was given up."""
        sender = self.sender()
        return isinstance(sender, Job) and sender is not self._job

    @property
    def stopping(self) -> bool:
        """Whether the running stage was asked to stop."""
        return self._job is not None and self._job.qt_run.stopping()

    def _next_stage(self) -> None:
        pipeline, goal = self.pipeline, self._goal
        todo = None
        if pipeline is not None and goal is not None:
            upto = STAGES[: STAGES.index(goal) + 1]
            todo = next((s for s in upto if pipeline.state(s).status != "done"), None)
        self.running = todo
        if todo is None or pipeline is None:
            self._goal = self._job = None
            self.run_changed.emit()
            self.states_changed.emit()
            return
        stage = todo
        self.failed.pop(stage, None)
        self._left = TimeLeft()
        job = Job(lambda run: pipeline.run(stage, run, with_earlier=False), name=stage, seed=self._seed())
        job.progressed.connect(self._on_progress)
        job.said.connect(self._on_said)
        job.warned.connect(self._on_warned)
        job.shown.connect(self._on_shown)
        job.succeeded.connect(self._on_success)
        job.stopped.connect(self._on_stopped)
        job.failed.connect(self._on_failure)
        self._job = self.jobs.start(job)
        self.run_changed.emit()
        self.states_changed.emit()

    def _seed(self) -> int:
        return self.recipe.seed if self.recipe is not None else 0

    @Slot(float, float, object)
    def _on_progress(self, done: float, total: float, what: str) -> None:
        if self.running is not None and not self._is_old():
            left = self._left.seconds(done, total, what)
            self.progressed.emit(Progress(self.running, done, total, what, left))

    @Slot(object)
    def _on_said(self, text: str) -> None:
        self.message.emit("info", text)

    @Slot(object)
    def _on_warned(self, text: str) -> None:
        self.message.emit("warning", text)

    @Slot(str, object)
    def _on_shown(self, key: str, values: list[Any]) -> None:
        if self.running is not None and not self._is_old():
            self.partial.emit(self.running, key, values)

    @Slot(object)
    def _on_success(self, result: Any) -> None:
        stage = self.running
        if stage is None or self._is_old():
            return
        self.results[stage] = result
        self.results_changed.emit(stage)
        self._tell_left_out(stage, result)
        if (
            self.pipeline is not None
            and self.pipeline.state(stage).status != "done"
            and self._goal is not None
        ):
            self._end_run()  # parameters were changed while it ran: the person decides what to run next
        else:
            self._next_stage()

    def _tell_left_out(self, stage: Stage, result: Any) -> None:
        """Name the photos that could not be oriented, each reason once."""
        reasons: dict[str, list[str]] = {}
        for failure in result.adjustment.block.failures if stage == "adjustment" else ():
            reasons.setdefault(failure.reason, []).append(failure.item)
        for reason, names in reasons.items():
            listed = ", ".join(names[:6]) + (" …" if len(names) > 6 else "")
            self.message.emit("warning", Text("Not oriented: {names}. {reason}", names=listed, reason=reason))

    @Slot()
    def _on_stopped(self) -> None:
        if self._is_old():
            return
        self.message.emit("info", "Stopped; what was finished before is kept.")
        self._end_run()

    @Slot(object)
    def _on_failure(self, problem: BaseException) -> None:
        if self._is_old():
            return
        if self.running is not None and isinstance(problem, GraphosError):
            error = problem if isinstance(problem, UserError) else UserError(str(problem))
            self.failed[self.running] = error
        self.tell(problem)
        self._end_run()

    def _end_run(self) -> None:
        self._giving_up.stop()
        self._goal = self._job = self.running = None
        self.run_changed.emit()
        self.states_changed.emit()

    # ---------------------------------------------------------------------------------------------- reading

    def _read(self, work: Callable[[Run], Any], then: Callable[[Any], None]) -> None:
        job = Job(work, name="reading", engine=False)
        job.warned.connect(self._on_warned)
        job.succeeded.connect(then)
        job.failed.connect(self.tell)
        self.jobs.start(job)

    @Slot(object)
    def tell(self, problem: BaseException) -> None:
        """Route a failure: moved photos are asked for, sentences go to the messages, a bug to its dialog."""
        if hasattr(problem, "expected") and isinstance(problem, UserError):
            self.photos_moved.emit(problem)
        elif isinstance(problem, (UserError, ParamError, GraphosError)):
            self.message.emit("error", problem)
        else:
            self.bug.emit(problem)

    # -------------------------------------------------------------------------------------------- selection

    def select_photo(self, index: int) -> None:
        """Select a photo in every view."""
        if (
            self.project is not None
            and 0 <= index < len(self.project.photo_set.photos)
            and index != self.photo
        ):
            self.photo = index
            self.photo_selected.emit(index)

    def why_not_run(self, stage: Stage) -> str:
        """Return why a stage cannot be run now; empty when it can."""
        if self.project is None:
            return "Open or make a project first."
        if self.running == stage:
            return "It is running."
        if self.running is not None:
            return Text("{stage} is running.", stage=STAGE_LABELS[self.running])
        if self.pipeline is not None and self.pipeline.state(stage).status == "done":
            return "Done with these parameters; change one to run again."
        return ""
