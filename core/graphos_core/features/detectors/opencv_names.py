"""OpenCV's detectors by name: version 5 moved some of them into its module of extra features."""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np

from graphos_core.data import Array
from graphos_core.features.detectors.assembling import FoundPoints

LEAST_SIDE = 8
"""OpenCV's detectors fail on images, and on levels of a pyramid, with fewer pixels along a side."""


def create(name: str, *arguments: Any, **named: Any) -> Any:
    """Make an OpenCV detector, such as ``create("AKAZE")``, in OpenCV 4 and 5."""
    factory = getattr(cv2, f"{name}_create", None) or getattr(cv2.xfeatures2d, f"{name}_create")
    return factory(*arguments, **named)


def most_levels(shape: tuple[int, ...], factor: float, wanted: int) -> int:
    """Return how many levels, each smaller by `factor`, an image (h, w) has; at least 1, at most `wanted`."""
    possible = 1 + math.floor(math.log(max(1.0, min(shape) / LEAST_SIDE)) / math.log(factor))
    return min(wanted, possible)


def binary_points(detector: Any, image: Array) -> FoundPoints:
    """Run a detector with binary descriptors on an image, uint8 (h, w); tiny images have no points."""
    points, descriptors = (
        ([], None) if min(image.shape) < LEAST_SIDE else detector.detectAndCompute(image, None)
    )
    if descriptors is None:
        descriptors = np.zeros((0, detector.descriptorSize()), np.uint8)
    return FoundPoints.of_cv2(points, descriptors, "hamming")
