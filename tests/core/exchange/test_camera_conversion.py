"""Camera conversion: each program's formula against an oracle, round trips through its files, residuals that are true."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from graphos_core.cameras import pixel_from_ray
from graphos_core.data import Camera
from graphos_core.errors import UserError
from graphos_core.exchange.camera_fit import (
    foreign_pixels,
    foreign_rays,
    from_foreign,
    pixel_grid,
    to_foreign,
)
from graphos_core.exchange.camera_formats import (
    CAMERA_FORMATS,
    convert_camera,
    end_to_end,
    exact,
    read_any_camera,
)
from graphos_core.exchange.conventions import CONVENTIONS
from graphos_core.exchange.dbat_script import read_script
from graphos_core.exchange.formulas import ForeignCamera, Format, formula, formulas
from graphos_core.exchange.graphos_camera import camera_text
from graphos_core.store import write_text

FRAME = Format(1201, 901, 0.004)
RAYS = np.column_stack([np.random.default_rng(0).uniform(-0.5, 0.5, (60, 2)), np.ones(60)])
K, P = (-0.11, 0.06, -0.02), (4e-4, -3e-4)


def camera(model: str, *values: float) -> Camera:
    return Camera(
        model=model, width=1201, height=901, values=np.array(values), pixel_pitch_mm=0.004, label="Lens ä 1"
    )


CAMERAS = {
    "basic": camera("basic", 1100.0, 607.0, 444.0, -0.1, 0.05),
    "basic centred": camera("basic", 1100.0, 600.0, 450.0, -0.1, 0.05),
    "brown": camera("brown", 1100.0, 607.0, 444.0, *K, 0.0, *P, 0.0, 0.0),
    "complete": camera("complete", 1100.0, 607.0, 444.0, 3.0, -2.0, *K, *P, 1e-3, -5e-4),
    "backward": camera("brown_backward", 1100.0, 607.0, 444.0, *K, *P, 0.0, 0.0),
    "backward affine": camera("brown_backward", 1100.0, 607.0, 444.0, *K, *P, 1e-3, 0.0),
    "opencv": camera("opencv", 1100.0, 607.0, 444.0, *K, 0.01, 0.005, 0.001, *P, 1e-4, 2e-5, -1e-4, 1e-5, 1e-3),
    "polynomial": camera("polynomial3", 1100.0, 607.0, 444.0, 600.0, 1.0, -2.0, 0.5, 1.5, -1.0, 2.0, *np.linspace(-3, 3, 8)),
    "fish-eye": camera("fisheye_equidistant", 380.0, 607.0, 444.0, 0.02, -0.004, 5e-4, 0, 0, 0, 0, 0),
    "fish-eye equisolid": camera("fisheye_equisolid", 380.0, 607.0, 444.0, 0.02, -0.004, 5e-4, 0, *P, 0, 0),
}  # fmt: skip

EXPRESSIBLE = [
    ("basic", "colmap"), ("basic", "metashape"), ("basic", "micmac"), ("basic", "opencv"), ("basic centred", "bundler"),
    ("brown", "colmap"), ("brown", "metashape"), ("brown", "micmac"), ("brown", "opencv"), ("complete", "micmac"),
    ("polynomial", "micmac"),
    ("backward", "photomodeler"), ("backward", "australis"), ("opencv", "opencv"), ("fish-eye", "colmap"),
    ("fish-eye", "opencv"), ("fish-eye", "metashape"), ("fish-eye equisolid", "metashape"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "to"), EXPRESSIBLE)
def test_round_trip_is_exact_where_the_target_expresses_the_camera(tmp_path, name, to):
    own = tmp_path / "own.toml"
    write_text(own, camera_text(CAMERAS[name]))
    there = convert_camera(own, tmp_path / "their.file", to)
    assert there.max_px <= 1e-6 and exact(there)
    frame = FRAME if to == "bundler" else None
    back = convert_camera(tmp_path / "their.file", tmp_path / "back.toml", "graphos", frame=frame)
    again = read_any_camera(tmp_path / "back.toml")
    pixels, difference, lost = end_to_end(CAMERAS[name], again)
    assert len(pixels) > 400 and not lost and np.abs(difference).max() <= 1e-6
    assert again.width == 1201 and back.file.is_file()


@pytest.mark.parametrize(
    ("name", "to"),
    [("basic", "photomodeler"), ("basic", "bundler"), ("complete", "colmap"), ("backward affine", "australis"),
     ("backward", "metashape"), ("fish-eye equisolid", "opencv"), ("fish-eye", "micmac")],
)  # fmt: skip
def test_what_the_target_cannot_express_is_reported_as_it_is(tmp_path, name, to):
    write_text(tmp_path / "own.toml", camera_text(CAMERAS[name]))
    there = convert_camera(tmp_path / "own.toml", tmp_path / "their.file", to)
    assert not exact(there)
    if name == "fish-eye":  # MicMac's ends at 90° from the axis: exact there, nothing beyond
        assert there.max_px < 1e-6 and there.without_image > 50 and "cannot be expressed" in there.remarks[-1]
        return
    assert 1e-6 < there.max_px < 30 and "approximated" in there.remarks[-1]
    found = read_any_camera(tmp_path / "their.file", to, FRAME)
    rays = foreign_rays(found, there.pixels)  # what the file means, against the camera that was written
    seen = np.isfinite(rays).all(axis=1)
    moved = pixel_from_ray(CAMERAS[name], rays[seen]) - there.pixels[seen]
    assert np.hypot(*moved.T).max() == pytest.approx(there.max_px, rel=0.15)


def test_a_fish_eye_is_refused_where_there_is_none(tmp_path):
    write_text(tmp_path / "own.toml", camera_text(CAMERAS["fish-eye"]))
    for to in ("photomodeler", "australis", "bundler"):
        with pytest.raises(UserError, match="no such camera"):
            convert_camera(tmp_path / "own.toml", tmp_path / "out", to)


def opencv_oracle(values, rays):
    matrix = np.array([[values[0], 0, values[2]], [0, values[1], values[3]], [0, 0, 1]])
    return cv2.projectPoints(rays, np.zeros(3), np.zeros(3), matrix, np.array(values[4:]))[0].reshape(-1, 2)


def test_opencv_yaml_is_what_opencv_reads_and_projects(tmp_path):
    for name in ("opencv", "fish-eye"):
        write_text(tmp_path / "own.toml", camera_text(CAMERAS[name]))
        convert_camera(tmp_path / "own.toml", tmp_path / "c.yaml", "opencv")
        storage = cv2.FileStorage(str(tmp_path / "c.yaml"), cv2.FILE_STORAGE_READ)
        matrix, d = storage.getNode("camera_matrix").mat(), storage.getNode("distortion_coefficients").mat()
        assert int(storage.getNode("image_width").real()) == 1201
        project = cv2.fisheye.projectPoints if name == "fish-eye" else cv2.projectPoints
        there = project(RAYS.reshape(-1, 1, 3), np.zeros(3), np.zeros(3), matrix, d)[0].reshape(-1, 2)
        np.testing.assert_allclose(there, pixel_from_ray(CAMERAS[name], RAYS), atol=1e-6)


@pytest.mark.parametrize("name", [n for n in formulas() if n.startswith("colmap ")])
def test_colmap_formulas_are_those_of_pycolmap(name):
    pycolmap = pytest.importorskip("pycolmap")
    f = formula(name)
    rng = np.random.default_rng(3)
    values = f.start(1000.0, np.array([610.0, 440.0]), FRAME)
    extra = len(f.parameters) - (4 if "fx" in f.parameters else 3)
    if extra:
        values[-extra:] += rng.normal(0, 0.02, extra)
    theirs = pycolmap.Camera(model=name.split()[1], width=1201, height=901, params=values).img_from_cam(RAYS)
    source = ForeignCamera(name, values, FRAME)
    np.testing.assert_allclose(foreign_pixels(source, RAYS), theirs - 0.5, atol=1e-9)
    np.testing.assert_allclose(np.cross(foreign_rays(source, theirs - 0.5), RAYS), 0, atol=1e-9)


def test_opencv_formulas_are_those_of_opencv():
    d = np.array([*K[:2], *P, K[2], 0.01, 0.005, 0.001, 1e-4, 2e-5, -1e-4, 1e-5])
    for count in (4, 5, 8, 12):
        values = np.array([1100.0, 1105.0, 607.0, 444.0, *d[:count]])
        np.testing.assert_allclose(foreign_pixels(ForeignCamera(f"opencv {count}", values, FRAME), RAYS),
                                   opencv_oracle(values, RAYS), atol=1e-9)  # fmt: skip


def test_metashape_and_micmac_are_brown_in_their_units():
    """Both against OpenCV: its p1, p2 exchanged, Metashape's centre at w/2 from the corner, MicMac's powers of px."""
    f, x0, y0 = 1100.0, 607.0, 444.0
    theirs = opencv_oracle([f, f, x0, y0, K[0], K[1], P[1], P[0], K[2]], RAYS)
    metashape = [f, x0 - 600.0, y0 - 450.0, *K, 0.0, *P, 0.0, 0.0]  # (w − 1) / 2 = 600
    np.testing.assert_allclose(
        foreign_pixels(ForeignCamera("metashape frame", np.array(metashape), FRAME), RAYS), theirs, atol=1e-9
    )
    powers = [K[0] / f**2, K[1] / f**4, K[2] / f**6, 0.0, 0.0]
    micmac = [f, x0, y0, x0, y0, *powers, P[0] / f, P[1] / f, 0.0, 0.0]
    np.testing.assert_allclose(
        foreign_pixels(ForeignCamera("micmac ModPhgrStd", np.array(micmac), FRAME), RAYS), theirs, atol=1e-9
    )


def test_photomodeler_and_australis_differ_by_their_origin():
    pitch, c, k, p = 0.004, 4.4, np.array([5e-3, -4e-5, 1e-6]), np.array([6e-5, -4e-5])
    corner = np.array([2.43, 1.77])
    offset = [corner[0] - 1201 * pitch / 2, -(corner[1] - 901 * pitch / 2)]
    pixels = pixel_grid(FRAME, 7)
    a = foreign_rays(ForeignCamera("photomodeler", np.array([c, *corner, *k, *p]), FRAME), pixels)
    b = foreign_rays(ForeignCamera("australis", np.array([c, *offset, *k, *p, 0, 0]), FRAME), pixels)
    np.testing.assert_allclose(a, b, atol=1e-12)
    centre = foreign_rays(ForeignCamera("australis", np.array([c, *offset, *k, *p, 0, 0]), FRAME),
                          (corner / pitch - 0.5)[None])  # fmt: skip
    np.testing.assert_allclose(centre, [[0, 0, 1]], atol=1e-12)


@pytest.mark.data
def test_dbat_camera_is_brown_backward(data_dir, tmp_path):
    """DBAT's calibrated camera: our model expresses it, and its rays are those that reproduce sigma0 of camcaldemo."""
    found = read_any_camera(data_dir / "dbat/camcaldemo/result/c4040z.xml")
    made = from_foreign(found)
    assert made.camera.model == "brown_backward" and made.exact
    assert made.camera.values[made.camera.values.size - 2] == pytest.approx(0.000389598, abs=1e-8)  # b1
    case = read_script(data_dir / "dbat/camcaldemo/camcaldemo.xml")
    v = {n: found.value(n) for n in ("cc", "px", "py", "as", "K1", "K2", "K3", "P1", "P2")}
    own = replace(case.camera, constant_mm=v["cc"], principal_mm=np.array([v["px"], v["py"]]), aspect=v["as"],
                  k=np.array([v["K1"], v["K2"], v["K3"]]), p=np.array([v["P1"], v["P2"]]))  # fmt: skip
    pixels = case.block.obs_xy[::50]
    rays = foreign_rays(found, pixels)
    np.testing.assert_allclose(rays[:, :2] * v["cc"], own.ideal_mm(pixels), atol=1e-12)
    to_pm = convert_camera(
        data_dir / "dbat/camcaldemo/result/c4040z.xml", tmp_path / "pm.txt", "photomodeler"
    )
    assert to_pm.max_px < 0.6  # PhotoModeler has no affinity: 3.9e-4 over half the format


