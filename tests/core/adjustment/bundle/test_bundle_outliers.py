"""Wrong observations, points behind cameras, and everything else that must not spoil an adjustment."""

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.adjust import Options, adjust_block
from graphos_core.adjustment.bundle.problem import Freedom
from graphos_core.adjustment.bundle.schur import adjust
from graphos_core.adjustment.bundle.sheet import BundleParams
from graphos_core.data import Known
from graphos_core.errors import Stopped, UserError
from graphos_core.geometry.similarity import estimate_similarity
from graphos_core.run import Run


class Listening(Run):
    def __init__(self, *, threads=1, stop_at=None):
        super().__init__(threads=threads)
        self.warnings, self.records, self.stop_at = [], [], stop_at

    def warn(self, text):
        self.warnings.append(text)

    def show(self, key, value):
        self.records.append(value)
        if self.stop_at is not None and len(self.records) > self.stop_at:
            self.stop()


def with_blunders(block, share, seed=0, size=60.0):
    rng = np.random.default_rng(seed)
    wrong = rng.random(len(block.obs_xy)) < share
    shifts = rng.uniform(-size, size, (int(wrong.sum()), 2))
    xy = block.obs_xy.copy()
    xy[wrong] += shifts + np.sign(shifts) * 5.0
    return replace(block, obs_xy=xy), wrong


def centre_error(block, truth):
    moved = estimate_similarity(block.centres, truth.centres).apply(block.centres)
    return float(np.sqrt(((moved - truth.centres) ** 2).mean()))


@pytest.mark.parametrize("robust", ["huber", "cauchy"])
def test_robust_weights_keep_blunders_from_pulling(make_block, robust):
    made = make_block(points=300)
    spoiled, wrong = with_blunders(made.start, 0.05)
    plain = adjust_block(spoiled)
    weighted = adjust_block(spoiled, options=Options(robust=robust, scale_px=1.0))
    good = adjust_block(made.start)
    truth = made.truth
    assert centre_error(weighted.block, truth) < 0.5 * centre_error(plain.block, truth)
    assert centre_error(weighted.block, truth) < 3.0 * centre_error(good.block, truth)
    assert weighted.weights[wrong].mean() < 0.3 < 0.7 < weighted.weights[~wrong].mean()


def test_the_stage_rejects_blunders_and_finds_the_noise(make_block):
    made = make_block(points=300)
    spoiled, wrong = with_blunders(made.start, 0.05)
    run = Listening()
    adjusted = adjust(spoiled, Known(), BundleParams(), run=run)
    gone = len(spoiled.obs_xy) - len(adjusted.block.obs_xy)
    assert 0.9 * wrong.sum() < gone < 1.3 * wrong.sum()
    assert adjusted.sigma0_px == pytest.approx(0.3, rel=0.05)
    error = adjusted.block.cameras[0].values - made.truth.cameras[0].values
    assert np.all(np.abs(error) < 4.0 * adjusted.block.cameras[0].sigmas)
    assert [r.iteration for r in adjusted.iterations] == list(range(len(adjusted.iterations)))
    assert not run.warnings


@pytest.mark.parametrize("robust", ["huber", "cauchy"])
def test_ten_percent_large_blunders_are_survived(make_block, robust):
    made = make_block(points=300)
    spoiled, wrong = with_blunders(made.start, 0.10, size=300.0)
    adjusted = adjust(spoiled, Known(), BundleParams(robust=robust), run=Run())
    length = np.hypot(*adjusted.residuals.T)
    assert length.max() < 2.5
    assert len(spoiled.obs_xy) - len(adjusted.block.obs_xy) < 1.3 * wrong.sum()
    assert centre_error(adjusted.block, made.truth) < 2.0 * centre_error(
        adjust(made.start, Known(), BundleParams(), run=Run()).block, made.truth
    )


def test_a_distortion_free_camera_becomes_basic_when_calibrated(make_block):
    made = make_block(points=300)
    camera = made.start.cameras[0]
    pinhole = replace(camera, model="pinhole", values=camera.values[:3], focal_estimated=True)
    adjusted = adjust(replace(made.start, cameras=(pinhole,)), Known(), BundleParams(), run=Run())
    found = adjusted.block.cameras[0]
    assert found.model == "basic"
    assert not found.focal_estimated
    assert np.all(np.abs(found.values - made.truth.cameras[0].values) < 4.0 * found.sigmas)
    fixed = adjust(
        replace(made.truth, cameras=(pinhole,)), Known(), BundleParams(calibration="fixed"), run=Run()
    )
    assert np.array_equal(fixed.block.cameras[0].values, pinhole.values)
    assert fixed.block.cameras[0].focal_estimated


def test_calibration_per_photo_gives_each_photo_its_own_values(make_block):
    made = make_block(points=300)
    adjusted = adjust(made.start, Known(), BundleParams(per_photo=True), run=Run())
    assert len(adjusted.block.cameras) == 8
    assert len({float(c.focal_px) for c in adjusted.block.cameras}) == 8


