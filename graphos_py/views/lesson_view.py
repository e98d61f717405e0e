"""Shows Markdown with formulas and the engine's own pictures; text of strangers can do no harm.

HTML in the text is escaped, nothing is loaded from files or the network; formulas and pictures are drawn in jobs
and filled in when they are ready.
"""

from __future__ import annotations

from base64 import urlsafe_b64decode, urlsafe_b64encode
from functools import cache
from html import escape
from typing import Any

from PySide6.QtCore import QTimer, QUrl, Signal, Slot
from PySide6.QtGui import QFont, QImage, QPainter, QResizeEvent, QTextDocument
from PySide6.QtWidgets import QTextBrowser, QWidget

from graphos_core.run import Run
from graphos_didactic.lessons import Lesson
from graphos_py.formula import formula_image
from graphos_py.jobs import Job, Jobs
from graphos_py.theme import theme

PICTURE = (1080, 620)
LINKS = ("lesson", "simulator")
LARGER = 1.12
"""The letters of formulas are smaller than those of the text at the same number of points."""


@cache
def parser() -> Any:
    """Return the Markdown parser: tables and formulas on, HTML off."""
    from markdown_it import MarkdownIt
    from mdit_py_plugins.dollarmath import dollarmath_plugin

    made = MarkdownIt("commonmark", {"html": False}).enable("table")
    return made.use(dollarmath_plugin, allow_digits=False, double_inline=True, renderer=_formula)


def _formula(text: str, options: dict[str, Any]) -> str:
    size = "d" if options.get("display_mode") else "i"
    address = urlsafe_b64encode(text.strip().encode()).decode()
    return f'<img src="formula:{size}{address}" alt="{escape(text.strip())}" style="vertical-align: middle"/>'


def to_html(markdown: str) -> str:
    """Return the HTML of a Markdown text; formulas are images with the address ``formula:``."""
    html = str(parser().render(markdown)).replace('<div class="math block">', '<div align="center">')
    return html.replace("<table>", '<table border="0" cellspacing="0" cellpadding="6" width="100%">').replace(
        "<eqn>", "<p align='center'>"
    )


def formulas_in(html: str) -> list[str]:
    """Return the addresses of the formulas of a page, each once."""
    parts = html.split('src="formula:')[1:]
    return list(dict.fromkeys("formula:" + part.partition('"')[0] for part in parts))


def formula_text(address: str) -> str:
    """Return the mathtext of a formula's address."""
    return urlsafe_b64decode(address.partition(":")[2][1:]).decode()


