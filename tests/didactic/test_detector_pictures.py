"""Pictures of detectors say what the engine found."""

import re

import pytest

from graphos_core.errors import UserError
from graphos_didactic.detector_pictures import SELECTIONS, detector_scene, selection_scene
from graphos_didactic.lesson_pictures import lesson_scene
from graphos_didactic.scene import Points, Polygon
from graphos_didactic.scene_svg import scene_svg


def test_the_number_found_again_is_that_of_the_circles() -> None:
    scene = detector_scene("orb,levels=4")
    said = re.search(r"(\d+) of (\d+) found again", scene.panel("changed").title)
    assert said is not None
    circles = {
        p: [m for m in scene.marks if isinstance(m, Polygon) and m.panel == p] for p in ("photo", "changed")
    }
    assert len(circles["changed"]) == int(said[1]) > 40
    assert len(circles["photo"]) == int(said[2])
    assert sum(m.dash == "solid" for m in circles["photo"]) == int(said[1])
    assert {m.thing for m in circles["changed"]} <= {m.thing for m in circles["photo"]}
    assert "found again" in scene_svg(scene)


def test_one_level_is_not_found_again_in_a_smaller_photo() -> None:
    def share(what: str) -> int:
        return int(re.search(r"(\d+) of", detector_scene(what).panel("changed").title)[1])

    assert share("orb,levels=1") < share("orb")


def test_points_chosen_by_distance_are_spread_most() -> None:
    scene = selection_scene("orb")
    shares = {how: int(re.search(r"(\d+) %", scene.panel(how).title)[1]) for how in SELECTIONS}
    assert max(shares, key=shares.get) == "anms"
    assert all(len(m.xy) == 120 for m in scene.marks if isinstance(m, Points))


def test_what_does_not_exist_is_refused() -> None:
    with pytest.raises(UserError, match="no detector"):
        lesson_scene("detector", "mutual")
    with pytest.raises(UserError, match="Unknown parameter"):
        lesson_scene("selection", "orb,tilt=3")
