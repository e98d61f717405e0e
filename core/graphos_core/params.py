"""Parameters, declared once.

A class derived from `Params` declares each parameter with its type, default and an `About`. Validation and its
message, the form in the window, the command-line option, the recipe, the reference page, the cache key and the
explanation all come from that one line::

    class WallisParams(Params):
        target_mean: Annotated[float, About(
            label="Target mean", symbol="m_t", unit="grey level", low=0, high=255, step=1,
            help="Brightness every neighbourhood is pulled towards.", effect="Higher: brighter image.")] = 127.0

Types: ``float``, ``int``, ``bool``, ``str``, ``Literal[...]``, ``tuple[float, float]``, each also ``| None``.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, Self, dataclass_transform, get_args, get_origin

from graphos_core.errors import ParamError
from graphos_core.text import Text

Level = Literal["novice", "student", "expert"]
Kind = Literal["float", "int", "bool", "str", "choice", "pair"]


@dataclass(frozen=True, kw_only=True)
class About:
    """What a person needs to know about a parameter.

    Attributes
    ----------
    label : str
        Name in forms and messages.
    help : str
        What it is, in one sentence.
    effect : str
        What happens when it grows or shrinks: ``"Higher: brighter image."``
    symbol : str
        Symbol in formulas, in mathtext without dollar signs.
    unit : str
        Unit, ``"px"``; empty only where there is none.
    low, high, step : float or None
        Admissible interval, ends included, and step of the form's arrows.
    low_open, high_open : bool
        Whether the end itself is excluded.
    learn : str
        Lesson, such as ``"preprocessing/wallis"``.
    level : {"novice", "student", "expert"}
        Who sees it first.
    group : str
        Heading in the form.
    choices : mapping
        Label of each choice of a ``Literal``; the bare value where missing.
    files : str
        Which files a text may name, such as ``"Calibration (*.toml)"``: the form offers to choose one.
    """

    label: str
    help: str
    effect: str = ""
    symbol: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None
    step: float | None = None
    low_open: bool = False
    high_open: bool = False
    learn: str = ""
    level: Level = "student"
    group: str = ""
    choices: Mapping[str, str] = dataclasses.field(default_factory=dict)
    files: str = ""


@dataclass(frozen=True)
class Declaration:
    """One declared parameter: its name, kind, default and `About`."""

    name: str
    kind: Kind
    optional: bool
    default: Any
    about: About
    options: tuple[str, ...] = ()

    @property
    def range_text(self) -> str:
        """The admissible values in words: ``"0 to 255 grey level"``."""
        about = self.about
        if self.kind == "choice":
            return " or ".join(self.options)
        if self.kind == "bool":
            return "true or false"
        unit = f" {about.unit}" if about.unit else ""
        low_word = "more than " if about.low_open else ""
        high_word = "less than " if about.high_open else ""
        if about.low is not None and about.high is not None:
            text = f"{low_word}{_plain(about.low)} to {high_word}{_plain(about.high)}{unit}"
        elif about.low is not None:
            text = f"{low_word or 'at least '}{_plain(about.low)}{unit}"
        elif about.high is not None:
            text = f"{high_word or 'at most '}{_plain(about.high)}{unit}"
        else:
            text = {"int": "a whole number", "float": "a number", "pair": "two numbers"}.get(
                self.kind, "a text"
            )
            text += f" in {about.unit}" if about.unit else ""
        return text

    def check(self, value: Any) -> Any:
        """Return `value` in its declared type.

        Raises
        ------
        ParamError
            With the label, the value and what is possible.
        """
        if value is None:
            if self.optional:
                return None
            raise self._refuse("nothing")
        if self.kind == "bool":
            if isinstance(value, bool):
                return value
            raise self._refuse(value)
        if self.kind == "choice":
            if value in self.options:
                return value
            raise self._refuse(value)
        if self.kind == "str":
            if isinstance(value, str):
                return str(value)
            raise self._refuse(value)
        if self.kind == "pair":
            if isinstance(value, str) or not hasattr(value, "__len__") or len(value) != 2:
                raise self._refuse(value)
            return tuple(self._number(part) for part in value)
        return self._number(value)

    def parse(self, text: str) -> Any:
        """Read the value from text, as typed on the command line or in a form.

        Raises
        ------
        ParamError
            When the text is not such a value.
        """
        text = text.strip()
        if self.optional and text.lower() in ("", "none", "auto"):
            return None
        if self.kind in ("str", "choice"):
            return self.check(text)
        if self.kind == "bool":
            words = {
                "true": True,
                "yes": True,
                "on": True,
                "1": True,
                "false": False,
                "no": False,
                "off": False,
            }
            words["0"] = False
            if text.lower() not in words:
                raise self._refuse(text)
            return words[text.lower()]
        try:
            if self.kind == "pair":
                return self.check([float(part) for part in text.replace(";", ",").split(",")])
            return self.check(int(text) if self.kind == "int" else float(text))
        except ValueError:
            raise self._refuse(text) from None

    def _number(self, value: Any) -> int | float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            if hasattr(value, "item") and getattr(value, "shape", None) == ():
                return self._number(value.item())
            raise self._refuse(value)
        if self.kind == "int" and not isinstance(value, int):
            raise self._refuse(value)
        if not math.isfinite(value):
            raise self._refuse(value)
        about = self.about
        if about.low is not None and (value < about.low or (about.low_open and value == about.low)):
            raise self._refuse(value)
        if about.high is not None and (value > about.high or (about.high_open and value == about.high)):
            raise self._refuse(value)
        return value if self.kind == "int" else float(value)

    def _refuse(self, value: Any) -> ParamError:
        shown = f"{value:g}" if isinstance(value, float) else str(value)
        unit = f" {self.about.unit}" if self.about.unit and isinstance(value, (int, float)) else ""
        possible = self.range_text
        if unit and possible.endswith(unit):
            possible = possible[: -len(unit)]
        return ParamError(
            self.name,
            Text(
                "{label}: {value}{unit}, needs {possible}",
                label=self.about.label,
                value=shown,
                unit=unit,
                possible=possible,
            ),
        )


@dataclass_transform(kw_only_default=True, frozen_default=True)
class Params:
    """Base of every parameter sheet; subclasses become frozen keyword-only dataclasses that validate themselves.

    Raises
    ------
    ParamError
        On construction, for the first value that is out of its declaration.
    """

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        dataclass(frozen=True, kw_only=True)(cls)

    def __post_init__(self) -> None:
        for name, declaration in self.declarations().items():
            object.__setattr__(self, name, declaration.check(getattr(self, name)))

    @classmethod
    def declarations(cls) -> dict[str, Declaration]:
        """Return the declared parameters in the order of declaration."""
        return _declarations(cls)  # type: ignore[arg-type]

    def to_dict(self) -> dict[str, Any]:
        """Return plain values by name, as for TOML or JSON; ``None`` stays ``None``."""
        return {
            name: list(value) if isinstance(value := getattr(self, name), tuple) else value
            for name in self.declarations()
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """Make a sheet from plain values; what is missing keeps its default.

        Raises
        ------
        ParamError
            For an unknown name, with the valid ones, and for a value out of its declaration.
        """
        known = cls.declarations()
        for name in values:
            if name not in known:
                raise ParamError(name, unknown_name(name, known, "parameter"))
        return cls(**dict(values))

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some values changed and everything validated."""
        return self.from_dict(self.to_dict() | changes)


