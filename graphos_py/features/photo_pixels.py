"""Reads the photos that a page shows, in the background; what a page no longer wants is dropped."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QObject, Slot

from graphos_core.data import Array
from graphos_py.session import Session
from graphos_py.tabs.images import read_photo

KEPT = 2
"""Photos kept in memory: those of the pair that was looked at last."""


class PhotoPixels(QObject):
    """The pixels of the project's photos for one place of one page: the photo asked for last is the one that comes."""

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self.session = session
        self._wanted, self._index = "", -1
        self._then: Callable[[int, Array], None] | None = None
        self._known: dict[str, Array] = {}

    def read(self, index: int, then: Callable[[int, Array], None]) -> None:
        """Give `then` the index and the pixels, uint8 (h, w) or (h, w, 3), of a photo unless another is asked for."""
        project = self.session.project
        photos = project.photo_set.photos if project is not None else ()
        if not 0 <= index < len(photos):
            return
        photo = self.session.seen(photos[index])
        self._wanted, self._index, self._then = photo.digest, index, then
        if photo.digest in self._known:
            then(index, self._known[photo.digest])
        else:
            read_photo(self.session, photo, self._take)

    @Slot(object)
    def _take(self, read: tuple[str, Array]) -> None:
        """Keep what was read, and hand it on if it is still wanted; not called once the page is gone."""
        digest, pixels = read
        while len(self._known) >= KEPT:
            self._known.pop(next(iter(self._known)))
        self._known[digest] = pixels
        if digest == self._wanted and self._then is not None:
            self._then(self._index, pixels)
