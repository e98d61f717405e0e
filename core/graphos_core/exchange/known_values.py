"""Values of ``known.toml``, each refused with its name and what is possible instead.

Everything raises `ValueError` with the end of a sentence that begins with "There"; `graphos_core.exchange.known` says
where.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from graphos_core.data import Array
from graphos_core.text import Text

KEYS: Mapping[str, tuple[str, ...]] = {
    "distance": ("a", "b", "metres", "sigma", "check"),
    "gnss": ("source", "sigma_m", "lever_arm_m", "lever_arm"),
    "attitudes": ("source", "sigma_deg", "boresight_deg", "boresight"),
    "shape": ("kind", "points", "sigma_m", "value", "name"),
    "rig": ("name", "photos", "centres", "rotations_deg", "sigma_deg", "sigma", "free"),
}
"""What each section may say."""


def section(content: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return a section ``[name]``."""
    found = content[name]
    if not isinstance(found, dict):
        raise ValueError(Text("“{name}” is no section, write [{name}] above its values", name=name))
    return _with_known_keys(found, name)


def sections(content: Mapping[str, Any], name: str) -> list[dict[str, Any]]:
    """Return the sections ``[[name]]``, none where the file has none."""
    found = content.get(name, [])
    if not isinstance(found, list) or not all(isinstance(item, dict) for item in found):
        raise ValueError(Text("“{name}” is no section, write [[{name}]] above the values of each", name=name))
    return [_with_known_keys(item, name) for item in found]


def _with_known_keys(values: dict[str, Any], name: str) -> dict[str, Any]:
    for key in values:
        if key not in KEYS[name]:
            raise ValueError(Text("“{key}” is nothing a section {name} can say; it can say {all}", key=key[:40],
                                  name=name, all=", ".join(KEYS[name])))  # fmt: skip
    return values


def number(value: Any, name: str) -> float:
    """Return a finite number."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not np.isfinite(value):
        raise ValueError(Text("{name} is {value}, needs a number", name=name, value=str(value)[:40]))
    return float(value)


def positive(value: Any, name: str) -> float:
    """Return a number above 0."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < np.inf:
        raise ValueError(Text("{name} is {value}, needs a number above 0", name=name, value=str(value)[:40]))
    return float(value)


def vector(value: Any, name: str) -> Array:
    """Return three finite numbers, float64 (3,)."""
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError(Text("{name} is {value}, needs three numbers", name=name, value=str(value)[:40]))
    return np.array([number(v, name) for v in value])


def positive_vector(value: Any, name: str) -> Array:
    """Return three numbers above 0, float64 (3,)."""
    return np.array([positive(v, name) for v in vector(value, name).tolist()])


def vectors(value: Any, name: str, count: int) -> Array:
    """Return `count` times three finite numbers, float64 (count, 3)."""
    if not isinstance(value, list) or len(value) != count:
        raise ValueError(Text("a rig of {count} cameras needs {count} {name} of three numbers each", name=name,
                              count=count))  # fmt: skip
    return np.array([vector(v, name) for v in value])


def word(value: Any, name: str, words: Collection[str]) -> str:
    """Return one of some words."""
    if value not in words:
        raise ValueError(Text("{name} is {value}, needs one of: {words}", name=name, value=str(value)[:40],
                              words=", ".join(words)))  # fmt: skip
    return str(value)


def yes(value: Any, name: str) -> bool:
    """Return true or false."""
    if not isinstance(value, bool):
        raise ValueError(Text("{name} is {value}, needs true or false", name=name, value=str(value)[:40]))
    return value


def names(value: Any, name: str, *, empty: bool = False) -> tuple[str, ...]:
    """Return different names; with `empty` some may be "", for a photo that is missing."""
    if (
        not isinstance(value, list)
        or not value
        or not all(isinstance(v, str) and (v or empty) for v in value)
    ):
        raise ValueError(Text("{name} is {value}, needs a list of names", name=name, value=str(value)[:40]))
    twice = next((v for i, v in enumerate(value) if v and v in value[:i]), None)
    if twice is not None:
        raise ValueError(Text("{name} has {twice} twice", name=name, twice=twice[:40]))
    return tuple(value)