def _plain(value: float) -> str:
    """Return a limit as people write it: 1000000, not 1e+06."""
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else f"{value:g}"


def unknown_name(name: str, known: Mapping[str, Any] | list[str], what: str) -> Text:
    """Say that `name` is not one of `known`, suggesting the nearest."""
    near = difflib.get_close_matches(name, list(known), n=1)
    hint = f" Did you mean “{near[0]}”?" if near else ""
    names = ", ".join(known) or "none"
    return Text(
        "Unknown {what} “{name}”.{hint} Valid: {names}.", what=what, name=name, hint=hint, names=names
    )


@cache
def _declarations(cls: type[Params]) -> dict[str, Declaration]:
    hints = typing.get_type_hints(cls, include_extras=True)
    found: dict[str, Declaration] = {}
    for field in dataclasses.fields(cls):  # type: ignore[arg-type]
        hint = hints[field.name]
        if get_origin(hint) is not typing.Annotated:
            raise TypeError(f"{cls.__name__}.{field.name} needs Annotated[type, About(...)]")
        plain, about = get_args(hint)[:2]
        optional = False
        if get_origin(plain) in (types.UnionType, typing.Union):
            optional = True
            (plain,) = (part for part in get_args(plain) if part is not type(None))
        if field.default is dataclasses.MISSING:
            raise TypeError(f"{cls.__name__}.{field.name} needs a default")
        kind, options = _kind(plain, f"{cls.__name__}.{field.name}")
        found[field.name] = Declaration(field.name, kind, optional, field.default, about, options)
    return found


def _kind(plain: Any, where: str) -> tuple[Kind, tuple[str, ...]]:
    simple: dict[Any, Kind] = {float: "float", int: "int", bool: "bool", str: "str"}
    if plain in simple:
        return simple[plain], ()
    if get_origin(plain) is Literal:
        return "choice", tuple(get_args(plain))
    if get_origin(plain) is tuple and len(get_args(plain)) == 2:
        return "pair", ()
    raise TypeError(f"{where}: a parameter cannot be of type {plain}")
