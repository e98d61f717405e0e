"""Preprocessing: the selected photo before and after, with a live preview of the present parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QTimer

from graphos_core.data import Array, Photo
from graphos_core.run import Run
from graphos_py.jobs import ENGINE, Job
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.translation import tr


def filtered(photo: Photo, chain: list[tuple[Any, Any]], run: Run) -> tuple[Array, Array | None]:
    """Read a photo and apply a chain of filters to it; uint8 before and after, None without filters."""
    from graphos_core.images import read_pixels
    from graphos_core.preprocessing.grey import eight_bit

    pixels = read_pixels(photo)
    image = pixels
    for algorithm, params in chain:
        run.check()
        image = algorithm.function(image, params, run=run)
    return eight_bit(pixels), eight_bit(image) if chain else None


def stored(photo: Photo, file: Path) -> tuple[Array, Array | None]:
    """Read a photo and its stored result; uint8."""
    import cv2

    from graphos_core.images import read_pixels
    from graphos_core.preprocessing.grey import eight_bit

    after = cv2.imdecode(np.fromfile(file, dtype=np.uint8), cv2.IMREAD_UNCHANGED)
    if after is not None and after.ndim == 3:
        after = cv2.cvtColor(after, cv2.COLOR_BGR2RGB)
    return eight_bit(read_pixels(photo)), after


class PreprocessingTab(StageTab):
    """Before and after with a divider; what is seen right of it are always the parameters of the form."""

    stage = "preprocessing"
    empty = (
        "Photos before and after filtering",
        "Here you will compare each photo with its filtered version, live while you change a parameter. "
        "Open or make a project first.",
    )
    empty_action = ""

    def __init__(self, session: Any, level: Any = "student") -> None:
        super().__init__(session, level)
        self._job: Job | None = None
        self._again = False
        self._later = QTimer(self, singleShot=True, interval=200)
        self._later.timeout.connect(self._preview)
        session.recipe_changed.connect(self._form_changed)
        session.run_changed.connect(self._later.start)

    @property
    def keeps_views(self) -> bool:
        """A photo is enough to show something."""
        return self.session.project is not None

    def make_views(self) -> None:
        """One image view."""
        from graphos_py.views.image_view import ImageView

        self.image = ImageView()
        self.add_view(self.image, "Before and after")

    def refresh(self) -> None:
        """Show forms and preview."""
        super().refresh()
        if self._made and self.isVisible():
            self._later.start()

    def show_result(self, result: Any) -> None:
        """Show the preview, which equals the result when nothing was changed."""
        self._later.start()

    def show_photo(self, index: int) -> None:
        """Preview another photo."""
        self._later.start()

    def _form_changed(self, stage: str) -> None:
        if stage == self.stage:
            self._later.start()

    def _preview(self) -> None:
        session = self.session
        if session.project is None or session.recipe is None or not self._made or not self.isVisible():
            return
        if self._job is not None:
            self._job.stop()
            self._again = True
            return
        photos = session.project.photo_set.photos
        if session.photo >= len(photos):
            return
        photo = photos[session.photo]
        chain = session.recipe.algorithms("preprocessing", "filter")
        done = session.pipeline is not None and session.pipeline.state("preprocessing").status == "done"
        files = getattr(self.result, "files", ()) if done else ()
        if files and session.photo < len(files):
            file = Path(files[session.photo])
            job = Job(lambda run: stored(photo, file), name="stored", engine=False)
        elif session.running is not None or ENGINE.locked():
            job = Job(lambda run: filtered(photo, [], run), name="photo", engine=False)
        else:
            job = Job(lambda run: filtered(photo, chain, run), name="preview", seed=session.recipe.seed)
        job.succeeded.connect(self._show)
        job.failed.connect(session.tell)
        job.finished.connect(self._over)
        self._job = session.jobs.start(job)

    def _show(self, pictures: tuple[Array, Array | None]) -> None:
        before, after = pictures
        if after is None:
            self.image.set_image(before, keep_view=True)
        else:
            self.image.compare(before, after, (tr("before"), tr("after")))

    def _over(self) -> None:
        self._job = None
        if self._again:
            self._again = False
            self._later.start()
