"""The Learn tab: everything in its list opens, lessons are drawn, and a lab leads from step to step."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from PySide6.QtCore import QEvent, QSettings, QUrl
from PySide6.QtGui import QImage, QTextDocument
from PySide6.QtWidgets import QApplication, QLabel
from pytestqt.qtbot import QtBot

from graphos_core.errors import UserError
from graphos_core.project import Project
from graphos_core.run import Run
from graphos_didactic.lab_session import LabSession
from graphos_didactic.labs import read_lab
from graphos_didactic.lessons import Lesson, Trial, find_lesson, lessons
from graphos_didactic.simulator import simulators
from graphos_py.app import make_application
from graphos_py.formula import formula_image
from graphos_py.jobs import Jobs
from graphos_py.main_window import MainWindow
from graphos_py.session import Session, load_engine
from graphos_py.settings import Settings
from graphos_py.tabs.lab_page import LabPage
from graphos_py.tabs.learn import LearnTab
from graphos_py.tabs.lesson_page import LessonPage
from graphos_py.tabs.simulator_page import SimulatorPage
from graphos_py.theme import theme
from graphos_py.views.lesson_view import LessonView, formulas_in, to_html

LAB = """title = "Small lab"
goal = "Walk"
minutes = 5
block = { template = "facade", photos = 3, width = 320, height = 240 }
[[step]]
kind = "read"
title = "First"
text = "Hello $x^2$"
[[step]]
kind = "predict"
title = "Guess"
text = "How many?"
figure = "photos_oriented"
hints = ["look", "look harder"]
[[step]]
kind = "do"
title = "Prepare"
text = "Run it"
stage = "preprocessing"
[[step]]
kind = "explain"
title = "Say"
text = "Why?"
words = 2
"""


@pytest.fixture(scope="session")
def qapp() -> QApplication:
    app = make_application()
    theme().apply("light")
    load_engine()
    return app


@pytest.fixture
def session(qapp: QApplication) -> Iterator[Session]:
    jobs = Jobs()
    made = Session(jobs)
    made.engine_ready()
    yield made
    made.save_recipe()
    assert jobs.stop_all(), "a thread did not end"
    qapp.sendPostedEvents(None, QEvent.Type.DeferredDelete)


@pytest.fixture
def tab(session: Session, qtbot: QtBot) -> LearnTab:
    made = LearnTab(session)
    qtbot.addWidget(made)
    made.resize(1300, 800)
    made.show()
    qtbot.waitUntil(lambda: made.ready, timeout=20_000)
    return made


@pytest.fixture
def lab_page(session: Session, qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> LabPage:
    """A lab whose photos are three pictures of noise, made at once."""

    def prepare(self: LabSession, run: Run) -> None:
        photos = self.simulation / "photos"
        photos.mkdir(parents=True, exist_ok=True)
        rng = np.random.default_rng(0)
        for i in range(3):
            small = rng.integers(0, 255, (12, 16, 3), dtype=np.uint8)
            cv2.imwrite(str(photos / f"p{i}.png"), cv2.resize(small, (160, 120)))
        Project.create(self.project_folder, photos, name="Noise", run=run)
        self.save()

    monkeypatch.setattr(LabSession, "prepare", prepare)
    monkeypatch.setattr("graphos_py.tabs.lab_start.documents", lambda: tmp_path)
    made = LabPage(session, read_lab("small", LAB))
    qtbot.addWidget(made)
    made.show()
    return made


def begin(page: LabPage, qtbot: QtBot, name: str = "Anna") -> LabSession:
    page.start.name.setText(name)
    page.start.name.textEdited.emit(name)
    page.start.begin()
    qtbot.waitUntil(lambda: page.student is not None and page.step.project_is_open(), timeout=20_000)
    assert page.student is not None
    return page.student


def test_the_tab_lists_simulators_lessons_and_labs(tab: LearnTab) -> None:
    assert len(tab.list.entries("simulator")) >= 3
    assert {e.name for e in tab.list.entries("lesson")} == set(lessons())
    assert tab.list.entries("lab")
    assert all(e.text for kind in ("simulator", "lesson", "lab") for e in tab.list.entries(kind))
    assert tab.stack.currentWidget() is tab.welcome
    assert len(tab.welcome.cards) >= 5


def test_what_is_asked_before_the_list_is_there_opens_later(session: Session, qtbot: QtBot) -> None:
    made = LearnTab(session)
    qtbot.addWidget(made)
    made.open_lesson("features/sift")
    qtbot.waitUntil(lambda: made.ready, timeout=20_000)
    assert isinstance(made.stack.currentWidget(), LessonPage)


def test_a_broken_catalogue_is_said_on_the_page(
    session: Session, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(run: Run) -> None:
        raise UserError("The lesson x/y cannot be read.")

    monkeypatch.setattr("graphos_py.tabs.learn.catalogue", broken)
    made = LearnTab(session)
    qtbot.addWidget(made)
    qtbot.waitUntil(
        lambda: any("x/y" in label.text() for label in made.welcome.findChildren(QLabel)), timeout=10_000
    )


def test_simulators_open_and_lead_back(tab: LearnTab) -> None:
    tab.open_simulator("adjustment/intersection")
    page = tab.stack.currentWidget()
    assert isinstance(page, SimulatorPage)
    page.lesson_asked.emit("adjustment/intersection")
    lesson = tab.stack.currentWidget()
    assert isinstance(lesson, LessonPage)
    lesson.left.emit()
    assert tab.stack.currentWidget() is tab.welcome


def test_an_unknown_name_is_a_sentence_not_an_end(tab: LearnTab) -> None:
    tab.open_lesson("features/magic")
    tab.open_simulator("features/magic")
    tab.open_lab("magic")
    assert tab.stack.currentWidget() is tab.welcome


def test_a_lab_of_an_instructor_opens_and_a_broken_one_says_the_line(tab: LearnTab, tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text(LAB, "utf-8")
    tab.open_lab(str(tmp_path))
    page = tab.stack.currentWidget()
    assert isinstance(page, LabPage)
    assert page.lab.title == "Small lab"
    broken = tmp_path / "broken"
    broken.mkdir()
    (broken / "lab.toml").write_text(LAB.replace('kind = "do"', 'kind = "dance"'), "utf-8")
    tab.open_lab(str(broken))
    assert tab.stack.currentWidget() is tab.welcome
    assert "line 15" in tab.welcome.note


def test_every_lesson_is_drawn_with_all_its_formulas(session: Session, qtbot: QtBot) -> None:
    for simulator in simulators():  # compiles what the window finds compiled, see `graphos_py.warm_up`
        simulator.scene(simulator.params())
    view = LessonView(session.jobs)
    qtbot.addWidget(view)
    for lesson in lessons().values():
        with qtbot.waitSignal(view.drawn, timeout=20_000):
            view.show_lesson(lesson)
        assert lesson.summary.split()[0] in view.toPlainText()
        for address in formulas_in(view._html):
            image = view.loadResource(QTextDocument.ResourceType.ImageResource, QUrl(address))
            assert not image.isNull(), address


def test_lessons_follow_the_theme(session: Session, qtbot: QtBot) -> None:
    view = LessonView(session.jobs)
    qtbot.addWidget(view)
    with qtbot.waitSignal(view.drawn, timeout=20_000):
        view.show_lesson(find_lesson("features/matching"))
    with qtbot.waitSignal(view.drawn, timeout=20_000):
        theme().apply("dark")
    theme().apply("light")
    qtbot.waitUntil(lambda: not view.waiting, timeout=20_000)


def test_text_of_strangers_stays_text(session: Session, qtbot: QtBot) -> None:
    html = to_html("<script>alert(1)</script> ![x](file:///etc/passwd) [y](javascript:alert(1)) <b>z</b>")
    assert "<script" not in html
    assert "<b>" not in html
    assert 'href="javascript' not in html
    view = LessonView(session.jobs)
    qtbot.addWidget(view)
    assert view.loadResource(QTextDocument.ResourceType.ImageResource, QUrl("file:///etc/hostname")).isNull()


def test_a_formula_that_cannot_be_set_is_shown_as_written(session: Session, qtbot: QtBot) -> None:
    view = LessonView(session.jobs)
    qtbot.addWidget(view)
    with qtbot.waitSignal(view.drawn, timeout=20_000):
        view.show_markdown(r"before $\nonsense{$ after")
    assert "nonsense" in view.toPlainText()


def test_a_trial_sets_the_parameters_and_chooses_the_algorithm(session: Session, qtbot: QtBot) -> None:
    lesson = find_lesson("preprocessing/wallis")
    page = LessonPage(session, lesson)
    qtbot.addWidget(page)
    page.tries[0].click()
    recipe = session.recipe
    assert recipe is not None
    assert recipe.chosen("preprocessing", "filter") == ("wallis",)
    for name, value in lesson.trials[0].values.items():
        assert getattr(recipe.params("preprocessing", "wallis"), name) == value
    with qtbot.waitSignal(page.stage_asked) as asked:
        page.go.click()
    assert asked.args == ["preprocessing"]


def test_a_trial_of_a_lesson_without_an_algorithm_opens_its_simulator(session: Session, qtbot: QtBot) -> None:
    lesson = Lesson(
        "adjustment/x",
        "x",
        "text\n",
        simulator="adjustment/intersection",
        trials=(Trial("x", {"a_x": -4.0}, simulator=True),),
    )
    page = LessonPage(session, lesson)
    qtbot.addWidget(page)
    with qtbot.waitSignal(page.simulator_tried) as asked:
        page.tries[0].click()
    assert asked.args == ["adjustment/intersection", {"a_x": -4.0}]


def test_try_this_of_the_explain_panel_chooses_the_algorithm(qtbot: QtBot, tmp_path: Path) -> None:
    window = MainWindow(Settings(QSettings(str(tmp_path / "s.ini"), QSettings.Format.IniFormat)))
    qtbot.addWidget(window)
    window.engine_loaded([])
    recipe = window.session.recipe
    assert recipe is not None and recipe.chosen("preprocessing", "filter") == ()
    window.explain.tried.emit("wallis", {"window": 11})
    recipe = window.session.recipe
    assert recipe.chosen("preprocessing", "filter") == ("wallis",)
    assert recipe.params("preprocessing", "wallis").window == 11  # type: ignore[attr-defined]
    window.close()
    window.jobs.stop_all()


def test_the_filled_button_is_the_next_thing_to_do(lab_page: LabPage, qtbot: QtBot) -> None:
    student = begin(lab_page, qtbot)
    lab_page.show_step(1)
    step = lab_page.step
    assert step.check_button.property("role") == "primary" and step.next_button.text() == "Skip for now"
    step.number.setText("3")
    step.check()
    qtbot.waitUntil(lambda: 1 in student.passed and not step.checking, timeout=10_000)
    assert step.next_button.property("role") == "primary" and step.next_button.text() == "Next step"


def test_a_lab_leads_from_step_to_step(lab_page: LabPage, session: Session, qtbot: QtBot) -> None:
    assert not lab_page.start.start.isEnabled()
    assert "name" in lab_page.start.said.text()
    student = begin(lab_page, qtbot)
    step = lab_page.step
    assert "Step 1 of 4" in lab_page.where()
    step.check()
    qtbot.waitUntil(lambda: lab_page.shown == 1, timeout=10_000)
    assert "Guess" in lab_page.where()
    step.hint()
    step.hint()
    assert "look harder" in step.hint_text.text()
    step.number.setText("3")
    step.check()
    qtbot.waitUntil(lambda: 1 in student.passed, timeout=10_000)
    lab_page.go_on()
    session.run("preprocessing")
    qtbot.waitUntil(lambda: 2 in student.passed and not step.checking, timeout=20_000)
    lab_page.go_on()
    step.words.setPlainText("one")
    step.check()
    qtbot.waitUntil(lambda: "✗" in step.result.text(), timeout=10_000)
    step.words.setPlainText("two words")
    step.check()
    qtbot.waitUntil(lambda: 3 in student.passed, timeout=10_000)
    assert "hand in" in lab_page.where()


def test_what_is_typed_is_saved_at_once_and_a_lab_resumes(
    lab_page: LabPage, session: Session, qtbot: QtBot
) -> None:
    student = begin(lab_page, qtbot)
    lab_page.show_step(3)
    lab_page.step.words.setPlainText("half a thought")
    qtbot.waitUntil(lambda: student.answers.get(3) == "half a thought", timeout=5_000)
    again = LabPage(session, lab_page.lab)
    qtbot.addWidget(again)
    found = again.start.resumable()
    assert [s.answers[3] for s in found] == ["half a thought"]
    again.start.name.textEdited.emit("Anna")
    assert again.start.start.text() == "Go on"


def test_the_hand_in_is_written_and_the_key_is_for_experts(
    lab_page: LabPage, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(
        "graphos_py.tabs.lab_step.QDesktopServices.openUrl", lambda url: opened.append(url.path())
    )
    student = begin(lab_page, qtbot, "<b>Eve</b>")
    assert not lab_page.key.isVisible()
    lab_page.set_level("expert")
    assert lab_page.key.isVisible()
    lab_page.hand_in.click()
    qtbot.waitUntil(lambda: bool(opened), timeout=20_000)
    page = (student.folder / "hand-in.html").read_text("utf-8")
    assert "<b>Eve" not in page
    assert (student.folder / "hand-in.pdf").read_bytes().startswith(b"%PDF")
    lab_page.key.click()
    qtbot.waitUntil(lambda: "not computed yet" in lab_page.step.text.toPlainText(), timeout=10_000)


def test_making_photos_can_be_stopped(
    lab_page: LabPage, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def endless(self: LabSession, run: Run) -> None:
        while True:
            run.check()

    monkeypatch.setattr(LabSession, "prepare", endless)
    lab_page.start.name.setText("Max")
    lab_page.start.name.textEdited.emit("Max")
    lab_page.start.begin()
    qtbot.waitUntil(lambda: lab_page.start.stop.isVisible())
    lab_page.start.cancel()
    qtbot.waitUntil(
        lambda: "Stopped" in lab_page.start.said.text() and lab_page.start.start.isVisible(), timeout=10_000
    )
    assert lab_page.student is None


def test_a_tall_fraction_is_drawn_whole() -> None:
    tall = formula_image(r"x = \dfrac{L_1 X + L_2 Y + L_3 Z + L_4}{L_9 X + L_{10} Y + 1}", "#000000", 12.0)
    alpha = tall.convertToFormat(QImage.Format.Format_Alpha8)
    rows = np.frombuffer(alpha.constBits(), np.uint8).reshape(tall.height(), alpha.bytesPerLine())[
        :, : tall.width()
    ]
    assert not rows[0].any() and not rows[-1].any()
