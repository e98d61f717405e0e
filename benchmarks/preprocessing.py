"""The preprocessing room: filters at 6 Mpx beside the other implementation's, the live preview at 20 Mpx, the stretch.

    python benchmarks/preprocessing.py filters [--repeat N]
    python benchmarks/preprocessing.py preview [--width 5472 --height 3648] [--repeat N]
    python benchmarks/preprocessing.py stretch THERMAL_PHOTOS

`filters` times every filter with its default parameters on a colour photo of 3000 × 2000. `preview` times, from a change
of a parameter or of the view to the pieces that are shown, what a window of 1200 × 900 sees: the whole photo, a quarter,
and 1:1. `stretch` takes thermal JPEGs that hold the sensor's values (APP3 segments): second views are made by a known
homography, with fresh noise as strong as measured, and the right matches (within 3 px) are counted for plain grey and
for the stretch.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.preprocessing.grey import eight_bit
from graphos_core.preprocessing.noise import noise_level
from graphos_core.preprocessing.preview import Preview, Region
from graphos_core.preprocessing.stretch import StretchParams, stretch, stretch_choice
from graphos_core.registry import algorithms, find
from graphos_core.run import Run

RUN = Run()
HOMOGRAPHIES = {
    "5 % larger, 7°": np.array([[1.02, 0.14, -30.0], [-0.12, 1.05, 25.0], [5e-5, -4e-5, 1.0]]),
    "40 % larger, 35°": np.vstack([cv2.getRotationMatrix2D((320, 256), 35, 1.4), [0.0, 0.0, 1.0]]),
}


def scene(width: int, height: int) -> Array:
    """A colour picture with structure of all sizes and noise of 3 grey levels."""
    rng = np.random.default_rng(0)
    image = np.zeros((height, width, 3), np.float32)
    for cells, weight in ((8, 60), (40, 40), (200, 25), (800, 15)):
        small = rng.normal(0, weight, (cells * height // width, cells, 3)).astype(np.float32)
        image += cv2.resize(small, (width, height), interpolation=cv2.INTER_LINEAR)
    image += 120 + rng.normal(0, 3, image.shape).astype(np.float32)
    return np.clip(image, 0, 255).astype(np.uint8)


def times(function: Callable[[], object], repeat: int) -> tuple[float, float]:
    """Best and median of `repeat` runs after one to warm up, s."""
    function()
    found = []
    for _ in range(repeat):
        begun = time.perf_counter()
        function()
        found.append(time.perf_counter() - begun)
    return min(found), statistics.median(found)


def filters(repeat: int) -> None:
    """Print the times of all filters at 6 Mpx."""
    image = scene(3000, 2000)
    grey = np.ascontiguousarray(image[:, :, 1])
    for algorithm in algorithms("preprocessing", "filter"):
        best, median = times(lambda a=algorithm: a.function(image, a.params(), run=RUN), repeat)
        print(f"{algorithm.name:10s} colour  best {1000 * best:7.1f} ms   median {1000 * median:7.1f} ms")
    wallis = find("preprocessing", "wallis")
    best, median = times(lambda: wallis.function(grey, wallis.params(), run=RUN), repeat)
    print(f"wallis     grey    best {1000 * best:7.1f} ms   median {1000 * median:7.1f} ms")
    best, median = times(lambda: cv2.decolor(image[:, :, ::-1].copy()), 1)
    print(f"cv2.decolor        best {1000 * best:7.1f} ms   median {1000 * median:7.1f} ms")
    engine = cv2.createCLAHE(3.0, (8, 8))
    best, median = times(lambda: engine.apply(grey), repeat)
    print(f"cv2 CLAHE, grey    best {1000 * best:7.1f} ms   median {1000 * median:7.1f} ms")


def preview(width: int, height: int, repeat: int) -> None:
    """Print the 95th percentile of the time to the first and to the last piece."""
    from graphos_py.preprocessing.live_preview import pieces_of

    pixels = scene(width, height)
    views = {
        "whole": (Region(0, 0, width, height), 4),
        "quarter": (Region(width // 4, height // 4, width // 4 + 2400, height // 4 + 1800), 2),
        "1:1": (Region(width // 3, height // 3, width // 3 + 1200, height // 3 + 900), 1),
    }
    chains = [
        ("wallis",),
        ("decolor", "wallis"),
        ("clahe",),
        ("equalize",),
        ("stretch",),
        ("sharpen",),
        ("bilateral",),
        ("nlm",),
    ]
    for names in chains:
        seen = Preview(pixels)
        for size in (2, 4, 8, 16):
            seen.reduced(size)
        for view, (region, factor) in views.items():
            first, last = [], []
            for i in range(repeat + 1):
                chain = [(a := find("preprocessing", n), _nudged(a.params(), i)) for n in names]
                heard: list[float] = []
                begun = time.perf_counter()
                pieces_of(seen, chain, region, factor, _Listening(heard, begun))
                last.append(time.perf_counter() - begun)
                first.append(heard[0] if heard else last[-1])
            a, b = (1000 * float(np.percentile(v[1:], 95)) for v in (first, last))
            print(
                f"{'+'.join(names):14s} {view:8s} first picture p95 {a:6.0f} ms   finest p95 {b:6.0f} ms",
                flush=True,
            )


class _Listening(Run):
    """Remembers when the first partial pieces came."""

    def __init__(self, heard: list[float], begun: float) -> None:
        super().__init__()
        self.heard, self.begun = heard, begun

    def show(self, key: str, value: object) -> None:
        self.heard.append(time.perf_counter() - self.begun)


def _nudged(params: object, i: int) -> object:
    """A sheet that differs from one turn to the next, as when somebody drags."""
    name, declared = next((n, d) for n, d in params.declarations().items() if d.kind in ("float", "int"))  # type: ignore[attr-defined]
    about = declared.about
    value = declared.default if declared.default is not None else about.low
    return params.replace(
        **{
            name: min(
                value + i * (about.step or 1) * 0.5 if declared.kind == "float" else value + i, about.high
            )
        }
    )  # type: ignore[attr-defined]


def radiometric(path: Path) -> Array:
    """The sensor's values of a thermal JPEG of 640 × 512, uint16."""
    data, at, kept = path.read_bytes(), 2, b""
    while data[at] == 0xFF and data[at + 1] != 0xDA:
        length = int.from_bytes(data[at + 2 : at + 4], "big")
        if data[at + 1] == 0xE3:
            kept += data[at + 4 : at + 2 + length]
        at += 2 + length
    return np.frombuffer(kept, "<u2").reshape(512, 640)


