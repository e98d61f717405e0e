"""Stations stand and look as the parameters say."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.errors import ParamError, UserError
from graphos_core.simulation.templates import (
    TEMPLATES,
    CoupleParams,
    FacadeParams,
    GridParams,
    OrbitalParams,
    TripleParams,
    place,
)


def axes(stations):
    """Viewing directions in the object frame."""
    return stations.rotations[:, 2]


def angle_deg(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


@pytest.mark.parametrize("name", list(TEMPLATES))
def test_every_template_gives_proper_rotations_and_unique_names(name):
    stations = place(name)
    eye = stations.rotations @ np.swapaxes(stations.rotations, 1, 2)
    assert np.abs(eye - np.eye(3)).max() < 1e-12
    assert np.linalg.det(stations.rotations) == pytest.approx(1.0)
    assert len(set(stations.names)) == len(stations.names) == len(stations.centres)


def test_couple_has_the_base_the_distance_and_the_convergence_of_its_parameters():
    params = CoupleParams(base=3.0, distance=10.0, convergence=25.0)
    stations = place("couple", params)
    assert np.linalg.norm(stations.centres[1] - stations.centres[0]) == pytest.approx(3.0)
    assert stations.centres.mean(axis=0) == pytest.approx([0.0, -10.0, 0.0])
    assert angle_deg(*axes(stations)) == pytest.approx(25.0)
    # converging, not diverging: the axes come nearer in front of the cameras
    ahead = stations.centres + axes(stations)
    assert np.linalg.norm(ahead[1] - ahead[0]) < 3.0


def test_the_normal_case_looks_straight_ahead_with_level_rows():
    stations = place("couple", CoupleParams(convergence=0.0))
    assert stations.rotations == pytest.approx(np.array([[[1, 0, 0], [0, 0, -1], [0, 1, 0]]] * 2), abs=1e-15)


def test_triple_has_equal_bases_and_equal_angles_between_neighbours():
    stations = place("triple", TripleParams(base=2.0, distance=8.0, convergence=15.0, rise=0.0))
    assert np.diff(stations.centres[:, 0]) == pytest.approx([2.0, 2.0])
    view = axes(stations)
    assert [angle_deg(view[0], view[1]), angle_deg(view[1], view[2])] == pytest.approx([15.0, 15.0])


def test_grid_has_its_bases_spacing_and_height_and_turns_every_second_strip():
    params = GridParams(height=50.0, base=6.0, spacing=9.0, strips=3, per_strip=5, oblique=0.0)
    stations = place("grid", params)
    centres = stations.centres.reshape(3, 5, 3)
    assert np.abs(np.diff(centres[:, :, 0], axis=1)) == pytest.approx(6.0)
    assert np.diff(centres[:, 0, 1]) == pytest.approx([9.0, 9.0])
    assert centres[:, :, 2] == pytest.approx(50.0)
    assert axes(stations) == pytest.approx(np.tile([0.0, 0.0, -1.0], (15, 1)))
    top_of_image = -stations.rotations[:, 1].reshape(3, 5, 3)
    flight = np.diff(centres, axis=1)
    assert (np.einsum("sic,sic->si", top_of_image[:, 1:], flight) > 0).all()


def test_oblique_grid_is_tilted_by_its_angle():
    stations = place("grid", GridParams(oblique=30.0))
    assert [angle_deg(a, np.array([0.0, 0.0, -1.0])) for a in axes(stations)] == pytest.approx([30.0] * 12)


def test_orbital_stations_lie_on_the_ellipsoid_and_look_at_its_centre():
    params = OrbitalParams(
        axis_x=5.0, axis_y=4.0, axis_z=3.0, equators=3, meridians=4, lowest=-40.0, highest=50.0
    )
    stations = place("orbital", params)
    assert ((stations.centres / [5.0, 4.0, 3.0]) ** 2).sum(axis=1) == pytest.approx(1.0)
    towards = -stations.centres / np.linalg.norm(stations.centres, axis=1, keepdims=True)
    assert axes(stations) == pytest.approx(towards)
    assert len(np.unique(np.round(stations.centres, 9), axis=0)) == len(stations.centres)


def test_an_orbit_without_rings_is_refused():
    with pytest.raises(UserError, match="no stations"):
        place("orbital", OrbitalParams(equators=0, meridians=0))


def test_facade_spans_its_arc_and_turns_some_photos_by_ninety_degrees():
    stations = place("facade", FacadeParams(distance=12.0, arc=60.0))
    flat = stations.centres * [1, 1, 0]
    assert np.linalg.norm(flat, axis=1) == pytest.approx(12.0)
    assert angle_deg(flat[0], flat[-1]) == pytest.approx(60.0)
    towards = -stations.centres / np.linalg.norm(stations.centres, axis=1, keepdims=True)
    assert axes(stations) == pytest.approx(towards)
    upright = np.abs(stations.rotations[:, 0, 2]) < 1e-9  # image rows are level
    sideways = np.abs(stations.rotations[:, 1, 2]) < 1e-9
    assert (upright ^ sideways).all()
    assert sideways.sum() == 3
    assert {np.sign(r[0, 2]) for r in stations.rotations[sideways]} == {-1.0, 1.0}


def test_bad_parameters_and_unknown_templates_are_refused_with_what_is_possible():
    with pytest.raises(ParamError, match="Base"):
        CoupleParams(base=0.0)
    with pytest.raises(UserError, match="couple"):
        place("cuple")
