"""The pages of the features tab show what is in the result, and say what will be there without one."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from graphos_core.features.matchers.mutual import nearest_two
from graphos_py.features.coverage_page import CAMERA, CoveragePage
from graphos_py.features.descriptor_page import DescriptorPage
from graphos_py.features.graph_page import GraphPage
from graphos_py.features.keypoints_page import MATCHED, KeypointsPage
from graphos_py.features.matching_page import MatchingPage
from graphos_py.features.numbers_page import NumbersPage
from graphos_py.tabs.features import FeaturesTab

PAGES = (KeypointsPage, DescriptorPage, MatchingPage, CoveragePage, GraphPage, NumbersPage)


@pytest.mark.parametrize("kind", PAGES)
def test_every_page_can_be_seen_without_a_result(show, session, kind) -> None:
    page = show(kind(session))
    page.show_result(None)
    page.show_photo(0)
    page.grab()


def test_keypoints_are_filtered_in_picture_and_table_alike(qtbot, show, session, result) -> None:
    page = show(KeypointsPage(session))
    page.show_result(result)
    features = result.features[0]
    qtbot.waitUntil(lambda: page.image.canvas.array is not None)
    assert page.table.model.rowCount() == len(features.xy) == page.image.keypoints.count
    page.scale.boxes[0].setValue(8.0)
    expected = np.flatnonzero(features.scale >= 8.0)
    qtbot.waitUntil(lambda: page.table.model.rowCount() == len(expected))
    assert 0 < len(expected) < len(features.xy)
    assert page.image.keypoints.count == len(expected)
    page.shown.setCurrentIndex(page.shown.findData(MATCHED))
    page.shown.activated.emit(page.shown.currentIndex())
    matched = set(result.pairs[0].matches[:, 0].tolist())
    assert set(page.table.model.columns[0].values) == matched & set(expected.tolist())


def test_a_keypoint_selected_in_the_table_is_marked_in_the_picture_and_the_other_way_round(
    qtbot, show, session, result
) -> None:
    page = show(KeypointsPage(session))
    page.show_result(result)
    qtbot.waitUntil(lambda: page.image.canvas.array is not None)
    with qtbot.waitSignal(page.keypoint_chosen) as heard:
        page.table.table.selectRow(5)
    assert heard.args == [5]
    assert page.image.keypoints.selected == 5
    x, y = page.image.canvas.to_screen(result.features[0].xy)[40]
    nearest = page.image.keypoints.nearest(*page.image.canvas.to_image(x, y))
    QTest.mouseClick(page.image.canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    assert page.table.selected_rows() == [page.chosen]
    assert np.allclose(result.features[0].xy[page.chosen], result.features[0].xy[nearest], atol=2)


def test_the_table_knows_rays_and_pairs(qtbot, show, session, result) -> None:
    page = show(KeypointsPage(session))
    page.show_result(result)
    columns = {column.title: np.asarray(column.values) for column in page.table.model.columns}
    tracks = result.tracks
    mine = tracks.photo == 0
    lengths = np.bincount(tracks.track)
    assert columns["rays"].max() == lengths[tracks.track[mine]].max() == 3
    assert (columns["rays"] > 0).sum() == mine.sum()
    assert (columns["pairs"] > 0).sum() == len(np.unique(result.pairs[0].matches[:, 0]))


def test_the_nearest_neighbour_is_the_engines_and_lies_where_the_shift_says(
    qtbot, show, session, result
) -> None:
    page = show(DescriptorPage(session))
    page.show_result(result)
    xy, matches = result.features[0].xy, result.pairs[0].matches
    alone = [int((xy == xy[own]).all(axis=1).sum()) == 1 for own in matches[:, 0]]
    chosen = int(np.flatnonzero(alone)[3])  # the matcher takes features at one place as one point
    keypoint, partner = matches[chosen].tolist()
    page.choose(keypoint)
    qtbot.waitUntil(lambda: page.look is not None, timeout=20000)
    assert page.look.other == 1, "the photo with most matches comes first"
    row, _ = nearest_two(result.features[0].descriptors, result.features[1].descriptors)
    first, second = page.look.neighbours[:2]
    assert first.index == row[2][keypoint] == partner
    assert first.verified and not second.verified
    assert first.distance == pytest.approx(np.sqrt(-2 * row[0][keypoint]), abs=1e-2)
    assert first.ratio == pytest.approx(float(result.pairs[0].ratio[chosen]), abs=1e-4)
    assert "✓" in page.strip.patches[0].lines[0]
    before = page.view.difference()
    assert np.linalg.norm(before) == pytest.approx(first.distance, abs=1e-6)
    QTest.keyClick(page.strip, Qt.Key.Key_Right)
    assert np.linalg.norm(page.view.difference()) == pytest.approx(second.distance, abs=1e-6)
    qtbot.waitUntil(lambda: page.other_image.keypoints.selected == second.index, timeout=5000)
    page.grab()


def test_a_pair_is_shown_with_its_funnel_its_meaning_and_its_residuals(qtbot, show, session, result) -> None:
    page = show(MatchingPage(session))
    page.show_result(result)
    qtbot.waitUntil(lambda: page.matches.residuals is not None, timeout=20000)
    qtbot.waitUntil(lambda: len(page.funnel.steps) > 0)
    pair = result.pairs[page.pair]
    counts = [count for _, count in page.funnel.steps]
    assert counts[0] == len(result.features[pair.a].xy)
    assert len(pair.matches) in counts
    assert counts == sorted(counts, reverse=True)
    assert "plane" in page.said.text() and "homography" in page.said.text()
    shift = pair.matrix[:2, 2]
    error = (
        result.features[pair.b].xy[pair.matches[:, 1]]
        - result.features[pair.a].xy[pair.matches[:, 0]]
        - shift
    )
    assert np.allclose(page.matches.residuals, np.hypot(*error.T), atol=1e-3)
    assert np.allclose(page.matches.curve(0, 100.0, 90.0)[0], [100.0 + shift[0], 90.0 + shift[1]])
    page.colours.setCurrentIndex(1)
    page.colours.activated.emit(1)
    assert np.array_equal(page.matches.colouring.values, pair.ratio)
    page.grab()


def test_a_pair_that_is_not_used_says_why_and_where_its_matches_went(qtbot, show, session, result) -> None:
    page = show(MatchingPage(session))
    page.show_result(result)
    page.show_pair(2)
    qtbot.waitUntil(lambda: page._shown is result.pairs[2], timeout=20000)
    assert "only 7 candidate matches" in page.said.text()
    qtbot.waitUntil(lambda: len(page.funnel.steps) > 0)
    assert [count for _, count in page.funnel.steps][1:4] == [400, 7, 0]


def test_a_thinning_is_previewed_and_changes_nothing(qtbot, show, session, result) -> None:
    page = show(MatchingPage(session))
    page.show_result(result)
    qtbot.waitUntil(lambda: page.matches.residuals is not None, timeout=20000)
    names = [page.thinning.choice.itemData(i) for i in range(page.thinning.choice.count())]
    session.recipe = session.recipe.set("features.best.number=20")
    page.thinning.choice.setCurrentIndex(names.index("best"))
    page.thinning.choice.activated.emit(0)
    qtbot.waitUntil(lambda: page.matches.kept is not None, timeout=20000)
    pair = result.pairs[page.pair]
    assert page.matches.kept.sum() == 20 < len(pair.matches) == len(page.matches.xy[0])
    assert "20" in page.thinning.said.text()
    page.thinning.choice.setCurrentIndex(0)
    page.thinning.choice.activated.emit(0)
    assert page.matches.kept is None


def test_coverage_of_the_photo_and_of_all_is_the_engines(qtbot, show, session, result) -> None:
    page = show(CoveragePage(session))
    page.show_result(result)
    qtbot.waitUntil(lambda: page.view.found is not None and page.table.model.rowCount() == 3)
    matched = np.unique(result.pairs[0].matches[:, 0])
    assert page.view.found.points == len(matched)
    assert ("Enough" in page.said.text()) == (not page.view.found.alert)
    page.which.setCurrentIndex(page.which.findData(CAMERA))
    page.which.activated.emit(1)
    qtbot.waitUntil(lambda: page.view.found.points > len(matched))
    page.grab()


def test_the_graph_hides_and_never_deletes(qtbot, show, session, result) -> None:
    page = show(GraphPage(session))
    page.show_result(result)
    assert [(e.a, e.b) for e in page.view.edges] == [(0, 1), (1, 2)]
    qtbot.waitUntil(lambda: bool(page.view.cut_photos) and np.ptp(page.view.places) > 0)
    assert page.view.cut_photos == {1} and all(edge.weak for edge in page.view.edges)
    assert "p1.png" in page.said.text()
    page.slider.setValue(page.slider.maximum())
    assert len(page.view.shown) == 1 and len(page.view.edges) == 2
    at = page.view.to_screen()
    bow = page.view.bow(page.view.shown[0])
    middle = bow[len(bow) // 2]
    straight = 0.5 * (at[page.view.shown[0].a] + at[page.view.shown[0].b])
    assert np.linalg.norm(middle - straight) > 5, "edges of photos in one line bow out"
    with qtbot.waitSignal(page.pair_chosen) as heard:
        QTest.mouseClick(
            page.view, Qt.MouseButton.LeftButton, pos=QPoint(*np.round(middle).astype(int).tolist())
        )
    assert heard.args == [page.view.shown[0].pair]
    with qtbot.waitSignal(page.photo_wanted) as heard:
        QTest.mouseClick(
            page.view, Qt.MouseButton.LeftButton, pos=QPoint(*np.round(at[2]).astype(int).tolist())
        )
    assert heard.args == [2]


def test_a_node_can_be_dragged_away(qtbot, show, session, result) -> None:
    page = show(GraphPage(session))
    page.show_result(result)
    qtbot.waitUntil(lambda: np.ptp(page.view.to_screen()[:, 0]) > 100)
    before = page.view.to_screen()
    start = QPoint(*np.round(before[0]).astype(int).tolist())
    QTest.mousePress(page.view, Qt.MouseButton.LeftButton, pos=start)
    for step in (20, 60):
        move = start + QPoint(0, step)
        QTest.mouseMove(page.view, move)
        page.view.mouseMoveEvent(_moved(page.view, move))
    QTest.mouseRelease(page.view, Qt.MouseButton.LeftButton, pos=start + QPoint(0, 60))
    after = page.view.to_screen()
    assert after[0, 1] - before[0, 1] == pytest.approx(60, abs=2)
    assert np.allclose(after[1:], before[1:])


def _moved(widget, at: QPoint):
    from PySide6.QtCore import QEvent, QPointF
    from PySide6.QtGui import QMouseEvent

    return QMouseEvent(
        QEvent.Type.MouseMove, QPointF(at), QPointF(widget.mapToGlobal(at)), Qt.MouseButton.NoButton,
        Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier,
    )  # fmt: skip


def test_the_pages_of_the_tab_hand_over_to_each_other(qtbot, show, session, result) -> None:
    tab = show(FeaturesTab(session))
    session.results["features"] = result
    tab.refresh()
    assert [tab.views.tabText(i) for i in range(tab.views.count())][:5] == [
        "Keypoints", "Descriptor", "Matches", "Coverage", "Image graph",
    ]  # fmt: skip
    tab.keypoints.choose(7)
    tab.keypoints.descriptor.click()
    assert tab.views.currentWidget() is tab.descriptor and tab.descriptor.keypoint == 7
    tab.graph.pair_chosen.emit(1)
    assert tab.views.currentWidget() is tab.matching and tab.matching.pair == 1
    qtbot.waitUntil(lambda: tab.matching._shown is result.pairs[1], timeout=20000)
    tab.matching.matches.select_match(4)
    tab.matching._compare()
    assert session.photo == 1
    assert tab.descriptor.keypoint == result.pairs[1].matches[4, 0]
    qtbot.waitUntil(lambda: tab.descriptor.look is not None and tab.descriptor.look.other == 2, timeout=20000)
    assert tab.descriptor.look.neighbours[0].index == result.pairs[1].matches[4, 1]
