"""The nearest descriptors of one are those of an independent search, in either metric."""

import cv2
import numpy as np
import pytest

from graphos_core.features.matchers.nearest_few import nearest_few


@pytest.mark.parametrize(("metric", "norm"), [("l2", cv2.NORM_L2), ("hamming", cv2.NORM_HAMMING)])
def test_neighbours_and_distances_are_those_of_brute_force(metric: str, norm: int) -> None:
    rng = np.random.default_rng(3)
    others = rng.integers(0, 256, (300, 32), dtype=np.uint8)
    one = rng.integers(0, 256, 32, dtype=np.uint8)
    kind = np.float32 if metric == "l2" else np.uint8
    expected = cv2.BFMatcher(norm).knnMatch(one[None].astype(kind), others.astype(kind), k=6)[0]
    index, distance = nearest_few(one, others, 6, metric)
    assert np.allclose(distance, [match.distance for match in expected], atol=1e-3)
    assert {int(i) for i in index} == {match.trainIdx for match in expected}


def test_few_others_are_all_returned_and_other_lengths_are_refused() -> None:
    index, distance = nearest_few(np.zeros(4, np.uint8), np.array([[9, 0, 0, 0], [0, 0, 0, 1]], np.uint8), 5)
    assert index.tolist() == [1, 0] and distance.tolist() == [1.0, 9.0]
    with pytest.raises(ValueError, match="length 4"):
        nearest_few(np.zeros(4, np.uint8), np.zeros((3, 5), np.uint8), 2)
