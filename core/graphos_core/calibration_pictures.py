"""Pictures of a calibration: residuals over the format, coverage, distortion with its confidence, network, board."""

from __future__ import annotations

import base64
import io
from typing import Any

import numpy as np

from graphos_core.adjustment.calibration.board import BoardShape
from graphos_core.adjustment.calibration.calibrate import Calibration
from graphos_core.adjustment.calibration.findings import coverage
from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.cameras.chain import without_distortion
from graphos_core.data import Adjustment, Array, Block, Camera

ACCENT = "#0b6bcb"
SECOND = "#c2571a"
ARROW_SHARE = 0.03
"""Length of the arrow of a large residual as a share of the format."""


def calibration_pictures(found: Calibration) -> list[dict[str, str]]:
    """Return pictures as SVG data URLs with title and caption, for a page."""
    result, block = found.adjustment, found.adjustment.block
    pictures = []
    used = np.unique(block.camera_of_photo[block.oriented])
    for c in used:
        name = f": {block.cameras[c].label or f'camera {c + 1}'}" if len(used) > 1 else ""
        pictures += [
            (f"Residuals over the format{name}", *residual_figure(result, int(c))),
            (f"Coverage of the format{name}", coverage_figure(block, int(c)),
             "Number of measured points in each part of the format. Where there are none, the distortion is extrapolated."),
            (f"Distortion{name}", *profile_figure(block.cameras[c])),
        ]  # fmt: skip
    pictures.append((
        "Network", network_figure(block),
        "Board and photos from the side and from above, in mm. Tilted photos separate principal distance and distance.",
    ))  # fmt: skip
    if found.board is not None:
        pictures.append((
            "Board", board_figure(block.points, found.board),
            "Deviation of the board from its drawing, from an adjustment with its points free: colour out of the plane, "
            "arrows in the plane (exaggerated).",
        ))  # fmt: skip
    return [{"title": t, "image": svg_url(figure), "caption": caption} for t, figure, caption in pictures]


def svg_url(figure: Any) -> str:
    """Return a figure as an SVG data URL."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()


def png_bytes(figure: Any, dpi: int = 110) -> bytes:
    """Return a figure as PNG."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()


def _figure(width: float, height: float, columns: int = 1) -> tuple[Any, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained", facecolor="white")
    return figure, figure.subplots(1, columns)


def _format_axes(axes: Any, camera: Camera) -> None:
    axes.set_xlim(-0.5, camera.width - 0.5)
    axes.set_ylim(camera.height - 0.5, -0.5)
    axes.set_aspect("equal")
    axes.set_xlabel("x [px]")
    axes.set_ylabel("y [px]")


def residual_figure(result: Adjustment, c: int) -> tuple[Any, str]:
    """Draw the residual vectors of all photos of a camera over its format; figure and caption."""
    block, camera = result.block, result.block.cameras[c]
    mine = block.camera_of_photo[block.obs_photo] == c
    xy, v = block.obs_xy[mine], result.residuals[mine]
    length = np.hypot(*v.T)
    large = float(np.percentile(length, 95)) or 1.0
    scale = ARROW_SHARE * max(camera.width, camera.height) / large
    figure, axes = _figure(8.0, 6.6 * camera.height / camera.width + 0.6)
    arrows = axes.quiver(
        *xy.T, *(scale * v).T, length, angles="xy", scale_units="xy", scale=1.0, cmap="viridis_r", width=0.0018,
        clim=(0.0, large),
    )  # fmt: skip
    axes.plot(camera.values[1], camera.values[2], "+", color=SECOND, markersize=12, markeredgewidth=2)
    _format_axes(axes, camera)
    figure.colorbar(arrows, ax=axes, label="length of the residual [px]", shrink=0.8, extend="max")
    caption = (
        f"Residuals (projected − measured) of all photos, arrows {scale:.0f} times their length; + is the principal "
        "point. No pattern should be seen: circles or streams say that the camera model is too simple."
    )
    return figure, caption


def coverage_figure(block: Block, c: int) -> Any:
    """Draw where points were measured, and how many there are in each part of the format."""
    camera = block.cameras[c]
    counts = coverage(block, c)
    figure, axes = _figure(8.0, 6.6 * camera.height / camera.width + 0.6)
    extent = (-0.5, camera.width - 0.5, camera.height - 0.5, -0.5)
    shown = axes.imshow(counts, extent=extent, cmap="cividis", alpha=0.75, aspect="equal")
    xy = block.obs_xy[block.camera_of_photo[block.obs_photo] == c]
    axes.plot(*xy.T, ".", color="white", markersize=2.0)
    rows, columns = counts.shape
    for i in range(rows):
        for j in range(columns):
            place = ((j + 0.5) * camera.width / columns - 0.5, (i + 0.5) * camera.height / rows - 0.5)
            axes.annotate(str(counts[i, j]), place, ha="center", va="center", fontsize=11, color="black",
                          bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.75})  # fmt: skip
    _format_axes(axes, camera)
    figure.colorbar(shown, ax=axes, label="points", shrink=0.8)
    return figure


