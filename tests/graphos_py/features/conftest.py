"""Photos whose truth is known: pieces of one picture, moved by whole pixels, with features and matches of the engine."""

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from PySide6.QtWidgets import QApplication

from graphos_core.data import Features, PairMatches, Photo
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.features.tracks import TrackParams, tracks
from graphos_core.project import Project
from graphos_core.results import FeaturesResult
from graphos_core.run import Run
from graphos_py.app import make_application
from graphos_py.jobs import Jobs
from graphos_py.loading import load_engine
from graphos_py.session import Session
from graphos_py.theme import theme

SHIFTS = ((0, 0), (30, 12), (60, 0))
"""Left and top of each photo in the picture, px."""
WIDTH, HEIGHT = 320, 240


@pytest.fixture(scope="session")
def qapp() -> QApplication:
    app = make_application()
    theme().apply("light")
    load_engine()
    return app


@pytest.fixture
def jobs(qapp: QApplication) -> Iterator[Jobs]:
    made = Jobs()
    yield made
    assert made.stop_all(), "a thread did not end"


@pytest.fixture(scope="session")
def photos() -> list[np.ndarray]:
    rng = np.random.default_rng(5)
    small = rng.integers(0, 255, (60, 80), dtype=np.uint8)
    picture = cv2.resize(small, (480, 360), interpolation=cv2.INTER_CUBIC)
    return [np.ascontiguousarray(picture[y : y + HEIGHT, x : x + WIDTH]) for x, y in SHIFTS]


@pytest.fixture(scope="session")
def result(photos) -> FeaturesResult:
    """Pairs 0–1 and 1–2 with the homography of their shift; 0–2 is not used."""
    run = Run()
    params = SiftParams(maximum=400, reduction=1.0)
    features = [sift(photo, photo, params, run=run) for photo in photos]
    pairs = [verified_pair(features, a, b) for a, b in ((0, 1), (1, 2))]
    pairs.append(
        PairMatches(a=0, b=2, matches=np.zeros((0, 2), np.int32), candidates=7, kind="none", matrix=np.zeros((3, 3)),
                    reason="only 7 candidate matches", steps=(("nearest", 400), ("ratio", 7), ("verified", 0)))
    )  # fmt: skip
    return FeaturesResult(
        features=tuple(features),
        pairs=tuple(pairs),
        tracks=tracks(features, pairs, TrackParams(), run=run),
    )


def verified_pair(features: list[Features], a: int, b: int) -> PairMatches:
    shift = np.subtract(SHIFTS[a], SHIFTS[b])
    matrix = np.array([[1.0, 0, shift[0]], [0, 1, shift[1]], [0, 0, 1]])
    found = mutual(features[a], features[b], MutualParams(), run=Run())
    error = features[b].xy[found.matches[:, 1]] - features[a].xy[found.matches[:, 0]] - shift
    good = np.hypot(*error.T) < 2.0
    if a == 1:  # the two pairs differ in strength
        good[::3] = False
    assert good.sum() > 50
    return PairMatches(
        a=a, b=b, matches=found.matches[good], candidates=len(found.matches), kind="homography", matrix=matrix,
        threshold_px=2.0, ratio=found.ratio[good], scene="planar",
        steps=(*found.steps, ("verified", int(good.sum())), ("kept", int(good.sum()))),
    )  # fmt: skip


@pytest.fixture
def session(jobs: Jobs, photos, tmp_path: Path) -> Session:
    """A session with a project of the photos."""
    folder = tmp_path / "photos"
    folder.mkdir()
    for i, photo in enumerate(photos):
        cv2.imwrite(str(folder / f"p{i}.png"), photo)
    made = Session(jobs)
    made.engine_ready()
    made.project = Project.create(tmp_path / "project", folder, name="Shifted")
    assert all(isinstance(photo, Photo) for photo in made.project.photo_set.photos)
    return made


@pytest.fixture
def show(qtbot):
    """Return a function that shows a page."""

    def shown(page):
        qtbot.addWidget(page)
        page.resize(900, 700)
        page.show()
        return page

    return shown