class LessonView(QTextBrowser):
    """A page of Markdown.

    Parameters
    ----------
    jobs : Jobs

    Signals
    -------
    asked : str, str
        A link to a ``"lesson"`` or a ``"simulator"``, and its name.
    drawn
        All formulas and pictures of the page are there.
    """

    asked = Signal(str, str)
    drawn = Signal()

    def __init__(self, jobs: Jobs, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._jobs = jobs
        self._markdown = ""
        self._html = ""
        self._images: dict[str, QImage] = {}
        self._scenes: dict[str, Any] = {}
        self._current: set[Job] = set()
        self.setOpenLinks(False)
        self.setOpenExternalLinks(False)
        self.document().setDocumentMargin(20)
        self.anchorClicked.connect(self._clicked)
        theme().changed.connect(self._dress)
        self._late = False
        self._lateness = QTimer(self, singleShot=True, interval=700)
        self._lateness.timeout.connect(self._be_late)
        self._refit = QTimer(self, singleShot=True, interval=120)
        self._refit.timeout.connect(self._place_pictures)

    @property
    def waiting(self) -> bool:
        """Whether formulas or pictures are still being drawn."""
        return bool(self._current)

    def show_lesson(self, lesson: Lesson) -> None:
        """Show a lesson with its pictures."""
        self.show_markdown(lesson.markdown(lambda simulator, preset: f"picture:{simulator}#{preset}"))

    def show_markdown(self, text: str) -> None:
        """Show a text; ``picture:ROOM/NAME#PRESET`` is the picture of a simulator, see `Simulator.described`."""
        self._markdown = text
        self._scenes.clear()
        self._draw()
        self.verticalScrollBar().setValue(0)

    def height_of_text(self) -> int:
        """Return the height at which nothing has to be scrolled."""
        return round(self.document().size().height()) + 2 * self.frameWidth() + 4

    def loadResource(self, kind: int, name: QUrl | str) -> Any:
        """Return what was drawn; nothing is ever read from a file or the network."""
        if kind == QTextDocument.ResourceType.ImageResource:
            return self._images.get(name.toString() if isinstance(name, QUrl) else name, QImage())
        return None

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the pictures to the width."""
        super().resizeEvent(event)
        if self._scenes:
            self._refit.start()

    # ---------------------------------------------------------------------------------------------- drawing

    def _dress(self) -> None:
        if self._markdown:
            self._scenes.clear()
            self._draw()

    def _draw(self) -> None:
        for job in self._current:
            job.stop()
        self._current = set()
        self._images, self._late = {}, False
        self._lateness.start()
        self._html = to_html(self._markdown)
        look = theme()
        text, muted, border, accent = (look.colour(n).name() for n in ("text", "muted", "border", "accent"))
        self.document().setDefaultStyleSheet(
            f"body, p, li, td, th {{ color: {text}; line-height: 122%; }} a {{ color: {accent}; }}"
            f"p {{ margin-top: 6px; margin-bottom: 8px; }} em {{ color: {muted}; }}"
            f"td, th {{ border-bottom: 1px solid {border}; line-height: 115%; }}"
            f"h1 {{ font-size: {look.points('title')}pt; }} h2 {{ font-size: {look.points('heading')}pt; }}"
            f"th {{ text-align: left; color: {muted}; }}"
        )
        self._lay()
        self._start(self._draw_formulas(), self._formulas_drawn)
        self._start(self._draw_pictures(), self._pictures_drawn)

    def _start(self, job: Job | None, then: Any) -> None:
        if job is not None:
            self._current.add(job)
            job.succeeded.connect(then)
            job.finished.connect(self._over)
            self._jobs.start(job)

    @Slot()
    def _over(self) -> None:
        job = self.sender()
        if job in self._current:
            self._current.discard(job)
            if not self._current:
                self.drawn.emit()

    def _draw_formulas(self) -> Job | None:
        wanted = formulas_in(self._html)
        colour, ratio = theme().colour("text").name(), self.devicePixelRatioF()
        points = {"d": theme().points("heading") * LARGER, "i": theme().points("body") * LARGER}

        def work(run: Run) -> dict[str, QImage]:
            found = {}
            for address in wanted:
                run.check()
                size, text = address.partition(":")[2][0], formula_text(address)
                if size == "d":
                    text = text.replace(r"\frac", r"\dfrac")
                found[address] = formula_image(text, colour, points[size], ratio)
            return found

        return Job(work, name="formulas", engine=False) if wanted else None

    @Slot(object)
    def _formulas_drawn(self, images: dict[str, QImage]) -> None:
        if self.sender() in self._current:
            self._images |= images
            self._lay()

    def _draw_pictures(self) -> Job | None:
        parts = self._html.split('src="picture:')[1:]
        wanted = ["picture:" + part.partition('"')[0] for part in parts]

        def work(run: Run) -> dict[str, Any]:
            from graphos_didactic.lesson_pictures import lesson_scene
            from graphos_didactic.scene_svg import scene_svg

            found = {}
            for address in wanted:
                run.check()
                key, _, preset = address.partition(":")[2].partition("#")
                found[address] = lesson_scene(key, preset)
                scene_svg(found[address])  # sets the formulas here, so that the window need not wait for them
            return found

        return Job(work, name="pictures", engine=False) if wanted else None

    @Slot(object)
    def _pictures_drawn(self, scenes: dict[str, Any]) -> None:
        if self.sender() in self._current:
            self._scenes = scenes
            self._place_pictures()

    def _place_pictures(self) -> None:
        from graphos_didactic.scene_drawing import Look, draw, for_print
        from graphos_py.views.scene_canvas import QtCanvas

        width = max(240, min(PICTURE[0], self.viewport().width() - 48))
        size = max(9.0, theme().points() * self.logicalDpiY() / 72.0 * width / PICTURE[0])
        look = for_print(Look(theme=theme().name, font=size))
        height = round(width * PICTURE[1] / PICTURE[0])
        ratio = self.devicePixelRatioF()
        for address, scene in self._scenes.items():
            image = QImage(round(width * ratio), round(height * ratio), QImage.Format.Format_RGB32)
            image.setDevicePixelRatio(ratio)
            painter = QPainter(image)
            draw(scene, QtCanvas(painter, QFont(self.font())), width, height, look)
            painter.end()
            self._images[address] = image
        self._lay()

    def _lay(self) -> None:
        place = self.verticalScrollBar().value()
        html = self._html
        for address in formulas_in(html):
            image = self._images.get(address)
            if image.isNull() if image is not None else self._late:
                html = _as_written(html, address)
        self.document().clear()
        self.setHtml(f"<body>{html}</body>")
        self.verticalScrollBar().setValue(place)

    def _be_late(self) -> None:
        """Show formulas as they are written while the typesetter is still being loaded."""
        if self.waiting:
            self._late = True
            self._lay()

    def _clicked(self, url: QUrl) -> None:
        if url.scheme() in LINKS:
            self.asked.emit(url.scheme(), url.path())


def _as_written(html: str, address: str) -> str:
    """Put the text of a formula in the place of its picture."""
    before, found, after = html.partition(f'<img src="{address}"')
    while found:
        html = f"{before}<code>{escape(formula_text(address))}</code>{after.partition('/>')[2]}"
        before, found, after = html.partition(f'<img src="{address}"')
    return html
