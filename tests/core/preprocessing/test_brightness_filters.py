"""Filters of brightness against their formulas and against other implementations."""

import colorsys
from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.preprocessing.bilateral import BilateralParams, bilateral
from graphos_core.preprocessing.clahe import ClaheParams, clahe
from graphos_core.preprocessing.equalization import EqualizationParams, equalize
from graphos_core.preprocessing.gamma import GammaParams, gamma
from graphos_core.preprocessing.lightness import LightnessParams, lightness
from graphos_core.preprocessing.luminance_kernels import with_luminance
from graphos_core.preprocessing.noise import noise_level
from graphos_core.preprocessing.nonlocal_means import NonlocalMeansParams, nlm
from graphos_core.preprocessing.principal_component import PrincipalComponentParams, principal
from graphos_core.preprocessing.sharpening import SharpeningParams, sharpen
from graphos_core.registry import algorithms
from graphos_core.run import Run

RUN = Run()


def textured(height: int = 120, width: int = 170, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    rough = cv2.resize(
        rng.normal(110, 45, (height // 8, width // 8)), (width, height), interpolation=cv2.INTER_CUBIC
    )
    return np.clip(rough + rng.normal(0, 6, (height, width)), 0, 255).astype(np.uint8)


def coloured(seed: int = 0) -> np.ndarray:
    return np.stack([textured(seed=seed + c) for c in range(3)], axis=2)


@pytest.mark.parametrize("name", [a.name for a in algorithms("preprocessing", "filter")])
@pytest.mark.parametrize("kind", ["grey8", "grey16", "colour8", "colour16", "one colour", "one px"])
def test_every_filter_takes_every_kind_of_image(name: str, kind: str) -> None:
    from graphos_core.registry import find

    image = {
        "grey8": textured(),
        "grey16": textured().astype(np.uint16) * 40 + 7000,
        "colour8": coloured(),
        "colour16": coloured().astype(np.uint16) * 40 + 7000,
        "one colour": np.full((40, 50, 3), 77, np.uint8),
        "one px": np.full((1, 1), 5, np.uint8),
    }[kind]
    algorithm = find("preprocessing", name)
    made = algorithm.function(image, algorithm.params(), run=RUN)
    assert made.dtype == np.uint8 and made.shape[:2] == image.shape[:2]


@pytest.mark.parametrize("shape", [(121, 170), (64, 64), (97, 203)])
@pytest.mark.parametrize(("clip", "tiles"), [(2.0, 8), (10.0, 4), (1.0, 3)])
def test_clahe_equals_the_other_implementation(shape: tuple[int, int], clip: float, tiles: int) -> None:
    image = textured(*shape)
    theirs = cv2.createCLAHE(clip, (tiles, tiles)).apply(image).astype(int)
    ours = clahe(image, ClaheParams(clip=clip, tiles=tiles), run=RUN).astype(int)
    assert np.abs(ours - theirs).max() <= 1


def test_equalisation_equals_the_other_implementation_and_flattens_the_histogram() -> None:
    image = textured()
    ours = equalize(image, EqualizationParams(), run=RUN)
    assert np.abs(ours.astype(int) - cv2.equalizeHist(image)).max() <= 1
    shares = np.histogram(ours, 8, (0, 256))[0] / ours.size
    assert (
        np.abs(shares - 1 / 8).max()
        < 0.03
        < np.abs(np.histogram(image, 8, (0, 256))[0] / image.size - 1 / 8).max()
    )
    assert np.array_equal(equalize(image, EqualizationParams(strength=0.0), run=RUN), image)


def test_gamma_and_lightness_follow_their_formulas() -> None:
    ramp = np.arange(256, dtype=np.uint8)[None]
    expected = 255 * (np.arange(256) / 255) ** (1 / 2.2)
    assert np.abs(gamma(ramp, GammaParams(gamma=2.2), run=RUN) - expected).max() <= 0.5
    rgb = coloured()[::7, ::7]
    linear = np.where(rgb / 255 <= 0.04045, rgb / 255 / 12.92, ((rgb / 255 + 0.055) / 1.055) ** 2.4)
    y = linear @ [0.212671, 0.715160, 0.072169]
    star = np.where(y > 0.008856, 116 * np.cbrt(y) - 16, 903.3 * y)
    assert np.abs(lightness(rgb, LightnessParams(), run=RUN) - star * 2.55).max() <= 1.5


def test_the_principal_component_has_the_largest_variance_of_all_mixtures() -> None:
    image = coloured()
    image[:, :, 2] = 255 - image[:, :, 0] // 2
    pixels = image.reshape(-1, 3) - image.reshape(-1, 3).mean(axis=0)
    _, _, axes = np.linalg.svd(pixels, full_matrices=False)
    made = principal(image, PrincipalComponentParams(clip=0.0), run=RUN).ravel().astype(float)
    assert abs(np.corrcoef(made, pixels @ axes[0])[0, 1]) > 0.9999
    assert made.min() == 0 and made.max() == 255


def test_a_new_luminance_keeps_the_hue() -> None:
    image = coloured(3)
    old = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    made = with_luminance(image, old, equalize(old, EqualizationParams(), run=RUN))
    strong = 0
    for before, after in zip(image.reshape(-1, 3)[::37], made.reshape(-1, 3)[::37]):
        if np.ptp(before.astype(int)) > 60 and np.ptp(after.astype(int)) > 40:
            a, b = (colorsys.rgb_to_hsv(*(v / 255.0))[0] for v in (before, after))
            assert abs((a - b + 0.5) % 1 - 0.5) < 0.012  # one grey level of rounding in 40
            strong += 1
    assert strong > 50
    wanted = equalize(old, EqualizationParams(), run=RUN).astype(int)
    assert np.abs(cv2.cvtColor(made, cv2.COLOR_RGB2GRAY).astype(int) - wanted).max() <= 1


@pytest.mark.parametrize("sigma", [2.0, 5.0, 10.0])
def test_the_noise_that_was_added_is_measured(sigma: float) -> None:
    rng = np.random.default_rng(1)
    scene = np.full((256, 320), 120.0)
    scene[:, 100:200] = 60.0
    scene += np.linspace(0, 50, 320)
    noisy = np.clip(np.rint(scene + rng.normal(0, sigma, scene.shape)), 0, 255).astype(np.uint8)
    assert noise_level(noisy) == pytest.approx(sigma, rel=0.15)
    assert noise_level(np.clip(np.rint(scene), 0, 255).astype(np.uint8)) < 0.8


@pytest.mark.parametrize("name", ["nlm", "bilateral"])
def test_denoising_takes_noise_and_leaves_edges(name: str) -> None:
    rng = np.random.default_rng(2)
    scene = np.full((120, 160), 70.0)
    scene[:, 80:] = 170.0
    noisy = np.clip(scene + rng.normal(0, 8.0, scene.shape), 0, 255).astype(np.uint8)
    made = (
        nlm(noisy, NonlocalMeansParams(), run=RUN)
        if name == "nlm"
        else bilateral(noisy, BilateralParams(sigma_range=24.0), run=RUN)
    ).astype(float)
    assert (made - scene)[:, :70].std() < 0.5 * 8.0
    assert abs((made[:, 82] - made[:, 77]).mean() - 100.0) < 8.0


def test_sharpening_gives_back_what_a_blur_took() -> None:
    scene = cv2.GaussianBlur(textured(seed=5), (0, 0), 1.0)
    blurred = cv2.GaussianBlur(scene.astype(np.float32), (0, 0), 1.5)
    made = sharpen(np.rint(blurred).astype(np.uint8), SharpeningParams(sigma=1.5, amount=1.0), run=RUN)
    assert np.abs(made - scene.astype(float)).mean() < 0.75 * np.abs(blurred - scene).mean()
    quiet = np.clip(np.random.default_rng(0).normal(100, 1, (60, 60)), 0, 255).astype(np.uint8)
    assert np.array_equal(sharpen(quiet, SharpeningParams(threshold=8.0), run=RUN), quiet)


@pytest.mark.data
def test_hue_stays_on_a_real_photo(data_dir: Path) -> None:
    image = np.ascontiguousarray(cv2.imread(str(data_dir / "colour" / "fruits.jpg"))[:, :, ::-1])
    made = clahe(image, ClaheParams(), run=RUN)
    before, after = (cv2.cvtColor(v.astype(np.float32) / 255, cv2.COLOR_RGB2HSV) for v in (image, made))
    clear = (np.ptp(image, axis=2) > 60) & (np.ptp(made, axis=2) > 60)
    turned = np.abs((before[clear][:, 0] - after[clear][:, 0] + 180) % 360 - 180)
    assert clear.mean() > 0.2 and np.percentile(turned, 99) < 2.0