def thermal(folder: Path) -> None:
    """Print the right matches of second views with fresh noise."""
    for path in sorted(folder.glob("*.[jJ][pP][gG]")):
        luma = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        for kind, values in (("sensor values", radiometric(path)), ("false colours, luma", luma)):
            for change, homography in HOMOGRAPHIES.items():
                one, two = _views(values, homography)
                choice = stretch_choice(one, StretchParams())
                plain = _right(eight_bit(one), eight_bit(two), homography)
                made = _right(*(stretch(v, StretchParams(), run=RUN) for v in (one, two)), homography)
                print(f"{path.name} {kind:20s} {change:16s} plain {plain[1]:5d} of {plain[0]:5d}   stretched {made[1]:5d} of "
                      f"{made[0]:5d}   ratio {made[1] / max(1, plain[1]):5.1f}   noise {choice.noise:.2f}, texture "
                      f"{choice.texture:.1f} grey levels, blur {choice.blur:.2f} px", flush=True)  # fmt: skip


def _views(values: Array, homography: Array) -> tuple[Array, Array]:
    rng, noise = np.random.default_rng(5), noise_level(values)
    smooth = cv2.GaussianBlur(values.astype(np.float32), (0, 0), 1.0)
    size = (values.shape[1], values.shape[0])
    second = cv2.warpPerspective(
        smooth, homography, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT
    )
    top = np.iinfo(values.dtype).max
    noisy = [np.clip(np.rint(v + rng.normal(0, noise, v.shape)), 0, top) for v in (smooth, second)]
    return noisy[0].astype(values.dtype), noisy[1].astype(values.dtype)


def _right(a: Array, b: Array, homography: Array) -> tuple[int, int]:
    sift, mutual = find("features", "sift"), find("features", "mutual")
    one, two = (sift.function(v, v, sift.params(), run=RUN) for v in (a, b))
    matches = mutual.function(one, two, mutual.params(), run=RUN).matches
    if not len(matches):
        return 0, 0
    xy = cv2.perspectiveTransform(one.xy[matches[:, 0]][None].astype(np.float64), homography)[0]
    return len(matches), int((np.linalg.norm(xy - two.xy[matches[:, 1]], axis=1) < 3).sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("what", choices=("filters", "preview", "stretch"))
    parser.add_argument("photos", type=Path, nargs="?")
    parser.add_argument("--repeat", type=int, default=10)
    parser.add_argument("--width", type=int, default=5472)
    parser.add_argument("--height", type=int, default=3648)
    asked = parser.parse_args()
    print("load", " ".join(f"{load:.1f}" for load in os.getloadavg()))
    if asked.what == "filters":
        filters(asked.repeat)
    elif asked.what == "preview":
        preview(asked.width, asked.height, asked.repeat)
    elif asked.photos is None:
        parser.error("which photos?")
    else:
        thermal(asked.photos)


if __name__ == "__main__":
    main()
