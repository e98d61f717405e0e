"""Draw the pictures of the README and the guides: ``python docs/draw_pictures.py MODEL [--out DIR] [--all]``.

MODEL is the finished project of ``graphos demo`` (its folder ``model``). Without a display the pictures are drawn with
Qt's offscreen platform; under a virtual display set ``QT_QPA_PLATFORM=xcb``. Each picture is a PNG of at most 300 kB.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if not os.environ.get("DISPLAY"):
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

if TYPE_CHECKING:
    from PIL.Image import Image
    from PySide6.QtWidgets import QWidget

    from graphos_py.main_window import MainWindow

SIZE = (1600, 1000)
LIMIT_BYTES = 300_000


@dataclass(frozen=True)
class Picture:
    """One picture: which tab, what is done there before it is drawn, in which theme the README shows it."""

    name: str
    tab: str
    prepare: Callable[[MainWindow], None] = lambda window: None
    theme: str = ""


def page(stage: str, title: str) -> Callable[[MainWindow], None]:
    """Return what brings a page of a tab into sight."""

    def show(window: MainWindow) -> None:
        views = window.stage_tab(stage).views  # type: ignore[arg-type]
        titles = [views.tabText(i) for i in range(views.count())]
        views.setCurrentIndex(titles.index(title))

    return show


def keypoint(title: str) -> Callable[[MainWindow], None]:
    """Return what shows a page of the features tab with the largest matched keypoint chosen."""

    def show(window: MainWindow) -> None:
        page("features", title)(window)
        wait(window, 0.4)
        tab = window.stage_tab("features")
        features = tab.result.features[window.session.photo]
        pairs = tab.keypoints.matched_in  # type: ignore[attr-defined]
        best = max(range(len(features.xy)), key=lambda i: (int(pairs[i]), float(features.scale[i])))
        tab.keypoints.choose(best)  # type: ignore[attr-defined]
        tab.descriptor.choose(best)  # type: ignore[attr-defined]

    return show


def learn(kind: str, name: str) -> Callable[[MainWindow], None]:
    """Return what opens a simulator, a lesson or a lab."""

    def show(window: MainWindow) -> None:
        tab = window.learn_page.layout().itemAt(0).widget()  # type: ignore[union-attr]
        tab.open(kind, name)  # type: ignore[attr-defined]

    return show


PICTURES = (
    Picture("start", "start", theme="light"),
    Picture("images", "images"),
    Picture("preprocessing", "preprocessing"),
    Picture("keypoints", "features", keypoint("Keypoints")),
    Picture("descriptor", "features", keypoint("Descriptor"), "dark"),
    Picture("features", "features", page("features", "Matches"), "light"),
    Picture("coverage", "features", page("features", "Coverage")),
    Picture("graph", "features", page("features", "Image graph"), "light"),
    Picture("features_numbers", "features", page("features", "Numbers")),
    Picture("adjustment", "adjustment", page("adjustment", "3D"), "light"),
    Picture("findings", "adjustment", page("adjustment", "Findings")),
    Picture("calibration", "adjustment", page("adjustment", "Calibration"), "light"),
    Picture("photos", "adjustment", page("adjustment", "Photos")),
    Picture("residuals", "adjustment", page("adjustment", "Residuals")),
    Picture("iterations", "adjustment", page("adjustment", "Iterations")),
    Picture("control", "adjustment", page("adjustment", "Control"), "light"),
    Picture("dense", "dense", page("dense", "Cloud"), "dark"),
    Picture("depth", "dense", page("dense", "Depth map")),
    Picture("quality", "quality", page("quality", "Distances and measuring"), "light"),
    Picture("quality_figures", "quality", page("quality", "Figures and advice")),
    Picture("learn", "learn", learn("welcome", "")),
    Picture("simulator_epipolar", "learn", learn("simulator", "features/epipolar"), "light"),
    Picture("simulator_intersection", "learn", learn("simulator", "adjustment/intersection"), "dark"),
    *(
        Picture(f"simulator_{name}", "learn", learn("simulator", f"adjustment/{name}"))
        for name in (
            "rotations",
            "collinearity",
            "coplanarity",
            "trifocal",
            "distortion",
            "network",
            "steps",
            "datum",
            "snooping",
            "robust",
        )
    ),
    *(
        Picture(f"simulator_{name}", "learn", learn("simulator", f"features/{name}"))
        for name in (
            "scale_space",
            "descriptor",
            "self_dissimilarity",
            "affine",
            "ratio_test",
            "sampling",
            "coverage",
        )
    ),
    Picture("simulator_decolorization", "learn", learn("simulator", "preprocessing/decolorization")),
    Picture("simulator_wallis", "learn", learn("simulator", "preprocessing/wallis")),
    Picture("lab", "learn", learn("lab", "from-photos-to-a-model")),
)


def wait(window: MainWindow, quiet_s: float = 0.7, limit_s: float = 90.0) -> None:
    """Let the window work until no thread of it has done anything for a while."""
    from PySide6.QtWidgets import QApplication

    from graphos_py.views.cloud_canvas import CloudCanvas
    from graphos_py.views.match_view import MatchView

    canvases = window.findChildren(CloudCanvas)
    pairs = window.findChildren(MatchView)
    end = time.monotonic() + limit_s
    last = time.monotonic()
    while time.monotonic() - last < quiet_s and time.monotonic() < end:
        QApplication.processEvents()
        time.sleep(0.01)
        busy = any(canvas.busy for canvas in canvases if canvas.isVisible())
        busy |= any(p.residuals is None for p in pairs if p.isVisible() and p.pair_geometry is not None)
        if window.jobs.running or busy:
            last = time.monotonic()


def save(widget: QWidget, path: Path) -> None:
    """Write what a widget shows as a PNG with as many colours as fit into the limit."""
    from PIL import Image
    from PySide6.QtCore import QBuffer

    buffer = QBuffer()
    buffer.open(QBuffer.OpenModeFlag.WriteOnly)
    widget.grab().save(buffer, "PNG")  # type: ignore[call-overload]
    image = Image.open(io.BytesIO(bytes(buffer.data().data()))).convert("RGB")
    for colours in (0, 256, 192, 128, 96, 64, 48):
        small = image if not colours else _fewer_colours(image, colours)
        packed = io.BytesIO()
        small.save(packed, "PNG", optimize=True)
        if packed.tell() <= LIMIT_BYTES:
            break
    path.write_bytes(packed.getvalue())
    print(f"{path.name}: {packed.tell() // 1000} kB, {colours or 'all'} colours", flush=True)


def _fewer_colours(image: Image, colours: int) -> Image:
    """Return a picture with a palette that holds the theme's colours too, which are rare and would be lost."""
    from PIL import Image

    from graphos_py.theme import theme

    names = ("good", "accent", "warn", "bad", "text", "muted", "on_accent", "selected")
    own = [part for name in names for part in theme().colour(name).getRgb()[:3]]
    found = image.quantize(colours - len(names), dither=Image.Dither.NONE).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette([*found[: 3 * (colours - len(names))], *own])
    return image.quantize(palette=palette, dither=Image.Dither.NONE)


