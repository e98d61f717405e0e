"""The window: opens and closes cleanly, empty states teach, a project opens, steps run, failures are sentences."""

import time
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QPointF, Qt, QUrl
from PySide6.QtGui import QDropEvent

from graphos_core.errors import UserError
from graphos_core.registry import STAGES
from graphos_core.run import each
from graphos_py.main_window import STEPS, MainWindow
from graphos_py.settings import Settings
from graphos_py.theme import theme


def open_project(qtbot, window: MainWindow, folder: Path) -> None:
    with qtbot.waitSignal(window.session.project_changed, timeout=10000):
        window.actions_of_project.open_folder(folder)
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=10000)


def test_it_opens_on_the_start_page_and_closes_without_threads(window):
    assert window.stack.currentWidget() is window.start_page
    assert window.ribbon.step("features").state.status == "not yet"
    assert window.ribbon.step("features").state.reason


def test_every_tab_can_be_seen_without_a_project_and_says_why_it_cannot_run(window):
    for key, _ in STEPS:
        window.show_tab(key)
        window.grab()
    for stage in STAGES:
        tab = window.stage_tab(stage)
        assert tab.empty_state.heading.text() and len(tab.empty_state.text.text()) > 40
        assert not tab.bar.run_button.isEnabled()
        assert "project first" in tab.bar.text.text()


def test_forms_appear_when_the_engine_is_loaded(window):
    window.show_tab("features")
    window.engine_loaded([])
    assert "sift" in window.stage_tab("features").panel.boxes


