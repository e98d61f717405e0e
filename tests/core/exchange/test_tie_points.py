"""Tie points: each format on a pixel grid, and what COLMAP's own importer makes of our files."""

from __future__ import annotations

import sqlite3

import numpy as np
import pytest

from graphos_core.errors import UserError
from graphos_core.exchange.bundler import write_bundler
from graphos_core.exchange.tie_points import from_observations, read_tie_points, write_tie_points


def grid_points():
    """Twelve points on a pixel grid in three photos; the last is seen in two only."""
    photos = ("a.jpg", "b.jpg", "c.jpg")
    grid = np.stack(np.meshgrid(np.arange(4.0), np.arange(3.0)), axis=-1).reshape(-1, 2) * 100
    point = np.repeat(np.arange(12), 3)[:-1]
    photo = np.tile(np.arange(3), 12)[:-1]
    xy = grid[point] + photo[:, None] * [7.0, 1.25]
    return from_observations(photos, point, photo, xy)


def as_sets(points):
    """The points as sets of (photo, x, y): numbers of points do not matter."""
    t = points.tracks
    return sorted(
        tuple(
            sorted(
                (points.photos[p], round(x, 6), round(y, 6))
                for p, (x, y) in zip(t.photo[t.track == k], t.xy[t.track == k], strict=True)
            )
        )
        for k in range(t.count)
    )


@pytest.mark.parametrize(
    ("name", "file"), [("table", "tie.csv"), ("micmac", "Homol"), ("colmap", "features")]
)
def test_tie_points_come_back(tmp_path, name, file):
    points = grid_points()
    write_tie_points(points, tmp_path / file, name)
    back = read_tie_points(tmp_path / file)
    assert as_sets(back) == as_sets(points)
    assert back.tracks.count == 12 and not back.remarks
    back.tracks.check_arrays()


def test_colmap_files_are_half_a_pixel_further_and_micmac_files_are_not(tmp_path):
    points = grid_points()
    write_tie_points(points, tmp_path / "c", "colmap")
    first = (tmp_path / "c" / "a.jpg.txt").read_text().splitlines()[1].split()[:2]
    assert [float(v) for v in first] == [0.5, 0.5]
    write_tie_points(points, tmp_path / "Homol", "micmac")
    line = (tmp_path / "Homol" / "Pastisa.jpg" / "b.jpg.txt").read_text().splitlines()[1]
    assert [float(v) for v in line.split()] == [100.0, 0.0, 107.0, 1.25]
    turned = (tmp_path / "Homol" / "Pastisb.jpg" / "a.jpg.txt").read_text().splitlines()[1]
    assert [float(v) for v in turned.split()] == [107.0, 1.25, 100.0, 0.0]


def test_a_database_of_colmap_is_read(tmp_path):
    points = grid_points()
    t = points.tracks
    path = tmp_path / "database.db"
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE images (image_id INTEGER, name TEXT)")
        database.execute("CREATE TABLE keypoints (image_id INTEGER, rows INTEGER, cols INTEGER, data BLOB)")
        database.execute("CREATE TABLE two_view_geometries (pair_id INTEGER, rows INTEGER, data BLOB)")
        for i, name in enumerate(points.photos):
            xy = (t.xy[t.photo == i] + 0.5).astype(np.float32)
            six = np.hstack([xy, np.zeros((len(xy), 4), np.float32)])
            database.execute("INSERT INTO images VALUES (?, ?)", (i + 1, name))
            database.execute("INSERT INTO keypoints VALUES (?, ?, ?, ?)", (i + 1, len(six), 6, six.tobytes()))
        for a, b in ((0, 1), (1, 2)):
            rows = []
            for k in range(t.count):
                seen = {
                    int(p): int(f)
                    for p, f in zip(t.photo[t.track == k], t.feature[t.track == k], strict=True)
                }
                if a in seen and b in seen:
                    rows.append([seen[a], seen[b]])
            table = np.array(rows, dtype=np.uint32)
            database.execute(
                "INSERT INTO two_view_geometries VALUES (?, ?, ?)",
                ((a + 1) * 2147483647 + b + 1, len(table), table.tobytes()),
            )
    back = read_tie_points(path)
    assert as_sets(back) == as_sets(points)


def test_bundler_views_are_tie_points(tmp_path, block_of):
    block = block_of()
    write_bundler(block, tmp_path / "bundle.out")
    back = read_tie_points(tmp_path / "bundle.out")
    assert back.tracks.count == 30 and len(back.tracks.track) == 90


def test_points_with_two_positions_in_a_photo_or_one_ray_are_left_out():
    point = np.array([0, 0, 0, 1, 1, 2])
    photo = np.array([0, 1, 1, 0, 1, 0])
    made = from_observations(("a", "b"), point, photo, np.arange(12.0).reshape(6, 2))
    assert made.tracks.count == 1 and made.tracks.conflicts == 1
    assert "two positions" in made.remarks[0] and "one photo only" in made.remarks[1]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("point,photo,x,y\n1,a,2,nan\n", "Line 2"),
        ("point,photo,x,y\n1,a,2\n", "Line 2"),
        ("name,x,y\n", "first line"),
        ("", "first line"),
    ],
)
def test_bad_tables_are_refused_with_the_line(tmp_path, text, said):
    path = tmp_path / "tie.csv"
    path.write_text(text)
    with pytest.raises(UserError, match=said):
        read_tie_points(path)


def test_damaged_folders_and_databases_are_refused(tmp_path):
    (tmp_path / "x.db").write_bytes(b"no database" * 100)
    with pytest.raises(UserError, match="database"):
        read_tie_points(tmp_path / "x.db")
    (tmp_path / "empty").mkdir()
    with pytest.raises(UserError, match=r"matches\.txt"):
        read_tie_points(tmp_path / "empty")
    write_tie_points(grid_points(), tmp_path / "Homol", "micmac")
    bad = tmp_path / "Homol" / "Pastisa.jpg" / "b.jpg.txt"
    bad.write_text("1 2 three 4\n")
    with pytest.raises(UserError, match="Line 1"):
        read_tie_points(tmp_path / "Homol")
    with pytest.raises(UserError, match="bundle file"):
        write_tie_points(grid_points(), tmp_path / "b", "bundler")
