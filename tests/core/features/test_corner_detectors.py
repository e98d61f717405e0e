"""Harris, Förstner and Moravec points against their definitions and against known positions."""

import cv2
import numpy as np
import pytest
from scipy import ndimage

from graphos_core.features.detectors.corner_kernels import local_maxima
from graphos_core.features.detectors.corners import strongest
from graphos_core.features.detectors.foerstner import (
    FoerstnerParams,
    foerstner,
    precise_positions,
    weight_and_roundness,
)
from graphos_core.features.detectors.harris import HarrisParams, differences, harris, harris_response
from graphos_core.features.detectors.moravec import MoravecParams, interest_value, moravec
from graphos_core.run import Run

RUN = Run()
DETECTORS = {"harris": (harris, HarrisParams), "foerstner": (foerstner, FoerstnerParams),
             "moravec": (moravec, MoravecParams)}  # fmt: skip


def texture(height: int = 240, width: int = 320, seed: int = 0) -> np.ndarray:
    noise = np.random.default_rng(seed).uniform(0, 255, (height, width)).astype(np.float32)
    return cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2.0), None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)


def board(
    shift: tuple[float, float], period: float = 46.0, size: tuple[int, int] = (320, 240)
) -> tuple[np.ndarray, np.ndarray]:
    """A turned chessboard with soft edges and the exact places of its crossings well inside the photo."""
    x, y = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    turn = np.radians(17.0)
    u = ((x - shift[0]) * np.cos(turn) + (y - shift[1]) * np.sin(turn)) * (np.pi / period)
    v = ((y - shift[1]) * np.cos(turn) - (x - shift[0]) * np.sin(turn)) * (np.pi / period)
    image = 127.5 + 100.0 * np.tanh(12 * np.sin(u)) * np.tanh(12 * np.sin(v))
    i, j = np.meshgrid(np.arange(-10, 11), np.arange(-10, 11))
    places = np.stack([
        shift[0] + period * (i * np.cos(turn) - j * np.sin(turn)),
        shift[1] + period * (i * np.sin(turn) + j * np.cos(turn)),
    ], axis=-1).reshape(-1, 2)  # fmt: skip
    inside = ((places > 25) & (places < np.array(size) - 26)).all(axis=1)
    return np.rint(image).astype(np.uint8), places[inside]


def wedge(tip: tuple[float, float], from_deg: float, to_deg: float, side: int = 41) -> np.ndarray:
    """A bright corner with an exactly known tip, averaged over 16 × 16 samples per pixel and slightly blurred."""
    fine = (np.arange(side * 16) + 0.5) / 16 - 0.5
    x, y = np.meshgrid(fine - tip[0], fine - tip[1])
    angle = np.degrees(np.arctan2(y, x)) % 360
    filled = np.where((angle >= from_deg) & (angle <= to_deg), 200.0, 50.0)
    image = filled.reshape(side, 16, side, 16).mean(axis=(1, 3))
    return np.rint(ndimage.gaussian_filter(image, 0.7)).astype(np.uint8)


def disc(centre: tuple[float, float], radius: float, side: int = 41) -> np.ndarray:
    fine = (np.arange(side * 16) + 0.5) / 16 - 0.5
    x, y = np.meshgrid(fine - centre[0], fine - centre[1])
    image = np.where(np.hypot(x, y) <= radius, 200.0, 50.0).reshape(side, 16, side, 16).mean(axis=(1, 3))
    return np.rint(ndimage.gaussian_filter(image, 0.7)).astype(np.uint8)


def test_the_response_of_harris_and_stephens_follows_its_formula() -> None:
    grey = texture()
    image = grey / 255.0
    padded = np.pad(image, 1, mode="edge")
    right, down = padded[1:-1, 2:] - padded[1:-1, :-2], padded[2:, 1:-1] - padded[:-2, 1:-1]
    a, b, c = (
        ndimage.gaussian_filter(p, 1.5, mode="nearest", truncate=4.0)
        for p in (right * right, down * down, right * down)
    )
    expected = a * b - c * c - 0.04 * (a + b) ** 2
    assert harris_response(grey, 0.04, 1.5) == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())


