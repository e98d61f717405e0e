"""Pictures of the report, as data URLs: the model with its cameras, residuals, distances."""

from __future__ import annotations

import base64
import io
from typing import Any

import cv2
import numpy as np

from graphos_core.data import Array, Block
from graphos_core.number_format import format_value
from graphos_core.pipeline import Pipeline
from graphos_core.text import Text

ACCENT = "#0b6bcb"


def report_pictures(pipeline: Pipeline) -> dict[str, str]:
    """Return data URLs by name: ``model`` with ``model_caption``, ``residuals``, ``distances``; empty where missing."""
    pictures = {"model": "", "model_caption": "", "residuals": "", "distances": ""}
    adjusted, dense, quality = (pipeline.result(s) for s in ("adjustment", "dense", "quality"))
    if adjusted is not None:
        block = adjusted.adjustment.block
        points, colours = block.points, block.colours
        if dense is not None and len(dense.cloud.points):
            points, colours = dense.cloud.points, dense.cloud.colours
        pictures["model"] = _jpeg(
            model_picture(block, points, colours, upward(block, adjusted.georeference.method))
        )
        what = "dense cloud" if dense is not None else "object points"
        pictures["model_caption"] = Text(
            "{n} points of the {what}, and the cameras.", n=format_value(len(points)), what=what
        )
        pictures["residuals"] = _histogram(
            adjusted.adjustment.residuals.ravel(), "image residual per coordinate", "px"
        )
    if quality is not None and quality.comparison is not None and len(quality.comparison.distances):
        c = quality.comparison
        scale, unit = (1000.0, "mm") if c.unit == "m" else (1.0, c.unit)
        pictures["distances"] = _histogram(scale * c.distances, "signed distance from the reference", unit)
    return pictures


def model_picture(
    block: Block, points: Array, colours: Array, up: Array, width: int = 1400, height: int = 800
) -> Array:
    """Draw the cloud from above and beside the mean viewing direction, with camera pyramids; uint8 (h, w, 3)."""
    from graphos_core.rendering import Lines, ViewCamera, camera_pyramids, render_cloud

    rotations, centres = block.rotations[block.oriented], block.centres[block.oriented]
    cameras = [block.cameras[c] for c in block.camera_of_photo[block.oriented]]
    low, high = np.percentile(points, (2, 98), axis=0)
    kept = ((points > low - 0.5 * (high - low)) & (points < high + 0.5 * (high - low))).all(axis=1)
    points, colours = points[kept], colours[kept]
    forward = rotations[:, 2].mean(axis=0)
    sideways = np.cross(forward, up)
    view = ViewCamera.looking(forward + 0.5 * sideways - 0.3 * up, up=up)
    size = 0.12 * float(np.linalg.norm(high - low))
    starts, ends, _ = camera_pyramids(rotations, centres, cameras, size)
    colour = np.tile(np.array([11, 107, 203], np.uint8), (starts.shape[0] * 8, 1))
    lines = Lines(starts.reshape(-1, 3), ends.reshape(-1, 3), colour)
    view = view.fitted(np.vstack([points[:: max(1, len(points) // 20000)], centres]), width, height)
    return render_cloud(points, colours, view, width, height, lines=[lines])


def upward(block: Block, method: str) -> Array:
    """Return the upward direction (3,): z where control points placed the block, else the one most photos call up."""
    if method == "control points":
        return np.array([0.0, 0.0, 1.0])
    ups = -block.rotations[block.oriented, 1]
    votes = np.clip(ups @ ups.T, 0.0, None).sum(axis=1)
    return np.asarray(ups[np.argmax(votes)])


def _jpeg(image: Array) -> str:
    _, encoded = cv2.imencode(".jpg", image[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, 88])
    return "data:image/jpeg;base64," + base64.b64encode(encoded.tobytes()).decode()


def _histogram(values: Array, label: str, unit: str) -> str:
    """Draw a histogram with the normal curve of the same NMAD, as an SVG data URL."""
    from matplotlib.figure import Figure

    values = np.asarray(values, dtype=np.float64)
    values = values[np.isfinite(values)]
    centre = float(np.median(values))
    spread = 1.4826 * float(np.median(np.abs(values - centre))) or float(values.std()) or 1.0
    edges = np.linspace(centre - 5 * spread, centre + 5 * spread, 101)
    figure = Figure(figsize=(9, 2.8), layout="constrained")
    axes: Any = figure.subplots()
    counts, _, _ = axes.hist(
        values, edges, color=ACCENT, alpha=0.75, label=f"{format_value(len(values))} values"
    )
    middle = 0.5 * (edges[1:] + edges[:-1])
    normal = np.exp(-0.5 * ((middle - centre) / spread) ** 2)
    normal *= counts.sum() / max(normal.sum(), 1e-300)
    axes.plot(middle, normal, color="#333333", linewidth=1.2, label=f"normal with NMAD = {spread:.3g} {unit}")
    axes.set_xlabel(f"{label} [{unit}]")
    axes.set_ylabel("count")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()
