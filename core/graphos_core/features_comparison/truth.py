"""The homography between two photos, read from a file."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.errors import UserError
from graphos_core.text import Text

LARGEST_FILE = 1_000_000
"""Bytes; a file with nine numbers is much smaller."""


def read_homography(path: Path) -> Array:
    """Read the homography that maps photo 1 to photo 2, float64 (3, 3), px, centre of the top-left pixel (0, 0).

    OpenCV's files (XML, YAML, JSON: the first matrix of three rows and columns) and plain text with nine numbers.

    Raises
    ------
    UserError
        When the file is missing or holds no such matrix, or one that cannot be inverted.
    """
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise _wrong(path, "It is too large for a file with nine numbers.")
        text = path.read_text("utf-8")
    except UnicodeDecodeError as problem:
        raise _wrong(path, "It is no text file.") from problem
    except OSError as problem:
        raise _wrong(path, problem.strerror or str(problem)) from problem
    structured = path.suffix.lower() in (".xml", ".yml", ".yaml", ".json") or text.lstrip().startswith(
        ("<", "%YAML")
    )
    matrix = _of_opencv(path, text) if structured else _of_text(path, text)
    if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix / np.abs(matrix).max())) < 1e-12:
        raise _wrong(path, "The matrix cannot be inverted.")
    return matrix


def _of_opencv(path: Path, text: str) -> Array:
    try:
        storage = cv2.FileStorage(text, cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY)
        root = storage.root()
        nodes = [root.getNode(key) for key in root.keys()]  # noqa: SIM118 - a cv2.FileNode is no dictionary
        for node in nodes:
            if node.isMap() and {"rows", "cols", "data"} <= set(node.keys()):
                matrix = node.mat()
                if matrix.shape == (3, 3):
                    return np.asarray(matrix, dtype=np.float64)
    except (cv2.error, SystemError) as problem:
        raise _wrong(path, "It cannot be read as a file of OpenCV.") from problem
    raise _wrong(path, "It holds no matrix of three rows and three columns.")


def _of_text(path: Path, text: str) -> Array:
    lines = [line.partition("#")[0] for line in text.splitlines()]
    words = " ".join(lines).replace(",", " ").replace(";", " ").split()
    try:
        numbers = np.array([float(word) for word in words])
    except ValueError as problem:
        raise _wrong(path, f"It holds more than numbers: {problem}.") from problem
    if len(numbers) != 9:
        raise _wrong(path, Text("It holds {n} numbers.", n=len(numbers)))
    return numbers.reshape(3, 3)


def check_homography(matrix: Array, first: tuple[int, int], second: tuple[int, int]) -> None:
    """Raise a `UserError` when a homography maps no part of photo 1 into photo 2 (width, height each)."""
    x, y = np.meshgrid(np.linspace(0, first[0] - 1, 25), np.linspace(0, first[1] - 1, 25))
    _, inside = mapped(matrix, np.stack([x.ravel(), y.ravel()], axis=1), second)
    if not inside.any():
        raise UserError(
            "The homography maps no part of photo 1 into photo 2.",
            "It belongs to other photos or to the other direction.",
            "Name the photos in the order of the homography: from photo 1 to photo 2.",
        )


def mapped(matrix: Array, xy: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """Return points mapped by a homography, float64 (n, 2), and which lie in a photo of `size` (width, height)."""
    raised = np.column_stack([xy, np.ones(len(xy))]) @ (matrix / matrix[2, 2] if matrix[2, 2] else matrix).T
    front = raised[:, 2] > 1e-9
    result = raised[:, :2] / np.where(front, raised[:, 2], 1.0)[:, None]
    inside = front & (result >= -0.5).all(axis=1) & (result <= np.array(size) - 0.5).all(axis=1)
    return result, inside


def _wrong(path: Path, why: str) -> UserError:
    return UserError(
        Text("The homography {name} cannot be used.", name=path.name),
        why,
        "Give a file of OpenCV with a matrix of 3 × 3 numbers, or a text with nine numbers.",
    )
