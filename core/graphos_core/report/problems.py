"""Problems first: what the adjustment found, photos without orientation, and warnings, the worst on top."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from graphos_core.data import Adjustment
from graphos_core.pipeline import Pipeline
from graphos_core.registry import STAGES
from graphos_core.steps import steps_of
from graphos_core.text import Text

ORDER = ("error", "warning", "info")


def problems(report: dict[str, Any], adjustment: Adjustment | None) -> list[dict[str, Any]]:
    """Return the part ``problems``: findings of the adjustment, photos left out, then warnings not yet said."""
    found: list[dict[str, Any]] = []
    if adjustment is not None:
        found += [asdict(f) for f in adjustment.findings]
        if not adjustment.converged and not any(f.learn == "adjustment/solver" for f in adjustment.findings):
            found.append(_problem(
                "error", Text("The adjustment did not converge: {why}.", why=adjustment.stop_reason),
                todo=Text("Allow more iterations, or look for outliers and weak photos."), learn="adjustment/solver",
            ))  # fmt: skip
    found += [
        _problem("warning", Text("{name} is not oriented: {reason}", name=f["name"], reason=f["reason"]),
                 learn="adjustment/overlap", items=(f["name"],))
        for f in report["images"]["not_oriented"]
    ]  # fmt: skip
    said = " ".join(f"{f['what']} {f['why']}" for f in found)
    found += [_problem("warning", line) for line in report["warnings"] if line not in said]
    return sorted(found, key=lambda f: ORDER.index(f["severity"]) if f["severity"] in ORDER else 0)


def _problem(
    severity: str, what: str, *, todo: str = "", learn: str = "", items: tuple[str, ...] = ()
) -> dict[str, Any]:
    return {"severity": severity, "what": what, "why": "", "todo": todo, "learn": learn, "items": items}


def warnings(pipeline: Pipeline) -> list[str]:
    """Return the part ``warnings``: everything the steps warned of, once each."""
    found: list[str] = []
    for camera in pipeline.photos.cameras:
        if camera.focal_estimated:
            found.append(Text(
                "The principal distance of {label} is an estimate: {source}", label=camera.label or "the camera",
                source=camera.focal_source))  # fmt: skip
    for failure in pipeline.photos.failures:
        found.append(Text("{item} is not used: {reason}", item=failure.item, reason=failure.reason))
    for stage in STAGES:
        for step in steps_of(stage):
            if pipeline.has(step.name):
                found.extend(pipeline.about(step.name).get("warnings", []))
    return list(dict.fromkeys(str(f) for f in found))
