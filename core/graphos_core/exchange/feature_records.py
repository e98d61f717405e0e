"""Keypoints, descriptors and matches of photos as a record, whatever file they came from."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from graphos_core.data import Array, Camera, Features, PairMatches


@dataclass(frozen=True)
class PhotoFeatures:
    """Keypoints and descriptors of one photo.

    Attributes
    ----------
    xy : float64 (n, 2)
        Px, centre of the top-left pixel at (0, 0).
    scale, angle, response : float64 (n,)
        As in `graphos_core.data.Features`; 1 px, 0 and 0 where a file does not tell.
    descriptors : uint8 or float32 (n, d)
        d = 0 where a file has none.
    metric : {"l2", "hamming"}
    """

    xy: Array
    scale: Array
    angle: Array
    response: Array
    descriptors: Array
    metric: str = "l2"

    @classmethod
    def of(cls, features: Features) -> PhotoFeatures:
        """Take over the features of a photo."""
        return cls(
            features.xy.astype(np.float64), features.scale.astype(np.float64), features.angle.astype(np.float64),
            features.response.astype(np.float64), features.descriptors, features.metric,
        )  # fmt: skip


@dataclass(frozen=True)
class FeatureFiles:
    """What files hold of the features of a set of photos.

    Attributes
    ----------
    photos : tuple of str
        Names.
    features : tuple of PhotoFeatures
        Of each photo.
    pairs : tuple of PairMatches
        Indices of photos and features count in the above; with matrices where the file has them.
    cameras : tuple of Camera
        Of each photo; empty where the file has none.
    remarks : tuple of str
        What was left out.
    """

    photos: tuple[str, ...]
    features: tuple[PhotoFeatures, ...]
    pairs: tuple[PairMatches, ...] = ()
    cameras: tuple[Camera, ...] = ()
    remarks: tuple[str, ...] = field(default=())


def plain_pair(a: int, b: int, matches: Array) -> PairMatches:
    """Return matches int (n, 2) of which no geometry is known, with a < b."""
    if a > b:
        a, b, matches = b, a, matches[:, ::-1]
    return PairMatches(
        a=a, b=b, matches=np.ascontiguousarray(matches, dtype=np.int32).reshape(-1, 2), candidates=len(matches), kind="none",
        matrix=np.zeros((3, 3)),
    )  # fmt: skip
