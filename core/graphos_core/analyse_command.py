"""``graphos analyse``: the smart image analyser over a folder of photos."""

from __future__ import annotations

import argparse
import json
from functools import partial
from typing import Any

from graphos_core.data import Photo, PhotoSet
from graphos_core.errors import UserError
from graphos_core.images import read_photo_set, read_pixels
from graphos_core.number_format import format_value
from graphos_core.outputs import check_writable
from graphos_core.params import unknown_name
from graphos_core.preprocessing.analyser import AnalyserParams, SetVerdict, judge_set, measure_photo
from graphos_core.preprocessing.analyser_figures import PhotoFigures
from graphos_core.run import Run, map_items
from graphos_core.store import write_text
from graphos_core.text import Text

FIGURES = (
    "spots", "contrast", "hue_dispersion", "saturation_dispersion", "blur", "motion", "motion_direction", "black",
    "white", "mean", "noise",
)  # fmt: skip


def analyse_photos(photos: PhotoSet, params: AnalyserParams, run: Run) -> SetVerdict:
    """Measure all photos, each in a thread, and judge the set.

    Parameters
    ----------
    photos : PhotoSet
    params : AnalyserParams
    run : Run

    Raises
    ------
    Stopped
        When the person asked to stop.
    """
    figures: list[PhotoFigures] = map_items(run, partial(_measure, run=run), list(photos.photos), "photos")
    return judge_set(figures, params, run=run)


def _measure(photo: Photo, run: Run) -> PhotoFigures:
    run.check()
    return measure_photo(read_pixels(photo))


def analysis_document(photos: PhotoSet, verdict: SetVerdict, params: AnalyserParams) -> dict[str, Any]:
    """Return the verdict as plain values for ``analysis.json``.

    Keys: ``enhance, filters, reason, score, threshold, unit, duplicates`` (names and correlation), ``photos`` (name,
    verdict, remarks, score and the figures of `PhotoFigures`), ``unusable`` (file and reason), ``parameters``.
    """
    names = [photo.name for photo in photos.photos]
    return {
        "enhance": verdict.enhance,
        "filters": list(verdict.filters),
        "reason": str(verdict.reason),
        "score": verdict.score,
        "threshold": verdict.threshold,
        "unit": verdict.unit,
        "duplicates": [
            {"photos": [names[a], names[b]], "correlation": alike} for a, b, alike in verdict.duplicates
        ],
        "photos": [
            {
                "name": name,
                "verdict": one.verdict,
                "remarks": [str(remark) for remark in one.remarks],
                "score": one.score,
                **{figure: getattr(one.figures, figure) for figure in FIGURES},
            }
            for name, one in zip(names, verdict.photos, strict=True)
        ],
        "unusable": [{"file": item.item, "reason": str(item.reason)} for item in photos.failures],
        "parameters": params.to_dict(),
    }


def analyse(options: argparse.Namespace) -> int:
    """``graphos analyse``: a folder of photos to verdicts."""
    from graphos_core.commands import console

    params = _sheet(options.assignments)
    if options.out is not None:
        check_writable(options.out)
    run = console(options, options.seed or 0)
    source = options.photos[0] if len(options.photos) == 1 else options.photos
    photos = read_photo_set(source, run=run)
    verdict = analyse_photos(photos, params, run)
    for item in photos.failures:
        print(f"{item.item}: {item.reason}")
    width = max(len(photo.name) for photo in photos.photos)
    for photo, one in zip(photos.photos, verdict.photos, strict=True):
        figures = one.figures
        print(
            f"{photo.name:{width}}  {one.verdict:5} {format_value(figures.spots):>7} spots  blur {figures.blur:.2f}  "
            f"noise {figures.noise:4.1f}  " + " ".join(str(remark) for remark in one.remarks)
        )
    for a, b, alike in verdict.duplicates:
        print(Text("{a} and {b} show the same from the same place (correlation {alike:.4f}).",
                   a=photos.photos[a].name, b=photos.photos[b].name, alike=alike))  # fmt: skip
    print(verdict.reason)
    chain = ",".join(verdict.filters)
    print(
        f"Recommended: --set preprocessing.filter={chain}"
        if chain
        else "Recommended: leave the photos alone."
    )
    if options.out is not None:
        document = analysis_document(photos, verdict, params)
        write_text(options.out / "analysis.json", json.dumps(document, indent=1, ensure_ascii=False))
    return 0


def _sheet(assignments: list[str]) -> AnalyserParams:
    known = AnalyserParams.declarations()
    values = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals or name.strip() not in known:
            raise UserError(
                unknown_name(name.strip(), known, "parameter of the analyser"), todo="Write PARAMETER=VALUE."
            )
        values[name.strip()] = known[name.strip()].parse(text)
    return AnalyserParams.from_dict(values)
