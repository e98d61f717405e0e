"""Features: keypoints of the selected photo, verified matches of the selected pair, how the photos hang together."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QSplitter, QVBoxLayout, QWidget

from graphos_core.data import Array, PairMatches, Photo
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_core.run import Run
from graphos_py.jobs import Job
from graphos_py.tabs.images import read_photo
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.translation import tr

KEYPOINTS, MATCHES, NUMBERS = 0, 1, 2


class FeaturesTab(StageTab):
    """Keypoints, matches with the matrix of pairs, and the funnel from keypoints to tracks."""

    stage = "features"
    empty = (
        "Points that several photos see",
        "Here you will see the keypoints of each photo, the matches that survive the epipolar check, and which "
        "photos hang together. Run finds them.",
    )

    def make_views(self) -> None:
        """Image view, matrix with match view, table."""
        from graphos_py.pair_matrix import PairMatrix
        from graphos_py.views.image_view import ImageView
        from graphos_py.views.match_view import MatchView
        from graphos_py.views.table_view import TableView

        self._shown = ("", "")
        self._photo_shown = ""
        self._found: tuple[str, Any] | None = None
        self._live: list[PairMatches] | None = None
        self._pair_job: Job | None = None
        self._pair_wanted: int | None = None
        self.image = ImageView()
        self.matrix = PairMatrix()
        self.matrix.pair_chosen.connect(self.show_pair)
        self.matches = MatchView()
        self.pair_text = QLabel()
        self.pair_text.setWordWrap(True)
        self.pair_text.setMargin(8)
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.matrix, 1)
        column.addWidget(self.pair_text)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(left)
        splitter.addWidget(self.matches)
        splitter.setStretchFactor(0, 1)
        splitter.setStretchFactor(1, 3)
        splitter.setSizes([300, 800])
        self.funnel = QLabel()
        self.funnel.setMargin(12)
        self.funnel.setTextFormat(Qt.TextFormat.RichText)
        self.table = TableView()
        self.table.row_selected.connect(self.session.select_photo)
        numbers = QWidget()
        column = QVBoxLayout(numbers)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.funnel)
        column.addWidget(self.table, 1)
        self.add_view(self.image, "Keypoints")
        self.add_view(splitter, "Matches")
        self.add_view(numbers, "Numbers")

    def show_result(self, result: Any) -> None:
        """Fill the pages."""
        self._live = self._found = None
        photos = self._photos()
        if len(photos) != len(result.features):  # a result of another set of photos
            self.stack.setCurrentWidget(self.empty_state)
            return
        names = [photo.name for photo in photos]
        self.matrix.show_pairs(result.pairs, names)
        self._fill_numbers(result, names)
        self._photo_shown = ""
        self.show_photo(self.session.photo)
        self.matrix.selected = -1
        self._show_best_pair(self.session.photo)

    def show_partial(self, key: str, values: list[Any]) -> None:
        """Show keypoints and pairs as they are found."""
        photos = self._photos()
        self.need_views()
        if key == "features":
            index, features = values[-1]
            if index < len(photos):
                self._found = (photos[index].digest, features)
                read_photo(self.session, photos[index], self._found_read)
        elif key == "pair":
            if self._live is None:
                self.views.setCurrentIndex(MATCHES)
                self.matrix.selected = -1
            self._live = [*(self._live or []), *values]
            self.matrix.show_pairs(self._live, [photo.name for photo in photos])

    def _found_read(self, read: tuple[str, Array]) -> None:
        digest, pixels = read
        if self.session.running == self.stage and self._found is not None and digest == self._found[0]:
            self.views.setCurrentIndex(KEYPOINTS)
            self.image.set_image(pixels, keep_view=True)
            self.image.set_keypoints(self._found[1])

    def show_photo(self, index: int) -> None:
        """Show the keypoints of another photo."""
        photos = self._photos()
        if self.result is None or index >= len(photos) or photos[index].digest == self._photo_shown:
            return
        self._photo_shown = photos[index].digest
        read_photo(self.session, photos[index], self._photo_read)
        self._show_best_pair(index)

    def _show_best_pair(self, photo: int) -> None:
        """Show the pair of a photo with the most verified matches, unless a pair of it is shown already."""
        pairs = self.result.pairs
        shown = self.matrix.selected
        if 0 <= shown < len(pairs) and photo in (pairs[shown].a, pairs[shown].b):
            return
        mine = [i for i, pair in enumerate(pairs) if photo in (pair.a, pair.b)]
        if mine:
            self.show_pair(max(mine, key=lambda i: len(pairs[i].matches)))

    def _photo_read(self, read: tuple[str, Array]) -> None:
        digest, pixels = read
        index = self.session.photo
        if digest == self._photo_shown and self.result is not None and index < len(self.result.features):
            self.image.set_image(pixels, keep_view=True)
            self.image.set_keypoints(self.result.features[index])

    # ------------------------------------------------------------------------------------------------ pairs

    def show_pair(self, index: int) -> None:
        """Show the verified matches of a pair."""
        self.matrix.select(index)
        if self.result is None or index >= len(self.result.pairs) or self._live is not None:
            return
        if self._pair_job is not None:
            self._pair_wanted = index
            return
        pair = self.result.pairs[index]
        photos = self._photos()
        self._write_pair(pair, photos)
        a, b = photos[pair.a], photos[pair.b]

        def work(run: Run) -> tuple[int, Array, Array]:
            from graphos_core.images import read_pixels
            from graphos_core.preprocessing.grey import eight_bit

            return index, eight_bit(read_pixels(a)), eight_bit(read_pixels(b))

        self._pair_job = Job(work, name="pair", engine=False)
        self._pair_job.succeeded.connect(self._pair_read)
        self._pair_job.failed.connect(self.session.tell)
        self._pair_job.finished.connect(self._pair_over)
        self.session.jobs.start(self._pair_job)

    def _pair_read(self, read: tuple[int, Array, Array]) -> None:
        index, image_a, image_b = read
        if self.result is None or index >= len(self.result.pairs):
            return
        pair, features = self.result.pairs[index], self.result.features
        matches = np.asarray(pair.matches).reshape(-1, 2)
        photos = self._photos()
        cameras = self.session.project.photo_set.cameras if self.session.project else ()
        curve = both = None
        if pair.kind == "essential" and cameras:
            both = (cameras[photos[pair.a].camera], cameras[photos[pair.b].camera])
            curve = essential_curve(np.asarray(pair.matrix), both)
        self.matches.set_pair(
            image_a,
            image_b,
            np.asarray(features[pair.a].xy)[matches[:, 0]],
            np.asarray(features[pair.b].xy)[matches[:, 1]],
            pair,
            (photos[pair.a].name, photos[pair.b].name),
            curve,
            both,
        )

    def _pair_over(self) -> None:
        self._pair_job = None
        if self._pair_wanted is not None:
            wanted, self._pair_wanted = self._pair_wanted, None
            self.show_pair(wanted)

    def _write_pair(self, pair: PairMatches, photos: tuple[Photo, ...]) -> None:
        text = tr(
            "{a} – {b}: {verified} verified of {candidates} candidates",
            a=photos[pair.a].name, b=photos[pair.b].name, verified=format_value(len(pair.matches)),
            candidates=format_value(pair.candidates),
        )  # fmt: skip
        text = text.replace(THIN_SPACE, "\u202f")  # where a thin space would break the line
        self.pair_text.setText(f"{text}. {tr(pair.reason)}" if pair.reason else text)

    # -------------------------------------------------------------------------------------------- numbers

    def _fill_numbers(self, result: Any, names: list[str]) -> None:
        from graphos_py.views.table_view import Column

        found = sum(f.found or len(f.xy) for f in result.features)
        used = [pair for pair in result.pairs if not pair.reason]
        lengths = np.bincount(np.asarray(result.tracks.track)) if len(result.tracks.track) else np.zeros(0)
        counts = [
            ("keypoints found", found),
            ("keypoints kept", sum(len(f.xy) for f in result.features)),
            ("candidate matches", sum(pair.candidates for pair in result.pairs)),
            ("verified matches", sum(len(pair.matches) for pair in used)),
            ("tracks", int(result.tracks.count)),
            ("tracks in 3 photos or more", int((lengths >= 3).sum())),
        ]
        cells = "".join(
            f"<td style='padding-right:28px'><span style='font-size:large'><b>{format_value(n)}</b></span>"
            f"<br>{tr(what)}</td>"
            for what, n in counts
        )
        parts = ""
        if len(result.tracks.components) > 1:
            sizes = ", ".join(str(len(c)) for c in result.tracks.components)
            parts = "<p>⚠ " + tr("The photos fall into {n} parts that do not hang together: {sizes} photos.",
                                 n=len(result.tracks.components), sizes=sizes) + "</p>"  # fmt: skip
        self.funnel.setText(f"<table><tr>{cells}</tr></table>{parts}")
        mine = [[pair for pair in used if i in (pair.a, pair.b)] for i in range(len(names))]
        in_tracks = np.bincount(np.asarray(result.tracks.photo), minlength=len(names))
        self.table.set_table(
            [
                Column(tr("photo"), names),
                Column(tr("keypoints found"), [int(f.found or len(f.xy)) for f in result.features]),
                Column(tr("kept"), [len(f.xy) for f in result.features]),
                Column(tr("pairs"), [len(pairs) for pairs in mine]),
                Column(tr("verified matches"), [sum(len(p.matches) for p in pairs) for pairs in mine]),
                Column(tr("in tracks"), [int(n) for n in in_tracks]),
            ]
        )

    def _photos(self) -> tuple[Photo, ...]:
        return self.session.project.photo_set.photos if self.session.project is not None else ()


def essential_curve(essential: Array, cameras: tuple[Any, Any]) -> Any:
    """Return the epipolar curve of a pair with an essential matrix, through the cameras' own distortion.

    The epipolar line ``l = E y_a`` of the ideal ray ``y_a`` is sampled over the other photo's field and projected
    with its camera model.
    """
    from graphos_core.cameras.model import pixel_from_ray, ray_from_pixel

    def curve(side: int, x: float, y: float) -> Array:
        ray = ray_from_pixel(cameras[side], np.array([[x, y]]))[0]
        if not np.isfinite(ray).all():
            return np.zeros((0, 2))
        a, b, c = (essential @ ray) if side == 0 else (essential.T @ ray)
        other = cameras[1 - side]
        reach = 0.75 * max(other.width, other.height) / other.focal_px
        t = np.linspace(-reach, reach, 160)
        if abs(b) >= abs(a):
            ideal = np.stack([t, -(c + a * t) / (b or 1e-12), np.ones_like(t)], axis=1)
        else:
            ideal = np.stack([-(c + b * t) / (a or 1e-12), t, np.ones_like(t)], axis=1)
        pixels = pixel_from_ray(other, ideal)
        inside = (np.abs(ideal[:, :2]) < 2 * reach).all(axis=1) & np.isfinite(pixels).all(axis=1)
        return pixels[inside]

    return curve
