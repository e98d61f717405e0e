"""Frozen records: what flows from stage to stage. Nothing here computes."""

from graphos_core.data.block import Adjustment, Block, IterationRecord
from graphos_core.data.cameras import Camera
from graphos_core.data.cloud import Cloud, DepthMap, Mesh
from graphos_core.data.control import Control, ControlObservations, Georeference, KnownDistance
from graphos_core.data.features import Features
from graphos_core.data.images import Exif, Photo, PhotoSet
from graphos_core.data.matches import PairMatches, Tracks
from graphos_core.data.record import Array, record

__all__ = [
    "Adjustment",
    "Array",
    "Block",
    "Camera",
    "Cloud",
    "Control",
    "ControlObservations",
    "DepthMap",
    "Exif",
    "Features",
    "Georeference",
    "IterationRecord",
    "KnownDistance",
    "Mesh",
    "PairMatches",
    "Photo",
    "PhotoSet",
    "Tracks",
    "record",
]
