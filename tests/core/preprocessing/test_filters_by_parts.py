"""What a filter makes of a piece of a photo is a piece of what it makes of the photo."""

import numpy as np
import pytest

from graphos_core.preprocessing.parts import Place, parts_of
from graphos_core.registry import algorithms, find
from graphos_core.run import Run

RUN = Run()
FILTERS = [a.name for a in algorithms("preprocessing", "filter")]
OTHER = {
    "wallis": [{"spacing": 16}, {"window": 8, "maximum_gain": 2.0}],
    "bands": [{"choice": "mean"}, {"choice": "index"}, {"choice": "number", "number": 3}],
    "grey": [{"weights": "mean"}, {"weights": "blue"}],
    "stretch": [{"local": "no"}, {"window": 31, "smooth": "yes"}],
    "sharpen": [{"threshold": 4.0, "sigma": 3.0}],
    "nlm": [{"strength": 12.0, "patch": 7}],
    "clahe": [{"tiles": 5, "clip": 8.0}],
}


def photo(bits: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    y, x = np.indices((210, 330))
    light = 90 + 60 * np.sin(x / 40.0) + 40 * np.cos(y / 25.0)
    values = light[:, :, None] + rng.normal(0, 10, (210, 330, 3)) + [0, 12, -20]
    if bits == 8:
        return np.clip(values, 0, 255).astype(np.uint8)
    return np.clip(9000 + 30 * values, 0, 65535).astype(np.uint16)


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("name", FILTERS)
def test_a_piece_equals_the_same_piece_of_the_whole_result(name: str, bits: int) -> None:
    algorithm = find("preprocessing", name)
    parts = parts_of(algorithm.function)
    assert parts is not None
    image = photo(bits)
    for values in ({}, *OTHER.get(name, [])):
        params = algorithm.params.from_dict(values)
        whole = algorithm.function(image, params, run=RUN)
        known = parts.learn(image, params, RUN)
        margin = parts.margin(params)
        top, bottom, left, right = 70, 150, 110, 230
        t, b = max(0, top - margin), min(210, bottom + margin)
        l, r = max(0, left - margin), min(330, right + margin)
        piece = np.ascontiguousarray(image[t:b, l:r])
        made = parts.apply(piece, params, known, Place(l, t, 330, 210))
        cut = made[top - t : top - t + bottom - top, left - l : left - l + right - left]
        assert np.array_equal(cut, whole[top:bottom, left:right]), values


@pytest.mark.parametrize("name", FILTERS)
def test_local_filters_need_nothing_of_the_whole_photo(name: str) -> None:
    algorithm = find("preprocessing", name)
    parts = parts_of(algorithm.function)
    assert parts is not None
    params = algorithm.params()
    same = (
        parts.learn(photo(8), params, RUN) == parts.learn(photo(8, 1), params, RUN) if parts.local else True
    )
    assert same is True


def test_parameters_in_pixels_shrink_with_the_photo() -> None:
    wallis = find("preprocessing", "wallis")
    parts = parts_of(wallis.function)
    assert parts is not None
    assert parts.reduced(wallis.params(window=41), 4.0).window == 11
    assert parts.reduced(wallis.params(window=3), 8.0).window == 3
