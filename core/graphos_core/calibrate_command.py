"""``graphos calibrate``: a camera calibrated with photos of a test field."""

from __future__ import annotations

import argparse
import csv
import io
import json
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from graphos_core.adjustment.calibration.calibrate import CalibrateParams, Calibration, calibrate_camera
from graphos_core.adjustment.calibration.drawing import draw_target, target_svg
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.calibration_pictures import coverage_figure, png_bytes, residual_figure
from graphos_core.calibration_report import calibration_html, calibration_report
from graphos_core.data import Adjustment
from graphos_core.exchange.calibration_file import write_calibration
from graphos_core.images import read_photo_set
from graphos_core.number_format import format_value
from graphos_core.outputs import check_writable
from graphos_core.params import Params
from graphos_core.run import Run
from graphos_core.store import cannot_write, write_bytes, write_text


def sheet_of(options: argparse.Namespace, sheet: type[Params]) -> dict[str, Any]:
    """Return the values of a parameter sheet that were given on the command line, parsed as declared."""
    given = ((name, getattr(options, name, None)) for name in sheet.declarations())
    return {
        name: sheet.declarations()[name].parse(value) if isinstance(value, str) else value
        for name, value in given
        if value is not None
    }


def calibrate(options: argparse.Namespace) -> int:
    """``graphos calibrate``: photos of a test field to a calibrated camera."""
    from graphos_core.commands import console

    if options.calibration is not None:
        options.calibration = options.calibration.replace("-", "_")  # as graphos run spells them
    params = CalibrateParams.from_dict(sheet_of(options, CalibrateParams))
    check_writable(options.out)
    progress = console(options, options.seed or 0)
    source = options.photos[0] if len(options.photos) == 1 else options.photos
    report = calibrate_folder(source, options.out, params, focal_px=options.focal_px, run=progress)
    for camera in report["cameras"]:
        for parameter in camera["parameters"]:
            shown = format_value(parameter["value"], parameter["sigma"], parameter["unit"], digits=6)
            label = f"{parameter['label']} {parameter['symbol'].replace('_', '')}"
            print(f"{label:34} {shown}{'' if parameter['sigma'] else ' (held fixed)'}")
    rms = report["orientation"]["reprojection_rms_px"]
    print(f"{'Photos with the target':34} {report['images']['oriented']} of {report['images']['total']}")
    print(f"{'Reprojection RMS (per coordinate)':34} {rms:.3f} px")
    print(f"{'Report':34} {options.out / 'report.html'}")
    return 0


def target(options: argparse.Namespace) -> int:
    """``graphos target``: a test field as SVG in true scale."""
    drawing = draw_target(TargetParams.from_dict(sheet_of(options, TargetParams)))
    check_writable(options.out.absolute().parent)
    write_text(options.out, target_svg(drawing))
    x0, y0, x1, y1 = drawing.frame
    print(
        f"{options.out}: {x1 - x0:g} × {y1 - y0:g} mm and a line of text; print at 100 % and measure the line"
    )
    return 0


def calibrate_folder(
    source: Path | Sequence[Path],
    out: Path,
    params: CalibrateParams,
    *,
    focal_px: float | None = None,
    run: Run,
) -> dict[str, Any]:
    """Calibrate with the photos of a folder (or a list of files) and write everything; return the report.

    Written are ``report.json``, ``report.html``, ``calibration.toml``, ``observations.csv``, and
    ``pictures/residuals_N.png`` and ``coverage_N.png`` per camera.

    Raises
    ------
    UserError
        When there is nothing to calibrate, or the folder cannot be written.
    Stopped
    """
    photos = read_photo_set(source, run=run, focal_px=focal_px)
    for failure in photos.failures:
        run.warn(f"{failure.item} is not used: {failure.reason}")
    found = calibrate_camera(photos, params, run=run)
    for failure in found.adjustment.block.failures:
        run.warn(f"{failure.item} is not used: {failure.reason}")
    made = datetime.now(UTC).isoformat(timespec="seconds")
    name = (source if isinstance(source, Path) else source[0].parent).resolve().name
    report = calibration_report(name, found, photos, params, seed=run.seed, made=made)
    try:
        write_calibration_folder(out, report, found)
    except OSError as problem:
        raise cannot_write(out, problem) from problem
    return report


def write_calibration_folder(out: Path, report: dict[str, Any], found: Calibration) -> None:
    """Write report, calibration, observations and pictures of a calibration to a folder."""
    block = found.adjustment.block
    used = np.unique(block.camera_of_photo[block.oriented])
    write_calibration(out / "calibration.toml", [block.cameras[c] for c in used])
    write_text(out / "observations.csv", _observations(found.adjustment, found))
    for number, c in enumerate(used, 1):
        residuals, _ = residual_figure(found.adjustment, int(c))
        write_bytes(out / "pictures" / f"residuals_{number}.png", png_bytes(residuals))
        write_bytes(out / "pictures" / f"coverage_{number}.png", png_bytes(coverage_figure(block, int(c))))
    write_text(out / "report.html", calibration_html(report, found))
    write_text(
        out / "report.json", json.dumps(report, indent=1, ensure_ascii=False, allow_nan=False, default=str)
    )


def _observations(result: Adjustment, found: Calibration) -> str:
    block = result.block
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["photo", "point", "x [px]", "y [px]", "sigma [px]", "vx [px]", "vy [px]"])
    order = np.lexsort((block.obs_point, block.obs_photo))
    for i in order:
        values = (*block.obs_xy[i], found.sigma_detection[i], *result.residuals[i])
        point = int(block.point_track[block.obs_point[i]])
        table.writerow([block.names[block.obs_photo[i]], point, *(f"{v:.5f}" for v in values)])
    return text.getvalue()
