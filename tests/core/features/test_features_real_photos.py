"""SIFT, matching, verification and tracks on real photos, against the reference orientation and homography."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from graphos_core.cameras import ray_from_pixel
from graphos_core.data import Camera
from graphos_core.exchange.colmap import read_colmap
from graphos_core.features.detectors.sift import SiftParams, sift
from graphos_core.features.matchers.mutual import MutualParams, mutual
from graphos_core.features.stage import detect_all, match_all
from graphos_core.features.tracks import TrackParams, tracks
from graphos_core.features.verification import UsacParams, usac
from graphos_core.geometry.epipolar import fundamental_from_cameras, sampson_distances
from graphos_core.images import read_photo_set, read_pixels
from graphos_core.registry import find
from graphos_core.run import Run

pytestmark = pytest.mark.data
RUN = Run()


def ideal(camera: Camera, xy: np.ndarray) -> np.ndarray:
    return ray_from_pixel(camera, xy.astype(np.float64))[:, :2] * camera.focal_px + camera.values[1:3]


def test_verified_matches_of_the_door_agree_with_the_reference_orientation(data_dir: Path) -> None:
    photos = read_photo_set(sorted((data_dir / "lund_door" / "images").iterdir())[3:7], run=RUN)
    truth = read_colmap(data_dir / "lund_door" / "colmap_ground_truth")
    (camera,) = truth.cameras
    poses = dict(zip(truth.names, zip(truth.rotations, truth.centres, strict=True), strict=True))

    def read(index: int) -> tuple[np.ndarray, np.ndarray]:
        colour = read_pixels(photos.photos[index])
        return cv2.cvtColor(colour, cv2.COLOR_RGB2GRAY), colour

    detector, matcher, check = (find("features", name) for name in ("sift", "mutual", "usac"))
    features = detect_all(4, read, detector, detector.params(), RUN)
    assert all(len(f.xy) == 8448 for f in features)
    pairs = match_all(features, photos.cameras * 4, (matcher, matcher.params()), (check, check.params()), RUN)
    assert all(pair.reason == "" and pair.kind == "essential" for pair in pairs)
    distances = []
    for pair in pairs:
        a, b = (photos.photos[index].name for index in (pair.a, pair.b))
        fundamental = fundamental_from_cameras(camera, *poses[a], camera, *poses[b])
        xy_a, xy_b = features[pair.a].xy[pair.matches[:, 0]], features[pair.b].xy[pair.matches[:, 1]]
        distances.append(sampson_distances(fundamental, ideal(camera, xy_a), ideal(camera, xy_b)))
    distance = np.concatenate(distances)
    assert len(distance) > 18_000
    assert np.median(distance) < 0.15  # px, as the data's description says of SIFT
    assert (distance < 2.0).mean() > 0.99
    found = tracks(features, pairs, TrackParams(), run=RUN)
    assert found.components == ((0, 1, 2, 3),)
    assert found.count > 7_000 and found.conflicts < 0.03 * found.count


@pytest.mark.parametrize("hellinger", [True, False])
def test_matches_of_the_graffiti_wall_agree_with_its_homography(data_dir: Path, hellinger: bool) -> None:
    folder = data_dir / "features"
    grey = [cv2.imread(str(folder / name), cv2.IMREAD_GRAYSCALE) for name in ("graf1.png", "graf3.png")]
    a, b = (sift(image, image, SiftParams(hellinger=hellinger), run=RUN) for image in grey)
    storage = cv2.FileStorage(str(folder / "H1to3p.xml"), cv2.FILE_STORAGE_READ)
    homography = storage.getFirstTopLevelNode().mat()
    matches = mutual(a, b, MutualParams(), run=RUN)

    def right(chosen: np.ndarray) -> np.ndarray:
        projected = cv2.perspectiveTransform(a.xy[chosen[:, 0]][None].astype(np.float64), homography)[0]
        return np.linalg.norm(projected - b.xy[chosen[:, 1]], axis=1) < 3.0

    # the description of the data names 354 of 632 for SIFT with the ratio test in one direction
    assert right(matches.matches).sum() > 300
    assert right(matches.matches).mean() > 354 / 632
    unknown = Camera(model="basic", width=800, height=640, values=np.array([960.0, 399.5, 319.5, 0.0, 0.0]),
                     focal_estimated=True)  # fmt: skip
    verified = usac((0, 1), a, b, matches, (unknown, unknown), UsacParams(threshold=2.0), run=RUN)
    assert right(verified.matches).mean() > right(matches.matches).mean()


def test_photos_of_different_objects_are_not_connected(data_dir: Path) -> None:
    paths = [data_dir / "lund_door" / "images" / "DSC_0001.JPG", data_dir / "features" / "leuvenA.jpg"]
    photos = read_photo_set(paths, run=RUN)
    features = [
        sift(read_pixels(photo, grey=True), read_pixels(photo), SiftParams(), run=RUN)
        for photo in photos.photos
    ]
    matches = mutual(*features, MutualParams(), run=RUN)
    cameras = (photos.cameras[photos.photos[0].camera], photos.cameras[photos.photos[1].camera])
    pair = usac((0, 1), *features, matches, cameras, UsacParams(), run=RUN)
    assert pair.reason
    assert pair.matches.shape == (0, 2)
