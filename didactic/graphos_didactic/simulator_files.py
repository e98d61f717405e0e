"""What can be taken home from a simulator: its state, which restores it exactly, and its data."""

from __future__ import annotations

import csv
import hashlib
import io
import tomllib
from dataclasses import dataclass
from typing import Any

import tomli_w

from graphos_core.data.record import Array
from graphos_core.errors import GraphosError, UserError
from graphos_core.params import Params
from graphos_didactic.scene import Scene, scene_table
from graphos_didactic.simulator import Simulator, find_simulator

SCHEMA = 1
LARGEST = 100_000
"""Characters; a longer text is not a state file."""


@dataclass(frozen=True)
class State:
    """Everything that makes a simulator look as it does.

    Attributes
    ----------
    simulator : Simulator
    params : Params
    step : int or None
    truth : bool
    seed : int or None
        Seed of the running challenge; None when there is none.
    photo, photo_sha256 : str
        Name and fingerprint of the project's photo it used; empty for the simulated one.
    """

    simulator: Simulator
    params: Params
    step: int | None = None
    truth: bool = True
    seed: int | None = None
    photo: str = ""
    photo_sha256: str = ""


def photo_fingerprint(photo: Array | None) -> str:
    """Return the SHA-256 of a photo's pixels, or an empty text for None."""
    return "" if photo is None else hashlib.sha256(photo.tobytes()).hexdigest()


def state_text(state: State) -> str:
    """Return the state as TOML that a class can be sent."""
    head: dict[str, Any] = {
        "format": "graphos simulator state",
        "schema": SCHEMA,
        "simulator": state.simulator.key,
        "version": state.simulator.version,
        "truth": state.truth,
        "photo": state.photo,
        "photo_sha256": state.photo_sha256,
    }
    if state.step is not None:
        head["step"] = state.step
    if state.seed is not None:
        head["seed"] = state.seed
    values = {name: value for name, value in state.params.to_dict().items() if value is not None}
    return tomli_w.dumps(head | {"params": values})


def read_state(text: str) -> State:
    """Read a state; it is data from a stranger and never a program.

    Raises
    ------
    UserError
        When the text is not a state, of a newer schema, or has values out of their range.
    """
    todo = "Ask the sender to save the state of the simulator again."
    if len(text) > LARGEST:
        raise UserError("This is not a simulator's state.", "The file is too long.", todo)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        raise UserError("This is not a simulator's state.", f"It is not TOML: {problem}.", todo) from None
    if data.get("format") != "graphos simulator state":
        raise UserError("This is not a simulator's state.", "The line “format” is missing.", todo)
    if (_whole(data.get("schema")) or SCHEMA + 1) > SCHEMA:
        raise UserError(
            "This state was written by a newer version of the program.",
            f"Its schema is {data.get('schema')}, this version reads up to {SCHEMA}.",
            "Update the program.",
        )
    found = find_simulator(str(data.get("simulator")))
    values = data.get("params", {})
    try:
        params = found.params.from_dict(values if isinstance(values, dict) else {})
    except GraphosError as problem:
        raise UserError("The state cannot be restored.", str(problem), todo) from None
    step, seed = _whole(data.get("step")), _whole(data.get("seed"))
    return State(
        found,
        params,
        min(max(step, 0), len(found.steps) - 1) if step is not None else None,
        data.get("truth") is not False,
        abs(seed) if seed is not None else None,
        str(data.get("photo", "")),
        str(data.get("photo_sha256", "")),
    )


def _whole(value: Any) -> int | None:
    return value if isinstance(value, int) and not isinstance(value, bool) else None


COLUMNS = ("panel", "thing", "label", "index", "x", "x_axis", "y", "y_axis", "value", "sigma", "unit")


def data_csv(state: State, scene: Scene) -> str:
    """Return the read-outs, points and curves of a scene as CSV: UTF-8, decimal point, units in the columns.

    Lines that begin with ``#`` say which simulator and which parameters made it.
    """
    text = io.StringIO()
    text.write(f"# {state.simulator.title} ({state.simulator.key}, version {state.simulator.version})\n")
    for name, declaration in type(state.params).declarations().items():
        unit = f" {declaration.about.unit}" if declaration.about.unit else ""
        text.write(f"# {name} = {getattr(state.params, name)}{unit}\n")
    writer = csv.DictWriter(text, COLUMNS, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(scene_table(scene))
    return text.getvalue()
