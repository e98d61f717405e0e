"""The four kinds of failure: a bad parameter, work that cannot go on, one item of many, and being stopped.

A fifth kind, a bug, is any other exception: it is not caught here.
"""

from __future__ import annotations

from dataclasses import dataclass


class GraphosError(Exception):
    """What the program says to people instead of a traceback."""


class ParamError(GraphosError):
    """A parameter has a value it cannot have; the window shows it red under its field.

    Parameters
    ----------
    name : str
        Name of the parameter, as declared.
    message : str
        What is wrong and which values are possible.
    """

    def __init__(self, name: str, message: str) -> None:
        super().__init__(message)
        self.name = name
        self.message = message

    def __reduce__(self) -> tuple[type[ParamError], tuple[str, str]]:
        return ParamError, (self.name, self.message)


class UserError(GraphosError):
    """Work that cannot go on, in three plain sentences and, where there is one, a lesson.

    Parameters
    ----------
    what, why, todo : str
        What happened; why; what to try.
    learn : str
        Name of a lesson, such as ``"adjustment/overlap"``, or empty.
    """

    def __init__(self, what: str, why: str = "", todo: str = "", learn: str = "") -> None:
        super().__init__(" ".join(part for part in (what, why, todo) if part))
        self.what = what
        self.why = why
        self.todo = todo
        self.learn = learn

    def __reduce__(self) -> tuple[type[UserError], tuple[str, str, str, str]]:
        return UserError, (self.what, self.why, self.todo, self.learn)


class Stopped(GraphosError):
    """The person asked to stop; results finished before stay."""

    def __init__(self, message: str = "Stopped; what was finished before is kept.") -> None:
        super().__init__(message)


@dataclass(frozen=True)
class ItemFailure:
    """One item of many that failed; the run goes on.

    Attributes
    ----------
    item : str
        Name of the photo, pair or point.
    reason : str
        Why it failed, in one sentence.
    """

    item: str
    reason: str
