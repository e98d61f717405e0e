"""The figures of the report are those of the adjustment; precision and accuracy stay apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from graphos_core.cameras import pixel_from_ray, ray_from_pixel
from graphos_core.data import Adjustment, CheckPoints, Georeference
from graphos_core.geometry.rotation import matrix_from_vector, opk_from_matrix
from graphos_core.report.adjustment_figures import sigma_opk
from graphos_core.report.build import adjustment_parts, left_out
from graphos_core.report.problems import problems
from graphos_core.report.residual_figures import kurtosis_excess, normal_quantiles
from graphos_core.report.statement import statement
from graphos_core.report.values import plain


def test_sigma_of_omega_phi_kappa_is_the_spread_of_turned_cameras(adjusted: Adjustment) -> None:
    rng = np.random.default_rng(0)
    mixing = rng.normal(0.0, 1e-3, (3, 3))
    rotation = adjusted.block.rotations[1]
    turns = rng.normal(size=(4000, 3)) @ mixing.T
    angles = np.array([opk_from_matrix(matrix_from_vector(t) @ rotation) for t in turns])
    assert sigma_opk(rotation, mixing @ mixing.T) == pytest.approx(angles.std(axis=0), rel=0.05)


def test_suspects_name_the_blunder_first(adjusted: Adjustment, placed: Georeference) -> None:
    worst = adjustment_parts(adjusted, placed)["reliability"]["suspects"][0]
    assert (worst["photo"], worst["point"], worst["coordinate"]) == ("photo 2", "A 1", "y")
    assert worst["residual_px"] == 5.0


def test_correlations_leave_out_fixed_parameters_and_have_ones_on_the_diagonal(
    adjusted: Adjustment, placed: Georeference
) -> None:
    found = adjustment_parts(adjusted, placed)["cameras"][0]["correlations"]
    assert len(found["names"]) == 4
    assert np.diag(found["matrix"]) == pytest.approx(np.ones(4))
    free = np.delete(np.arange(5), 2)
    assert adjusted.covariance is not None
    c = adjusted.covariance.cameras[0][np.ix_(free, free)]
    assert found["matrix"][0][1] == pytest.approx(c[0, 1] / np.sqrt(c[0, 0] * c[1, 1]), abs=1e-4)


def test_control_and_check_points_are_kept_apart(adjusted: Adjustment, placed: Georeference) -> None:
    parts = plain(adjustment_parts(adjusted, placed))
    assert [p["name"] for p in parts["control"]["points"]] == ["A 1", "B", "C", "D"]
    assert [p["name"] for p in parts["check"]["points"]] == ["E1", "E2", "E3"]
    assert parts["check"]["rms_m"] == pytest.approx([0.001, 0.002, 0.003])
    assert parts["check"]["predicted_m"] == pytest.approx([0.001, 0.002, 0.003])
    assert [g["kind"] for g in parts["known"]] == ["distances"]


@pytest.mark.parametrize(("factor", "verdict"), [(1.0, "confirmed"), (3.0, "optimistic"), (0.1, "cautious")])
def test_statement_compares_check_points_with_their_covariance(
    adjusted: Adjustment, placed: Georeference, factor: float, verdict: str
) -> None:
    assert adjusted.check is not None
    check = replace(adjusted.check, residuals=factor * adjusted.check.residuals)
    parts = adjustment_parts(replace(adjusted, check=check), placed)
    found = statement(plain(parts))
    assert found is not None
    assert found["verdict"] == verdict
    assert found["factor"] == pytest.approx(factor)


def test_statement_confirms_true_noise_at_its_error_probability(
    adjusted: Adjustment, placed: Georeference
) -> None:
    rng = np.random.default_rng(1)
    parts, rejected = plain(adjustment_parts(adjusted, placed)), 0
    for _ in range(400):
        for point in parts["check"]["points"]:
            point["normalised"] = rng.normal(size=3).tolist()
        rejected += statement(parts)["verdict"] != "confirmed"  # type: ignore[index]
    assert rejected <= stats.binom.ppf(0.999, 400, 0.01)


def test_without_check_points_accuracy_is_unknown(adjusted: Adjustment, placed: Georeference) -> None:
    found = statement(plain(adjustment_parts(replace(adjusted, check=None), placed)))
    assert found is not None
    assert found["verdict"] == "not checked"
    assert "no check points" in found["accuracy"]


def test_parts_that_are_missing_are_named_with_a_reason(adjusted: Adjustment) -> None:
    bare = replace(adjusted, groups=(), covariance=None, reliability=None, global_test=None, significance=())
    assert len(left_out(bare)) == 5
    assert all(p["reason"] for p in left_out(bare))
    assert left_out(adjusted) == []


def test_problems_put_the_worst_first(adjusted: Adjustment) -> None:
    report = {"images": {"not_oriented": [{"name": "photo 9", "reason": "too few points"}]}, "warnings": []}
    found = problems(report, adjusted)
    assert [f["severity"] for f in found] == ["error", "warning", "info"]
    assert found[0]["todo"] == "Give one distance."


def test_normal_quantiles_and_kurtosis_agree_with_scipy() -> None:
    values = np.random.default_rng(2).normal(size=500) ** 3
    theory, _ = stats.probplot(values, fit=False)
    assert normal_quantiles(500) == pytest.approx(theory, abs=1e-9)
    assert kurtosis_excess(values) == pytest.approx(stats.kurtosis(values))


def test_unknown_given_sigmas_do_not_spoil_the_normalised_residuals(
    adjusted: Adjustment, placed: Georeference
) -> None:
    assert adjusted.check is not None
    unknown: CheckPoints = replace(adjusted.check, given_sigmas=np.full((3, 3), np.nan))
    parts = plain(adjustment_parts(replace(adjusted, check=unknown), placed))
    assert parts["check"]["points"][0]["normalised"] == pytest.approx([1.0, -1.0, 1.0])


def test_projection_uncertainty_is_the_spread_of_projections_with_sampled_parameters(
    adjusted: Adjustment, placed: Georeference
) -> None:
    assert adjusted.covariance is not None
    camera, covariance = adjusted.block.cameras[0], adjusted.covariance.cameras[0]
    found = plain(adjustment_parts(adjusted, placed))["cameras"][0]["projection_uncertainty"]
    corner = np.array([[found["columns_px"][0], found["rows_px"][0]]])
    ray = ray_from_pixel(camera, corner)
    rng = np.random.default_rng(4)
    changes = rng.multivariate_normal(np.zeros(5), covariance, 2000)
    pixels = np.vstack([pixel_from_ray(replace(camera, values=camera.values + c), ray) for c in changes])
    axis = np.sqrt(np.linalg.eigvalsh(np.cov(pixels.T))[-1])
    assert found["sigma_px"][0][0] == pytest.approx(axis, rel=0.08)


def test_profiles_have_bands_only_with_a_covariance(adjusted: Adjustment, placed: Georeference) -> None:
    with_band = plain(adjustment_parts(adjusted, placed))["cameras"][0]["profile"]
    without = plain(adjustment_parts(replace(adjusted, covariance=None), placed))["cameras"][0]["profile"]
    assert with_band["gaussian"]["sigma_px"][-1] > 0
    assert without["gaussian"]["sigma_px"] is None
    assert without["gaussian"]["shift_px"] == with_band["gaussian"]["shift_px"]
