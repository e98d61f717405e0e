"""What the simulator of the trifocal tensor shows is true."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_didactic.simulator import find_simulator
from graphos_didactic.simulators.adjustment.trifocal_model import HEIGHTS, ThreePhotos, TrifocalParams


@pytest.mark.parametrize("source", ["orientation", "points"])
def test_without_errors_both_transfers_find_the_point(source: str) -> None:
    photos = ThreePhotos(TrifocalParams(sigma_px=0.0, source=source))  # type: ignore[arg-type]
    for xy in photos.found:
        np.testing.assert_allclose(xy, photos.pixels[2], atol=1e-4)


def test_in_the_trifocal_plane_only_the_tensor_finds_it() -> None:
    params = TrifocalParams(c_z=0.5)
    height = ThreePhotos(params).height_in_plane
    photos = ThreePhotos(params.replace(p_z=height))
    assert photos.above_plane == pytest.approx(0.0, abs=1e-12)
    assert photos.errors[0] > 100
    assert photos.errors[1] < 5
    scene = find_simulator("adjustment/trifocal").scene(params.replace(p_z=height))
    assert scene.numbers()["P above the trifocal plane"].value == pytest.approx(0.0, abs=1e-12)


def test_centres_on_a_line_lose_every_point_by_lines_and_none_by_the_tensor() -> None:
    simulator = find_simulator("adjustment/trifocal")
    photos = ThreePhotos(simulator.preset("on_line"))  # type: ignore[arg-type]
    errors = photos.errors_of_heights()
    assert photos.plane is None
    assert errors[:, 0].min() > 100
    assert errors[:, 1].max() < 5


def test_errors_grow_in_proportion_to_the_noise_away_from_the_plane() -> None:
    far = np.abs(HEIGHTS) > 1.0
    one, two = (ThreePhotos(TrifocalParams(sigma_px=s)).errors_of_heights()[far] for s in (0.5, 1.0))
    np.testing.assert_allclose(two / one, 2.0, rtol=0.1)
