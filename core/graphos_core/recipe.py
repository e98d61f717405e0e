"""A recipe: which algorithm plays each role and with which parameters; TOML on disk, immutable in memory.

::

    schema = 1
    seed = 0

    [features]
    detector = "sift"

    [features.sift]
    contrast = 0.02
"""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import tomli_w

from graphos_core import registry
from graphos_core.errors import ParamError, UserError
from graphos_core.params import Params, unknown_name
from graphos_core.project_file import relative_path, resolved
from graphos_core.registry import STAGES, Algorithm
from graphos_core.store import write_text
from graphos_core.text import Text

SCHEMA = 1

DEFAULTS: Mapping[str, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "preprocessing": {"analysis": ("analyser",), "undistortion": ("as_taken",), "filter": ()},
        "features": {
            "detector": ("sift",),
            "pairs": ("multiscale",),
            "matcher": ("mutual",),
            "verification": ("usac",),
            "thinning": ("every",),
            "tracks": ("tracks",),
        },
        "adjustment": {
            "orientation": ("incremental",),
            "bundle": ("schur",),
            "georeferencing": ("similarity",),
        },
        "dense": {"depth": ("multiview",), "fusion": ("consistent",)},
        "quality": {"registration": ("placed",), "comparison": ("nearest",)},
    }
)
"""The algorithm of every role when nobody chose: ``DEFAULTS[stage][role]``. Filters form a chain, here an empty one."""

CHAINS = ("filter",)
"""Roles that take any number of algorithms, one after the other."""


