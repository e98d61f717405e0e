"""Frozen records: what flows from stage to stage. Nothing here computes."""

from graphos_core.data.adjustment import (
    Adjustment,
    CheckPoints,
    Covariance,
    ExtraUnknown,
    Finding,
    GlobalTest,
    IterationRecord,
    ObservationGroup,
    Reliability,
    Significance,
)
from graphos_core.data.block import Block
from graphos_core.data.cameras import Camera
from graphos_core.data.cloud import Cloud, DepthMap, Mesh
from graphos_core.data.control import (
    Control,
    ControlObservations,
    Georeference,
    Known,
    KnownAttitudes,
    KnownCentres,
    KnownDistance,
    KnownRig,
    KnownShape,
)
from graphos_core.data.features import Features
from graphos_core.data.images import Exif, Photo, PhotoSet
from graphos_core.data.matches import Candidates, PairMatches, PairSelection, Tracks
from graphos_core.data.record import Array, record
from graphos_core.data.tree import OrientationTree

__all__ = [
    "Adjustment",
    "Array",
    "Block",
    "Camera",
    "Candidates",
    "CheckPoints",
    "Cloud",
    "Control",
    "ControlObservations",
    "Covariance",
    "DepthMap",
    "Exif",
    "ExtraUnknown",
    "Features",
    "Finding",
    "Georeference",
    "GlobalTest",
    "IterationRecord",
    "Known",
    "KnownAttitudes",
    "KnownCentres",
    "KnownDistance",
    "KnownRig",
    "KnownShape",
    "Mesh",
    "ObservationGroup",
    "OrientationTree",
    "PairMatches",
    "PairSelection",
    "Photo",
    "PhotoSet",
    "Reliability",
    "Significance",
    "Tracks",
    "record",
]
