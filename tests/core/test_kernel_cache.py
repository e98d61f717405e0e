"""A changed kernel is never used in its old form."""

from __future__ import annotations

from pathlib import Path

import pytest

from graphos_core import kernel_cache


def test_the_cache_has_another_folder_when_any_kernel_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "cameras").mkdir()
    (tmp_path / "cameras" / "basic.py").write_text("from numba import njit\na = 1")
    (tmp_path / "sgm_kernels.py").write_text("b = 1")
    monkeypatch.setattr(kernel_cache, "__file__", str(tmp_path / "kernel_cache.py"))
    before = kernel_cache.kernel_fingerprint()
    assert kernel_cache.kernel_fingerprint() == before
    (tmp_path / "cameras" / "basic.py").write_text("from numba import njit\na = 2")
    assert kernel_cache.kernel_fingerprint() != before


def test_a_file_without_kernels_leaves_the_cache_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "cameras").mkdir()
    (tmp_path / "cameras" / "profile.py").write_text("a = 1")
    monkeypatch.setattr(kernel_cache, "__file__", str(tmp_path / "kernel_cache.py"))
    before = kernel_cache.kernel_fingerprint()
    (tmp_path / "cameras" / "profile.py").write_text("a = 2")
    assert kernel_cache.kernel_fingerprint() == before


def test_every_file_with_kernels_counts() -> None:
    package = Path(kernel_cache.__file__).parent
    for path in package.rglob("*.py"):
        if "@njit" in path.read_text("utf-8"):
            assert path.name.endswith("kernels.py") or path.parent.name == "cameras", path


def test_a_setting_of_the_person_stays_and_old_versions_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", "mine")
    kernel_cache.use_kernel_cache()
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr(kernel_cache, "_cache_home", lambda: tmp_path)
    for number in range(5):
        (tmp_path / "graphos-py" / f"kernels-{number}").mkdir(parents=True)
    kernel_cache.use_kernel_cache()
    found = list((tmp_path / "graphos-py").iterdir())
    assert len(found) == kernel_cache.KEPT
    assert tmp_path / "graphos-py" / f"kernels-{kernel_cache.kernel_fingerprint()}" in found
