"""The lab that compares detectors: played from beginning to end, and its numbers against the truth."""

from __future__ import annotations

import json
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.errors import UserError
from graphos_core.features_comparison.measures import REPEATED_PX, RIGHT_PX
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.run import Run
from graphos_didactic.lab_check import figure_of
from graphos_didactic.lab_detectors import kept, place, true_places
from graphos_didactic.lab_figures import Figure
from graphos_didactic.lab_session import LabSession, hand_in, key_page
from graphos_didactic.labs import Lab, read_lab

NAME = "the-same-wall-five-detectors"


def small_lab() -> Lab:
    source = (resources.files("graphos_resources") / "labs" / NAME / "lab.toml").read_text("utf-8")
    return read_lab(NAME, source.replace("width = 640, height = 480", "width = 320, height = 240"))


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> tuple[LabSession, Pipeline]:
    """A student who answers every step: by the tabs, the button, and numbers computed from the table."""
    session, run = LabSession(small_lab(), "Anna", tmp_path_factory.mktemp("lab")), Run(threads=2)
    session.prepare(run)
    pipeline = Pipeline(Project.open(session.project_folder), Recipe.default(0))
    for i, step in enumerate(session.lab.steps):
        answer = ""
        if step.kind == "predict":
            answer = "50"
        elif step.kind == "explain":
            answer = "because " * step.words
        elif step.kind == "measure":
            answer = read_from_table(session, step.figure)
        elif step.kind == "do" and step.stage is not None:
            pipeline.run(step.stage, run)  # type: ignore[arg-type]
        outcome = session.answer(i, answer, pipeline, run)
        assert outcome.passed, f"{step.title}: {outcome.text}"
    return session, pipeline


def read_from_table(session: LabSession, figure: str) -> str:
    """Compute from the rounded numbers of the table what a student computes."""
    detector, _, what = figure.partition("_")
    row = kept(session.simulation, detector)
    assert row is not None
    if what == "yield":
        return f"{round(row['verified']) / round(row['keypoints']):.3f}"
    if what == "right":
        return f"{100 * round(row['right']) / round(row['verified']):.1f}"
    return f"{100 * row[what]:.0f}"


def test_the_lab_can_be_played_to_its_end(played: tuple[LabSession, Pipeline]) -> None:
    session, _ = played
    assert session.passed == set(range(len(session.lab.steps)))
    again = LabSession.resume(session.lab, session.folder)
    assert again.current == len(session.lab.steps)


def test_the_text_of_the_lab_names_the_tolerances_that_are_used() -> None:
    texts = " ".join(" ".join(step.text.split()) for step in small_lab().steps)
    assert (REPEATED_PX, RIGHT_PX) == (1.5, 3.0)
    assert "within one and a half pixels" in texts
    assert "within three pixels" in texts


def test_hand_in_and_key_show_what_the_detectors_gave(played: tuple[LabSession, Pipeline]) -> None:
    session, pipeline = played
    page = hand_in(session, pipeline)
    assert "keypoints per photo" in page
    assert "predicted 50" in page
    key = dict(key_page(session, pipeline))
    row = kept(session.simulation, "akaze")
    assert row is not None
    assert key["Verified is not right"].startswith(f"{100 * row['right'] / row['verified']:.0f}"[:1])
    assert "truth" in key["Is it true? The principal distance"]


def test_the_numbers_belong_together_and_differ(played: tuple[LabSession, Pipeline]) -> None:
    session, _ = played
    rows = {s.detector: kept(session.simulation, s.detector) for s in session.lab.steps if s.kind == "detect"}
    assert len(rows) == 5
    for name, row in rows.items():
        assert row is not None, name
        assert row["right"] <= row["verified"] <= row["matches"], name
        assert row["inlier_share"] == pytest.approx(row["verified"] / row["matches"])
        assert 0.0 < row["coverage"] <= 1.0
        assert 0.05 < row["repeatability"] < 1.0
        assert row["right"] > 0.4 * row["verified"], name
    assert len({tuple(row.values()) for row in rows.values() if row}) == 5


def test_a_wrong_reading_is_refused_without_the_answer(played: tuple[LabSession, Pipeline]) -> None:
    session, pipeline = played
    index, step = next((i, s) for i, s in enumerate(session.lab.steps) if s.kind == "measure")
    figure = figure_of(step, pipeline, session.truth())
    assert isinstance(figure, Figure)
    outcome = session.answer(index, f"{1.5 * figure.value:.3f}", pipeline)
    assert not outcome.passed
    assert f"{figure.value:.3g}" not in outcome.text
    session.answer(index, f"{figure.value:.3f}", pipeline)


def test_places_by_the_truth_are_where_the_surface_is_seen(played: tuple[LabSession, Pipeline]) -> None:
    """Points of the true mesh, projected into both photos, against what is carried over by depth."""
    truth = played[0].truth()
    assert truth is not None
    rng = np.random.default_rng(0)
    corners = truth.mesh.vertices[truth.mesh.triangles[rng.integers(0, len(truth.mesh.triangles), 4000)]]
    points = (corners * rng.dirichlet((1, 1, 1), 4000)[..., None]).sum(axis=1)
    seen = [
        pixel_from_ray(truth.cameras[0], (points - truth.centres[i]) @ truth.rotations[i].T) for i in (0, 1)
    ]
    inside = np.all((seen[0] > 1) & (seen[0] < (318, 238)), axis=1)
    seen, points = [s[inside] for s in seen], points[inside]
    local = (points - truth.centres[0]) @ truth.rotations[0].T
    column, row = np.rint(seen[0]).astype(int).T
    front = np.abs(truth.depth(0)[row, column] - local[:, 2]) < 0.002 * local[:, 2]
    there = true_places(truth, 0, 1, seen[0])
    known = np.isfinite(there).all(axis=1) & front
    assert known.sum() > 300
    miss = np.hypot(*(there - seen[1])[known].T)
    assert np.quantile(miss, 0.5) < 0.7


def test_numbers_that_cannot_be_read_are_missing(tmp_path: Path) -> None:
    assert kept(tmp_path, "sift") is None
    file = place(tmp_path, "sift")
    file.parent.mkdir()
    file.write_text("[]", "utf-8")
    assert kept(tmp_path, "sift") is None
    file.write_text(json.dumps({"keypoints": 3}), "utf-8")
    assert kept(tmp_path, "sift") is None


def test_an_unknown_detector_is_refused_with_its_line() -> None:
    source = (resources.files("graphos_resources") / "labs" / NAME / "lab.toml").read_text("utf-8")
    for change, says in (
        (('detector = "orb"', 'detector = "orbb"'), "Did you mean “orb”"),
        (('detector = "orb"', ""), "needs “detector”"),
        (('figure = "orb_yield"', 'figure = "orb_yeld"'), "orb_yield"),
    ):
        with pytest.raises(UserError) as refused:
            read_lab("broken", source.replace(*change, 1))
        assert says in str(refused.value)
        assert "line" in str(refused.value)