def test_a_project_shows_its_photos_everywhere(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    assert window.stack.currentWidget() is window.images
    assert window.thumbnails.count() == 3
    assert window.ribbon.step("images").state.line.startswith("3 photos")
    assert window.settings.recent() == [project_folder]
    window.session.select_photo(2)
    assert window.thumbnails.currentRow() == 2
    assert "p2.png" in window.tree.currentItem().text(0)


def test_an_estimated_principal_distance_is_flagged(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    qtbot.waitUntil(lambda: "p0.png" in window.images.facts.text())
    assert "estimated" in window.images.facts.text()


def test_explain_never_talks_about_another_tab(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    window.show_tab("quality")
    qtbot.waitUntil(lambda: window.explain.subject is not None, timeout=5000)
    window.show_tab("preprocessing")
    assert window.explain.subject is None or window.explain.subject[0].stage == "preprocessing"


def test_a_step_runs_with_progress_and_its_state_becomes_done(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    window.show_tab("preprocessing")
    window.session.choose("preprocessing", "filter", ("grey",))
    assert window.ribbon.step("preprocessing").state.status == "next"
    heard = []
    window.session.progressed.connect(heard.append)
    with qtbot.waitSignal(window.session.results_changed, timeout=20000):
        window.run_current()
    qtbot.waitUntil(lambda: window.session.running is None)
    assert window.ribbon.step("preprocessing").state.status == "done"
    assert heard[-1].done == heard[-1].total == 3
    window.session.choose("preprocessing", "filter", ())
    assert window.ribbon.step("preprocessing").state.status == "stale"


def test_a_failed_step_says_its_three_sentences_and_the_window_goes_on(
    qtbot, window, project_folder, monkeypatch
):
    open_project(qtbot, window, project_folder)

    def fail(self, stage, run, with_earlier=True):
        raise UserError("Nothing matched.", "The photos show noise.", "Take overlapping photos.")

    monkeypatch.setattr("graphos_core.pipeline.Pipeline.run", fail)
    window.session.run("preprocessing")
    qtbot.waitUntil(lambda: window.session.running is None)
    assert (
        window.messages.texts("error")[-1]
        == "Nothing matched.\nThe photos show noise.\nTake overlapping photos."
    )
    state = window.ribbon.step("preprocessing").state
    assert (state.status, state.line) == ("failed", "Nothing matched.")
    assert "Take overlapping photos." in state.reason


def test_a_running_step_can_be_stopped_within_a_second(qtbot, window, project_folder, monkeypatch):
    open_project(qtbot, window, project_folder)

    def slow(self, stage, run, with_earlier=True):
        for _ in each(run, range(10000), "pairs"):
            time.sleep(0.01)

    monkeypatch.setattr("graphos_core.pipeline.Pipeline.run", slow)
    window.show_tab("preprocessing")
    window.session.run("preprocessing")
    qtbot.wait(200)
    bar = window.stage_tab("preprocessing").bar
    assert bar.stop_button.isVisible() and "pairs" in bar.text.text()
    assert window.ribbon.step("preprocessing").state.status == "running"
    started = time.monotonic()
    bar.stop_button.click()
    qtbot.waitUntil(lambda: window.session.running is None, timeout=1000)
    assert time.monotonic() - started < 1.0
    assert bar.run_button.isVisible()


def test_a_step_inside_one_long_call_is_left_alone_and_the_next_run_waits_for_it(
    qtbot, window, project_folder, monkeypatch
):
    open_project(qtbot, window, project_folder)
    calls = []

    def deaf(self, stage, run, with_earlier=True):
        calls.append(stage)
        if len(calls) == 1:
            time.sleep(1.8)
        return f"result {len(calls)}"

    monkeypatch.setattr("graphos_core.pipeline.Pipeline.run", deaf)
    window.show_tab("features")
    window.session.run("preprocessing")
    qtbot.wait(100)
    started = time.monotonic()
    window.session.stop()
    qtbot.waitUntil(lambda: window.session.running is None, timeout=1500)
    assert time.monotonic() - started < 1.0
    assert "preprocessing" not in window.session.results
    window.session.run("preprocessing")
    assert window.session.running == "preprocessing"
    with qtbot.waitSignal(window.session.results_changed, timeout=5000):
        pass
    assert window.session.results["preprocessing"] == "result 2"
    assert time.monotonic() - started > 1.6, "two runs never compute at once"
    window.session.stop()
    qtbot.waitUntil(lambda: not window.jobs.running, timeout=5000)


def test_closing_during_a_run_asks_and_may_be_refused(qtbot, window, project_folder, monkeypatch):
    open_project(qtbot, window, project_folder)

    def slow(self, stage, run, with_earlier=True):
        while True:
            run.check()
            time.sleep(0.01)

    monkeypatch.setattr("graphos_core.pipeline.Pipeline.run", slow)
    window.session.run("preprocessing")
    asked = []
    monkeypatch.setattr(
        "graphos_py.main_window.ask_to_close", lambda stage, parent: bool(asked.append(stage))
    )
    assert not window.close()
    assert asked == ["Preprocessing"]
    assert window.session.running == "preprocessing"


def test_moved_photos_are_asked_for_and_found(
    qtbot, window, project_folder, photo_folder, tmp_path, monkeypatch
):
    moved = photo_folder.rename(tmp_path / "elsewhere")
    asked = []
    monkeypatch.setattr(
        "graphos_py.main_window.ask_where_photos_are",
        lambda problem, expected, parent: asked.append(expected) or moved,
    )
    with qtbot.waitSignal(window.session.project_changed, timeout=10000):
        window.actions_of_project.open_folder(project_folder)
    assert asked == [photo_folder]
    assert window.session.project.photos_folder == moved


def test_a_folder_that_is_no_project_is_a_sentence_not_a_crash(qtbot, window, tmp_path):
    window.actions_of_project.open_folder(tmp_path)
    qtbot.waitUntil(lambda: bool(window.messages.texts("error")))
    assert "not a GRAPHOS project" in window.messages.texts("error")[0]


def test_a_bug_shows_a_report_and_keeps_the_session(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    window.session.tell(ZeroDivisionError("oops"))
    dialogs = [w for w in window.findChildren(object) if type(w).__name__ == "BugDialog"]
    assert "ZeroDivisionError" in dialogs[0].report.toPlainText()
    assert str(Path.home()) not in dialogs[0].report.toPlainText()
    dialogs[0].close()
    assert window.session.project is not None


def test_a_dropped_project_opens(qtbot, window, project_folder):
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(project_folder))])
    event = QDropEvent(
        QPointF(5, 5),
        Qt.DropAction.CopyAction,
        data,
        Qt.MouseButton.LeftButton,
        Qt.KeyboardModifier.NoModifier,
    )
    with qtbot.waitSignal(window.session.project_changed, timeout=10000):
        window.dropEvent(event)


def test_unchecking_a_photo_takes_it_out_of_the_project(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    window.thumbnails.item(1).setCheckState(Qt.CheckState.Unchecked)
    with qtbot.waitSignal(window.session.project_changed, timeout=10000):
        pass
    assert [photo.name for photo in window.session.project.photo_set.photos] == ["p0.png", "p2.png"]
    assert window.thumbnails.count() == 3


def test_parameters_survive_closing_and_opening(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    recipe = window.session.recipe.set("features.sift.contrast=0.031")
    window.session.use_recipe(recipe)
    window.session.save_recipe()
    with qtbot.waitSignal(window.session.project_changed, timeout=10000):
        window.session.open(project_folder)
    assert window.session.recipe.params("features", "sift").contrast == 0.031


def test_a_recipe_of_another_version_does_not_keep_the_project_shut(qtbot, window, project_folder):
    (project_folder / "recipe_in_work.toml").write_text(
        "schema = 1\n[features.sift]\nno_such_thing = 1\n", "utf-8"
    )
    open_project(qtbot, window, project_folder)
    assert "no_such_thing" in window.messages.texts("warning")[0]
    assert window.session.recipe.params("features", "sift").to_dict()


def test_an_old_run_gives_its_parameters_back(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    window.session.choose("preprocessing", "filter", ("grey",))
    with qtbot.waitSignal(window.session.results_changed, timeout=20000):
        window.session.run("preprocessing")
    window.session.choose("preprocessing", "filter", ())
    qtbot.waitUntil(
        lambda: window.tree._runs is not None and window.tree._runs.childCount() == 1, timeout=5000
    )
    past = window.tree._runs.child(0).data(0, Qt.ItemDataRole.UserRole)[1]
    window.actions_of_project.use_run(past)
    assert window.session.recipe.chosen("preprocessing", "filter") == ("grey",)
    assert window.ribbon.step("preprocessing").state.status == "done"


def test_a_wrong_field_disables_run_with_its_sentence(qtbot, window, project_folder):
    open_project(qtbot, window, project_folder)
    window.show_tab("features")
    form = window.stage_tab("features").panel.boxes["sift"].form
    field = form.row("contrast").field
    field.widget.lineEdit().setText("x")
    field.edited.emit()
    bar = window.stage_tab("features").bar
    assert not bar.run_button.isEnabled()
    assert "needs" in bar.text.text()


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("name", ["light", "dark"])
def test_themes_and_projector_scale_apply_at_once(window, name, scale):
    window.menus.use_theme(name)
    window.menus.use_scale(scale)
    try:
        assert theme().name == name
        assert window.font().pointSizeF() == pytest.approx(theme().points("body"), rel=0.02)
        window.grab()
    finally:
        window.menus.use_theme("light")
        window.menus.use_scale(1.0)


def test_the_level_is_remembered(window, settings: Settings):
    window.set_level("expert")
    assert settings.level == "expert"


def test_the_demo_shows_progress_can_be_stopped_and_says_nothing_is_lost(
    qtbot, window, tmp_path, monkeypatch
):
    import graphos_core.simulation.photo_block as photo_block

    def slow(template, out, *, seed, photos, run):
        for _ in each(run, range(1000), "photos"):
            time.sleep(0.01)

    monkeypatch.setattr(photo_block, "simulate_photos", slow)
    page = window.start_page
    window.actions_of_project.demo(tmp_path / "demo")
    qtbot.waitUntil(lambda: page.stop_button.isVisible() and "photos" in page._doing.text(), timeout=5000)
    page.stop_button.click()
    qtbot.waitUntil(lambda: not page.stop_button.isVisible(), timeout=1500)
    assert window.session.project is None
