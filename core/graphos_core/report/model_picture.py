"""The model with its cameras as a picture, and the two pictures of a lab's hand-in."""

from __future__ import annotations

import base64

import cv2
import numpy as np

from graphos_core.data import Array, Block
from graphos_core.number_format import format_value
from graphos_core.pipeline import Pipeline
from graphos_core.report.residual_pictures import residual_histogram
from graphos_core.text import Text


def report_pictures(pipeline: Pipeline) -> dict[str, str]:
    """Return data URLs by name: ``model`` with ``model_caption``, ``residuals``; empty where missing."""
    model, caption = overview(pipeline)
    adjusted, residuals = pipeline.result("adjustment"), ""
    if adjusted is not None:
        markup = residual_histogram(adjusted.adjustment.residuals).svg
        residuals = "data:image/svg+xml;base64," + base64.b64encode(markup.encode()).decode()
    return {"model": model, "model_caption": caption, "residuals": residuals}


def overview(pipeline: Pipeline) -> tuple[str, str]:
    """Return the model with its cameras as a data URL, and its caption; both empty before the adjustment."""
    adjusted, dense = pipeline.result("adjustment"), pipeline.result("dense")
    if adjusted is None:
        return "", ""
    block = adjusted.adjustment.block
    points, colours, what = block.points, block.colours, Text("object points")
    if dense is not None and len(dense.cloud.points):
        points, colours, what = dense.cloud.points, dense.cloud.colours, Text("points of the dense cloud")
    up = upward(block, adjusted.georeference.method)
    caption = Text("{n} {what}, and the cameras.", n=format_value(len(points)), what=what)
    return _jpeg(model_picture(block, points, colours, up)), caption


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
