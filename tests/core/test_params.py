"""A parameter is declared once: what is refused, with which sentence, and what comes back unchanged."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import pytest

from graphos_core.errors import ParamError
from graphos_core.params import About, Params


class Sheet(Params):
    """Every kind of parameter."""

    mean: Annotated[float, About(label="Target mean", unit="grey level", low=0, high=255, help="h")] = 127.0
    count: Annotated[int, About(label="Count", low=1, help="h")] = 3
    sharp: Annotated[bool, About(label="Sharp", help="h")] = False
    kind: Annotated[Literal["a", "b"], About(label="Kind", help="h")] = "a"
    name: Annotated[str | None, About(label="Name", help="h")] = None
    point: Annotated[tuple[float, float] | None, About(label="Point", unit="px", help="h")] = None
    ratio: Annotated[float, About(label="Ratio", low=0, high=1, low_open=True, help="h")] = 0.8


def test_a_value_out_of_range_is_refused_with_label_value_and_range() -> None:
    with pytest.raises(ParamError) as caught:
        Sheet(mean=300)
    assert caught.value.name == "mean"
    assert str(caught.value) == "Target mean: 300 grey level, needs 0 to 255"


@pytest.mark.parametrize(
    ("name", "value"),
    [("mean", math.nan), ("mean", math.inf), ("mean", "5"), ("mean", True), ("count", 2.5), ("count", True),
     ("count", 0), ("sharp", 1), ("sharp", "yes"), ("kind", "c"), ("name", 3), ("point", (1.0,)),
     ("point", (1.0, math.nan)), ("ratio", 0.0), ("mean", None)],
)  # fmt: skip
def test_a_value_of_the_wrong_kind_is_refused(name: str, value: object) -> None:
    with pytest.raises(ParamError):
        Sheet(**{name: value})


def test_ends_of_the_interval_are_allowed_unless_open() -> None:
    assert Sheet(mean=0).mean == 0.0
    assert Sheet(mean=255).mean == 255.0
    assert Sheet(ratio=1).ratio == 1.0


def test_plain_values_make_the_same_sheet_again() -> None:
    sheet = Sheet(mean=10, count=7, sharp=True, kind="b", name="x y", point=(1, 2.5))
    assert Sheet.from_dict(sheet.to_dict()) == sheet


def test_text_is_read_as_its_kind() -> None:
    declarations = Sheet.declarations()
    read = {name: declarations[name].parse(text) for name, text in
            {"mean": "12.5", "count": "4", "sharp": "yes", "kind": "b", "name": "none", "point": "1, 2"}.items()}  # fmt: skip
    assert read == {"mean": 12.5, "count": 4, "sharp": True, "kind": "b", "name": None, "point": (1.0, 2.0)}
    with pytest.raises(ParamError):
        declarations["count"].parse("4.5")
    with pytest.raises(ParamError):
        declarations["mean"].parse("nan")


def test_an_unknown_name_is_refused_with_the_valid_ones_and_the_nearest() -> None:
    with pytest.raises(ParamError, match=r"Did you mean “mean”.*Valid: mean, count"):
        Sheet.from_dict({"maen": 3})


def test_a_sheet_cannot_be_changed() -> None:
    with pytest.raises(AttributeError):
        Sheet().mean = 3  # type: ignore[misc]
    assert Sheet().replace(mean=3).mean == 3.0
