"""The descriptor viewer: what a keypoint is recognised by, and what it was, or could have been, confused with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QScrollArea, QSplitter, QVBoxLayout, QWidget

from graphos_core.data import Array, Features, Photo
from graphos_core.features.detectors.selection import by_rank, spread_over_cells
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_core.run import Run
from graphos_py.features.descriptor_work import GreyPhotos, Look, Neighbour, look_at, partners
from graphos_py.features.photo_pixels import PhotoPixels
from graphos_py.jobs import Job
from graphos_py.result_page import ResultPage
from graphos_py.session import Session
from graphos_py.translation import tr
from graphos_py.views.descriptor_shown import Shown
from graphos_py.views.descriptor_view import DescriptorView
from graphos_py.views.image_view import ImageView
from graphos_py.views.patch_strip import Patch, PatchStrip

IN_SIGHT = 300
"""Keypoints drawn in the small photo at once; zooming in shows the others."""


class DescriptorPage(ResultPage):
    """Two photos above, the nearest neighbours, and two descriptors with their difference.

    Signals
    -------
    keypoint_chosen(index)
        A keypoint of the selected photo; −1 for none.
    """

    label = "Descriptor"
    keypoint_chosen = Signal(int)

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.keypoint = -1
        self.look: Look | None = None
        self._photo = -1
        self._wanted = -1
        self._job: Job | None = None
        self._again = False
        self._grey = GreyPhotos()
        self._pixels = PhotoPixels(session, self)
        self._other_pixels = PhotoPixels(session, self)
        self.image, self.other_image = ImageView(), ImageView()
        self.image.set_empty_text(
            tr("The selected photo"), tr("Run this step, then click one of its keypoints.")
        )
        self.other_image.set_empty_text(
            tr("The other photo"), tr("The nearest neighbours are marked here by their rank.")
        )
        self.image.brief = self.other_image.brief = True
        self._thinning = QTimer(self, singleShot=True, interval=60)
        self._thinning.timeout.connect(self._thin_out)
        self.image.canvas.view_changed.connect(self._thinning.start)
        self.image.keypoint_selected.connect(self._clicked)
        self.other_image.keypoint_selected.connect(self._neighbour_clicked)
        self.strip = PatchStrip()
        self.strip.chosen.connect(self._compare)
        self.view = DescriptorView()
        self._lay()

    def _lay(self) -> None:
        photos = QSplitter(Qt.Orientation.Horizontal)
        photos.addWidget(self.image)
        photos.addWidget(self.other_image)
        photos.setSizes([500, 500])
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setWidget(self.view)
        lower = QWidget()
        column = QVBoxLayout(lower)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.strip)
        column.addWidget(scroll, 1)
        splitter = QSplitter(Qt.Orientation.Vertical)
        splitter.addWidget(photos)
        splitter.addWidget(lower)
        splitter.setStretchFactor(0, 1)
        splitter.setStretchFactor(1, 2)
        splitter.setSizes([190, 430])
        self.column.addLayout(self._bar())
        self.column.addWidget(splitter, 1)

    def _bar(self) -> QHBoxLayout:
        bar = QHBoxLayout()
        bar.setContentsMargins(8, 4, 8, 4)
        bar.setSpacing(8)
        bar.addStretch(1)
        bar.addWidget(QLabel(tr("Neighbours in")))
        self.others = QComboBox()
        self.others.setAccessibleName(tr("Photo in which neighbours are looked for"))
        self.others.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.others.setMinimumContentsLength(16)
        self.others.activated.connect(lambda _: self._look())
        bar.addWidget(self.others)
        bar.addWidget(self.lesson_button("features/descriptor"))
        return bar

    # ------------------------------------------------------------------------------------------------ public

    def fill(self) -> None:
        """Show the selected photo."""
        self._photo, self.look = -1, None
        self.show_photo(self.session.photo)

    def show_photo(self, index: int) -> None:
        """Show another photo; a keypoint of it has to be chosen."""
        if not self.isVisible():
            self._stale = True
            return
        features = self.result.features if self.result is not None else ()
        if index >= len(features):
            self._photo = self.keypoint = -1
            for image in (self.image, self.other_image):
                image.set_image(None)
            self._show_nothing()
            return
        if index == self._photo:
            return
        self._photo = index
        self._list_others(index)
        if not 0 <= self._wanted < len(features[index].xy):
            self._wanted = -1
        self.keypoint = self._wanted
        self._show_nothing()
        self._pixels.read(index, self._read)
        self._look()

    def choose(self, index: int) -> None:
        """Look at a keypoint of the selected photo; −1 for none. Emits nothing."""
        self._wanted = self.keypoint = index
        if not self.isVisible():
            self._stale = True
            return
        self.image.show_keypoint(index)
        self._look()

    def compare(self, keypoint: int, other: int) -> None:
        """Look at a keypoint of the selected photo and its neighbours in another photo."""
        self.choose(keypoint)
        place = self.others.findData(other)
        if place >= 0 and place != self.others.currentIndex():
            self.others.setCurrentIndex(place)
            self._look()

    # --------------------------------------------------------------------------------------------- looking

    def _list_others(self, index: int) -> None:
        names = [photo.name for photo in self._photos()]
        self.others.clear()
        for other in partners(self.result.pairs, index, len(names)):
            self.others.addItem(names[other], other)

    def _look(self) -> None:
        """Compute patch and neighbours of the keypoint in a job."""
        if self.result is None or self.keypoint < 0 or self._photo < 0:
            self._show_nothing()
            return
        if self._job is not None:
            self._again = True
            return
        result, other = self.result, self.others.currentData()
        keypoint, grey = (self._photo, self.keypoint), self._grey_reader()

        def work(run: Run) -> Look:
            chosen = -1 if other is None else int(other)
            return look_at(keypoint, chosen, result.features, result.pairs, grey, run)

        self._job = Job(work, name="descriptor", engine=False)
        self._job.succeeded.connect(self._looked)
        self._job.failed.connect(self.session.tell)
        self._job.finished.connect(self._over)
        self.session.jobs.start(self._job)

    def _grey_reader(self) -> Callable[[int], Array]:
        """Return what reads a photo as the detector saw it; as plain grey where the filters changed since."""
        pipeline, known = self.session.pipeline, self._grey
        photos = [self.session.seen(photo) for photo in self._photos()]
        done = pipeline is not None and pipeline.state("preprocessing").status == "done"

        def read(index: int) -> Array:
            from graphos_core.bands import visible
            from graphos_core.images import read_pixels
            from graphos_core.preprocessing.grey import eight_bit, luma
            from graphos_core.seen_photos import photo_grey_and_colour

            if pipeline is not None and done:
                return photo_grey_and_colour(pipeline, index)[0]
            return luma(eight_bit(visible(read_pixels(photos[index]))))

        key = pipeline.key("images") if pipeline is not None and done else ""
        return lambda index: known.get(photos[index].digest + key, lambda: read(index))

    def _looked(self, look: Look) -> None:
        if self.result is None or (look.photo, look.keypoint) != (self._photo, self.keypoint):
            return
        self.look = look
        mine = self.result.features[look.photo]
        best = next((i for i, n in enumerate(look.neighbours) if n.verified), 0)
        empty = (
            tr("The descriptors of the two photos are of different kinds.")
            if look.why
            else tr("No other photo.")
        )
        self.strip.set_patches([_patch(i, n, mine) for i, n in enumerate(look.neighbours)], best, empty)
        self._show_other(look)
        self._compare(best)

    def _show_other(self, look: Look) -> None:
        if look.other < 0:
            self.other_image.set_image(None)
            return
        self._other_pixels.read(look.other, self._other_read)

    def _other_read(self, index: int, pixels: Array) -> None:
        look = self.look
        if look is None or look.other != index or self.result is None:
            return
        features = self.result.features[index]
        shown = np.zeros(len(features.xy), bool)
        shown[[neighbour.index for neighbour in look.neighbours]] = True
        self.other_image.set_image(pixels, keep_view=True)
        self.other_image.set_keypoints(features, shown)
        places = np.asarray(features.xy)[[neighbour.index for neighbour in look.neighbours]]
        self.other_image.set_overlay(places, names=[str(rank + 1) for rank in range(len(places))])
        self._mark_other()

    def _mark_other(self) -> None:
        look, row = self.look, self.strip.selected
        if look is not None and 0 <= row < len(look.neighbours):
            self.other_image.select_keypoint(look.neighbours[row].index)

    def _compare(self, row: int) -> None:
        look = self.look
        if look is None or self.result is None:
            return
        features, names = self.result.features, [photo.name for photo in self._photos()]
        mine = features[look.photo]
        first = Shown(_title(names[look.photo], mine, look.keypoint), mine.descriptors[look.keypoint], look.described,
                      mine.metric)  # fmt: skip
        second = None
        if 0 <= row < len(look.neighbours):
            other, neighbour = features[look.other], look.neighbours[row]
            second = Shown(_title(names[look.other], other, neighbour.index), other.descriptors[neighbour.index],
                           neighbour.described, other.metric)  # fmt: skip
        self.view.show_pair(first, second)
        self._mark_other()

    # --------------------------------------------------------------------------------------------- reacting

    def _read(self, index: int, pixels: Array) -> None:
        if self.result is not None and index == self._photo:
            self.image.set_image(pixels, keep_view=True)
            self.image.set_keypoints(self.result.features[index])
            self.image.select_keypoint(self.keypoint)
            self._thin_out()

    def _thin_out(self) -> None:
        """Show keypoints all over what is in sight, and all of them where there are not too many."""
        features = self.result.features[self._photo] if self.result is not None and self._photo >= 0 else None
        if features is None or self.image.canvas.array is None:
            return
        seen = self.image.canvas.visible()
        corner, size = np.array([seen.left(), seen.top()]), (int(seen.width()) + 1, int(seen.height()) + 1)
        xy = np.asarray(features.xy, np.float64) - corner
        rows = np.flatnonzero(((xy > 0) & (xy < size)).all(axis=1))
        largest_first = by_rank(xy[rows], np.asarray(features.scale)[rows])
        rows = rows[spread_over_cells(largest_first, xy[rows], IN_SIGHT, size)]
        shown = np.zeros(len(features.xy), bool)
        shown[rows] = True
        if self.keypoint >= 0:
            shown[self.keypoint] = True
        self.image.filter_keypoints(shown)

    def _clicked(self, index: int) -> None:
        self._wanted = self.keypoint = index
        self._look()
        self.keypoint_chosen.emit(index)

    def _neighbour_clicked(self, index: int) -> None:
        rows = (
            [] if self.look is None else [i for i, n in enumerate(self.look.neighbours) if n.index == index]
        )
        if rows:
            self.strip.selected = rows[0]
            self.strip.update()
            self._compare(rows[0])

    def _over(self) -> None:
        self._job = None
        if self._again:
            self._again = False
            self._look()

    def _show_nothing(self) -> None:
        self.look = None
        self.strip.set_patches(
            [], empty=tr("Click a keypoint in the left photo: its nearest neighbours appear here.")
        )
        self.view.show_pair(None, None)
        self.other_image.set_image(None)

    def _photos(self) -> tuple[Photo, ...]:
        return self.session.project.photo_set.photos if self.session.project is not None else ()


def _patch(rank: int, neighbour: Neighbour, features: Features) -> Patch:
    bits = features.metric == "hamming"
    distance = (
        tr("{n} bits", n=int(neighbour.distance)) if bits else format_value(neighbour.distance, digits=3)
    )
    sign = "✓ " if neighbour.verified else ""
    ratio = tr("ratio {q}", q=f"{neighbour.ratio:.2f}")
    pixels = neighbour.described.patch if neighbour.described is not None else None
    return Patch(pixels, (f"{sign}{rank + 1}.  d {distance}", ratio), neighbour.verified)


def _title(name: str, features: Features, index: int) -> str:
    """Return two lines: photo and number of a keypoint; its place, diameter and orientation."""
    x, y = features.xy[index].tolist()
    diameter = format_value(float(features.scale[index]), unit="px", digits=3)
    angle = format_value(float(np.degrees(features.angle[index])), unit="°", digits=3)
    return f"{name}  #{index}\n{x:.1f}, {y:.1f}{THIN_SPACE}px  ⌀ {diameter}  ∠ {angle}"