def test_a_parameter_that_the_photos_cannot_tell_is_warned_of(make_block):
    made = make_block(points=60, photos=8)
    flat = replace(
        made.start, points=made.start.points * [1, 1, 0]
    )  # parallel views of a plane: f and Z are one
    rng = np.random.default_rng(0)
    centres = rng.uniform([-1, -1, 6], [1, 1, 6], (8, 3))
    down = np.broadcast_to(np.diag([1.0, -1.0, -1.0]), (8, 3, 3)).copy()
    rays = flat.points[flat.obs_point] - centres[flat.obs_photo]
    rays = np.einsum("nij,nj->ni", down[flat.obs_photo], rays)
    f = 1500.0
    xy = f * rays[:, :2] / rays[:, 2:] + [800.0, 600.0] + rng.normal(0, 0.3, (len(rays), 2))
    camera = replace(made.truth.cameras[0], values=np.array([f, 800.0, 600.0, 0.0, 0.0]))
    block = replace(flat, cameras=(camera,), centres=centres, rotations=down, obs_xy=xy)
    run = Listening()
    adjust(block, Known(), BundleParams(principal_point="fixed"), run=run)
    assert any("Principal distance" in text for text in run.warnings)


def test_points_that_start_behind_a_camera_do_not_stop_the_others(make_block):
    made = make_block(points=200)
    points = made.start.points.copy()
    points[:5] = (
        made.start.centres[made.start.obs_photo[np.searchsorted(made.start.obs_point, np.arange(5))]] * 1.3
    )
    adjusted = adjust_block(replace(made.start, points=points))
    clean = adjust_block(made.start)
    assert np.isfinite(adjusted.residuals).all()
    assert np.isfinite(adjusted.sigma_points).all()
    assert adjusted.block.point_track.min() >= 0
    assert centre_error(adjusted.block, made.truth) < 2.0 * centre_error(clean.block, made.truth) + 1e-3


def test_duplicates_single_rays_and_photos_not_oriented_are_left_out(make_block):
    made = make_block()
    start = made.start
    clean = adjust_block(start)
    twice = replace(
        start,
        obs_photo=np.append(start.obs_photo, start.obs_photo[7]),
        obs_point=np.append(start.obs_point, start.obs_point[7]),
        obs_xy=np.vstack([start.obs_xy, start.obs_xy[7] + 5.0]),
    )
    assert adjust_block(twice).observations == clean.observations
    oriented = start.oriented.copy()
    oriented[3] = False
    seven = adjust_block(replace(start, oriented=oriented))
    assert not (seven.block.obs_photo == 3).any()
    assert np.array_equal(seven.block.centres[3], start.centres[3])
    assert seven.sigma_centres[3].max() == 0.0
    lonely = np.ones(len(start.obs_xy), dtype=bool)
    lonely[np.flatnonzero(start.obs_point == 0)[1:]] = False
    fewer = adjust_block(replace(
        start, obs_photo=start.obs_photo[lonely], obs_point=start.obs_point[lonely], obs_xy=start.obs_xy[lonely]
    ))  # fmt: skip
    assert 0 not in fewer.block.point_track
    assert len(fewer.block.points) == len(clean.block.points) - 1


def test_poses_alone_are_refined_when_every_point_is_fixed(make_block):
    made = make_block(noise_px=0.1)
    known = replace(made.start, points=made.truth.points, cameras=made.truth.cameras)
    adjusted = adjust_block(known, Freedom(fixed_points=np.ones(len(known.points), dtype=bool)))
    assert adjusted.unknowns == 48
    assert np.array_equal(adjusted.block.points, made.truth.points)
    error = (adjusted.block.centres - made.truth.centres) / adjusted.sigma_centres
    assert np.abs(error).max() < 4.5


def test_a_block_without_common_points_is_refused_in_words(make_block):
    start = make_block().start
    with pytest.raises(UserError, match="no observations"):
        adjust_block(replace(start, oriented=np.arange(8) == 0))
    with pytest.raises(UserError, match="share enough points"):
        adjust(replace(start, oriented=np.arange(8) == 0), Known(), BundleParams(), run=Run())


def test_cancel_takes_effect_at_the_next_iteration(make_block):
    run = Listening(stop_at=2)
    with pytest.raises(Stopped):
        adjust_block(make_block().start, run=run)
    assert len(run.records) == 3


def test_one_and_two_threads_give_the_same_bits(make_block):
    start = make_block(points=1500, photos=12).start
    free = Freedom(interior=(("focal_px", "x0", "y0", "k1", "k2"),))
    one, two = (adjust_block(start, free, run=Run(threads=threads)) for threads in (1, 2))
    for name in ("points", "centres", "rotations"):
        assert np.array_equal(getattr(one.block, name), getattr(two.block, name))
    assert np.array_equal(one.block.cameras[0].values, two.block.cameras[0].values)
    assert np.array_equal(one.sigma_points, two.sigma_points)
    assert one.sigma0_px == two.sigma0_px


def test_without_statistics_nothing_is_claimed(make_block):
    adjusted = adjust_block(make_block().start, options=Options(statistics=False))
    assert adjusted.block.cameras[0].sigmas is None
    assert np.isnan(adjusted.sigma_points).all()
    assert adjusted.sigma0_px > 0
