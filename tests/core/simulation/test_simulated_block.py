"""The written block: complete, repeatable byte for byte, and compared with results rightly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Block
from graphos_core.errors import Stopped, UserError
from graphos_core.exchange.control import read_control
from graphos_core.geometry.rotation import matrix_from_vector
from graphos_core.geometry.similarity import Similarity
from graphos_core.run import Run
from graphos_core.simulation.comparison import camera_centre_errors, coverage, surface_errors
from graphos_core.simulation.control_targets import CONTROL_SIGMA_PX
from graphos_core.simulation.photo_block import load_truth, simulate_photos

SIZE = {"width": 320, "height": 240, "photos": 3}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("block")
    simulate_photos("facade", out, seed=5, run=Run(threads=2), **SIZE)
    return out


@pytest.fixture(scope="module")
def truth(folder):
    return load_truth(folder)


def files(folder: Path) -> dict[str, bytes]:
    return {
        p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()
    }


def test_same_seed_gives_the_same_bytes_with_one_and_two_threads(folder, tmp_path):
    simulate_photos("facade", tmp_path, seed=5, run=Run(threads=1), **SIZE)
    a, b = files(folder), files(tmp_path)
    assert sorted(a) == sorted(b)
    assert [name for name in a if a[name] != b[name]] == []


def test_the_block_holds_photos_depth_mesh_and_control(folder):
    names = set(files(folder))
    assert {f"photos/facade_00{i}.jpg" for i in (1, 2, 3)} <= names
    assert {f"truth/depth/facade_00{i}.npz" for i in (1, 2, 3)} <= names
    assert {"truth/cameras.json", "truth/mesh.ply", "control.csv", "control_measurements.csv"} <= names


def test_true_depth_and_pose_put_every_pixel_on_the_true_surface(truth):
    from graphos_core.simulation.renderer import ray_grid

    rays = ray_grid(truth.cameras[0]).centre
    for i in range(3):
        depth = truth.depth(i)
        assert depth.dtype == np.float32 and depth.shape == (240, 320)
        y, x = np.nonzero(np.isfinite(depth))
        points = (rays[y, x] * depth[y, x, None].astype(np.float64)) @ truth.rotations[i] + truth.centres[i]
        assert np.quantile(surface_errors(points, truth.mesh).distances, 0.999) < 2e-4


def test_target_measurements_are_projections_with_the_documented_noise(folder, truth):
    control, measured = read_control(folder / "control.csv")
    assert control is not None and measured is not None
    assert control.check.any() and (~control.check).sum() >= 3
    place = [truth.names.index(name) for name in measured.photo]
    local = np.einsum(
        "nij,nj->ni",
        truth.rotations[place],
        control.xyz[measured.point] + control.origin - truth.centres[place],
    )
    noise = measured.xy - pixel_from_ray(truth.cameras[0], local)
    assert len(noise) > 15
    assert noise.std() == pytest.approx(CONTROL_SIGMA_PX, rel=5 / np.sqrt(2 * noise.size))


@pytest.mark.parametrize("template", ["couple", "triple", "grid", "orbital"])
def test_every_template_can_be_photographed_and_sees_its_object_in_the_middle(template, tmp_path):
    made = simulate_photos(template, tmp_path, width=96, height=72, photos=2)
    truth = load_truth(tmp_path)
    assert len(made.names) == len(truth.names) == 2
    for i in range(2):
        depth = truth.depth(i)
        assert np.isfinite(depth).mean() > 0.25
        assert depth[36, 48] == pytest.approx(truth.object_distance_m, rel=0.35)


def test_stopping_ends_the_simulation_without_an_index(tmp_path):
    run = Run()
    run.stop()
    with pytest.raises(Stopped):
        simulate_photos("couple", tmp_path, run=run, width=96, height=72)
    assert not (tmp_path / "truth" / "cameras.json").exists()


def test_photos_of_another_block_in_the_folder_are_not_mixed_in(tmp_path):
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "holiday.jpg").write_bytes(b"mine")
    with pytest.raises(UserError, match="other photos"):
        simulate_photos("facade", tmp_path, **SIZE)
    assert (tmp_path / "photos" / "holiday.jpg").read_bytes() == b"mine"


def test_a_folder_without_truth_is_refused(tmp_path):
    with pytest.raises(UserError, match="no complete simulated block"):
        load_truth(tmp_path)


def block_of(truth, similarity, shift=0.0):
    """The truth seen through a similarity, as an adjustment without control leaves it."""
    n = len(truth.names)
    empty = np.zeros(0, np.int32)
    return Block(
        cameras=truth.cameras, names=truth.names, camera_of_photo=truth.camera_of_photo, oriented=np.ones(n, bool),
        rotations=similarity.rotate_camera(truth.rotations), centres=similarity.apply(truth.centres + shift),
        points=np.zeros((0, 3)), colours=np.zeros((0, 3), np.uint8), point_track=empty, obs_photo=empty,
        obs_point=empty, obs_xy=np.zeros((0, 2)),
    )  # fmt: skip


def test_centre_errors_vanish_for_the_truth_in_another_frame(truth):
    away = Similarity(0.3, matrix_from_vector(np.array([0.3, -0.8, 0.2])), np.array([4.0, -1.0, 2.0]))
    errors = camera_centre_errors(block_of(truth, away), truth)
    assert errors.rms_m < 1e-9 and errors.rotation_errors.max() < 1e-7
    assert errors.similarity.scale == pytest.approx(1 / 0.3)


def test_centre_errors_find_an_injected_error(truth):
    same = Similarity(1.0, np.eye(3), np.zeros(3))
    shift = np.zeros((3, 3))
    shift[0, 2] = 0.05
    errors = camera_centre_errors(block_of(truth, same, shift), truth)
    assert 0.0 < errors.rms_m <= np.sqrt((shift**2).sum() / 3)  # the similarity takes up a part, never adds
    assert errors.relative == pytest.approx(errors.rms_m / truth.object_distance_m)


def test_surface_errors_are_the_distance_by_which_a_cloud_was_lifted(truth):
    seen = coverage(np.zeros((0, 3)), truth, 0.05, samples=20_000).seen
    wall = seen[np.abs(seen[:, 1]) < 1e-6]
    assert len(wall) > 100
    result = surface_errors(wall - [0.0, 0.004, 0.0], truth.mesh)
    assert result.median_m == pytest.approx(0.004, abs=1e-5)
    assert result.share_within(0.0041) > 0.9 and result.share_within(0.003) < 0.1


def test_coverage_is_the_share_of_the_seen_surface_that_the_cloud_holds(truth):
    first = coverage(np.zeros((0, 3)), truth, 0.01, samples=20_000)
    assert first.share == 0.0 and len(first.seen) > 1000
    assert coverage(first.seen, truth, 0.01, samples=20_000).share == 1.0
    left = first.seen[first.seen[:, 0] < np.median(first.seen[:, 0])]
    assert coverage(left, truth, 0.01, samples=20_000).share == pytest.approx(0.5, abs=0.02)
