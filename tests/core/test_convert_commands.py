"""``graphos convert``: what is printed, exit codes, and that nothing ends in a traceback."""

from __future__ import annotations

import numpy as np
import pytest

from graphos_core.cli import DONE, FAILED, USAGE, main
from graphos_core.data import Camera
from graphos_core.exchange.bundler import read_bundler
from graphos_core.exchange.graphos_camera import camera_text, read_camera

CAMERA = Camera(model="brown", width=1201, height=901, label="Lens",
                values=np.array([1100.0, 607.0, 444.0, -0.1, 0.05, 0, 0, 4e-4, -3e-4, 0, 0]))  # fmt: skip


@pytest.fixture
def own(tmp_path):
    path = tmp_path / "lens.toml"
    path.write_text(camera_text(CAMERA), encoding="utf-8")
    return path


def test_a_camera_goes_there_and_back(own, tmp_path, capsys):
    assert main(["convert", "camera", str(own), str(tmp_path / "m.xml"), "--to", "metashape"]) == DONE
    assert "Exact" in capsys.readouterr().out
    assert (
        main(
            [
                "convert",
                "camera",
                str(tmp_path / "m.xml"),
                str(tmp_path / "b.toml"),
                "--to",
                "graphos",
                "--model",
                "brown",
            ]
        )
        == DONE
    )
    np.testing.assert_allclose(read_camera(tmp_path / "b.toml").values, CAMERA.values, atol=1e-7)


def test_what_is_lost_is_printed_in_pixels(own, tmp_path, capsys):
    assert (
        main(
            [
                "convert",
                "camera",
                str(own),
                str(tmp_path / "a.txt"),
                "--to",
                "australis",
                "--pixel-mm",
                "0.004",
            ]
        )
        == DONE
    )
    said = capsys.readouterr().out
    assert "Largest difference" in said and "px" in said and "Exact" not in said


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--to", "australis"], "pixels on the sensor"), (["--to", "nothing"], "Valid: metashape"),
        (["--to", "dbat"], "only read"), (["--to", "opencv", "--from", "micmac"], "not plain XML"),
        (["--to", "australis", "--pixel-mm", "7"], "not possible"), (["--to", "graphos", "--from", "nothing"], "Unknown"),
    ],
)  # fmt: skip
def test_failures_are_sentences(own, tmp_path, capsys, words, said):
    assert main(["convert", "camera", str(own), str(tmp_path / "out"), *words]) == FAILED
    captured = capsys.readouterr()
    assert said in captured.err and "Traceback" not in captured.err


def test_wrong_usage():
    for words in (
        ["convert"],
        ["convert", "camera", "a", "b"],
        ["convert", "camera", "a", "b", "--to", "x", "--size", "1"],
    ):
        with pytest.raises(SystemExit) as caught:
            main(words)
        assert caught.value.code == USAGE


def test_formats_are_listed(capsys):
    assert main(["convert", "formats"]) == DONE
    said = capsys.readouterr().out
    for word in ("metashape", "colmap-binary", "micmac", "table", "poses only"):
        assert word in said


@pytest.mark.data
def test_a_colmap_model_goes_to_bundler_and_its_points_to_micmac(data_dir, tmp_path, capsys):
    model = data_dir / "lund_door" / "colmap_ground_truth"
    assert (
        main(["convert", "orientation", str(model), str(tmp_path / "bundle.out"), "--to", "bundler"]) == DONE
    )
    assert "12 of 12 photos oriented" in capsys.readouterr().out
    assert len(read_bundler(tmp_path / "bundle.out").block.points) == 11384
    assert (
        main(
            [
                "convert",
                "orientation",
                str(model),
                str(tmp_path / "eo.csv"),
                "--to",
                "table",
                "--angle-unit",
                "gon",
            ]
        )
        == DONE
    )
    capsys.readouterr()
    assert (
        main(
            ["convert", "orientation", str(tmp_path / "eo.csv"), str(tmp_path / "x.xml"), "--to", "metashape"]
        )
        == FAILED
    )
    assert "--camera" in capsys.readouterr().err
    assert (
        main(["convert", "orientation", str(tmp_path / "absent"), str(tmp_path / "x"), "--to", "nvm"])
        == FAILED
    )
