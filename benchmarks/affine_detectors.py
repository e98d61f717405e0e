"""SIFT, ASIFT, MSD and affine MSD: time of MSD, right matches on graf1–graf3, and whole blocks.

usage: python benchmarks/affine_detectors.py msd | graf | blocks [BLOCK …] [DETECTOR …]

The real data lie in the folder that GRAPHOS_DATA names. Blocks run one after the other, each with every detector and
robust matching, through the product's own pipeline.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numba
import numpy as np

from graphos_core.features_comparison.measures import occupied_cells
from graphos_core.pipeline import Pipeline
from graphos_core.project import Project
from graphos_core.recipe import Recipe
from graphos_core.registry import algorithms, find
from graphos_core.run import Run

THREADS = 2
DETECTORS = ("sift", "asift", "msd", "amsd")
BLOCKS = {"lund_door": 12, "banana": 14, "brighton_uav6": 6}
"""Photos that must be oriented."""
MSD_SETTINGS = (3, 5, 5, 0, 250.0, 4, 1.25, -1, False)
REPEATS = 3


def photo(*parts: str) -> np.ndarray:
    return cv2.imread(str(Path(os.environ["GRAPHOS_DATA"], *parts)), cv2.IMREAD_GRAYSCALE)


def msd_times() -> None:
    """Detection without descriptors, same parameters, best of three, alternating."""
    from graphos_core.features.detectors.msd import MsdParams, detected_levels

    params = MsdParams(threshold=250.0)
    for name, grey in (
        ("graf1", photo("features", "graf1.png")),
        ("1.5 Mpx", cv2.resize(photo("lund_door", first_photo("lund_door")), (1000, 1500))),
    ):
        seconds: dict[str, list[float]] = {"ours": [], "OpenCV": []}
        for _ in range(REPEATS + 1):
            started = time.perf_counter()
            ours = sum(len(level.pixels) for level in detected_levels(grey, params))
            seconds["ours"].append(time.perf_counter() - started)
            started = time.perf_counter()
            theirs = len(cv2.xfeatures2d.MSDDetector_create(*MSD_SETTINGS).detect(grey))
            seconds["OpenCV"].append(time.perf_counter() - started)
        best = {key: min(values[1:]) for key, values in seconds.items()}
        print(
            f"{name:8} ours {best['ours']:.3f} s, {ours} points; OpenCV {best['OpenCV']:.3f} s, {theirs} points; "
            f"ratio {best['ours'] / best['OpenCV']:.2f}",
            flush=True,
        )


def first_photo(block: str) -> str:
    return str(photo_folder(block).relative_to(Path(os.environ["GRAPHOS_DATA"], block)) / photos(block)[0])


def photo_folder(block: str) -> Path:
    """Return the folder of the block with most photos."""
    folders: dict[Path, int] = {}
    for file in Path(os.environ["GRAPHOS_DATA"], block).rglob("*"):
        if file.suffix.lower() in (".jpg", ".jpeg"):
            folders[file.parent] = folders.get(file.parent, 0) + 1
    return max(folders, key=lambda folder: folders[folder])


def photos(block: str) -> list[str]:
    return sorted(f.name for f in photo_folder(block).iterdir() if f.suffix.lower() in (".jpg", ".jpeg"))


def graf() -> None:
    """Matches of graf1 with graf3 within 3 px of the homography, counted once per 2 px cell of graf1."""
    first, second = photo("features", "graf1.png"), photo("features", "graf3.png")
    file = cv2.FileStorage(
        str(Path(os.environ["GRAPHOS_DATA"], "features", "H1to3p.xml")), cv2.FILE_STORAGE_READ
    )
    truth = file.getFirstTopLevelNode().mat()
    matcher = find("features", "mutual")
    run = Run(threads=THREADS)
    for name in DETECTORS:
        detector = find("features", name)
        started = time.perf_counter()
        a, b = (detector.function(grey, grey, detector.params(), run=run) for grey in (first, second))
        detected = time.perf_counter()
        pairs = matcher.function(a, b, matcher.params(), run=run).matches
        matched = time.perf_counter()
        mapped = cv2.perspectiveTransform(a.xy[pairs[:, 0]][None].astype(np.float64), truth)[0]
        right = np.linalg.norm(mapped - b.xy[pairs[:, 1]], axis=1) <= 3.0
        print(
            f"{name:6} keypoints {len(a.xy):6} {len(b.xy):6}  matches {len(pairs):5}  right {int(right.sum()):5}  "
            f"cells {occupied_cells(a.xy[pairs[right, 0]]):5}  both photos {detected - started:6.2f} s  "
            f"matching {matched - detected:5.2f} s",
            flush=True,
        )


def blocks(names: list[str], detectors: list[str]) -> None:
    print("| block | detector | keypoints | verified | tracks | oriented | σ0 px | seconds |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for block in names:
        for detector in detectors:
            recipe = (
                Recipe.default()
                .choose("features", "detector", detector)
                .choose("features", "matcher", "robust")
            )
            with tempfile.TemporaryDirectory() as out:
                run = Run(threads=THREADS)
                project = Project.create(Path(out) / "project", photo_folder(block), run=run)
                started = time.perf_counter()
                pipeline = Pipeline(project, recipe)
                pipeline.run("adjustment", run)
                seconds = time.perf_counter() - started
                row = figures(pipeline)
            enough = "" if row["oriented"] >= BLOCKS[block] else " **too few**"
            print(
                f"| {block} | {detector} | {row['keypoints']} | {row['verified']} | {row['tracks']} | "
                f"{row['oriented']} of {row['photos']}{enough} | {row['sigma0_px']:.3f} | {seconds:.0f} |",
                flush=True,
            )


def figures(pipeline: Pipeline) -> dict[str, float]:
    """Mean keypoints per photo, verified matches of all pairs, tracks, oriented photos, σ0."""
    features = pipeline.result("features")
    adjustment = pipeline.result("adjustment").adjustment
    return {
        "keypoints": round(float(np.mean([len(f.xy) for f in features.features]))),
        "verified": sum(len(pair.matches) for pair in features.pairs if not pair.reason),
        "tracks": features.tracks.count,
        "oriented": int(adjustment.block.oriented.sum()),
        "photos": len(adjustment.block.oriented),
        "sigma0_px": adjustment.sigma0_px,
    }


def main() -> None:
    algorithms()
    cv2.setNumThreads(THREADS)
    numba.set_num_threads(THREADS)
    what = sys.argv[1] if len(sys.argv) > 1 else ""
    if what == "blocks":
        blocks(
            [name for name in sys.argv[2:] if name in BLOCKS] or list(BLOCKS),
            [name for name in sys.argv[2:] if name in DETECTORS] or list(DETECTORS),
        )
    elif what in ("msd", "graf"):
        {"msd": msd_times, "graf": graf}[what]()
    else:
        print(__doc__)


if __name__ == "__main__":
    main()
