"""What a record is: a frozen dataclass whose arrays cannot be written to and that the store can keep."""

from __future__ import annotations

import dataclasses
from typing import Any, TypeAlias, TypeVar, cast, dataclass_transform

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[Any]
Cls = TypeVar("Cls", bound=type)

RECORDS: dict[str, type[Any]] = {}
"""Every record class by name; the store writes the name and finds the class here."""


@dataclass_transform(frozen_default=True, kw_only_default=True)
def record(cls: Cls) -> Cls:
    """Make `cls` a frozen keyword-only dataclass that is known to the store.

    Arrays given to the constructor are made read-only (as views: the caller's own array stays writable).
    """
    inner = getattr(cls, "__post_init__", None)

    def __post_init__(self: Any) -> None:
        if inner is not None:
            inner(self)
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                view = value.view()
                view.flags.writeable = False
                object.__setattr__(self, field.name, view)

    cls.__post_init__ = __post_init__  # type: ignore[attr-defined]
    frozen = cast(Cls, dataclasses.dataclass(frozen=True, kw_only=True, eq=False)(cls))
    RECORDS[cls.__name__] = frozen
    return frozen


def check_indices(what: str, indices: Array, count: int) -> None:
    """Raise `ValueError` when an index into something that occurs `count` times does not exist.

    Stored results may come from a stranger, and compiled loops do not look whether an index exists.
    """
    if indices.dtype.kind not in "iu" or (indices.size and not 0 <= indices.min() <= indices.max() < count):
        raise ValueError(f"{what} that do not exist")


def check_shape(what: str, array: Array, *shape: int | None) -> None:
    """Raise `ValueError` when an array has another shape; None stands for any length."""
    if array.ndim != len(shape) or any(b not in (None, a) for a, b in zip(array.shape, shape, strict=True)):
        raise ValueError(f"{what} of shape {array.shape}")