def profile_figure(camera: Camera) -> tuple[Any, str]:
    """Draw the displacement by distortion along the diagonals from the principal point; figure and caption."""
    corners = np.array(
        [[0.0, 0.0], [camera.width - 1, 0], [camera.width - 1, camera.height - 1], [0, camera.height - 1]]
    )
    share = np.linspace(0.02, 1.0, 60)
    figure, axes = _figure(8.0, 3.4)
    axes.axhline(0.0, color="#888888", linewidth=0.8)
    for corner, style in zip(corners, ("-", "--", "-.", ":"), strict=True):
        measured = camera.values[1:3] + share[:, None] * (corner - camera.values[1:3])
        displacement, radius = _displacement(camera, measured)
        axes.plot(radius, displacement, style, color=ACCENT, linewidth=1.4)
    axes.set_xlabel("distance from the principal point [px]")
    axes.set_ylabel("displacement [px]")
    axes.spines[["top", "right"]].set_visible(False)
    return figure, (
        "Radial displacement by distortion (measured − ideal position) from the principal point to the four corners. "
        "Negative: towards the centre (barrel)."
    )


def _displacement(camera: Camera, measured: Array) -> tuple[Array, Array]:
    """Return the outward displacement by distortion and the distance from the principal point, px."""
    plain = without_distortion(camera)
    ideal = pixel_from_ray(plain, ray_from_pixel(camera, measured))
    offset = measured - camera.values[1:3]
    radius = np.hypot(*offset.T)
    outward: Array = ((measured - ideal) * offset).sum(axis=1) / np.maximum(radius, 1e-9)
    return outward, radius


def network_figure(block: Block) -> Any:
    """Draw board and viewing axes from the side and from above, mm."""
    figure, axes = _figure(8.0, 3.8, 2)
    centres = 1000 * block.centres[block.oriented]
    forward = block.rotations[block.oriented, 2]
    points = 1000 * block.points
    middle = points.mean(axis=0)
    length = 0.25 * float(np.median(np.linalg.norm(centres - middle, axis=1)))
    for ax, across, label in ((axes[0], 0, "x"), (axes[1], 1, "y")):
        ax.plot(points[:, across], -points[:, 2], ".", color="#555555", markersize=3)
        ends = centres + length * forward
        for a, b in zip(centres, ends, strict=True):
            ax.plot([a[across], b[across]], [-a[2], -b[2]], "-", color=ACCENT, linewidth=1.0)
        ax.plot(centres[:, across], -centres[:, 2], "o", color=ACCENT, markersize=4)
        ax.set_xlabel(f"{label} along the board [mm]")
        ax.set_ylabel("height above the board [mm]")
        ax.set_aspect("equal", adjustable="datalim")
        ax.spines[["top", "right"]].set_visible(False)
    return figure


def board_figure(points: Array, shape: BoardShape) -> Any:
    """Draw the deviations of the board from its drawing, mm."""
    figure, axes = _figure(8.0, 4.6)
    xy, d = 1000 * points[:, :2], 1000 * shape.deviations
    reach = float(np.abs(d[:, 2]).max()) or 1.0
    drawn = axes.scatter(
        *xy.T, c=-d[:, 2], cmap="RdBu_r", vmin=-reach, vmax=reach, s=70, edgecolors="#555555", linewidths=0.5
    )
    arrow = 0.04 * float(np.ptp(xy, axis=0).max()) / (float(np.percentile(np.hypot(*d[:, :2].T), 95)) or 1.0)
    axes.quiver(
        *xy.T, *(arrow * d[:, :2]).T, angles="xy", scale_units="xy", scale=1.0, width=0.003, color="#222222"
    )
    axes.invert_yaxis()
    axes.set_aspect("equal")
    axes.margins(0.08)
    axes.set_xlabel(f"x [mm], arrows × {arrow:.0f}")
    axes.set_ylabel("y [mm]")
    axes.spines[["top", "right"]].set_visible(False)
    figure.colorbar(drawn, ax=axes, label="above the plane [mm]", shrink=0.85)
    return figure
