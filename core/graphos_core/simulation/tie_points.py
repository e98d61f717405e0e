"""What the features room would hand over for a theoretical model: photos, tracks, verified pairs."""

from __future__ import annotations

import numpy as np

from graphos_core.data import Camera, Exif, PairMatches, Photo, PhotoSet, Tracks
from graphos_core.simulation.model import TheoreticalModel


def simulated_tie_points(
    model: TheoreticalModel, camera: Camera | None = None, fewest: int = 15
) -> tuple[PhotoSet, Tracks, list[PairMatches]]:
    """Return photos without files, a track per object point, and the pairs with enough common points.

    Parameters
    ----------
    model : TheoreticalModel
        Its noisy observations are the tracks.
    camera : Camera, optional
        What is known about the camera of all photos; by default the true cameras.
    fewest : int
        Common points from which a pair counts as verified.
    """
    names, count = model.stations.names, len(model.points)
    cameras = model.cameras if camera is None else (camera,)
    of_photo = np.asarray(model.camera_of_photo) if camera is None else np.zeros(len(names), np.int32)
    photos = tuple(
        Photo(name=f"{name}.jpg", path="", width=cameras[c].width, height=cameras[c].height, bits=8, channels=3,
              camera=int(c), digest=name, exif=Exif())
        for name, c in zip(names, of_photo, strict=True)
    )  # fmt: skip
    tracks = Tracks(
        photo=model.obs_photo, feature=np.zeros(len(model.obs_photo), np.int32), track=model.obs_point,
        xy=model.obs_xy, colour=np.zeros((count, 3), np.uint8), count=count,
    )  # fmt: skip
    seen = np.zeros((len(names), count), dtype=np.int64)
    seen[model.obs_photo, model.obs_point] = 1
    common = seen @ seen.T
    pairs = []
    for a in range(len(names)):
        for b in range(a + 1, len(names)):
            n = int(common[a, b])
            good = n >= fewest
            pairs.append(PairMatches(
                a=a, b=b, matches=np.zeros((n if good else 0, 2), np.int32), candidates=n,
                kind="essential" if good else "none", matrix=np.zeros((3, 3)), reason="" if good else "too few",
            ))  # fmt: skip
    return PhotoSet(photos=photos, cameras=cameras), tracks, pairs
