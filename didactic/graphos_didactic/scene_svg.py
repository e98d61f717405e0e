"""Scenes as SVG: for tests, lessons and print."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from graphos_core.data.record import Array
from graphos_didactic.formula_outline import Outline
from graphos_didactic.scene import Scene
from graphos_didactic.scene_drawing import Horizontal, Look, Vertical, draw, for_print
from graphos_didactic.scene_layout import Box

if TYPE_CHECKING:
    from graphos_didactic.scene_drawing import Canvas

_ANCHORS = {"left": "start", "centre": "middle", "right": "end"}
_NARROW = set("iljtfrI.,:;'|!()[] ")
_WIDE = set("mwMW@%—")


def scene_svg(scene: Scene, *, width: int = 1200, height: int = 750, look: Look | None = None) -> str:
    """Return the scene as a complete SVG document of `width` × `height` px, without handles."""
    canvas = SvgCanvas()
    draw(scene, canvas, width, height, for_print(look or Look()))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
        f"font-family=\"'Noto Sans','DejaVu Sans',Arial,sans-serif\">\n"
        f"<title>{escape(scene.says)}</title>\n<desc>{escape('; '.join(scene.things.values()))}</desc>\n"
        + canvas.body()
        + "</svg>\n"
    )


class SvgCanvas:
    """A canvas that writes SVG elements."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._clips = 0

    def body(self) -> str:
        """Return the elements written so far."""
        return "\n".join(self._lines) + "\n"

    def polyline(self, xy: Array, colour: str, width: float, dash: tuple[float, ...]) -> None:
        """Write an open line; where a coordinate is NaN it is interrupted."""
        for part in finite_parts(xy):
            self._lines.append(
                f'<polyline points="{_points(part)}" fill="none" stroke="{colour}" '
                f'stroke-width="{width:.2f}" stroke-linejoin="round"{_dash(dash)}/>'
            )

    def polygon(
        self,
        xy: Array,
        fill: str,
        opacity: float,
        colour: str = "",
        width: float = 0.0,
        dash: tuple[float, ...] = (),
    ) -> None:
        """Write a closed polygon."""
        if not np.isfinite(xy).all():
            return
        edge = f' stroke="{colour}" stroke-width="{width:.2f}"{_dash(dash)}' if colour and width else ""
        self._lines.append(
            f'<polygon points="{_points(xy)}" fill="{fill}" fill-opacity="{opacity:.3g}"{edge}/>'
        )

    def discs(self, xy: Array, radius: float, fill: str, colour: str, width: float) -> None:
        """Write a circle at every position."""
        for x, y in xy[np.isfinite(xy).all(axis=1)]:
            self._lines.append(
                f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius:.2f}" fill="{fill or "none"}" '
                f'stroke="{colour}" stroke-width="{width:.2f}"/>'
            )

    def text(
        self,
        at: tuple[float, float],
        text: str,
        size: float,
        colour: str,
        horizontal: Horizontal = "left",
        vertical: Vertical = "baseline",
        bold: bool = False,
        upright: bool = True,
    ) -> None:
        """Write a text; not `upright` reads from bottom to top and is centred on its position."""
        x, y = at
        y += {"middle": 0.35, "top": 0.8, "baseline": 0.0}[vertical] * size
        turn = "" if upright else f' transform="rotate(-90 {x:.2f} {y:.2f})"'
        weight = ' font-weight="600"' if bold else ""
        self._lines.append(
            f'<text x="{x:.2f}" y="{y:.2f}" font-size="{size:.2f}" fill="{colour}" '
            f'text-anchor="{_ANCHORS[horizontal]}"{weight}{turn}>{escape(text)}</text>'
        )

    def text_width(self, text: str, size: float, bold: bool = False) -> float:
        """Estimate the width of a text, px; fonts differ, so a little generously."""
        units = sum(0.32 if c in _NARROW else 0.9 if c in _WIDE else 0.57 for c in text)
        return units * size * (1.06 if bold else 1.0)

    def outline(self, outline: Outline, at: tuple[float, float], scale: float, colour: str) -> None:
        """Write a formula as a filled path."""
        path = _path(outline.vertices * (scale, -scale) + at, outline.codes)
        self._lines.append(f'<path d="{path}" fill="{colour}" fill-rule="nonzero"/>')

    def picture(self, pixels: Array, box: Box) -> None:
        """Embed an image as PNG."""
        import cv2

        stored = pixels if pixels.ndim == 2 else pixels[..., ::-1]
        data = base64.b64encode(cv2.imencode(".png", np.ascontiguousarray(stored))[1].tobytes()).decode()
        left, top, width, height = box
        self._lines.append(
            f'<image x="{left:.2f}" y="{top:.2f}" width="{width:.2f}" height="{height:.2f}" '
            f'preserveAspectRatio="none" xlink:href={quoteattr("data:image/png;base64," + data)}/>'
        )

    def clip(self, box: Box) -> None:
        """Begin a group that shows only what lies in `box`."""
        self._clips += 1
        left, top, width, height = box
        self._lines.append(
            f'<clipPath id="clip{self._clips}"><rect x="{left:.2f}" y="{top:.2f}" width="{width:.2f}" '
            f'height="{height:.2f}"/></clipPath><g clip-path="url(#clip{self._clips})">'
        )

    def unclip(self) -> None:
        """End the group of the last `clip`."""
        self._lines.append("</g>")


def finite_parts(xy: Array) -> list[Array]:
    """Cut a line (n, 2) where it is not finite; parts of at least two points."""
    good = np.isfinite(xy).all(axis=1)
    if good.all():
        return [xy] if len(xy) > 1 else []
    cuts = np.flatnonzero(np.diff(good.astype(np.int8))) + 1
    parts = np.split(xy, cuts)
    return [part for part in parts if len(part) > 1 and np.isfinite(part[0]).all()]


def _points(xy: Array) -> str:
    return " ".join(f"{x:.2f},{y:.2f}" for x, y in np.clip(xy, -1e6, 1e6))


def _dash(dash: tuple[float, ...]) -> str:
    return f' stroke-dasharray="{" ".join(f"{part:.2f}" for part in dash)}"' if dash else ""


def _path(vertices: Array, codes: Array) -> str:
    parts, i = [], 0
    while i < len(codes):
        code = int(codes[i])
        count = {1: 1, 2: 1, 3: 2, 4: 3, 79: 1}[code]
        if code == 79:
            parts.append("Z")
        else:
            parts.append("MLQC"[code - 1] + " ".join(f"{x:.2f} {y:.2f}" for x, y in vertices[i : i + count]))
        i += count
    return "".join(parts)


def _is_canvas(canvas: SvgCanvas) -> Canvas:
    """Let the type checker prove that `SvgCanvas` implements the protocol."""
    return canvas
