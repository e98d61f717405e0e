"""Where compiled kernels are kept, so that a changed kernel is never used in its old form.

numba keeps a compiled function until *its own* file changes; the functions compiled into it may have changed since.
The cache's folder is therefore named after the content of all kernel files.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import sys
from contextlib import suppress
from pathlib import Path

KEPT = 3
"""How many versions of the compiled kernels stay on disk."""


def kernel_fingerprint() -> str:
    """Return a hash of every file with kernels, 12 hexadecimal digits.

    In ``cameras/`` some kernels lie beside their model; there the files that name numba count.
    """
    package = Path(__file__).parent
    digest = hashlib.sha256()
    for path in sorted({*package.rglob("*kernels.py"), *(package / "cameras").glob("*.py")}):
        content = path.read_bytes()
        if path.name.endswith("kernels.py") or b"numba" in content:
            digest.update(path.name.encode() + content)
    return digest.hexdigest()[:12]


def use_kernel_cache() -> None:
    """Tell numba, before it is imported, where to keep compiled kernels; an own setting of the person stays."""
    if "NUMBA_CACHE_DIR" in os.environ:
        return
    with suppress(OSError, RuntimeError):  # without a place to write, numba finds one or compiles each time
        home = _cache_home() / "graphos-py"
        folder = home / f"kernels-{kernel_fingerprint()}"
        if not folder.is_dir():
            folder.mkdir(parents=True)
            _remove_old(home, folder)
        os.environ["NUMBA_CACHE_DIR"] = str(folder)


def _cache_home() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")


def _remove_old(home: Path, new: Path) -> None:
    others = sorted(
        (f for f in home.glob("kernels-*") if f != new), key=lambda f: f.stat().st_mtime, reverse=True
    )
    for folder in others[KEPT - 1 :]:
        shutil.rmtree(folder, ignore_errors=True)
