"""The live preview: exact at full size, near when reduced, and honest about which it is."""

import numpy as np
import pytest

from graphos_core.preprocessing.chain import apply_filters
from graphos_core.preprocessing.preview import Preview, Region
from graphos_core.registry import find
from graphos_core.run import Run

RUN = Run()


def photo(seed: int = 0, bits: int = 8) -> np.ndarray:
    rng = np.random.default_rng(seed)
    y, x = np.indices((600, 800))
    light = 110 + 70 * np.sin(x / 90.0) + 40 * np.cos(y / 60.0)
    values = np.clip(light[:, :, None] + rng.normal(0, 12, (600, 800, 3)) + [0, 25, -30], 0, 255)
    return values.astype(np.uint8) if bits == 8 else (9000 + 40 * values).astype(np.uint16)


def chain(*names: str) -> list:
    return [(a := find("preprocessing", n), a.params()) for n in names]


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize(
    "names",
    [
        ("wallis",),
        ("decolor", "wallis"),
        ("equalize",),
        ("clahe", "sharpen"),
        ("gamma", "decolor", "clahe"),
        ("stretch",),
    ],
)
def test_at_full_size_the_piece_equals_the_result(names: tuple[str, ...], bits: int) -> None:
    image = photo(bits=bits)
    preview, filters = Preview(image), chain(*names)
    region = Region(200, 150, 420, 330)
    if preview.needs_whole(filters):
        assert not preview.piece(filters, region, 1, RUN).exact
        preview.learn_whole(filters, RUN)
    piece = preview.piece(filters, region, 1, RUN)
    assert piece.exact and "equals" in piece.why and piece.region == region
    assert np.array_equal(piece.after, apply_filters(image, filters, RUN)[150:330, 200:420])


def test_before_the_whole_was_looked_at_the_piece_is_near() -> None:
    image, filters = photo(), chain("decolor", "equalize")
    piece = Preview(image).piece(filters, Region(100, 100, 400, 300), 1, RUN)
    whole = apply_filters(image, filters, RUN)[100:300, 100:400]
    assert not piece.exact
    assert np.corrcoef(piece.after.ravel(), whole.ravel())[0, 1] > 0.98
    assert np.abs(piece.after.astype(float) - whole).mean() < 12


def test_reduced_it_looks_like_the_reduced_result_and_says_that_it_is_not_exact() -> None:
    import cv2

    image, filters = photo(), chain("wallis")
    piece = Preview(image).piece(filters, Region(0, 0, 800, 600), 4, RUN)
    small = cv2.resize(apply_filters(image, filters, RUN), (200, 150), interpolation=cv2.INTER_AREA)
    assert piece.after.shape == (150, 200) and not piece.exact and "1:4" in piece.why
    assert np.corrcoef(piece.after.ravel(), small.ravel())[0, 1] > 0.85


def test_another_parameter_asks_for_another_look_at_the_whole() -> None:
    preview, filters = Preview(photo()), chain("equalize")
    preview.learn_whole(filters, RUN)
    assert not preview.needs_whole(filters)
    other = [(filters[0][0], filters[0][1].replace(strength=0.5))]
    assert preview.needs_whole(other) and not preview.needs_whole(chain("wallis"))


def test_slow_filters_are_shown_coarser_first() -> None:
    preview, filters = Preview(photo()), chain("nlm")
    whole = Region(0, 0, 800, 600)
    pace = 0.48 / (800 * 600)
    preview._pace = {("nlm", factor): pace for factor in (1, 2, 4)}  # 0.48 s for the whole at full size
    assert preview.first_factor(filters, whole, 1, RUN) == 4
    assert preview.first_factor(filters, Region(0, 0, 100, 100), 1, RUN) == 1
    preview._pace.clear()
    assert preview.first_factor(filters, whole, 8, RUN) >= 8 and preview._pace["nlm", 8] > 0


def test_odd_sizes_and_bands_are_no_harm() -> None:
    image = np.random.default_rng(0).integers(0, 256, (101, 77, 5), dtype=np.uint8)
    preview, filters = Preview(image), chain("bands")
    for factor in (1, 2, 4):
        piece = preview.piece(filters, Region(0, 0, 77, 101), factor, RUN)
        assert piece.after.ndim == 2 and piece.region == Region(0, 0, 77, 101)
        assert piece.after.shape == piece.before.shape[:2]
