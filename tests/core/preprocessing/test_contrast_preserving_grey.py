from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.preprocessing.decolorization import DecolorParams, decolor, fit_weights
from graphos_core.preprocessing.grey import luma
from graphos_core.preprocessing.kernels import polynomial_grey
from graphos_core.run import Run

RUN = Run()


def two_colours(first: tuple[int, int, int], second: tuple[int, int, int]) -> np.ndarray:
    rng = np.random.default_rng(0)
    image = np.empty((120, 160, 3), np.uint8)
    image[:] = first
    image[(np.indices((120, 160)) // 20).sum(axis=0) % 2 == 1] = second
    return np.clip(image + rng.normal(0, 2, image.shape), 0, 255).astype(np.uint8)


def kept_contrast(colour: np.ndarray, grey: np.ndarray) -> float:
    """Colour contrast preserving ratio (Lu et al. 2012, section 4), mean over thresholds 1 to 15."""
    factor = max(1.0, np.sqrt(grey.size / 40000))
    size = (round(grey.shape[1] / factor), round(grey.shape[0] / factor))
    lab = cv2.cvtColor(
        cv2.resize(colour, size, interpolation=cv2.INTER_AREA).astype(np.float32) / 255, cv2.COLOR_RGB2LAB
    )
    level = cv2.resize(grey, size, interpolation=cv2.INTER_AREA).astype(float) * 100 / 255
    a, b = np.random.default_rng(0).integers(0, lab.shape[0] * lab.shape[1], (2, 50_000))
    flat = lab.reshape(-1, 3)
    in_colour = np.linalg.norm(flat[a] - flat[b], axis=1)
    in_grey = np.abs(level.ravel()[a] - level.ravel()[b])
    return float(np.mean([(in_grey[in_colour >= t] >= t).mean() for t in range(1, 16)]))


def test_two_colours_of_equal_luma_become_two_grey_values() -> None:
    image = two_colours((180, 80, 60), (40, 135, 140))
    assert np.ptp(luma(image)) < 30
    grey = decolor(image, DecolorParams(), run=RUN).astype(int)
    fields = (np.indices((120, 160)) // 20).sum(axis=0) % 2 == 1
    assert abs(grey[fields].mean() - grey[~fields].mean()) > 150


def test_what_is_brighter_in_every_channel_stays_brighter() -> None:
    image = two_colours((60, 40, 90), (120, 90, 140))
    grey = decolor(image, DecolorParams(), run=RUN).astype(int)
    fields = (np.indices((120, 160)) // 20).sum(axis=0) % 2 == 1
    assert grey[fields].mean() > grey[~fields].mean() + 100


def test_grey_photos_and_photos_of_one_colour_come_through() -> None:
    grey = np.random.default_rng(1).integers(0, 256, (40, 50), dtype=np.uint8)
    assert decolor(grey, DecolorParams(), run=RUN) is grey
    as_colour = np.repeat(grey[:, :, None], 3, axis=2)
    made = decolor(as_colour, DecolorParams(clip=0.0), run=RUN)
    assert np.corrcoef(made.ravel(), grey.ravel())[0, 1] > 0.99
    flat = decolor(np.full((40, 50, 3), 77, np.uint8), DecolorParams(), run=RUN)
    assert flat.shape == (40, 50) and np.ptp(flat) == 0


def test_the_compiled_polynomial_equals_the_plain_one() -> None:
    image = np.random.default_rng(2).integers(0, 256, (13, 17, 3), dtype=np.uint8)
    weights = np.random.default_rng(3).normal(size=9).astype(np.float32)
    r, g, b = (image[:, :, channel] / 255.0 for channel in range(3))
    plain = np.stack([r, g, b, r * g, r * b, g * b, r * r, g * g, b * b], axis=2) @ weights
    assert np.abs(polynomial_grey(image, weights) - plain).max() < 1e-5


def test_sixteen_bit_and_eight_bit_agree() -> None:
    image = two_colours((180, 80, 60), (40, 135, 140))
    deep = decolor(image.astype(np.uint16) * 257, DecolorParams(), run=RUN)
    assert np.corrcoef(deep.ravel(), decolor(image, DecolorParams(), run=RUN).ravel())[0, 1] > 0.98


@pytest.mark.data
@pytest.mark.parametrize("name", ["baboon.jpg", "fruits.jpg", "butterfly.jpg"])
def test_it_keeps_at_least_as_much_contrast_as_the_other_implementation(data_dir: Path, name: str) -> None:
    image = np.ascontiguousarray(cv2.imread(str(data_dir / "colour" / name))[:, :, ::-1])
    ours = decolor(image, DecolorParams(), run=RUN)
    theirs, _ = cv2.decolor(np.ascontiguousarray(image[:, :, ::-1]))
    assert np.corrcoef(ours.ravel(), theirs.ravel())[0, 1] > 0.98
    assert kept_contrast(image, ours) >= kept_contrast(image, theirs) - 0.005
    assert kept_contrast(image, ours) >= kept_contrast(image, luma(image))


@pytest.mark.data
def test_weights_fitted_small_serve_the_full_size(data_dir: Path) -> None:
    image = np.ascontiguousarray(cv2.imread(str(data_dir / "colour" / "fruits.jpg"))[:, :, ::-1])
    small, full = (
        polynomial_grey(image, fit_weights(image, DecolorParams(fit_pixels=n), RUN).astype(np.float32))
        for n in (60_000, 1_000_000)
    )
    assert np.corrcoef(small.ravel(), full.ravel())[0, 1] > 0.99
