"""What the ribbon says about each step, from the session alone."""

from __future__ import annotations

from graphos_core.registry import STAGES, Stage
from graphos_py.ribbon import StepState
from graphos_py.session import Session
from graphos_py.translation import tr


def images_state(session: Session) -> StepState:
    """Return the state of the photos."""
    if session.project is None:
        return StepState("next", "add photos")
    photos = session.project.photo_set
    if len(photos.cameras) == 1:
        return StepState("done", tr("{n} photos · 1 camera", n=len(photos.photos)))
    return StepState("done", tr("{n} photos · {c} cameras", n=len(photos.photos), c=len(photos.cameras)))


def stage_state(session: Session, stage: Stage) -> StepState:
    """Return the state of a stage: running and failed are known to the session, the rest to the pipeline."""
    if session.pipeline is None:
        return StepState("not yet", "needs photos", "Open or make a project first.")
    if session.running == stage:
        return StepState("running", "stopping …" if session.stopping else "running")
    if stage in session.failed:
        problem = session.failed[stage]
        return StepState("failed", problem.what, " ".join(tr(p) for p in (problem.why, problem.todo) if p))
    state = session.pipeline.state(stage)
    return StepState(state.status, state.line, state.reason)


def why_not_all(session: Session) -> str:
    """Return why "Run all" is disabled; empty when it is not."""
    pipeline = session.pipeline
    if pipeline is None:
        return "Open or make a project first."
    if session.running is not None:
        return "A step is running."
    done = all(pipeline.state(stage).status == "done" for stage in STAGES)
    return "Everything is done with these parameters." if done else ""
