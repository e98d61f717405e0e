"""The analyser against degradations that are applied on purpose."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.analyse_command import analyse_photos, analysis_document
from graphos_core.cli import main
from graphos_core.images import read_photo_set
from graphos_core.preprocessing.analyser import AnalyserParams, duplicates, judge_set, measure_photo
from graphos_core.preprocessing.analyser_figures import colour_dispersion, noise_level, strong_spots
from graphos_core.run import Run

RUN = Run(seed=0)


def picture(seed: int = 0, size: tuple[int, int] = (480, 640), colour: bool = True) -> np.ndarray:
    """A photo-like texture: sums of blurred noise, sharp."""
    rng = np.random.default_rng(seed)
    layers = [cv2.GaussianBlur(rng.normal(size=(*size, 3)), (0, 0), s) * s * w
              for s, w in ((1.0, 110), (3, 90), (12, 60), (40, 40))]  # fmt: skip
    values = np.clip(128 + sum(layers), 0, 255).astype(np.uint8)
    return values if colour else cv2.cvtColor(values, cv2.COLOR_RGB2GRAY)


def test_noise_that_was_added_is_found() -> None:
    grey = cv2.GaussianBlur(picture(colour=False, size=(900, 900)), (0, 0), 3)
    rng = np.random.default_rng(1)
    for sigma in (2.0, 5.0, 10.0):
        noisy = np.clip(np.rint(grey + rng.normal(0, sigma, grey.shape)), 0, 255).astype(np.uint8)
        assert noise_level(noisy) == pytest.approx(sigma, rel=0.08)


def test_motion_blur_is_told_from_defocus_and_its_direction_found() -> None:
    photo = picture()
    streak = np.eye(15, dtype=np.float32) / 15
    blurred = {
        "sharp": photo,
        "defocus": cv2.GaussianBlur(photo, (0, 0), 3),
        "row": cv2.blur(photo, (15, 1)),
        "column": cv2.blur(photo, (1, 15)),
        "diagonal": cv2.filter2D(photo, -1, streak),
    }
    found = {name: measure_photo(image) for name, image in blurred.items()}
    assert all(found[name].blur > found["sharp"].blur + 0.1 for name in blurred if name != "sharp")
    assert abs(found["defocus"].motion) < 0.05 < 0.2 < found["row"].motion
    for name, angle in (("row", 0), ("diagonal", 45), ("column", 90)):
        assert np.degrees(found[name].motion_direction) == pytest.approx(angle)
    others = [measure_photo(picture(seed)) for seed in (1, 2, 3)]
    verdict = judge_set([found["row"], found["defocus"], *others], AnalyserParams(), run=RUN)
    assert verdict.photos[0].verdict == "bad" and "Motion blur" in verdict.photos[0].remarks[0]
    assert "Out of focus" in verdict.photos[1].remarks[0]
    assert all(not any("lur" in r for r in one.remarks) for one in verdict.photos[2:])


def test_exposure_is_remarked() -> None:
    photo = picture().astype(float)
    bright, dark = (np.clip(photo + shift, 0, 255).astype(np.uint8) for shift in (150, -150))
    verdict = judge_set([measure_photo(p) for p in (bright, dark)], AnalyserParams(), run=RUN)
    assert verdict.photos[0].remarks[0].startswith("Overexposed")
    assert verdict.photos[1].remarks[0].startswith("Underexposed")
    assert measure_photo(bright).white == pytest.approx(
        (cv2.cvtColor(bright, cv2.COLOR_RGB2GRAY) == 255).mean()
    )


def test_strong_spots_fall_with_contrast_and_blobs_are_counted() -> None:
    photo = picture(colour=False).astype(float)
    counts = [strong_spots(np.rint(128 + c * (photo - 128)).astype(np.uint8)) for c in (1, 0.5, 0.25, 0.1)]
    assert counts == sorted(counts, reverse=True) and counts[0] > 4 * counts[2] > 0

    def blobs(places: list[int]) -> np.ndarray:
        canvas = np.zeros((200, 200), np.float32)
        canvas[np.ix_(places, places)] = 1.0
        spread = cv2.GaussianBlur(canvas, (0, 0), 1.5)
        return np.rint(200 * spread / spread.max()).astype(np.uint8)

    one = strong_spots(blobs([100]))
    assert one >= 2  # at both scales, and the dark rings around
    assert strong_spots(blobs([20, 60, 100, 140, 180])) == 25 * one


def test_hue_is_circular_and_grey_pixels_have_none() -> None:
    def of_hues(degrees: list[float], saturation: int = 200) -> np.ndarray:
        hsv = np.array([[[d / 360 * 256 % 256, saturation, 200] for d in degrees]], np.uint8)
        return cv2.cvtColor(np.repeat(hsv, 8, axis=0), cv2.COLOR_HSV2RGB_FULL)

    around_red, _ = colour_dispersion(of_hues([350, 355, 0, 5, 10]))
    everywhere, _ = colour_dispersion(of_hues([0, 90, 180, 270]))
    assert around_red < 0.02 and everywhere > 0.97
    with_grey = np.concatenate([of_hues([350, 0, 10]), of_hues([120, 180, 240], saturation=0)], axis=1)
    hue, saturation = colour_dispersion(with_grey)
    assert hue < 0.02 and saturation == pytest.approx(1.0, abs=0.01)  # half S, half 0: σ = μ
    assert colour_dispersion(np.zeros((9, 9), np.uint8)) == (0.0, 0.0)


def test_duplicates_are_found_and_neighbours_are_not() -> None:
    rng = np.random.default_rng(5)
    photo = picture(size=(500, 700))
    again = np.clip(photo + rng.normal(0, 3, photo.shape), 0, 255).astype(np.uint8)
    moved = np.roll(photo, 60, axis=1)
    flat = np.full_like(photo, 90)
    figures = [measure_photo(p) for p in (photo, moved, again, flat, flat)]
    assert [pair[:2] for pair in duplicates(figures, 0.995)] == [(0, 2)]


def test_a_set_is_enhanced_by_its_median_and_says_why() -> None:
    textured, plain = picture(size=(1000, 1200)), np.rint(128 + 0.1 * (picture(size=(1000, 1200)) - 128.0))
    rich, poor = measure_photo(textured), measure_photo(plain.astype(np.uint8))
    left = judge_set([rich, rich, poor], AnalyserParams(), run=RUN)
    assert not left.enhance and left.filters == () and str(rich.spots) in left.reason
    assert [one.verdict for one in left.photos] == ["good", "good", "weak"]
    raised = judge_set([rich, poor, poor], AnalyserParams(), run=RUN)
    assert raised.enhance and raised.filters and str(poor.spots) in raised.reason
    assert judge_set([rich], AnalyserParams(threshold=rich.spots + 1), run=RUN).enhance
    by_colour = judge_set([rich], AnalyserParams(score="colour", colour_threshold=0.0), run=RUN)
    assert by_colour.score == pytest.approx((rich.hue_dispersion + rich.saturation_dispersion) / 2)


def test_the_command_writes_what_it_says(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "photos"
    folder.mkdir()
    for index in range(3):
        cv2.imwrite(str(folder / f"p{index}.png"), picture(index))
    cv2.imwrite(str(folder / "one colour.png"), np.full((200, 300, 3), 77, np.uint8))
    (folder / "text.jpg").write_text("no photo")
    assert main(["analyse", str(folder), "--out", str(tmp_path / "out")]) == 0
    said = capsys.readouterr().out
    assert "text.jpg: It is no JPEG" in said and "one colour.png" in said and "Recommended" in said
    photos = read_photo_set(folder, run=RUN)
    document = analysis_document(photos, analyse_photos(photos, AnalyserParams(), RUN), AnalyserParams())
    import json

    assert json.loads((tmp_path / "out" / "analysis.json").read_text("utf-8")) == json.loads(
        json.dumps(document)
    )
    assert main(["analyse", str(folder), "--set", "treshold=3"]) == 1
    assert "threshold" in capsys.readouterr().err
