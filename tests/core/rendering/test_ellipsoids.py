"""Lines of error ellipsoids lie on the ellipsoids."""

import numpy as np

from graphos_core.rendering.ellipsoids import SEGMENTS, ellipsoid_lines


def test_every_point_of_the_lines_lies_on_its_ellipsoid() -> None:
    rng = np.random.default_rng(1)
    roots = rng.standard_normal((5, 3, 3))
    covariances = roots @ roots.transpose(0, 2, 1)
    centres = rng.standard_normal((5, 3))
    starts, ends = ellipsoid_lines(centres, covariances, 3.0)
    assert starts.shape == ends.shape == (5 * 3 * SEGMENTS, 3)
    for part in (starts, ends):
        offset = part.reshape(5, -1, 3) - centres[:, None]
        squares = np.einsum("nki,nij,nkj->nk", offset, np.linalg.inv(covariances), offset)
        assert np.allclose(squares, 9.0)
    largest = np.linalg.norm(starts.reshape(5, -1, 3) - centres[:, None], axis=2).max(axis=1)
    assert np.allclose(largest, 3 * np.sqrt(np.linalg.eigvalsh(covariances)[:, -1]))


def test_undetermined_points_have_none() -> None:
    covariances = np.stack([np.eye(3), np.diag([np.inf] * 3), np.zeros((3, 3))])
    assert len(ellipsoid_lines(np.zeros((3, 3)), covariances, 1.0)[0]) == 3 * SEGMENTS
