from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.preprocessing.decolorization_quality import decolorization_quality
from graphos_core.preprocessing.grey import luma
from graphos_core.preprocessing.grey_variants import compare_grey_variants
from graphos_core.run import Run


def every_pair(colour: np.ndarray, grey: np.ndarray, tau: float) -> tuple[float, float]:
    """CCPR and CCFR as the paper defines them, over all pairs."""
    lab = cv2.cvtColor(colour.astype(np.float32) / 255, cv2.COLOR_RGB2LAB).reshape(-1, 3).astype(float)
    level = grey.ravel().astype(float) * 100 / 255
    i, j = np.triu_indices(len(level), 1)
    delta = np.linalg.norm(lab[i] - lab[j], axis=1)
    d = np.abs(level[i] - level[j])
    return float((d[delta >= tau] >= tau).mean()), 1.0 - float((delta[d > tau] <= tau).mean())


def test_drawn_pairs_agree_with_all_pairs() -> None:
    rng = np.random.default_rng(0)
    colour = rng.integers(0, 256, (30, 40, 3), dtype=np.uint8)
    grey = (255 - colour[:, :, 2] // 2).astype(np.uint8)
    found = decolorization_quality(colour, grey)
    for tau in (1, 10, 30):
        ccpr, ccfr = every_pair(colour, grey, tau)
        at = int(tau) - 1
        assert found.thresholds[at] == tau
        assert abs(found.ccpr[at] - ccpr) < 0.01 and abs(found.ccfr[at] - ccfr) < 0.01
        assert found.e_score[at] == pytest.approx(
            2 * found.ccpr[at] * found.ccfr[at] / (found.ccpr[at] + found.ccfr[at])
        )


def test_grey_of_a_grey_photo_keeps_everything_and_a_flat_one_nothing() -> None:
    level = np.random.default_rng(1).integers(0, 256, (50, 60), dtype=np.uint8)
    colour = np.repeat(level[:, :, None], 3, axis=2)
    star = cv2.cvtColor(colour, cv2.COLOR_RGB2LAB)[:, :, 0]
    ccpr, ccfr, e_score = decolorization_quality(colour, star).means()
    assert min(ccpr, ccfr, e_score) > 0.98
    flat = decolorization_quality(colour, np.full((50, 60), 100, np.uint8))
    assert flat.ccpr.max() == 0.0 and np.isnan(flat.ccfr).all()
    invented = decolorization_quality(np.full((50, 60, 3), 90, np.uint8), level)
    assert np.isnan(invented.ccpr).all() and invented.ccfr.max() == 0.0


def test_variants_are_counted_by_the_caller_and_one_hue_apart_is_best_seen_by_its_remedy() -> None:
    image = np.empty((120, 160, 3), np.uint8)
    image[:] = (180, 80, 60)
    image[(np.indices((120, 160)) // 20).sum(axis=0) % 2 == 1] = (40, 135, 140)
    seen: list[np.ndarray] = []

    def count(grey: np.ndarray) -> int:
        seen.append(grey)
        return len(seen)

    rows = compare_grey_variants(image, count, run=Run())
    assert len(rows) == 8 and [r.keypoints for r in rows] == list(range(1, 9))
    by_name = {(r.algorithm, r.choice): r for r in rows}
    assert by_name["decolor", ""].ccpr > 0.99 > 0.5 > by_name["grey", "luma"].ccpr
    assert np.array_equal(seen[[(r.algorithm, r.choice) for r in rows].index(("grey", "luma"))], luma(image))
    with pytest.raises(ValueError, match="without colour"):
        compare_grey_variants(image[:, :, 0], None, run=Run())


@pytest.mark.data
def test_contrast_preserving_grey_never_loses_against_luma_and_wins_where_hues_differ(data_dir: Path) -> None:
    gained = {}
    for name in ["baboon.jpg", "fruits.jpg", "butterfly.jpg", "smarties.png", "starry_night.jpg"]:
        image = np.ascontiguousarray(cv2.imread(str(data_dir / "colour" / name))[:, :, ::-1])
        rows = {(r.algorithm, r.choice): r.e_score for r in compare_grey_variants(image, None, run=Run())}
        gained[name] = rows["decolor", ""] - rows["grey", "luma"]
    assert min(gained.values()) > -0.01
    assert gained["baboon.jpg"] > 0.03 and gained["fruits.jpg"] > 0.01
