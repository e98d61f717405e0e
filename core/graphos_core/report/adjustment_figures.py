"""The adjustment as figures: sigma0, global test, groups of observations, iterations, photos."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import numpy as np

from graphos_core.data import Adjustment, Array, GlobalTest, ObservationGroup
from graphos_core.geometry.rotation import matrix_from_vector, opk_from_matrix
from graphos_core.quality.internal import image_coverage
from graphos_core.report.values import rms
from graphos_core.text import Text

SIGMA0 = Text(
    "A posteriori standard deviation of unit weight, √(vᵀPv / r), without unit: 1 when the a priori standard "
    "deviations are right."
)
SIGMA0_PX = Text(
    "The same in px: times the a priori standard deviation of an image coordinate of unit weight."
)
RMS_PX = Text(
    "Root mean square of the image residuals (projected − measured) per coordinate, over all "
    "observations of the final model, in px of the full photo."
)
REDUNDANCY = Text("Observations − unknowns + datum conditions. Control held fixed is no observation.")


def sigma0_of(adjustment: Adjustment) -> float:
    """Return sigma0 without unit, also of a result that was stored before it was kept."""
    if math.isfinite(adjustment.sigma0):
        return float(adjustment.sigma0)
    return float(adjustment.sigma0_px / adjustment.prior_px)


def orientation(adjustment: Adjustment) -> dict[str, Any]:
    """Return the part ``orientation`` of the report."""
    block = adjustment.block
    points = len(np.unique(block.obs_point))
    return {
        "points": points,
        "observations": len(block.obs_xy),
        "scalar_observations": adjustment.observations,
        "reprojection_rms_px": adjustment.rms_px,
        "sigma0": sigma0_of(adjustment),
        "sigma0_px": adjustment.sigma0_px,
        "prior_px": adjustment.prior_px,
        "redundancy": adjustment.redundancy,
        "unknowns": adjustment.unknowns,
        "mean_rays_per_point": len(block.obs_xy) / points if points else 0.0,
        "unit": block.unit,
        "datum": adjustment.datum,
        "converged": adjustment.converged,
        "stop_reason": adjustment.stop_reason,
        "iterations": len(adjustment.iterations),
        "iteration_records": [asdict(i) for i in adjustment.iterations],
        "global_test": None if adjustment.global_test is None else _test(adjustment.global_test),
        "groups": [_group(g) for g in adjustment.groups],
        "extras": [asdict(e) for e in adjustment.extras],
        "definitions": {
            "sigma0": SIGMA0,
            "sigma0_px": SIGMA0_PX,
            "reprojection_rms_px": RMS_PX,
            "redundancy": REDUNDANCY,
        },
        "photos": photos(adjustment),
    }


def _test(test: GlobalTest) -> dict[str, Any]:
    return asdict(test)


def _group(group: ObservationGroup) -> dict[str, Any]:
    return {
        "kind": group.kind, "unit": group.unit, "count": group.count, "redundancy": group.redundancy,
        "squares": group.squares, "sigma0": group.sigma0, "rms": group.rms, "factor": group.factor,
    }  # fmt: skip


def photos(adjustment: Adjustment) -> list[dict[str, Any]]:
    """Return the oriented photos in order."""
    block, covers = adjustment.block, image_coverage(adjustment.block)
    rows = []
    for i in np.flatnonzero(block.oriented):
        mine = block.obs_photo == i
        residuals = adjustment.residuals[mine]
        rows.append({
            "name": block.names[i],
            "camera": int(block.camera_of_photo[i]),
            "centre": block.centres[i],
            "sigma_centre": adjustment.sigma_centres[i],
            "omega_phi_kappa_deg": np.degrees(opk_from_matrix(block.rotations[i])),
            "sigma_omega_phi_kappa_deg": np.degrees(sigma_opk(block.rotations[i], rotation_covariance(adjustment, int(i)))),
            "sigma_rotation_deg": np.degrees(adjustment.sigma_rotations[i]),
            "observations": int(mine.sum()),
            "coverage": float(covers[i]),
            "rms_px": rms(residuals),
            "mean_residual_px": residuals.mean(axis=0) if mine.any() else np.full(2, np.nan),
        })  # fmt: skip
    return rows


def rotation_covariance(adjustment: Adjustment, photo: int) -> Array:
    """Return the covariance (3, 3) of a photo's small rotation; without covariances that of independent rotations."""
    if adjustment.covariance is not None:
        return np.asarray(adjustment.covariance.photos[photo, :3, :3])
    return np.diag(adjustment.sigma_rotations[photo] ** 2)


def sigma_opk(cam_from_world: Array, covariance: Array) -> Array:
    """Return the standard deviations (3,) of omega, phi, kappa, radians, by propagation of errors.

    Parameters
    ----------
    cam_from_world : float64 (3, 3)
    covariance : float64 (3, 3)
        Of the small rotation δ about the axes of the camera: ``exp([δ]×) cam_from_world``.
    """
    step = 1e-6
    jacobian = np.empty((3, 3))
    for k in range(3):
        turn = np.zeros(3)
        turn[k] = step
        ahead = np.array(opk_from_matrix(matrix_from_vector(turn) @ cam_from_world))
        behind = np.array(opk_from_matrix(matrix_from_vector(-turn) @ cam_from_world))
        jacobian[:, k] = ((ahead - behind + np.pi) % (2 * np.pi) - np.pi) / (2 * step)
    return np.asarray(np.sqrt(np.maximum(np.diag(jacobian @ covariance @ jacobian.T), 0.0)))
