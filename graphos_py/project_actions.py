"""What a person does with projects: make, open, drop, tell what is known, recipes, past runs, export."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog, QInputDialog, QWidget

from graphos_core.errors import GraphosError, UserError
from graphos_core.run import Run
from graphos_core.text import Text
from graphos_py.dialogs import KnownDistanceDialog, NewProject, ask, documents
from graphos_py.jobs import Job, TimeLeft
from graphos_py.loading import load_engine
from graphos_py.run_bar import seconds_text
from graphos_py.session import Session
from graphos_py.settings import Settings
from graphos_py.translation import tr

if TYPE_CHECKING:
    from graphos_py.project_tree import PastRun

PROJECT_FILE = "project.toml"
PHOTO_FILES = (".jpg", ".jpeg", ".png", ".tif", ".tiff")


class ProjectActions(QObject):
    """The actions behind menus, start page, tree and dropped files."""

    making = Signal(str, object)
    made = Signal()

    def __init__(self, window: QWidget, session: Session, settings: Settings) -> None:
        super().__init__(window)
        self._window = window
        self._session = session
        self._settings = settings
        self._demo_job: Job | None = None
        self._left = TimeLeft()
        self.asked_folder: Path | None = None

    # ---------------------------------------------------------------------------------------- make and open

    def new(self, photos: Path | None = None) -> None:
        """Ask for photos and folder, and make a project."""
        if self._busy():
            return
        dialog = NewProject(self._window, photos)
        if dialog.exec():
            folder = Path(dialog.folder.text().strip())
            self.asked_folder = folder
            self._session.create(folder, Path(dialog.photos.text().strip()), **dialog.settings())

    def open(self) -> None:
        """Ask for a project folder and open it."""
        if not self._busy():
            chosen = QFileDialog.getExistingDirectory(self._window, tr("Open project"), str(documents()))
            if chosen:
                self.open_folder(Path(chosen))

    def open_folder(self, folder: Path) -> None:
        """Open the project in a folder."""
        if not self._busy():
            self.asked_folder = folder
            self._session.open(folder)

    def dropped(self, paths: list[Path]) -> None:
        """Open what was dropped: a project, a folder of photos, or photos."""
        first = paths[0]
        if first.name == PROJECT_FILE or (first / PROJECT_FILE).is_file():
            self.open_folder(first.parent if first.name == PROJECT_FILE else first)
        elif first.is_dir():
            self.new(first)
        elif first.suffix.lower() in PHOTO_FILES:
            self.new(first.parent)
        elif first.suffix.lower() == ".toml":
            self._load(first)
        else:
            what = Text("{name} is neither a photo, a folder of photos nor a project.", name=first.name)
            self._session.message.emit(
                "error", UserError(what, todo="Drop JPEG, PNG or TIFF photos, or a folder.")
            )

    def demo(self, folder: Path | None = None) -> None:
        """Make the demo's photos, with known truth, and open them as a project."""
        if self._busy():
            return
        out = folder or documents() / "GRAPHOS" / "demo"

        def work(run: Run) -> Path:
            load_engine()
            from graphos_core.project import Project
            from graphos_core.simulation.photo_block import simulate_photos

            if not (out / "simulation" / "truth" / "cameras.json").exists():
                simulate_photos("facade", out / "simulation", seed=0, photos=12, run=run)
            project = Project.create(
                out / "model", out / "simulation" / "photos", name="Demo façade", run=run,
                control=out / "simulation" / "control.csv", reference="../simulation/truth/mesh.ply", seed=0,
            )  # fmt: skip
            return project.folder

        self._left = TimeLeft()
        self.making.emit(tr("Preparing the scene of the demo …"), None)
        self._demo_job = Job(work, name="demo")
        self._demo_job.progressed.connect(self._demo_progress)
        self._demo_job.succeeded.connect(self._demo_made)
        self._demo_job.failed.connect(self._session.tell)
        self._demo_job.finished.connect(self._demo_over)
        self._session.jobs.start(self._demo_job)

    def stop_demo(self) -> None:
        """Stop making the demo's photos; those that are finished stay."""
        if self._demo_job is not None:
            self._demo_job.stop()

    def _demo_progress(self, done: float, total: float, what: str) -> None:
        seconds = self._left.seconds(done, total, what)
        text = tr(
            "Making the demo: {what} {done} of {total}",
            what=tr(what),
            done=f"{done:.0f}",
            total=f"{total:.0f}",
        )
        if seconds is not None:
            text += " · " + seconds_text(seconds)
        self.making.emit(text, done / total if total else None)

    def _demo_made(self, folder: Path) -> None:
        self._demo_job = None
        self.open_folder(folder)

    def _demo_over(self) -> None:
        self._demo_job = None
        self.made.emit()

    def _busy(self) -> bool:
        if self._session.running is None and self._demo_job is None:
            return False
        what = Text("Something is running in this project.")
        self._session.message.emit(
            "error", UserError(what, todo="Stop it with Esc, or wait until it is done.")
        )
        return True

    # --------------------------------------------------------------------------------------- what is known

    def ask(self, what: str) -> None:
        """Ask for one thing: ``"new"``, ``"camera"``, ``"control"``, ``"distance"``, ``"reference"``, ``"seed"``."""
        if what == "new":
            self.new()
        elif self._session.project is not None and not self._busy():
            getattr(self, f"_ask_{what}")(self._session.project)

    def _ask_camera(self, project: Any) -> None:
        now = project.settings.focal_px or project.photo_set.cameras[0].focal_px
        label = tr("Principal distance of all cameras in px; 0 takes it from EXIF again.")
        value, chosen = QInputDialog.getDouble(self._window, tr("Camera"), label, now, 0, 1e6, 2)
        if chosen:
            self._session.change_project(focal_px=value or None)

    def _ask_control(self, project: Any) -> None:
        pattern = tr("Control points") + " (*.csv *.txt *.json);;" + tr("All files") + " (*)"
        name, _ = QFileDialog.getOpenFileName(
            self._window, tr("Control points"), str(project.photos_folder), pattern
        )
        if name:
            self._session.change_project(control=name)

    def _ask_distance(self, project: Any) -> None:
        names = [photo.name for photo in project.photo_set.photos]
        try:
            control, _ = project.control()
        except GraphosError:
            control = None
        dialog = KnownDistanceDialog(
            [*(control.names if control else ()), *names], project.settings.distance, self._window
        )
        if dialog.exec():
            self._session.change_project(distance=dialog.value())

    def _ask_reference(self, project: Any) -> None:
        pattern = tr("Clouds and meshes") + " (*.ply *.xyz *.obj *.stl);;" + tr("All files") + " (*)"
        name, _ = QFileDialog.getOpenFileName(
            self._window, tr("Reference surface"), str(project.photos_folder), pattern
        )
        if name:
            import os

            try:
                relative = Path(os.path.relpath(name, project.folder)).as_posix()
            except ValueError:  # another drive
                relative = Path(name).as_posix()
            self._session.change_project(reference=relative)

    def _ask_seed(self, project: Any) -> None:
        recipe = self._session.recipe
        if recipe is None:
            return
        label = tr("Every random step takes this seed: same seed, same result.")
        value, chosen = QInputDialog.getInt(self._window, tr("Seed"), label, recipe.seed, 0, 2**31 - 1)
        if chosen:
            self._session.use_recipe(recipe.with_seed(value))

    # ------------------------------------------------------------------------------------ recipes and runs

    def load_recipe(self) -> None:
        """Ask for a recipe file and use it."""
        name, _ = QFileDialog.getOpenFileName(
            self._window, tr("Load recipe"), str(documents()), "TOML (*.toml)"
        )
        if name:
            self._load(Path(name))

    def _load(self, path: Path) -> None:
        from graphos_core.recipe import Recipe

        try:
            self._session.use_recipe(Recipe.load(path))
        except GraphosError as problem:
            self._session.tell(problem)

    def save_recipe(self) -> None:
        """Ask for a file and write the recipe."""
        name, _ = QFileDialog.getSaveFileName(
            self._window, tr("Save recipe"), str(documents() / "recipe.toml"), "TOML (*.toml)"
        )
        if name and self._session.recipe is not None:
            try:
                self._session.recipe.save(Path(name))
            except UserError as problem:
                self._session.tell(problem)

    def reset_recipe(self) -> None:
        """Put every parameter and choice back to its default; results stay."""
        recipe = self._session.recipe
        if recipe is not None:
            from graphos_core.recipe import Recipe

            self._session.use_recipe(Recipe.default(recipe.seed))

    def use_run(self, past: PastRun) -> None:
        """Go back to the parameters of a stored result."""
        session = self._session
        if session.project is None or session.recipe is None or self._busy():
            return
        try:
            session.use_recipe(recipe_of_run(session.project, session.recipe, past))
        except GraphosError as problem:
            session.tell(problem)

    def delete_run(self, past: PastRun) -> None:
        """Delete a stored result after asking."""
        project = self._session.project
        text = tr("Delete this result of {stage} from disk? {line}", stage=past.stage, line=tr(past.line))
        if project is None or self._busy() or not ask(tr("Delete"), text, tr("Delete"), self._window):
            return
        project.store.delete(past.step, past.key)
        self._session.states_changed.emit()
        self._session.load_results()

    # ----------------------------------------------------------------------------------------------- export

    def export(self) -> None:
        """Write report, recipe, clouds and the COLMAP model into the project folder."""
        pipeline = self._session.pipeline
        if pipeline is None or self._busy():
            return

        def work(run: Run) -> Path:
            from graphos_core.outputs import write_outputs

            made = datetime.now(UTC).isoformat(timespec="seconds")
            return write_outputs(pipeline, made) / "report.html"

        job = Job(work, name="export")
        job.succeeded.connect(self._exported)
        job.failed.connect(self._session.tell)
        self._session.jobs.start(job)

    def _exported(self, report: Path) -> None:
        self._session.message.emit("info", Text("Written: {path} and the models beside it.", path=report))
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(report)))

    def show_folder(self) -> None:
        """Show the project folder in the system's file manager."""
        if self._session.project is not None:
            QDesktopServices.openUrl(QUrl.fromLocalFile(str(self._session.project.folder)))


def recipe_of_run(project: Any, recipe: Any, past: PastRun) -> Any:
    """Return the recipe that produced a stored result; later stages keep their present parameters."""
    from graphos_core import registry
    from graphos_core.steps import STEPS

    keys = project.store.about(past.step, past.key).get("keys", {})
    for name, key in keys.items():
        if name not in STEPS or not project.store.has(name, key):
            continue
        stage = STEPS[name].stage
        for role, used in project.store.about(name, key).get("algorithms", {}).items():
            names = [str(entry["algorithm"]).partition(".")[2] for entry in used]
            recipe = recipe.choose(stage, role, names)
            for algorithm, entry in zip(names, used):
                sheet = registry.find(stage, algorithm).params.from_dict(entry["params"])
                recipe = recipe.with_params(stage, algorithm, sheet)
    return recipe
