"""Do the analyser's verdicts agree with the measured effect on verified matches?

``python benchmarks/analyser.py [--out FILE.md]``. For every real set of the shared data and for simulated series of
falling contrast and growing blur, neighbouring photos are matched as they are and enhanced. Enhancing *pays* when it
brings at least a tenth more verified matches; the verdict agrees when it recommends just that. A set without any
verified pair either way (the four thermal photos show four places) measures nothing and is not counted. Beside it stands how
often the best single threshold on the dispersion of hue, of saturation, and on their mean would agree.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

from graphos_core import registry
from graphos_core.data import Array, Camera
from graphos_core.features.stage import detect_all, match_all
from graphos_core.images import read_photo_set, read_pixels
from graphos_core.preprocessing.analyser import ENHANCEMENT, AnalyserParams, judge_set, measure_photo
from graphos_core.preprocessing.chain import apply_filters
from graphos_core.preprocessing.grey import eight_bit, luma
from graphos_core.recipe import Recipe
from graphos_core.run import Run

RUN = Run(seed=0)
PAYS = 1.1
DATA = Path(os.environ["GRAPHOS_DATA"])
SETS = {
    "lund_door": "lund_door/images/*.JPG", "banana": "banana/images/*", "brighton_uav6": "brighton_uav6/*.JPG",
    "berlin_gcp": "berlin_gcp/images/*", "thermal": "thermal/*.JPG", "graf": "features/graf?.png",
    "box": "features/box*.png", "leuven": "features/leuven?.jpg", "aloe": "aloe_stereo/aloe?.jpg",
    "tsukuba": "middlebury/tsukuba/*", "venus": "middlebury/venus/*", "calib_opencv": "calib_opencv/left0[1-3].jpg",
    "calib_boofcv circles": "calib_boofcv/*CircleHexagonal/*.jp*g", "calib_boofcv chess": "calib_boofcv/*Chess/*.jp*g",
    "dbat cam": "dbat/cam_images/*.JPG",
}  # fmt: skip
PHOTOS_PER_SET = 3


def real_sets() -> Iterator[tuple[str, list[Array], list[Camera]]]:
    """Every real set with overlapping photos: name, pixels and cameras."""
    for name, pattern in SETS.items():
        files = [
            f for f in sorted(DATA.glob(pattern)) if f.suffix.lower() in (".jpg", ".jpeg", ".png", ".ppm")
        ]
        if "middlebury" in pattern:
            files = [f for f in files if f.stem not in ("groundtruth", "nonocc", "all", "disc")]
        if len(files) < 2:
            raise SystemExit(f"{name}: no files {pattern}")
        photos = read_photo_set(files[:PHOTOS_PER_SET], run=RUN)
        yield name, [read_pixels(p) for p in photos.photos], [photos.cameras[p.camera] for p in photos.photos]


def simulated_series(folder: Path) -> Iterator[tuple[str, list[Array], list[Camera]]]:
    """The façade with less and less contrast, and more and more blur; sensor noise stays 1 grey level."""
    photos = read_photo_set(folder, run=RUN)
    cameras = [photos.cameras[p.camera] for p in photos.photos]
    base = [read_pixels(p).astype(np.float32) for p in photos.photos]
    for contrast in (1.0, 0.7, 0.5, 0.35, 0.25, 0.18, 0.12):
        yield (
            f"contrast {contrast}",
            [_noisy(i.mean() + contrast * (i - i.mean()), n) for n, i in enumerate(base)],
            cameras,
        )
    for sigma in (1.0, 2.0, 3.0, 5.0):
        yield (
            f"blur {sigma} px",
            [_noisy(cv2.GaussianBlur(i, (0, 0), sigma), n) for n, i in enumerate(base)],
            cameras,
        )


def _noisy(values: Array, seed: int) -> Array:
    noise = np.random.default_rng(seed).normal(0.0, 1.0, values.shape)
    return np.clip(np.rint(values + noise), 0, 255).astype(np.uint8)


def verified(greys: list[Array], cameras: list[Camera]) -> int:
    """Verified matches of neighbouring photos with the default recipe."""
    recipe = Recipe.default()
    detector, sheet = recipe.algorithm("features", "detector")
    found = detect_all(len(greys), lambda i: (greys[i], greys[i]), detector, sheet, RUN)
    matched = match_all(found, cameras, recipe.algorithm("features", "matcher"),
                        recipe.algorithm("features", "verification"), RUN,
                        [(i, i + 1) for i in range(len(greys) - 1)])  # fmt: skip
    return sum(len(pair.matches) for pair in matched)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--series", type=Path, required=True, help="folder with two or three simulated photos of the façade"
    )
    parser.add_argument("--out", type=Path, help="Markdown file")
    options = parser.parse_args()
    chain = [(a := registry.find("preprocessing", name), a.params()) for name in ENHANCEMENT]
    lines = ["| set | strong spots | hue | saturation | verdict | as they are | enhanced | effect | agrees |",
             "|---|---|---|---|---|---|---|---|---|"]  # fmt: skip
    rows, seconds = [], []
    for name, images, cameras in (*real_sets(), *simulated_series(options.series)):
        figures = []
        for image in images:
            start = time.perf_counter()
            figures.append(measure_photo(image))
            seconds.append(time.perf_counter() - start)
        verdict = judge_set(figures, AnalyserParams(), run=RUN)
        plain = verified([luma(eight_bit(i)) for i in images], cameras)
        raised = verified([luma(apply_filters(i, chain, RUN)) for i in images], cameras)
        pays = raised >= PAYS * plain and raised > plain
        hue, saturation = (float(np.median([getattr(f, n) for f in figures]))
                           for n in ("hue_dispersion", "saturation_dispersion"))  # fmt: skip
        overlap = max(plain, raised) > 0
        agrees = verdict.enhance == pays
        if overlap:
            rows.append((agrees, pays, hue, saturation))
        lines.append(f"| {name} | {verdict.score:.0f} | {hue:.2f} | {saturation:.2f} | "
                     f"{'enhance' if verdict.enhance else 'leave'} | {plain} | {raised} | "
                     f"{f'{raised / plain:.2f}' if plain else '–'} | {('yes' if agrees else 'no') if overlap else 'nothing to measure'} |")  # fmt: skip
        print(lines[-1], flush=True)
    agree = sum(row[0] for row in rows)
    pays = np.array([row[1] for row in rows])
    table = np.array([row[2:] for row in rows])
    lines.append(f"\nThe verdict agrees in {agree} of {len(rows)} cases. Best single threshold on")
    for what, values in (
        ("hue", table[:, 0]),
        ("saturation", table[:, 1]),
        ("their mean", table.mean(axis=1)),
    ):
        best = max(int(((values < t) == pays).sum()) for t in (*values, np.inf))
        at = next(t for t in sorted((*values, np.inf)) if ((values < t) == pays).sum() == best)
        lines.append(f"- {what}: {best} of {len(rows)} (at {at:.2f})")
    lines.append(f"\nMeasuring one photo: median {np.median(seconds):.3f} s, largest {max(seconds):.3f} s.")
    print("\n".join(lines[-5:]))
    if options.out:
        options.out.write_text("\n".join(lines) + "\n", "utf-8")


if __name__ == "__main__":
    main()
