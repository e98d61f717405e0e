"""Simulators: pure functions from parameters to a scene, declared with what a teacher and a student need.

A simulator is one file in `graphos_didactic.simulators`: its parameter sheet, its function, and ``@simulator(…)``::

    @simulator(room="adjustment", name="intersection", title="Base and intersection angle", …)
    def intersection(params: IntersectionParams, setting: Setting) -> Scene: ...

The function computes nothing itself that the engine can compute: `Simulator.engine` names the engine's functions
it calls, and a test asserts that these are the engine's own.
"""

from __future__ import annotations

import importlib
import pkgutil
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Literal, TypeVar

from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.params import Params, unknown_name
from graphos_core.registry import STAGES, Stage
from graphos_didactic.scene import Handle, Scene

Function = TypeVar("Function", bound=Callable[..., Scene])
PresetKind = Literal["plain", "degenerate", "photo"]


@dataclass(frozen=True, eq=False)
class Setting:
    """What surrounds the parameters.

    Attributes
    ----------
    photo : uint8 (h, w) or (h, w, 3) RGB, or None
        A photo of the open project; None lets a simulator make a photo of the simulated block.
    photo_name : str
        Its name, for the picture's title.
    step : int or None
        Number of the algorithm's step up to which the scene is shown; None for all.
    """

    photo: Array | None = None
    photo_name: str = ""
    step: int | None = None


@dataclass(frozen=True)
class Preset:
    """A set of parameters worth looking at.

    Attributes
    ----------
    name, label : str
    note : str
        What to notice, in one sentence.
    values : mapping
        Parameters that differ from their defaults.
    kind : {"plain", "degenerate", "photo"}
        ``"degenerate"`` breaks the method; ``"photo"`` works on the open project's photo.
    """

    name: str
    label: str
    note: str
    values: Mapping[str, Any]
    kind: PresetKind = "plain"


@dataclass(frozen=True)
class Step:
    """One step of the algorithm: its name and what happens in it, in one sentence."""

    title: str
    text: str


@dataclass(frozen=True)
class Prediction:
    """A question to guess before the answer is shown.

    Attributes
    ----------
    question : str
    choices : tuple of str
    change : callable
        ``change(params)`` gives the parameters of which the question asks.
    answer : callable
        ``answer(params, setting)`` gives the index of the right choice, from parameters before the change.
    explain : callable
        ``explain(params, setting)`` says why, with computed numbers.
    """

    question: str
    choices: tuple[str, ...]
    change: Callable[[Any], Any]
    answer: Callable[[Any, Setting], int]
    explain: Callable[[Any, Setting], str]


@dataclass(frozen=True)
class Verdict:
    """Result of a check.

    Attributes
    ----------
    right : bool
    text : str
        What is right or how far off, with numbers and units.
    misconception : str
        Name of the misconception behind a typical wrong answer, or empty.
    """

    right: bool
    text: str
    misconception: str = ""


@dataclass(frozen=True)
class Task:
    """An instance of a challenge.

    Attributes
    ----------
    text : str
        What to do, with this instance's numbers.
    start : Params
        Parameters to start from.
    unit : str or None
        Unit of the number to answer; None when the answer is the state of the picture.
    check : callable
        ``check(params, number)`` judges an answer.
    solution : Params or float
        A right answer, for the test and the instructor's key.
    mistakes : mapping of str to Params or float
        A typical wrong answer for each named misconception.
    free : tuple of str
        Parameters that may be changed while the task runs; the others are locked.
    """

    text: str
    start: Params
    unit: str | None
    check: Callable[[Any, float | None], Verdict]
    solution: Params | float
    mistakes: Mapping[str, Params | float]
    free: tuple[str, ...] = ()


@dataclass(frozen=True)
class Simulator:
    """A declared simulator; the attributes are those of `simulator`."""

    room: Stage
    name: str
    title: str
    summary: str
    first: str
    source: str
    params: type[Params]
    function: Callable[[Any, Setting], Scene]
    engine: tuple[Callable[..., Any], ...]
    presets: tuple[Preset, ...]
    steps: tuple[Step, ...]
    prediction: Prediction
    challenge: Callable[[int], Task]
    learn: str = ""
    version: int = 1
    place: int = 100

    @property
    def key(self) -> str:
        """Room and name: ``"adjustment/intersection"``."""
        return f"{self.room}/{self.name}"

    def scene(self, params: Params, setting: Setting | None = None) -> Scene:
        """Return the scene of these parameters."""
        return self.function(params, setting or Setting())

    def preset(self, name: str) -> Params:
        """Return the parameters of a preset.

        Raises
        ------
        UserError
            When there is none of that name.
        """
        for candidate in self.presets:
            if candidate.name == name:
                return self.params.from_dict(candidate.values)
        raise UserError(unknown_name(name, [p.name for p in self.presets], "preset"))

    def described(self, text: str) -> Params:
        """Return the parameters that a text names: a preset, values such as ``fold=0,count=20``, or nothing.

        Raises
        ------
        UserError
            For an unknown preset, an unknown name, or a value out of its declaration.
        """
        if "=" not in text:
            return self.preset(text) if text else self.params()
        declarations = self.params.declarations()
        values: dict[str, Any] = {}
        for part in text.split(","):
            name, _, value = part.partition("=")
            if name not in declarations:
                raise UserError(unknown_name(name, declarations, "parameter"))
            values[name] = declarations[name].parse(value)
        return self.params.from_dict(values)


