"""Algorithms and where to find them: one file each, found by walking the rooms and the entry points.

Other people's packages add algorithms through the entry-point group ``graphos.algorithms``: each entry point is
a module that declares algorithms when it is imported.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import typing
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from typing import Any, Literal, TypeVar

from graphos_core.errors import UserError
from graphos_core.params import Params, unknown_name
from graphos_core.text import Text

Stage = Literal["preprocessing", "features", "adjustment", "dense", "quality"]
STAGES: tuple[Stage, ...] = ("preprocessing", "features", "adjustment", "dense", "quality")

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Algorithm:
    """A declared algorithm.

    Attributes
    ----------
    stage, role, name : str
        Room, what it does in the room (``"detector"``), and its own name (``"sift"``).
    label : str
        Name for people.
    version : int
        Raised when results change, so stored results are not reused.
    source : str
        Author, year, section.
    params : type of Params
        Its parameter sheet.
    function : callable
        ``function(inputs…, params, *, run)``; see `graphos_core.pipeline` for the inputs of each role.
    learn : str
        Lesson about it, or empty.
    """

    stage: Stage
    role: str
    name: str
    label: str
    version: int
    source: str
    params: type[Params]
    function: Callable[..., Any]
    learn: str = ""

    @property
    def summary(self) -> str:
        """First sentence of the function's documentation."""
        return (inspect.getdoc(self.function) or "").partition("\n")[0]

    def key(self, params: Params) -> dict[str, Any]:
        """Return what identifies this algorithm with these parameters in a result's key.

        Names of files are left out: what a file holds is an input of the step, wherever it lies.
        """
        known = params.declarations()
        values = {name: value for name, value in params.to_dict().items() if not known[name].about.files}
        return {"algorithm": f"{self.stage}.{self.name}", "version": self.version, "params": values}


_declared: dict[tuple[Stage, str], Algorithm] = {}


def algorithm(
    *, stage: Stage, role: str, name: str, label: str, source: str, version: int = 1, learn: str = ""
) -> Callable[[Function], Function]:
    """Declare the decorated function as an algorithm; its ``params`` argument names its parameter sheet.

    Raises
    ------
    ValueError
        When the name is taken in this stage, or ``params`` is not annotated with a `Params` subclass.
    """

    def declare(function: Function) -> Function:
        sheet = typing.get_type_hints(function).get("params")
        if not (isinstance(sheet, type) and issubclass(sheet, Params)):
            raise ValueError(f"{stage}.{name}: the argument params needs a Params subclass as its type")
        known = _declared.get((stage, name))
        if known is not None and known.function.__module__ != function.__module__:
            raise ValueError(f"{stage}.{name} is declared in {known.function.__module__} already")
        _declared[stage, name] = Algorithm(stage, role, name, label, version, source, sheet, function, learn)
        return function

    return declare


@cache
def _load() -> list[str]:
    problems: list[str] = []
    for stage in STAGES:
        room = importlib.import_module(f"graphos_core.{stage}")
        for module in sorted(pkgutil.walk_packages(room.__path__, room.__name__ + "."), key=lambda m: m.name):
            importlib.import_module(module.name)
    for point in sorted(entry_points(group="graphos.algorithms"), key=lambda p: p.name):
        try:
            point.load()
        except Exception as problem:  # another package's fault must not stop the program
            problems.append(
                Text("Add-on {name} could not be loaded: {problem}", name=point.name, problem=problem)
            )
    return problems


def problems() -> list[str]:
    """Return sentences about add-ons that could not be loaded."""
    return list(_load())


def algorithms(stage: Stage | None = None, role: str | None = None) -> list[Algorithm]:
    """Return the algorithms, of one stage and role if given, in the order of stage, role and name."""
    _load()
    found = [a for a in _declared.values() if stage in (None, a.stage) and role in (None, a.role)]
    return sorted(found, key=lambda a: (STAGES.index(a.stage), a.role, a.name))


def find(stage: str, name: str) -> Algorithm:
    """Return one algorithm by stage and name.

    Raises
    ------
    UserError
        When there is none; names the valid ones.
    """
    _load()
    if stage not in STAGES:
        raise UserError(unknown_name(stage, list(STAGES), "stage"))
    for candidate in _declared.values():
        if (candidate.stage, candidate.name) == (stage, name):
            return candidate
    raise UserError(
        unknown_name(name, [a.name for a in algorithms(candidate_stage(stage))], f"{stage} algorithm")
    )


def candidate_stage(stage: str) -> Stage:
    """Return `stage` as a known stage.

    Raises
    ------
    UserError
        When there is no such stage.
    """
    for known in STAGES:
        if known == stage:
            return known
    raise UserError(unknown_name(stage, list(STAGES), "stage"))
