"""The point splatter: right pixel, right order, same picture for any number of threads, and picking."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from graphos_core.rendering import Lines, Quads, ViewCamera, prepare_cloud, render_cloud, render_frame

WIDTH, HEIGHT = 160, 120
RED, GREEN, BLUE = (255, 0, 0), (0, 200, 0), (0, 0, 255)


@pytest.fixture
def camera() -> ViewCamera:
    """Look along +y from 10 units away, z up."""
    return ViewCamera(np.zeros(3), np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), 10.0, math.radians(40))


@pytest.fixture
def cloud() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(20_000, 3)) * [1.0, 1.0, 0.6]
    return points, rng.integers(30, 255, (20_000, 3)).astype(np.uint8)


def one(
    points: list[list[float]], colours: list[tuple[int, int, int]], camera: ViewCamera, **more: object
) -> np.ndarray:
    return render_cloud(
        np.array(points),
        np.array(colours, np.uint8),
        camera,
        WIDTH,
        HEIGHT,
        shading=0.0,
        **{"point_size": 1, **more},
    )


def test_a_point_is_drawn_at_the_pixel_that_projection_gives(camera: ViewCamera) -> None:
    rng = np.random.default_rng(1)
    for point in rng.uniform(-2.5, 2.5, (50, 3)):
        x, y, _ = camera.project(point, WIDTH, HEIGHT)[0]
        image = one([point.tolist()], [RED], camera)
        rows, columns = np.nonzero((image == RED).all(axis=2))
        assert len(rows) == 1
        assert abs(columns[0] - x) <= 0.51
        assert abs(rows[0] - y) <= 0.51


def test_the_target_is_in_the_middle_and_depth_is_inverted(camera: ViewCamera) -> None:
    assert_allclose(camera.project(camera.target, 161, 121)[0], [80, 60, 10], atol=1e-12)
    points = np.random.default_rng(0).uniform(-2, 2, (20, 3))
    for point, (x, y, depth) in zip(points, camera.project(points, WIDTH, HEIGHT)):
        assert_allclose(camera.point_at(x, y, depth, WIDTH, HEIGHT), point, atol=1e-10)


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_the_nearer_point_hides_the_farther_whatever_the_order(camera: ViewCamera, order: list[int]) -> None:
    points = np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])[order].tolist()
    colours = np.array([RED, BLUE], np.uint8)[order].tolist()
    image = one(points, colours, camera, point_size=3)
    assert (image == RED).all(axis=2).sum() == 9
    assert not (image == BLUE).all(axis=2).any()


def test_points_behind_the_camera_and_not_finite_are_not_drawn(camera: ViewCamera) -> None:
    image = one([[0, -11, 0], [np.nan, 0, 0], [0, np.inf, 0]], [RED, RED, RED], camera)
    assert (image == 255).all()


def test_same_picture_with_one_two_and_three_threads(
    camera: ViewCamera, cloud: tuple[np.ndarray, np.ndarray]
) -> None:
    pictures = [
        render_cloud(*cloud, camera, WIDTH, HEIGHT, 2.0, shading=1.0, threads=threads)
        for threads in (1, 2, 3)
    ]
    assert_array_equal(pictures[0], pictures[1])
    assert_array_equal(pictures[0], pictures[2])


def test_the_splatter_agrees_with_plain_numpy(
    camera: ViewCamera, cloud: tuple[np.ndarray, np.ndarray]
) -> None:
    points, colours = cloud
    image = render_cloud(points, colours, camera, WIDTH, HEIGHT, 1.0, shading=0.0)
    placed = camera.project(points, WIDTH, HEIGHT)
    pixels = np.floor(placed[:, :2] + 0.5).astype(int)
    expected = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
    inside = ((pixels >= 0) & (pixels < [WIDTH, HEIGHT])).all(axis=1)
    for i in np.argsort(-placed[:, 2]):
        if inside[i]:
            expected[pixels[i, 1], pixels[i, 0]] = colours[i]
    different = (image != expected).any(axis=2).mean()
    assert different < 2e-3  # single precision moves few points over a pixel's border


def test_pick_returns_the_nearest_point_and_its_original_index(
    camera: ViewCamera, cloud: tuple[np.ndarray, np.ndarray]
) -> None:
    points, colours = cloud
    frame = render_frame(prepare_cloud(points, colours), camera, WIDTH, HEIGHT, 1.0)
    placed = camera.project(points, WIDTH, HEIGHT)
    pixel = np.array([80, 60])
    on_pixel = np.flatnonzero((np.floor(placed[:, :2] + 0.5) == pixel).all(axis=1))
    nearest = on_pixel[np.argmin(placed[on_pixel, 2])]
    hit = frame.pick(80.0, 60.0)
    assert hit is not None
    assert hit[:2] == ("point", nearest)
    assert hit[2] == pytest.approx(placed[nearest, 2], rel=1e-5)


def test_pick_finds_a_point_nearby_and_nothing_where_nothing_is(camera: ViewCamera) -> None:
    frame = render_frame(prepare_cloud(np.zeros((1, 3))), camera, 161, 121, 1.0)
    assert frame.pick(83.0, 60.0, radius=4) == ("point", 0, pytest.approx(10.0))
    assert frame.pick(90.0, 60.0, radius=4) is None
    assert frame.pick(-50.0, -50.0) is None


def test_every_second_point_while_moving_is_a_subset(
    camera: ViewCamera, cloud: tuple[np.ndarray, np.ndarray]
) -> None:
    prepared = prepare_cloud(*cloud)
    full = render_frame(prepared, camera, WIDTH, HEIGHT, 1.0)
    half = render_frame(prepared, camera, WIDTH, HEIGHT, 1.0, step=2)
    empty = np.uint64(0xFFFFFFFFFFFFFFFF)
    assert ((full.keys == empty) <= (half.keys == empty)).all()
    assert (half.keys >= full.keys).all()


def test_a_line_is_hidden_by_a_nearer_point_unless_it_is_on_top(camera: ViewCamera) -> None:
    def middle(on_top: bool) -> tuple[int, ...]:
        line = Lines(
            np.array([[-2.0, 1, 0]]), np.array([[2.0, 1, 0]]), np.array([GREEN], np.uint8), 3.0, on_top
        )
        image = render_cloud(
            np.zeros((1, 3)), np.array([RED], np.uint8), camera, 161, 121, 5, [line], shading=0.0
        )
        assert tuple(image[60, 50]) == GREEN
        return tuple(image[60, 80])

    assert middle(False) == RED
    assert middle(True) == GREEN


def test_a_line_that_passes_behind_the_camera_is_cut_there(camera: ViewCamera) -> None:
    line = Lines(np.array([[0.0, -30, -0.5]]), np.array([[0.0, 5, -0.5]]), np.array([RED], np.uint8), 2.0)
    image = render_cloud(np.zeros((0, 3)), None, camera, 161, 121, lines=[line])
    rows = np.nonzero((image[:, 80] == RED).all(axis=1))[0]
    assert rows.max() == 120
    assert rows.min() > 60


def test_a_photo_is_drawn_right_way_round_and_in_front_only_if_it_is(camera: ViewCamera) -> None:
    texture = np.zeros((2, 2, 3), np.uint8)
    texture[0, 0], texture[0, 1], texture[1, 0], texture[1, 1] = RED, GREEN, BLUE, (90, 90, 90)
    corners = np.array([[[-2.0, 1, 2], [4.0, 0, 0], [0.0, 0, -4]]])
    frame = render_frame(
        prepare_cloud(np.zeros((1, 3)), np.array([[1, 2, 3]])), camera, 161, 121, 3, quads=Quads(corners, (texture,)),
        shading=0.0,
    )  # fmt: skip
    image = frame.image
    assert tuple(image[45, 65]) == RED
    assert tuple(image[45, 95]) == GREEN
    assert tuple(image[75, 65]) == BLUE
    assert tuple(image[60, 80]) == (1, 2, 3)
    assert frame.pick(95, 45) == ("quad", 0, pytest.approx(11.0))


def test_shading_darkens_behind_an_edge_and_leaves_flat_areas(camera: ViewCamera) -> None:
    x, z = np.meshgrid(np.linspace(-3, 3, 400), np.linspace(-3, 3, 400))
    wall = np.column_stack([x.ravel(), np.full(x.size, 1.0), z.ravel()])
    box = wall[np.abs(wall[:, [0, 2]]).max(axis=1) < 0.5] - [0, 1.5, 0]
    points = np.concatenate([wall, box])
    image = render_cloud(points, np.full(points.shape, 200, np.uint8), camera, WIDTH, HEIGHT, 2.0)
    assert abs(int(image[60, 45, 0]) - 200) <= 3
    edge = camera.project(np.array([[0.5, -0.5, 0.0]]), WIDTH, HEIGHT)[0, 0]
    assert image[60, int(edge) + 2, 0] < 120


def test_an_empty_cloud_gives_the_background(camera: ViewCamera) -> None:
    image = render_cloud(np.zeros((0, 3)), None, camera, 20, 10, background=(1, 2, 3))
    assert image.shape == (10, 20, 3)
    assert (image == [1, 2, 3]).all()
