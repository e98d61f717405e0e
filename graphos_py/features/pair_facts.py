"""What is said about a pair of photos: the steps of its funnel, and what its geometry means."""

from __future__ import annotations

from collections.abc import Sequence

from graphos_core.data import PairMatches
from graphos_core.number_format import THIN_SPACE, format_value
from graphos_py.translation import tr

STEPS = {
    "keypoints": "keypoints",
    "nearest": "nearest neighbours",
    "ratio": "ratio test",
    "mutual": "both directions",
    "discrepancy": "discrepancy filter",
    "in file": "in the file",
    "candidates": "candidates",
    "verified": "verified",
    "kept": "kept",
}
SCENES = {
    "general": "Depth is seen from two places: the pair determines object points.",
    "planar": "Only a plane is seen: a homography explains all matches. Points on the plane can be intersected, but the "
    "relative orientation has more than one solution; other pairs must decide.",
    "rotation": "The camera only turned: rays to a point are the same in both photos, so this pair determines no depth "
    "and no object points.",
}
KINDS = {
    "essential": "essential matrix",
    "fundamental": "fundamental matrix",
    "homography": "homography",
}


def named_steps(steps: Sequence[tuple[str, int]]) -> list[tuple[str, int]]:
    """Return a funnel with names for people; a step that is not known here keeps its own name."""
    return [(tr(STEPS.get(name, name)), int(count)) for name, count in steps]


def pair_sentence(pair: PairMatches) -> str:
    """Say what became of a pair and what its geometry means."""
    said = tr("{verified} verified of {candidates} candidates", verified=format_value(len(pair.matches)),
              candidates=format_value(pair.candidates))  # fmt: skip
    said = said.replace(THIN_SPACE, "\u202f")  # where a thin space would break the line
    if pair.kind in KINDS:
        said += ", " + tr(KINDS[pair.kind])
    parts = [f"{said}.", tr(pair.reason) if pair.reason else "", tr(SCENES.get(pair.scene, ""))]
    return " ".join(part for part in parts if part)
