import numpy as np
import pytest

from graphos_core.preprocessing.grey import luma
from graphos_core.preprocessing.wallis import WallisParams, local_statistics, wallis
from graphos_core.registry import find
from graphos_core.run import Run

RUN = Run()


def scene(height: int = 61, width: int = 83, seed: int = 0) -> np.ndarray:
    """Texture under light that falls off from left to right."""
    rng = np.random.default_rng(seed)
    light = np.linspace(220.0, 40.0, width)
    texture = rng.normal(0.0, 1.0, (height, width)) * light * 0.12
    return np.clip(light + texture, 0, 255).astype(np.uint8)


def plain_twin(image: np.ndarray, params: WallisParams) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The filter of the docstring, window by window: filtered, mean, standard deviation."""
    half = params.window // 2
    padded = np.pad(image.astype(np.float64), half, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, (2 * half + 1, 2 * half + 1))
    mean, std = windows.mean(axis=(2, 3)), windows.std(axis=(2, 3))
    c, b = params.contrast, params.brightness
    gain = c * params.target_std / (c * np.maximum(std, 1.0) + (1 - c) * params.target_std)
    value = gain * (image - mean) + b * params.target_mean + (1 - b) * mean
    return np.clip(value, 0, 255), mean, std


@pytest.mark.parametrize(
    "params",
    [
        WallisParams(window=9),
        WallisParams(window=8, contrast=1.0, brightness=1.0, target_mean=100.0, target_std=30.0),
        WallisParams(window=21, contrast=0.0, brightness=0.0),
        WallisParams(window=33, contrast=0.3, brightness=0.5, target_std=5.0),
    ],
)
def test_the_fast_filter_equals_the_formula_window_by_window(params: WallisParams) -> None:
    image = scene()
    expected, mean, std = plain_twin(image, params)
    assert np.abs(wallis(image, params, run=RUN) - expected).max() <= 0.501
    fast_mean, fast_std = local_statistics(image, params.window)
    assert np.abs(fast_mean - mean).max() < 1e-4
    assert np.abs(fast_std - std).max() < 1e-4


def test_full_weights_give_every_neighbourhood_the_target_mean_and_deviation() -> None:
    params = WallisParams(window=25, contrast=1.0, brightness=1.0, target_mean=120.0, target_std=25.0)
    mean, std = local_statistics(wallis(scene(200, 300), params, run=RUN), 25)
    assert np.abs(mean - 120.0).mean() < 3.0
    assert np.abs(std - 25.0).mean() < 2.5
    before = local_statistics(scene(200, 300), 25)
    assert np.ptp(before[0]) > 10 * np.ptp(mean[30:-30, 30:-30])


def test_a_photo_without_contrast_stays_without_contrast() -> None:
    for level in (0, 90, 255):
        filtered = wallis(np.full((40, 50), level, np.uint8), WallisParams(), run=RUN)
        assert np.ptp(filtered) == 0


def test_sixteen_bit_keeps_steps_that_eight_bit_would_lose() -> None:
    rng = np.random.default_rng(1)
    dark = (1000 + 60 * rng.standard_normal((80, 90))).astype(np.uint16)  # a quarter of one 8-bit level
    dark[0, :2] = 0, 65535
    filtered = wallis(dark, WallisParams(window=15), run=RUN)
    assert np.corrcoef(filtered[20:, 20:].ravel(), dark[20:, 20:].ravel())[0, 1] > 0.9


def test_colour_is_made_grey_first_and_a_window_larger_than_the_photo_is_no_harm() -> None:
    rng = np.random.default_rng(2)
    colour = rng.integers(0, 256, (30, 20, 3), dtype=np.uint8)
    params = WallisParams(window=101)
    assert np.array_equal(wallis(colour, params, run=RUN), wallis(luma(colour), params, run=RUN))


def test_every_parameter_says_what_both_directions_do() -> None:
    for stage, name in (("preprocessing", "wallis"), ("preprocessing", "decolor"), ("preprocessing", "grey"),
                        ("features", "sift"), ("features", "mutual"), ("features", "usac"), ("features", "tracks")):  # fmt: skip
        algorithm = find(stage, name)
        assert algorithm.source and algorithm.learn
        for declaration in algorithm.params.declarations().values():
            about = declaration.about
            assert about.help.endswith(".") and about.effect.endswith(".") and about.learn, declaration.name


def test_the_gain_stays_between_its_limits() -> None:
    image = scene()
    _, mean, std = plain_twin(image, WallisParams(window=15))
    params = WallisParams(window=15, minimum_gain=1.8, maximum_gain=2.4)
    c, b = params.contrast, params.brightness
    free = c * params.target_std / (c * np.maximum(std, 1.0) + (1 - c) * params.target_std)
    assert free.min() < 1.8 and free.max() > 2.4
    value = np.clip(free, 1.8, 2.4) * (image - mean) + b * params.target_mean + (1 - b) * mean
    assert np.abs(wallis(image, params, run=RUN) - np.clip(value, 0, 255)).max() <= 0.501


def test_between_the_nodes_of_a_grid_gain_and_shift_are_interpolated() -> None:
    image = scene(60, 80)
    params = WallisParams(window=15, spacing=10)
    _, mean, std = plain_twin(image, WallisParams(window=15))
    c, b = params.contrast, params.brightness
    gain = c * params.target_std / (c * np.maximum(std, 1.0) + (1 - c) * params.target_std)
    shift = b * params.target_mean + (1 - b - gain) * mean
    made = wallis(image, params, run=RUN).astype(float)
    for y, x in ((20, 33), (27, 41), (30, 50), (5, 5)):
        r, s, v = y // 10 * 10, min(y // 10 * 10 + 10, 59), y % 10 / 10
        p, q, u = x // 10 * 10, min(x // 10 * 10 + 10, 79), x % 10 / 10
        both = [
            (f[r, p] * (1 - u) + f[r, q] * u) * (1 - v) + (f[s, p] * (1 - u) + f[s, q] * u) * v
            for f in (gain, shift)
        ]
        assert abs(made[y, x] - np.clip(both[0] * image[y, x] + both[1], 0, 255)) <= 0.51
    near = np.abs(made - wallis(image, WallisParams(window=15), run=RUN)).mean()
    assert 0 < near < 12