@dataclass(frozen=True)
class Recipe:
    """Choice and parameters of every algorithm, and the seed.

    Attributes
    ----------
    seed : int
    choices : mapping
        ``choices[stage, role]``: names of the algorithms; roles that are missing have their default.
    sheets : mapping
        ``sheets[stage, name]``: parameter sheets that differ from the default.
    """

    seed: int = 0
    choices: Mapping[tuple[str, str], tuple[str, ...]] = dataclasses.field(default_factory=dict)
    sheets: Mapping[tuple[str, str], Params] = dataclasses.field(default_factory=dict)

    @classmethod
    def default(cls, seed: int = 0) -> Recipe:
        """Return the recipe in which nothing was changed."""
        return cls(seed)

    def chosen(self, stage: str, role: str) -> tuple[str, ...]:
        """Return the names of the algorithms that play a role: exactly one, any number for filters."""
        return self.choices.get((stage, role), DEFAULTS[stage][role])

    def algorithms(self, stage: str, role: str) -> list[tuple[Algorithm, Params]]:
        """Return the algorithms that play a role, with their parameters."""
        return [(registry.find(stage, name), self.params(stage, name)) for name in self.chosen(stage, role)]

    def algorithm(self, stage: str, role: str) -> tuple[Algorithm, Params]:
        """Return the one algorithm that plays a role, with its parameters."""
        (only,) = self.algorithms(stage, role)
        return only

    def params(self, stage: str, name: str) -> Params:
        """Return the parameter sheet of an algorithm, chosen or not."""
        found = self.sheets.get((stage, name))
        return found if found is not None else registry.find(stage, name).params()

    def with_seed(self, seed: int) -> Recipe:
        """Return a recipe with another seed.

        Raises
        ------
        ParamError
            For a seed that is not a whole number from 0 to 2³¹ − 1.
        """
        if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**31:
            raise ParamError(
                "seed", Text("Seed: {value}, needs a whole number from 0 to 2147483647", value=seed)
            )
        return dataclasses.replace(self, seed=seed)

    def choose(self, stage: str, role: str, names: str | Sequence[str]) -> Recipe:
        """Return a recipe in which `names` play a role.

        Raises
        ------
        UserError
            For an unknown stage, role or algorithm, or not exactly one where one is needed.
        """
        names = (names,) if isinstance(names, str) else tuple(names)
        _check_role(stage, role)
        if role not in CHAINS and len(names) != 1:
            raise UserError(Text("{stage}.{role} needs exactly one algorithm.", stage=stage, role=role))
        for name in names:
            found = registry.find(stage, name)
            if found.role != role:
                raise UserError(
                    Text("{name} is a {other}, not a {role}.", name=name, other=found.role, role=role),
                    todo=Text(
                        "Valid: {names}.",
                        names=", ".join(
                            a.name for a in registry.algorithms(registry.candidate_stage(stage), role)
                        ),
                    ),
                )
        return dataclasses.replace(self, choices={**self.choices, (stage, role): names})

    def with_room_of(self, other: Recipe, stage: str) -> Recipe:
        """Return a recipe with the choices and parameters of one room of another recipe."""
        choices = {k: v for k, v in self.choices.items() if k[0] != stage}
        sheets = {k: v for k, v in self.sheets.items() if k[0] != stage}
        choices |= {k: v for k, v in other.choices.items() if k[0] == stage}
        sheets |= {k: v for k, v in other.sheets.items() if k[0] == stage}
        return dataclasses.replace(self, choices=choices, sheets=sheets)

    def with_params(self, stage: str, name: str, params: Params) -> Recipe:
        """Return a recipe with another parameter sheet for an algorithm."""
        sheets = {**self.sheets, (stage, name): params}
        if params == registry.find(stage, name).params():
            del sheets[stage, name]
        return dataclasses.replace(self, sheets=sheets)

    def moved(self, old: Path, new: Path) -> Recipe:
        """Return the recipe of a project in `old` for one in `new`: relative names of files lead to the same files."""
        recipe = self
        for (stage, name), sheet in self.sheets.items():
            files = [n for n, declaration in sheet.declarations().items() if declaration.about.files]
            for parameter in files:
                value = getattr(sheet, parameter)
                if value and not Path(value).is_absolute():
                    there = relative_path(resolved(old, value), new)
                    sheet = sheet.replace(**{parameter: there})
            recipe = recipe.with_params(stage, name, sheet)
        return recipe

    def set(self, assignment: str) -> Recipe:
        """Return a recipe with one assignment applied, as typed on the command line.

        Parameters
        ----------
        assignment : str
            ``room.algorithm.parameter=value`` or ``room.role=algorithm[,algorithm…]``.

        Raises
        ------
        UserError
            When it is not such an assignment or names what does not exist.
        ParamError
            For an unknown parameter or a value out of its declaration.
        """
        path, equals, text = assignment.partition("=")
        parts = path.strip().split(".")
        if not equals or len(parts) not in (2, 3):
            raise UserError(
                Text("“{text}” is not an assignment.", text=assignment),
                todo="Write room.algorithm.parameter=value, such as features.sift.contrast=0.01.",
            )
        if len(parts) == 2:
            return self.choose(parts[0], parts[1], [n.strip() for n in text.split(",") if n.strip()])
        stage, name, parameter = parts
        declarations = registry.find(stage, name).params.declarations()
        if parameter not in declarations:
            raise ParamError(parameter, unknown_name(parameter, declarations, f"parameter of {stage}.{name}"))
        value = declarations[parameter].parse(text)
        return self.with_params(stage, name, self.params(stage, name).replace(**{parameter: value}))

    def to_toml(self, *, complete: bool = False) -> str:
        """Return the recipe as TOML: the choices and what differs, or with `complete` every parameter.

        TOML has no null: an optional parameter that is off is left out, which means its default.
        """
        document: dict[str, Any] = {"schema": SCHEMA, "seed": self.seed}
        for stage in STAGES:
            room: dict[str, Any] = {}
            for role in DEFAULTS[stage]:
                names = self.chosen(stage, role)
                room[role] = list(names) if role in CHAINS else names[0]
            for name in dict.fromkeys(n for role in DEFAULTS[stage] for n in self.chosen(stage, role)):
                room[name] = self._values(stage, name, complete)
            for other_stage, name in self.sheets:
                if other_stage == stage and name not in room:
                    room[name] = self._values(stage, name, complete)
            document[stage] = {k: v for k, v in room.items() if v != {}}
        return tomli_w.dumps(document)

    def _values(self, stage: str, name: str, complete: bool) -> dict[str, Any]:
        defaults = registry.find(stage, name).params().to_dict()
        values = self.params(stage, name).to_dict()
        kept = {k: v for k, v in values.items() if complete or v != defaults[k]}
        return {
            k: "none" if v is None else v for k, v in kept.items() if v is not None or defaults[k] is not None
        }

    def save(self, path: Path) -> None:
        """Write the recipe to a file, every parameter included."""
        write_text(path, self.to_toml(complete=True))

    @classmethod
    def load(cls, path: Path) -> Recipe:
        """Read a recipe file.

        Raises
        ------
        UserError
            When it cannot be read, is not TOML, or names what does not exist.
        ParamError
            For a value out of its declaration.
        """
        try:
            return cls.from_toml(path.read_text("utf-8"))
        except (OSError, UnicodeDecodeError) as problem:
            raise UserError(
                Text("The recipe {name} cannot be read.", name=path.name), str(problem), "Check the path."
            ) from problem

    @classmethod
    def from_toml(cls, text: str) -> Recipe:
        """Read a recipe from TOML text; see `load` for what is raised."""
        try:
            document = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as problem:
            raise UserError(
                "The recipe is not valid TOML.", Text("{why}.", why=problem), "Correct that line."
            ) from problem
        if document.pop("schema", SCHEMA) != SCHEMA:
            raise UserError(
                "The recipe was written by another version of the program.",
                Text("This version reads schema {schema}.", schema=SCHEMA),
            )
        recipe = cls().with_seed(document.pop("seed", 0))
        for stage, room in document.items():
            if stage not in STAGES:
                raise UserError(unknown_name(stage, list(STAGES), "stage"))
            if not isinstance(room, dict):
                raise UserError(Text("“{stage}” in the recipe must be a table [{stage}].", stage=stage))
            recipe = recipe._with_room(stage, room)
        return recipe

    def _with_room(self, stage: str, room: Mapping[str, Any]) -> Recipe:
        recipe = self
        for name, value in room.items():
            if not isinstance(value, dict):
                if not (
                    isinstance(value, str)
                    or (isinstance(value, list) and all(isinstance(v, str) for v in value))
                ):
                    raise UserError(
                        Text("{stage}.{name} must be a name or a list of names.", stage=stage, name=name)
                    )
                recipe = recipe.choose(stage, name, value)
                continue
            found = registry.find(stage, name)
            known = found.params.declarations()
            plain = {
                k: None if v == "none" and k in known and known[k].optional else v for k, v in value.items()
            }
            try:
                plain = _of_today(f"{stage}.{name}", plain)
                recipe = recipe.with_params(stage, name, found.params.from_dict(plain))
            except ParamError as problem:
                raise ParamError(problem.name, f"[{stage}.{name}] {problem.message}") from problem
        return recipe


def _check_role(stage: str, role: str) -> None:
    if stage not in DEFAULTS:
        raise UserError(unknown_name(stage, list(STAGES), "stage"))
    if role not in DEFAULTS[stage]:
        raise UserError(unknown_name(role, list(DEFAULTS[stage]), f"role in {stage}"))


def _of_today(algorithm: str, values: dict[str, Any]) -> dict[str, Any]:
    """Return parameters of a recipe of version 0.1.0 under the names they have now."""
    retired = {"free_k1": "k1", "free_k2": "k2"} if algorithm == "adjustment.schur" else {}
    if algorithm == "features.sift" and values.get("selection") == "even":
        return values | {"selection": "grid"}
    held = [new for old, new in retired.items() if values.get(old) is False]
    kept = {name: value for name, value in values.items() if name not in retired}
    if held:
        said = [kept.get("parameters", ""), *(f"{name}=fixed" for name in held)]
        kept["parameters"] = ", ".join(filter(None, said))
    return kept
