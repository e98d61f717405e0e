import numpy as np

from graphos_core.preprocessing.chain import apply_filters
from graphos_core.preprocessing.grey import GreyParams, eight_bit, grey
from graphos_core.registry import find
from graphos_core.run import Run

RUN = Run()
COLOUR = np.random.default_rng(0).integers(0, 256, (20, 30, 3), dtype=np.uint8)


def test_each_choice_weighs_the_channels_as_it_says() -> None:
    weights = {
        "luma": [0.299, 0.587, 0.114],
        "mean": [1 / 3] * 3,
        "red": [1, 0, 0],
        "green": [0, 1, 0],
        "blue": [0, 0, 1],
    }
    for name, weight in weights.items():
        made = grey(COLOUR, GreyParams(weights=name), run=RUN)
        assert np.abs(made - COLOUR @ np.array(weight)).max() <= 0.51


def test_sixteen_bit_is_stretched_between_its_quantiles_and_keeps_hue() -> None:
    ramp = np.tile(np.linspace(2000, 6000, 100).astype(np.uint16), (100, 1))
    ramp[0, 0], ramp[0, 1] = 0, 65535  # dead and hot pixel
    levels = eight_bit(ramp)
    assert levels[5, 0] == 0 and levels[5, -1] == 255
    assert np.abs(levels[5].astype(float) - np.linspace(0, 255, 100)).max() <= 1.0
    colour = np.stack([ramp, ramp // 2 + 1000, ramp], axis=2)
    assert eight_bit(colour)[5, 50, 0] == eight_bit(colour)[5, 50, 2]
    assert eight_bit(np.full((4, 4), 7, np.uint16)).dtype == np.uint8


def test_filters_are_applied_in_order() -> None:
    chain = [(a := find("preprocessing", name), a.params()) for name in ("decolor", "wallis")]
    by_hand = chain[1][0].function(chain[0][0].function(COLOUR, chain[0][1], run=RUN), chain[1][1], run=RUN)
    assert np.array_equal(apply_filters(COLOUR, chain, RUN), by_hand)
    assert apply_filters(COLOUR, [], RUN) is COLOUR