def test_a_report_of_australis_is_read(tmp_path):
    """Layout of Australis 6, final values in the third column (values of a published WASP-LT calibration)."""
    path = tmp_path / "camera3.txt"
    path.write_text(
        "Australis Bundle Adjustment Results: Camera Parameters\nSensor Size   Pixel Size (mm)\nH  648   0.007\nV  494   0.007\n"
        "Variable  Value  Adjustment  Value  Std. Error  Std. Error\n"
        "C   8.0000  0.30937  8.3094  1.0e+003  6.782e-003 (mm)\nXP  0.0000 -0.02804 -0.0280  1.0e+003  6.879e-003 (mm)\n"
        "YP  0.0000  0.02142  0.0214  1.0e+003  7.204e-003 (mm)\nK1  0.00000e+000  1.674e-003  1.67381e-003  1.0e+003  1.238e-004\n"
        "B1  0.00000e+000 -4.343e-004 -4.34298e-004  1.0e+003  1.100e-004\n"
    )
    found = read_any_camera(path)
    assert found.formula == "australis" and found.frame == Format(648, 494, 0.007)
    assert [found.value(n) for n in ("c", "xp", "yp", "K1", "K2", "B1")] == [
        8.3094,
        -0.028,
        0.0214,
        1.67381e-3,
        0,
        -4.34298e-4,
    ]


