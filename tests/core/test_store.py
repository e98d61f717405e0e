"""The store: what is read is what was written, results are complete or absent, and never overwritten."""

from __future__ import annotations

import errno
import io
import json
import math
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from graphos_core.data import Block, Camera, Exif, Photo, PhotoSet
from graphos_core.errors import ItemFailure, UserError
from graphos_core.store import Store, content_key, write_text


def sample() -> PhotoSet:
    photo = Photo(
        name="ä b.jpg", path="x", width=4, height=3, bits=8, channels=3, camera=0, digest="d", exif=Exif()
    )
    camera = Camera(model="basic", width=4, height=3, values=np.array([5.0, 1.5, 1.0, 0.0, math.pi]))
    return PhotoSet(photos=(photo,), cameras=(camera,), failures=(ItemFailure("a.jpg", "no picture"),))


def test_a_tree_of_records_comes_back_the_same(tmp_path: Path) -> None:
    Store(tmp_path).save("photos", "k", sample(), {"line": "one"})
    back = Store(tmp_path).load("photos", "k")
    assert back.photos[0].name == "ä b.jpg"
    assert back.failures == (ItemFailure("a.jpg", "no picture"),)
    np.testing.assert_array_equal(back.cameras[0].values, sample().cameras[0].values)
    assert Store(tmp_path).about("photos", "k") == {"line": "one"}


def test_numbers_that_json_does_not_know_come_back(tmp_path: Path) -> None:
    Store(tmp_path).save("s", "k", {"a": math.inf, "b": (math.nan, None, True, 3)}, {})
    back = Store(tmp_path).load("s", "k")
    assert back["a"] == math.inf
    assert math.isnan(back["b"][0])
    assert back["b"][1:] == (None, True, 3)


def test_the_same_result_has_the_same_bytes(tmp_path: Path) -> None:
    for name in "ab":
        Store(tmp_path / name).save("photos", "k", sample(), {})
    files = [
        (tmp_path / n / "photos" / "k" / f).read_bytes() for f in ("arrays.npz", "result.json") for n in "ab"
    ]
    assert files[0] == files[1]
    assert files[2] == files[3]


def test_an_existing_result_is_never_overwritten(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.save("s", "k", 1, {})
    store.save("s", "k", 2, {})
    assert Store(tmp_path).load("s", "k") == 1


def test_a_half_written_result_does_not_exist(tmp_path: Path) -> None:
    store = Store(tmp_path)
    begun = store.begin("s")
    (begun / "file.png").write_bytes(b"half")
    assert store.keys("s") == []
    Store(tmp_path).sweep()
    assert begun.exists()  # this process may still be writing it


def test_what_a_killed_program_left_is_swept_away(tmp_path: Path) -> None:
    killed = subprocess.run(
        [sys.executable, "-c", f"from pathlib import Path; from graphos_core.store import Store\n"
         f"Store(Path({str(tmp_path)!r})).begin('s')"], check=True)  # fmt: skip
    assert killed.returncode == 0
    assert len(list((tmp_path / "s").iterdir())) == 1
    Store(tmp_path).sweep()
    assert list((tmp_path / "s").iterdir()) == []


def test_a_full_disk_is_said_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*args: Any, **kwargs: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("graphos_core.store._write_arrays", full)
    with pytest.raises(UserError, match="disk is full"):
        Store(tmp_path).save("s", "k", np.zeros(3), {})
    assert list((tmp_path / "s").iterdir()) == []


def test_a_damaged_result_is_a_sentence_not_a_traceback(tmp_path: Path) -> None:
    Store(tmp_path).save("s", "k", np.arange(3), {})
    (tmp_path / "s" / "k" / "arrays.npz").write_bytes(b"PK damaged")
    with pytest.raises(UserError, match="cannot be read"):
        Store(tmp_path).load("s", "k")
    (tmp_path / "s" / "k" / "result.json").write_text(
        json.dumps({"format": 1, "value": {"record": "Evil", "fields": {}}})
    )
    with pytest.raises(UserError, match="cannot be read"):
        Store(tmp_path).load("s", "k")


def test_pickled_arrays_from_strangers_are_refused(tmp_path: Path) -> None:
    Store(tmp_path).save("s", "k", np.arange(3), {})
    shutil.rmtree(tmp_path / "s" / "k" / "arrays.npz", ignore_errors=True)
    np.savez(tmp_path / "s" / "k" / "arrays.npz", a0=np.array([{"x": 1}], dtype=object))
    with pytest.raises(UserError, match="cannot be read"):
        Store(tmp_path).load("s", "k")


def test_a_key_depends_on_every_part_and_on_nothing_else() -> None:
    base = {"algorithm": "a", "params": {"x": 1.0, "y": 2}}
    assert content_key(base) == content_key({"params": {"y": 2, "x": 1.0}, "algorithm": "a"})
    assert content_key(base) != content_key({**base, "params": {"x": 1.0, "y": 3}})


def test_writing_text_leaves_the_old_file_when_it_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "f.txt"
    write_text(path, "old")
    monkeypatch.setattr("os.fsync", lambda fd: (_ for _ in ()).throw(OSError(errno.ENOSPC, "full")))
    with pytest.raises(UserError, match="disk is full"):
        write_text(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["f.txt"]


@pytest.mark.parametrize("text", ["[1]", '{"format":1,"value":' + "[" * 20000 + "]" * 20000 + "}"])
def test_a_hostile_result_is_refused_in_a_sentence(tmp_path: Path, text: str) -> None:
    store = Store(tmp_path)
    store.save("x", "k", (1,), {})
    (tmp_path / "x" / "k" / "result.json").write_text(text)
    (tmp_path / "x" / "k" / "about.json").write_text("[1]")
    with pytest.raises(UserError, match="cannot be read"):
        store.load("x", "k")
    assert store.about("x", "k") == {}


def test_an_array_that_claims_more_than_the_memory_is_refused(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.save("x", "k", np.zeros(3), {})
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (10**13,)})
    with zipfile.ZipFile(tmp_path / "x" / "k" / "arrays.npz", "w") as archive:
        archive.writestr("a0.npy", header.getvalue())
    with pytest.raises(UserError, match="cannot be read"):
        store.load("x", "k")


@pytest.mark.parametrize("field", ["obs_photo", "obs_point", "camera_of_photo"])
def test_a_stored_block_whose_indices_do_not_exist_never_reaches_the_compiled_loops(
    tmp_path: Path, field: str
) -> None:
    camera = Camera(model="pinhole", width=100, height=80, values=np.array([100.0, 49.5, 39.5]))
    arrays = {
        "camera_of_photo": np.zeros(2, np.int32),
        "obs_photo": np.array([0, 1], np.int32),
        "obs_point": np.zeros(2, np.int32),
    }
    block = {
        "cameras": (camera,), "names": ("a", "b"), "oriented": np.ones(2, bool),
        "rotations": np.tile(np.eye(3), (2, 1, 1)), "centres": np.zeros((2, 3)), "points": np.ones((1, 3)),
        "colours": np.zeros((1, 3), np.uint8), "point_track": np.zeros(1, np.int32), "obs_xy": np.ones((2, 2)),
    }  # fmt: skip
    store = Store(tmp_path)
    store.save("x", "good", Block(**block, **arrays), {})
    assert store.load("x", "good").names == ("a", "b")
    arrays[field] = np.array([0, 10**6], np.int32)
    store.save("x", "bad", Block(**block, **arrays), {})
    with pytest.raises(UserError, match="do not exist"):
        store.load("x", "bad")