_declared: dict[str, Simulator] = {}


def simulator(
    *,
    room: Stage,
    name: str,
    title: str,
    summary: str,
    first: str,
    source: str,
    engine: tuple[Callable[..., Any], ...],
    presets: tuple[Preset, ...],
    steps: tuple[Step, ...],
    prediction: Prediction,
    challenge: Callable[[int], Task],
    learn: str = "",
    version: int = 1,
    place: int = 100,
) -> Callable[[Function], Function]:
    """Declare the decorated function ``(params, setting) -> Scene`` as a simulator.

    Parameters
    ----------
    room, name, title, summary : str
        Where it belongs, its name in files, its name for people, what it shows in one sentence.
    first : str
        The first thing to try, in one line.
    source : str
        Author, year, section.
    engine : tuple of callable
        The engine's functions it uses.
    presets, steps, prediction, challenge
        See `Preset`, `Step`, `Prediction`; `challenge` makes a `Task` from a seed.
    learn : str
        Lesson about it.
    version : int
        Raised when old state files would show something else.
    place : int
        Where it stands among those of its room: from low to high, then by name.

    Raises
    ------
    ValueError
        When ``params`` is not annotated with a `Params` subclass.
    """

    def declare(function: Function) -> Function:
        sheet = typing.get_type_hints(function).get("params")
        if not (isinstance(sheet, type) and issubclass(sheet, Params)):
            raise ValueError(f"{room}/{name}: the argument params needs a Params subclass as its type")
        made = Simulator(
            room, name, title, summary, first, source, sheet, function, engine, presets, steps, prediction,
            challenge, learn, version, place,
        )  # fmt: skip
        _declared[made.key] = made
        return function

    return declare


@cache
def _load() -> None:
    package = importlib.import_module("graphos_didactic.simulators")
    for module in sorted(
        pkgutil.walk_packages(package.__path__, package.__name__ + "."), key=lambda m: m.name
    ):
        importlib.import_module(module.name)


def simulators(room: str | None = None) -> list[Simulator]:
    """Return all simulators, of one room if given, in the order of the workflow and of their places."""
    _load()
    found = [s for s in _declared.values() if room in (None, s.room)]
    return sorted(found, key=lambda s: (STAGES.index(s.room), s.place, s.name))


def find_simulator(key: str) -> Simulator:
    """Return one simulator by its key, ``"adjustment/intersection"``.

    Raises
    ------
    UserError
        When there is none; names the valid ones.
    """
    _load()
    if key not in _declared:
        raise UserError(unknown_name(key, list(_declared), "simulator"))
    return _declared[key]


def drag(params: Params, handle: Handle, x: float, y: float) -> Params:
    """Return the parameters after `handle` was dragged to (x, y) of its panel, within the declared limits."""
    declarations = type(params).declarations()
    changes: dict[str, Any] = {}
    for name, value in handle.move(x, y).items():
        about = declarations[name].about
        low = about.low if about.low is not None else value
        high = about.high if about.high is not None else value
        value = min(max(float(value), low), high)
        changes[name] = round(value) if declarations[name].kind == "int" else value
    return params.replace(**changes) if changes else params


@dataclass
class History:
    """Undo and redo of parameters.

    Attributes
    ----------
    present : Params
    """

    present: Params
    _past: list[Params] = field(default_factory=list)
    _future: list[Params] = field(default_factory=list)

    def push(self, params: Params) -> None:
        """Make `params` the present and remember what was before."""
        if params != self.present:
            self._past.append(self.present)
            self._future.clear()
            self.present = params

    def undo(self) -> bool:
        """Go one change back; False when there is none."""
        if not self._past:
            return False
        self._future.append(self.present)
        self.present = self._past.pop()
        return True

    def redo(self) -> bool:
        """Take the last undo back; False when there is none."""
        if not self._future:
            return False
        self._past.append(self.present)
        self.present = self._future.pop()
        return True

    @property
    def can_undo(self) -> bool:
        """Whether there is something to undo."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether there is something to redo."""
        return bool(self._future)
