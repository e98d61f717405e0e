"""The result store: every result under a key made of what produced it, written atomically, never overwritten.

A result is a tree of records (see `graphos_core.data.record`), tuples, dicts, arrays and plain values. It becomes a
folder with ``result.json`` (the tree) and ``arrays.npz`` (the arrays, never pickled). The folder is written under a
temporary name and renamed, so a result is either complete or absent.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
import shutil
import time
import uuid
import zipfile
import zlib
from collections import OrderedDict
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from graphos_core.data.record import RECORDS
from graphos_core.errors import ItemFailure, UserError
from graphos_core.text import Text

KEPT = 16
"""Results kept in memory after they were read."""

FORMAT = 1
"""Raised when the layout of a stored result changes; other versions are not read."""

UNREADABLE = (
    OSError,
    ValueError,
    KeyError,
    TypeError,
    AttributeError,
    MemoryError,
    RecursionError,
    zipfile.BadZipFile,
    zlib.error,
)
"""What reading a damaged or hostile result raises: any nesting, any size it claims."""

RECORDS.setdefault("ItemFailure", ItemFailure)


def content_key(parts: Mapping[str, Any]) -> str:
    """Return the key of a result: SHA-256 of what produced it, 24 hexadecimal digits.

    Parameters
    ----------
    parts : mapping
        Algorithm and version, parameters, seed, keys of the inputs: anything JSON can hold.
    """
    text = json.dumps(parts, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def write_text(path: Path, text: str) -> None:
    """Write a text file atomically in UTF-8.

    Raises
    ------
    UserError
        When the folder cannot be written or the disk is full.
    """
    write_bytes(path, text.encode())


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file atomically: a temporary name beside it, then a rename.

    Raises
    ------
    UserError
        When the folder cannot be written or the disk is full.
    """
    temporary = path.with_name(f".{path.name}.{uuid.uuid4().hex[:8]}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except OSError as problem:
        with suppress(OSError):
            temporary.unlink()
        raise cannot_write(path, problem) from problem


def cannot_write(path: Path, problem: OSError) -> UserError:
    """Say in three sentences that `path` could not be written."""
    if problem.errno == 28:
        return UserError(
            Text("{name} could not be written.", name=path.name),
            "The disk is full.",
            "Free some space and run again; everything finished before is kept.",
        )
    return UserError(
        Text("{name} could not be written.", name=str(path)),
        Text("The system says: {why}.", why=problem.strerror or str(problem)),
        "Choose a folder you may write to; everything finished before is kept.",
    )


class Store:
    """Results on disk, by stage and key.

    Parameters
    ----------
    folder : Path
        Folder of the store; made when the first result is written.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._recent: OrderedDict[tuple[str, str], Any] = OrderedDict()

    def path(self, stage: str, key: str) -> Path:
        """Folder of one result, whether it exists or not."""
        return self.folder / stage / key

    def has(self, stage: str, key: str) -> bool:
        """Say whether a complete result exists."""
        return (self.path(stage, key) / "result.json").is_file()

    def keys(self, stage: str) -> list[str]:
        """Return the keys of all complete results of a stage, oldest first."""
        folder = self.folder / stage
        if not folder.is_dir():
            return []
        found = [p for p in folder.iterdir() if not p.name.startswith(".") and (p / "result.json").is_file()]
        return [p.name for p in sorted(found, key=lambda p: ((p / "result.json").stat().st_mtime_ns, p.name))]

    def begin(self, stage: str) -> Path:
        """Make a temporary folder for a result that also has files of its own; hand it to `save`.

        Raises
        ------
        UserError
            When the folder cannot be written.
        """
        temporary = self.folder / stage / f".{os.getpid()}-{uuid.uuid4().hex[:8]}.part"
        try:
            temporary.mkdir(parents=True)
        except OSError as problem:
            raise cannot_write(self.folder, problem) from problem
        return temporary

    def save(
        self, stage: str, key: str, value: Any, about: Mapping[str, Any], begun: Path | None = None
    ) -> None:
        """Write a result completely, or not at all; an existing one is kept as it is.

        Parameters
        ----------
        stage, key : str
        value : record, tuple, dict, array or plain value
        about : mapping
            What produced it, for people; written to ``about.json``.
        begun : Path, optional
            Temporary folder from `begin` with files that belong to the result.

        Raises
        ------
        UserError
            When the disk is full or the folder cannot be written.
        """
        target = self.path(stage, key)
        temporary = begun or self.begin(stage)
        try:
            arrays: dict[str, np.ndarray[Any, Any]] = {}
            tree = _encode(value, arrays)
            if arrays:
                _write_arrays(temporary / "arrays.npz", arrays)
            (temporary / "about.json").write_text(json.dumps(about, indent=1, ensure_ascii=False), "utf-8")
            text = json.dumps({"format": FORMAT, "value": tree}, ensure_ascii=False, allow_nan=False)
            with (temporary / "result.json").open("w", encoding="utf-8") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            if self.has(stage, key):
                shutil.rmtree(temporary)
                return
            if target.exists():  # a folder without result.json is no result
                shutil.rmtree(target)
            temporary.rename(target)
        except OSError as problem:
            shutil.rmtree(temporary, ignore_errors=True)
            raise cannot_write(Path(f"The result of the step “{stage}”"), problem) from problem
        except BaseException:
            shutil.rmtree(temporary, ignore_errors=True)
            raise

    def load(self, stage: str, key: str) -> Any:
        """Read a result.

        Raises
        ------
        UserError
            When it is not there, damaged, or of another format.
        """
        if (stage, key) in self._recent:
            self._recent.move_to_end((stage, key))
            return self._recent[stage, key]
        value = self._read(stage, key)
        self._recent[stage, key] = value
        while len(self._recent) > KEPT:
            self._recent.popitem(last=False)
        return value

    def _read(self, stage: str, key: str) -> Any:
        folder = self.path(stage, key)
        try:
            document = json.loads((folder / "result.json").read_text("utf-8"))
            if not isinstance(document, dict) or document.get("format") != FORMAT:
                raise ValueError("another format")
            arrays: dict[str, Any] = {}
            if (folder / "arrays.npz").is_file():
                with np.load(folder / "arrays.npz", allow_pickle=False) as loaded:
                    arrays = {name: loaded[name] for name in loaded.files}
            return _decode(document["value"], arrays)
        except UNREADABLE as problem:
            raise UserError(
                Text("The stored {stage} result {key} cannot be read.", stage=stage, key=key),
                Text("The files are incomplete or were made by another version ({why}).", why=problem),
                "Run the stage again; delete the damaged result to free its space.",
            ) from problem

    def take_over(self, other: Store, stage: str, key: str) -> bool:
        """Put a result of another store into this one and say whether it is there now; nothing is computed.

        Files are linked where the file system can, for results are never written to again, else copied.

        Raises
        ------
        UserError
            When the folder cannot be written or the disk is full.
        """
        if self.has(stage, key) or not other.has(stage, key):
            return self.has(stage, key)
        folder, target = self.begin(stage), self.path(stage, key)
        try:
            shutil.rmtree(folder)
            shutil.copytree(other.path(stage, key), folder, copy_function=_link_or_copy)
            folder.replace(target)
        except OSError as problem:
            shutil.rmtree(folder, ignore_errors=True)
            raise cannot_write(target, problem) from problem
        return True

    def about(self, stage: str, key: str) -> dict[str, Any]:
        """Return what produced a result; empty when unreadable."""
        try:
            found = json.loads((self.path(stage, key) / "about.json").read_text("utf-8"))
        except (OSError, ValueError, RecursionError):
            return {}
        return found if isinstance(found, dict) else {}

    def size(self, stage: str, key: str) -> int:
        """Return the bytes a result takes on disk."""
        return sum(p.stat().st_size for p in self.path(stage, key).rglob("*") if p.is_file())

    def delete(self, stage: str, key: str) -> None:
        """Delete one result that the person chose; its name must be a plain key."""
        if Path(key).name != key or key.startswith("."):
            raise ValueError(key)
        self._recent.pop((stage, key), None)
        shutil.rmtree(self.path(stage, key), ignore_errors=True)

    def abandon(self, begun: Path) -> None:
        """Remove a temporary folder from `begin` whose work failed or was stopped."""
        shutil.rmtree(begun, ignore_errors=True)

    def sweep(self) -> None:
        """Remove what killed runs left half written; what a running program is writing stays."""
        for part in self.folder.glob("*/.*.part"):
            if not _is_running(part):
                shutil.rmtree(part, ignore_errors=True)


def _link_or_copy(source: str, target: str) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


def _is_running(part: Path) -> bool:
    """Say whether the program that began a temporary folder may still be writing it."""
    if os.name != "posix":  # there signal 0 is not a question
        return time.time() - part.stat().st_mtime < 3600.0
    owner = part.name[1:].partition("-")[0]
    if not owner.isdigit():
        return False
    try:
        os.kill(int(owner), 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _write_arrays(path: Path, arrays: Mapping[str, np.ndarray[Any, Any]]) -> None:
    """Write an npz whose bytes depend on the arrays alone: no time stamps."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED, allowZip64=True) as archive:
        for name, array in arrays.items():
            entry = zipfile.ZipInfo(name + ".npy", (1980, 1, 1, 0, 0, 0))
            with archive.open(entry, "w", force_zip64=True) as file:
                np.lib.format.write_array(file, np.asanyarray(array), allow_pickle=False)


def _encode(value: Any, arrays: dict[str, np.ndarray[Any, Any]]) -> Any:
    if isinstance(value, np.ndarray):
        name = f"a{len(arrays)}"
        arrays[name] = value
        return {"array": name}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        if RECORDS.get(type(value).__name__) is not type(value):
            raise TypeError(f"{type(value).__name__} is not a record")
        fields = {f.name: _encode(getattr(value, f.name), arrays) for f in dataclasses.fields(value)}
        return {"record": type(value).__name__, "fields": fields}
    if isinstance(value, (tuple, list)):
        return {"tuple": [_encode(v, arrays) for v in value]}
    if isinstance(value, dict):
        return {"dict": [[k, _encode(v, arrays)] for k, v in value.items()]}
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return {"float": repr(value)}
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"a result cannot hold a {type(value).__name__}")


def _record_type(name: str) -> type[Any]:
    """Return a record class by name; the modules that declare records are imported first."""
    import graphos_core.results  # noqa: F401  (declares the records of the stages)

    return RECORDS[name]


def _decode(tree: Any, arrays: Mapping[str, Any]) -> Any:
    if not isinstance(tree, dict):
        return tree
    if "array" in tree:
        return arrays[tree["array"]]
    if "record" in tree:
        made = _record_type(tree["record"])(**{k: _decode(v, arrays) for k, v in tree["fields"].items()})
        if hasattr(made, "check_arrays"):
            made.check_arrays()
        return made
    if "tuple" in tree:
        return tuple(_decode(v, arrays) for v in tree["tuple"])
    if "dict" in tree:
        return {k: _decode(v, arrays) for k, v in tree["dict"]}
    return float(tree["float"])
