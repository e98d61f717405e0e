"""The compiled normal equations are those of a plain numpy twin with numerical derivatives."""

from dataclasses import replace

import numpy as np
import pytest

from graphos_core.adjustment.bundle.kernels import Rules
from graphos_core.adjustment.bundle.problem import Freedom, make_problem
from graphos_core.adjustment.bundle.reduced_system import ReducedSystem
from graphos_core.cameras import pixel_from_ray
from graphos_core.geometry.rotation import matrix_from_vector

FREE = ("focal_px", "y0", "k2")
INDEX = [0, 2, 4]


def residuals(block, unknowns):
    """Residuals (2m,) after small changes: 6 per photo, 3 per camera, 3 per point."""
    n, c = len(block.names), len(block.cameras)
    photo = unknowns[: 6 * n].reshape(n, 6)
    inner = unknowns[6 * n : 6 * n + 3 * c].reshape(c, 3)
    points = block.points + unknowns[6 * n + 3 * c :].reshape(-1, 3)
    out = np.empty((len(block.obs_xy), 2))
    for o, (i, p) in enumerate(zip(block.obs_photo, block.obs_point, strict=True)):
        camera = block.cameras[block.camera_of_photo[i]]
        values = camera.values.copy()
        values[INDEX] += inner[block.camera_of_photo[i]]
        rotation = matrix_from_vector(photo[i, :3]) @ block.rotations[i]
        ray = rotation @ (points[p] - block.centres[i] - photo[i, 3:])
        out[o] = pixel_from_ray(replace(camera, values=values), ray[None])[0] - block.obs_xy[o]
    return out.ravel()


def jacobian(block):
    size = 6 * len(block.names) + 3 * len(block.cameras) + 3 * len(block.points)
    steps = np.full(size, 1e-6)
    steps[6 * len(block.names) : 6 * len(block.names) + 3 * len(block.cameras)] = 1e-4
    columns = []
    for k, h in enumerate(steps):
        change = np.zeros(size)
        change[k] = h
        columns.append((residuals(block, change) - residuals(block, -change)) / (2 * h))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("cameras", [1, 3])
@pytest.mark.parametrize("rules", [Rules(0, 1.0, True), Rules(1, 3.0, True), Rules(2, 3.0, True)])
def test_reduced_system_is_the_schur_complement_of_the_dense_one(make_block, cameras, rules):
    block = make_block(photos=3, points=12, cameras=cameras).start
    problem = make_problem(block, Freedom(interior=(FREE,) * cameras))
    block, damping = problem.block, 1e-3
    system = ReducedSystem(problem, rules, 1)
    with system.working():
        found = system.build(problem.scene, damping)
    v = residuals(block, np.zeros(18 + 3 * cameras + 3 * len(block.points))).reshape(-1, 2)
    length = np.hypot(*v.T)
    weight = [np.ones(len(v)), np.minimum(1.0, 3.0 / length), 1.0 / (1.0 + (length / 3.0) ** 2)][rules.robust]
    rows = jacobian(block) * np.repeat(np.sqrt(weight), 2)[:, None]
    v = (v * np.sqrt(weight)[:, None]).ravel()
    if cameras == 3:  # the kernel puts a photo's own camera beside the photo
        order = np.concatenate([[*range(6 * i, 6 * i + 6), *range(18 + 3 * i, 21 + 3 * i)] for i in range(3)])
        rows[:, : len(order)] = rows[:, order]
    u = problem.unknowns
    normal, gradient = rows.T @ rows, rows.T @ v
    points = normal[u:, u:] + damping * np.diag(np.diag(normal[u:, u:]))
    reduced = normal[:u, :u] - normal[:u, u:] @ np.linalg.solve(points, normal[u:, :u])
    right = gradient[:u] - normal[:u, u:] @ np.linalg.solve(points, gradient[u:])
    scale = np.sqrt(np.outer(np.diag(normal)[:u], np.diag(normal)[:u]))
    assert np.abs(np.triu(found.matrix - reduced) / scale).max() < 1e-7
    assert np.allclose(found.gradient, gradient[:u], atol=1e-6 * np.abs(gradient).max())
    assert np.allclose(found.reduced_gradient, right, atol=1e-6 * np.abs(gradient).max())
    assert np.allclose(found.diagonal, np.diag(normal)[:u], rtol=1e-6)


def test_back_substitution_solves_the_whole_dense_system(make_block):
    block = make_block(photos=3, points=12).start
    problem = make_problem(block, Freedom(interior=(FREE,)))
    damping = 1e-2
    system = ReducedSystem(problem, Rules(0, 1.0, True), 1)
    with system.working():
        equations = system.build(problem.scene, damping)
        step = system.solve(equations, damping)
        moved = system.move(problem.scene, equations, damping, step)
    rows = jacobian(problem.block)
    v = residuals(problem.block, np.zeros(rows.shape[1]))
    normal = rows.T @ rows
    whole = -np.linalg.solve(normal + damping * np.diag(np.diag(normal)), rows.T @ v)
    points = np.empty_like(moved.scene.points)
    points[problem.order] = moved.scene.points - problem.scene.points
    assert np.allclose(step, whole[:21], rtol=1e-5, atol=1e-7 * np.abs(whole).max())
    assert np.allclose(points.ravel(), whole[21:], rtol=1e-4, atol=1e-7)
    predicted = 0.5 * (v @ v - np.sum((v + rows @ whole) ** 2)) - 0.0
    assert moved.predicted == pytest.approx(predicted, rel=1e-5)
    assert moved.cost == pytest.approx(0.5 * np.sum(residuals(problem.block, whole) ** 2), rel=1e-5)
