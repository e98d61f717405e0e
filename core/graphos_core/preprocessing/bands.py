r"""Band choice: one grey photo of the bands of a multi-band one."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.params import About, Params
from graphos_core.preprocessing.grey import eight_bit, luma
from graphos_core.preprocessing.luminance import levels_of
from graphos_core.preprocessing.parts import Place, partwise
from graphos_core.preprocessing.principal_component import mixture_grey, principal_mixture
from graphos_core.registry import algorithm
from graphos_core.run import Run
from graphos_core.text import Text

LESSON = "preprocessing/bands"


class BandsParams(Params):
    """Parameters of the band choice."""

    choice: Annotated[
        Literal["first", "mean", "principal", "number", "index"],
        About(
            label="Bands",
            help="What becomes the grey value.",
            effect="Mean: least noise. Principal component: most contrast. Index: what differs between two bands only.",
            choices={
                "first": "the first band",
                "mean": "mean of all bands",
                "principal": "principal component",
                "number": "one band, by number",
                "index": "normalised difference of two bands",
            },
            learn=LESSON,
            level="novice",
        ),
    ] = "principal"
    number: Annotated[
        int,
        About(
            label="Band",
            low=1,
            high=64,
            step=1,
            help="Which band, counted from 1, when one is chosen by its number.",
            effect="The order is that of the file; in a colour photo 1 is red, 2 green, 3 blue.",
            learn=LESSON,
            level="student",
        ),
    ] = 1
    infrared: Annotated[
        int,
        About(
            label="Band A of the index",
            low=1,
            high=64,
            step=1,
            help="The band that counts positive, for vegetation the near infrared.",
            effect="The index is (A − B) / (A + B): bright where A is stronger.",
            learn=LESSON,
            level="student",
        ),
    ] = 1
    red: Annotated[
        int,
        About(
            label="Band B of the index",
            low=1,
            high=64,
            step=1,
            help="The band that counts negative, for vegetation the red.",
            effect="The index is (A − B) / (A + B): dark where B is stronger.",
            learn=LESSON,
            level="student",
        ),
    ] = 2


def one_band(image: Array) -> Array:
    """Return one band of a photo in its own bit depth: grey as it is, luma of colour, else the mean of all bands."""
    if image.ndim == 2:
        return np.ascontiguousarray(image)
    if image.shape[2] == 3:
        return luma(np.ascontiguousarray(image))
    return np.rint(image.mean(axis=2)).astype(image.dtype)


def _band(image: Array, number: int) -> Array:
    count = 1 if image.ndim == 2 else image.shape[2]
    if number > count:
        raise UserError(
            Text("Band {number} was asked for, but the photo has {count}.", number=number, count=count),
            todo=Text("Choose a band from 1 to {count}.", count=count),
            learn=LESSON,
        )
    return np.ascontiguousarray(image if image.ndim == 2 else image[:, :, number - 1])


def index_of(a: Array, b: Array) -> Array:
    """Return ``(a − b) / (a + b)``, −1 … 1 as 0 … 255; middle grey where both are 0."""
    first, second = a.astype(np.float32), b.astype(np.float32)
    total = first + second
    ratio = np.divide(first - second, total, out=np.zeros_like(total), where=total > 0)
    return np.rint((ratio + 1.0) * np.float32(127.5)).astype(np.uint8)


def _chosen(image: Array, params: BandsParams) -> Array:
    if params.choice == "mean":
        return image if image.ndim == 2 else np.rint(image.mean(axis=2)).astype(image.dtype)
    return _band(image, params.number if params.choice == "number" else 1)


def _learn(image: Array, params: BandsParams, run: Run) -> Any:
    if params.choice == "index":
        return None
    if params.choice == "principal":
        return principal_mixture(image, 0.1) if image.ndim == 3 else levels_of(image)
    return levels_of(_chosen(image, params))


def _apply(image: Array, params: BandsParams, known: Any, place: Place) -> Array:
    if params.choice == "index":
        return index_of(_band(image, params.infrared), _band(image, params.red))
    if params.choice == "principal":
        return mixture_grey(image, known) if image.ndim == 3 else eight_bit(image, known)
    return eight_bit(_chosen(image, params), known)


@algorithm(
    stage="preprocessing",
    role="filter",
    name="bands",
    label="Band choice",
    source="Index: Rouse et al. 1974, Monitoring vegetation systems in the Great Plains with ERTS (NDVI); "
    "principal component: Jolliffe 2002, section 1.1",
    learn=LESSON,
)
@partwise(learn=_learn, apply=_apply)
def bands(image: Array, params: BandsParams, *, run: Run) -> Array:
    r"""Make one grey value of the bands of a pixel.

    One band, the mean of all, their first principal component, or the normalised difference of two,

    .. math::
        \frac{A - B}{A + B} \in [-1, 1] \;\rightarrow\; 0 \ldots 255

    With near infrared for A and red for B this is the vegetation index NDVI. 16 bit is stretched between the 0.1 %
    and 99.9 % quantiles, the index never.

    Parameters
    ----------
    image : uint8 or uint16 (h, w) or (h, w, n)
    params : BandsParams
    run : Run

    Returns
    -------
    uint8 (h, w)

    Raises
    ------
    UserError
        When the photo has no band of that number.
    """
    return _apply(image, params, _learn(image, params, run), Place.whole(image))
