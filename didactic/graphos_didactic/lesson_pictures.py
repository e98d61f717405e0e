"""The scene behind a picture of a lesson: of a simulator, a filter, a detector, or the selection of points."""

from __future__ import annotations

from collections.abc import Callable

from graphos_didactic.detector_pictures import detector_scene, selection_scene
from graphos_didactic.filter_pictures import filter_scene
from graphos_didactic.lessons import DETECTOR, FILTER, SELECTION
from graphos_didactic.scene import Scene
from graphos_didactic.simulator import find_simulator

OWN: dict[str, Callable[[str], Scene]] = {
    FILTER: filter_scene,
    DETECTOR: detector_scene,
    SELECTION: selection_scene,
}


def lesson_scene(key: str, what: str) -> Scene:
    """Return the scene of a picture, as `graphos_didactic.lessons.Lesson.markdown` names it.

    Parameters
    ----------
    key : str
        Name of a simulator, or one of `OWN`.
    what : str
        Preset or parameters, separated by commas.

    Raises
    ------
    GraphosError
        For what does not exist.
    """
    if key in OWN:
        return OWN[key](what)
    simulator = find_simulator(key)
    return simulator.scene(simulator.described(what))