@pytest.mark.parametrize("convention", CONVENTIONS, ids=lambda c: c.program)
def test_the_origin_of_the_conventions_table_is_the_one_of_the_formulas(convention):
    """A camera that looks through the first pixel's centre: where the program puts it is what the table says."""
    for name in convention.formats:
        f = next((f for n, f in formulas().items() if n.split()[0] == name), None)
        if f is None:
            continue
        assert convention.direction == f.direction
        values = f.start(1000.0, np.array([0.0, 0.0]), FRAME)
        if convention.first_pixel is not None:
            principal = {"colmap": values[1:3], "opencv": values[2:4], "micmac": values[1:3],
                         "metashape": values[1:3] + np.array([1201 / 2, 901 / 2]),
                         "photomodeler": values[1:3] / 0.004, "dbat": values[1:3] / 0.004}[name]  # fmt: skip
            np.testing.assert_allclose(principal, convention.first_pixel, atol=1e-12)


def test_every_written_format_has_a_convention():
    named = {name for convention in CONVENTIONS for name in convention.formats}
    assert set(CAMERA_FORMATS) <= named


@pytest.mark.parametrize(
    ("to", "old", "new", "said"),
    [
        ("metashape", "<f>", "<f>x", "numbers"), ("metashape", "<k1>", "<k1>nan", "numbers"),
        ("metashape", "<projection>frame", "<projection>rpc", "rpc"),
        ("micmac", "eConvApero_DistM2C", "eConvApero_DistC2M", "convention"), ("micmac", "<F>", "<F>-", "not possible"),
        ("opencv", "data: [ 1100.0", "data: [ .nan", "camera_matrix"), ("opencv", "camera_matrix", "kamera", "camera_matrix"),
        ("colmap", "607.5", "nan", "Line 3"), ("colmap", "RADIAL", "RADIALISH", "not supported"),
        ("bundler", "f k1 k2\n1", "f k1 k2\ninf", "f, k1, k2"), ("photomodeler", "Fw - format width", "Fx", "Fw"),
        ("australis", "XP", "QQ", "C and XP"), ("australis", "C   ", "C   x", "a number"),
    ],
)  # fmt: skip
def test_damaged_camera_files_are_refused_with_a_sentence(tmp_path, to, old, new, said):
    write_text(tmp_path / "own.toml", camera_text(CAMERAS["basic"]))
    convert_camera(tmp_path / "own.toml", tmp_path / "their.file", to)
    text = (tmp_path / "their.file").read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "their.file").write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(UserError, match=said):
        read_any_camera(tmp_path / "their.file", to, FRAME)


@pytest.mark.parametrize("text", ["", "hello", "[camera]\nmodel = 'basic'\n", "[camera.values]\nfocal_px = nan\n",
                                  camera_text(CAMERAS["basic"]).replace("x0 =", "q0 =")])  # fmt: skip
def test_what_is_no_camera_is_refused(tmp_path, text):
    path = tmp_path / "c.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError):
        read_any_camera(path)


def test_a_format_in_millimetres_needs_the_pixel_size():
    nameless = Camera(model="basic", width=1201, height=901, values=CAMERAS["basic"].values)
    with pytest.raises(UserError, match="pixels on the sensor is not known"):
        to_foreign(nameless, "australis")
    with pytest.raises(UserError, match="format in pixels is not known"):
        to_foreign(Camera(model="basic", width=0, height=0, values=CAMERAS["basic"].values), "colmap RADIAL")
