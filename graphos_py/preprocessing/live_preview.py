"""Keeps the preview of one photo up to date in jobs: coarse first, then what is seen, then exact."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, QTimer, Signal

from graphos_core.data import Array, Photo
from graphos_core.preprocessing.preview import Piece, Preview, Region, displayed
from graphos_core.run import Run
from graphos_py.jobs import ENGINE, Job
from graphos_py.session import Session

Wanted = Callable[[], tuple[Region, int] | None]
COARSE_PIXELS = 200_000
"""The whole photo is filtered at about this size for what lies outside the piece that is seen."""

SOON_MS, BUSY_MS = 10, 300
"""How long a wish waits for the next one, and for an engine that computes something else."""


def _opened(read: Callable[[], Array], run: Run) -> tuple[Preview, Array]:
    preview = Preview(read())
    run.check()
    return preview, displayed(preview.pixels, preview.levels)


def _whole(preview: Preview, chain: Any, run: Run) -> list[Piece]:
    """Filter a photo with a filter that does not know how to work on a piece."""
    from graphos_core.preprocessing.chain import apply_filters
    from graphos_core.text import Text

    height, width = preview.pixels.shape[:2]
    after = displayed(apply_filters(preview.pixels, chain, run), preview.levels)
    before = displayed(preview.pixels, preview.levels)
    return [Piece(before, after, Region(0, 0, width, height), 1, True, Text("the whole photo, as in a run"))]


def pieces_of(preview: Preview, chain: Any, region: Region, factor: int, run: Run) -> list[Piece]:
    """Return the whole photo coarsely and a region at `factor`; of slow filters a coarser region is told before."""
    height, width = preview.pixels.shape[:2]
    coarse = factor
    while width * height / coarse**2 > COARSE_PIXELS:
        coarse *= 2
    whole = Region(0, 0, width, height)
    pieces = [preview.piece(chain, whole, preview.first_factor(chain, whole, coarse, run), run)]
    first = preview.first_factor(chain, region, factor, run)
    if first > factor:
        run.show("pieces", list(pieces))
        pieces.append(preview.piece(chain, region, first, run))
        run.show("pieces", list(pieces))
    pieces.append(preview.piece(chain, region, factor, run))
    return pieces


class LivePreview(QObject):
    """One job at a time; a newer wish stops the older.

    Signals
    -------
    opened(array)
        A photo was read, uint8.
    shown(pieces, filtered)
        Pieces to lay over it.
    """

    opened = Signal(object)
    shown = Signal(object, bool)

    def __init__(self, session: Session, wanted: Wanted, parent: QObject) -> None:
        super().__init__(parent)
        self.session = session
        self.preview: Preview | None = None
        self._wanted = wanted
        self._photo: Photo | None = None
        self._way = ""
        self._job: Job | None = None
        self._again = False
        self._soon = QTimer(self, singleShot=True)
        self._soon.timeout.connect(self._next)
        self._idle = QTimer(self, singleShot=True, interval=350)
        self._idle.timeout.connect(self._look_at_whole)

    def open(self, photo: Photo) -> None:
        """Show another photo, undistorted where the recipe says so."""
        way = self.session.undistortion()
        same = self._photo is not None and (photo.digest, photo.path) == (
            self._photo.digest,
            self._photo.path,
        )
        if same and way == self._way:
            self.ask()
            return
        self._photo, self._way, self.preview = photo, way, None
        self.ask()

    def ask(self) -> None:
        """Show what is seen now with the filters of now."""
        self._idle.stop()
        if self._job is not None:
            self._job.stop()
            self._again = True
        else:
            self._soon.start(SOON_MS)

    @property
    def busy(self) -> bool:
        """Whether something is being computed or about to be."""
        return self._job is not None or self._soon.isActive() or self._idle.isActive()

    def _chain(self) -> list[tuple[Any, Any]]:
        recipe = self.session.recipe
        return recipe.algorithms("preprocessing", "filter") if recipe is not None else []

    def _next(self) -> None:
        photo = self._photo
        if photo is None or self._job is not None:
            return
        preview = self.preview
        if preview is None:
            read = self.session.filter_reader(photo)
            job = Job(lambda run: _opened(read, run), name="photo", engine=False)
            job.succeeded.connect(self._read)
            self._start(job)
            return
        chain, wanted = self._chain(), self._wanted()
        if wanted is None:
            return
        region, factor = wanted
        if self.session.running is not None or ENGINE.locked():
            self._soon.start(BUSY_MS)
            return
        if Preview.can(chain):
            job = Job(lambda run: pieces_of(preview, chain, region, factor, run), name="preview")
        else:
            job = Job(lambda run: _whole(preview, chain, run), name="preview")
        filtered = bool(chain)
        job.shown.connect(lambda _, values: self.shown.emit(values[-1], filtered))
        job.succeeded.connect(lambda pieces: self.shown.emit(pieces, filtered))
        self._start(job)
        self._idle.start()

    def _look_at_whole(self) -> None:
        """Make the preview exact once the person has stopped changing things."""
        preview, chain = self.preview, self._chain()
        if preview is None:
            return
        if self._job is not None or self.session.running is not None or ENGINE.locked():
            self._idle.start()
            return
        wanted = self._wanted()
        if wanted is None or not Preview.can(chain):
            return
        if wanted[1] > 1 or not preview.needs_whole(chain):
            return
        job = Job(lambda run: preview.learn_whole(chain, run), name="whole photo")
        job.succeeded.connect(lambda _: self.ask())
        self._start(job)

    def _start(self, job: Job) -> None:
        job.failed.connect(self.session.tell)
        job.finished.connect(self._over)
        self._job = self.session.jobs.start(job)

    def _read(self, read: tuple[Preview, Array]) -> None:
        if self._again and self._photo is not None and self._job is not None and self._job.qt_run.stopping():
            return
        self.preview = read[0]
        self.opened.emit(read[1])
        self._again = True

    def _over(self) -> None:
        self._job = None
        if self._again:
            self._again = False
            self._soon.start(SOON_MS)