def test_the_interest_value_of_moravec_is_that_of_explicit_windows() -> None:
    grey = texture(30, 40)
    image = grey.astype(float)
    for window in (3, 4, 5, 8):
        value = interest_value(grey, window)
        for y, x in ((10, 12), (15, 20), (18, 9)):
            patch = image[y - window // 2 :, x - window // 2 :][:window, :window]
            sums = (
                ((patch[:, 1:] - patch[:, :-1]) ** 2).sum(), ((patch[1:] - patch[:-1]) ** 2).sum(),
                ((patch[1:, 1:] - patch[:-1, :-1]) ** 2).sum(), ((patch[1:, :-1] - patch[:-1, 1:]) ** 2).sum(),
            )  # fmt: skip
            assert value[y, x] == pytest.approx(min(sums), rel=1e-5)


def test_weight_and_roundness_are_those_of_the_eigenvalues() -> None:
    right, down = differences(texture())
    w, q = weight_and_roundness(right, down, 1.5)
    sums = [ndimage.gaussian_filter(p.astype(float), 1.5, mode="nearest", truncate=4.0)
            for p in (right * right, right * down, down * down)]  # fmt: skip
    for y, x in ((50, 60), (120, 200), (7, 300)):
        eigen = np.linalg.eigvalsh([[sums[0][y, x], sums[1][y, x]], [sums[1][y, x], sums[2][y, x]]])
        assert w[y, x] == pytest.approx(1.0 / (1.0 / eigen).sum(), rel=1e-3)
        assert q[y, x] == pytest.approx(1.0 - ((eigen[0] - eigen[1]) / eigen.sum()) ** 2, rel=1e-3)


@pytest.mark.parametrize("tip", [(20.0, 20.0), (20.37, 19.81), (19.6, 20.45)])
@pytest.mark.parametrize("corner", [(20, 110), (200, 260), (75, 195)])
def test_a_corner_is_located_where_its_edges_meet(tip: tuple[float, float], corner: tuple[int, int]) -> None:
    right, down = differences(wedge(tip, *corner))
    starts = [(20, 20), (21, 20), (19, 21)]  # rows and columns: the window need not be over the tip
    for row, column in starts:
        xy, inside = precise_positions(right, down, np.array([row]), np.array([column]), 2.5, "corner")
        assert inside[0]
        assert np.hypot(*(xy[0] - tip)) < 0.4  # the blur rounds the tip off


@pytest.mark.parametrize("shift", [(131.3, 117.8), (130.0, 120.0), (127.6, 111.45)])
def test_crossings_are_located_to_a_tenth_of_a_pixel(shift: tuple[float, float]) -> None:
    image, crossings = board(shift)
    right, down = differences(image)
    columns, rows = np.rint(crossings).astype(int).T
    xy, inside = precise_positions(right, down, rows, columns, 2.5, "corner")
    assert inside.all() and len(crossings) > 10
    assert np.linalg.norm(xy - crossings, axis=1).max() < 0.1


@pytest.mark.parametrize("centre", [(20.0, 20.0), (20.37, 19.81)])
def test_the_centre_of_a_disc_is_located_and_recognised_as_one(centre: tuple[float, float]) -> None:
    right, down = differences(disc(centre, 4.3))
    for kind in ("best", "circle"):
        xy, inside = precise_positions(right, down, np.array([20]), np.array([20]), 2.5, kind)
        assert inside[0]
        assert np.hypot(*(xy[0] - centre)) < 0.03
    corner, _ = precise_positions(right, down, np.array([21]), np.array([22]), 2.5, "corner")
    assert np.hypot(*(corner[0] - centre)) > 0.3


def test_local_maxima_are_those_of_comparing_every_neighbour() -> None:
    rng = np.random.default_rng(1)
    value = rng.integers(0, 12, (40, 50)).astype(np.float32)  # with many ties
    found = local_maxima(value, 2, 8.5)
    for y in range(40):
        for x in range(50):
            window = [
                (value[v, u], (v, u) < (y, x))
                for v in range(max(0, y - 2), min(40, y + 3))
                for u in range(max(0, x - 2), min(50, x + 3))
                if (v, u) != (y, x)
            ]
            own = value[y, x]
            assert found[y, x] == (own > 8.5 and all(o < own or (o == own and not e) for o, e in window))


def test_a_parabola_finds_the_top_between_pixels() -> None:
    x, y = np.meshgrid(np.arange(30.0), np.arange(20.0))
    surface = (50.0 - (x - 13.3) ** 2 - 2.0 * (y - 8.8) ** 2).astype(np.float32)
    xy, value = strongest(surface, 3, 0.0)
    assert xy == pytest.approx(np.array([[13.3, 8.8]]), abs=1e-4)
    assert value[0] == surface.max()


@pytest.mark.parametrize("name", sorted(DETECTORS))
@pytest.mark.parametrize("reduction", [1.0, 1.7])
def test_points_lie_on_the_crossings_of_a_board(name: str, reduction: float) -> None:
    image, crossings = board((131.3, 117.8))
    detect, sheet = DETECTORS[name]
    found = detect(image, image, sheet(reduction=reduction, levels=3), run=RUN)
    finest = found.scale == found.scale.min()
    apart = found.xy[finest][None] - crossings[:, None]
    nearest = np.linalg.norm(apart, axis=2).argmin(axis=1)
    errors = apart[np.arange(len(crossings)), nearest]
    assert np.abs(errors.mean(axis=0)).max() < 0.12 * reduction  # no shift of the whole photo
    assert np.percentile(np.linalg.norm(errors, axis=1), 90) < 0.6 * reduction
    coarse = found.xy[found.scale == found.scale.max()]
    errors = coarse[np.linalg.norm(coarse[None] - crossings[:, None], axis=2).argmin(axis=1)] - crossings
    assert np.abs(np.median(errors, axis=0)).max() < 0.3 * reduction


@pytest.mark.parametrize("name", sorted(DETECTORS))
def test_every_parameter_of_corners_does_what_it_says(name: str) -> None:
    image = texture()
    detect, sheet = DETECTORS[name]

    def points(**changes: object):
        return detect(image, image, sheet(**changes), run=RUN)

    usual = points(upright=True)
    assert usual.descriptors.shape == (len(usual.xy), 128) and usual.metric == "l2"
    assert len(points(radius=8, upright=True).xy) < len(usual.xy)
    one = points(levels=1, upright=True, radius=6)
    apart = np.abs(one.xy[:, None] - one.xy[None]).max(axis=2) + 99.0 * np.eye(len(one.xy))
    assert apart.min() > 4.0  # fractions of a pixel aside
    assert np.unique(points(levels=3, upright=True).scale).size == 3
    steps = np.unique(points(levels=2, scale_factor=2.0, upright=True).scale)
    assert steps[1] / steps[0] == pytest.approx(2.0)
    assert points(patch=36.0, levels=1).scale[0] == pytest.approx(6.0)  # 2 σ of 12 σ
    assert not usual.angle.any() and points().angle.any()
    least = "weight" if name == "foerstner" else "threshold"
    few, many = (points(upright=True, **{least: value}) for value in (2.0, 0.2)) if name != "harris" else (
        points(upright=True, threshold=0.2), points(upright=True, threshold=0.0001))  # fmt: skip
    assert len(few.xy) < len(many.xy)
    assert few.response.min() >= many.response.min()
    assert len(points(window=9 if name == "moravec" else 4.0, upright=True).xy) < len(usual.xy)
    plain = points(hellinger=False, upright=True).descriptors.astype(float)
    root = usual.descriptors.astype(float) / 512
    assert np.abs(root - np.sqrt(plain / plain.sum(axis=1, keepdims=True)).clip(max=255 / 512)).max() < 0.002


def test_the_edge_weight_and_the_roundness_keep_points_off_edges() -> None:
    image = np.full((120, 160), 60, np.uint8)
    for x in range(10, 150):
        image[60 + (x * 7919 % 5 > 3) :, x] = 180  # a rough edge
    edge = [harris(image, image, HarrisParams(k=k, threshold=0.0, levels=1), run=RUN).xy for k in (0.0, 0.2)]
    assert len(edge[0]) > 2 * max(1, len(edge[1]))
    slides = [foerstner(image, image, FoerstnerParams(roundness=q, weight=0.0, levels=1), run=RUN).xy for q in (0.0, 0.9)]  # fmt: skip
    assert len(slides[0]) > 2 * max(1, len(slides[1]))