def draw(window: MainWindow, pictures: list[Picture], out: Path, theme: str, all_themes: bool) -> None:
    """Draw pictures in one theme."""
    window.menus.use_theme(theme)  # type: ignore[arg-type]
    for picture in pictures:
        if not all_themes and picture.theme != theme:
            continue
        window.show_tab(picture.tab)
        wait(window, 0.2)
        picture.prepare(window)
        wait(window)
        suffix = "_dark" if theme == "dark" and (all_themes or picture.name.startswith("simulator")) else ""
        save(window, out / f"{picture.name}{suffix}.png")


def main() -> int:
    """Draw what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("project", type=Path, help="finished project of the demo")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "pictures")
    parser.add_argument("--all", action="store_true", help="every picture in light and dark")
    parser.add_argument("--only", default="", help="names, separated by commas")
    parser.add_argument("--scale", type=float, default=1.0, help="font scale, 1 to 2")
    asked = parser.parse_args()
    from PySide6.QtCore import QSettings

    from graphos_py.app import Application, make_application
    from graphos_py.settings import Settings

    asked.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        make_application()
        settings = Settings(QSettings(str(Path(scratch) / "settings.ini"), QSettings.Format.IniFormat))
        settings.theme, settings.scale = "light", asked.scale
        application = Application(settings)
        window = application.window
        window.resize(*SIZE)
        application.show()
        wait(window, 2.0)
        names = set(asked.only.split(",")) if asked.only else {p.name for p in PICTURES}
        pictures = [picture for picture in PICTURES if picture.name in names]
        for theme in ("light", "dark"):
            draw(window, [p for p in pictures if p.tab == "start"], asked.out, theme, asked.all)
        window.actions_of_project.open_folder(asked.project)
        wait(window, 2.0)
        for theme in ("light", "dark"):
            draw(window, [p for p in pictures if p.tab != "start"], asked.out, theme, asked.all)
        window.close()
        window.jobs.stop_all()
    return 0


if __name__ == "__main__":
    sys.exit(main())
