"""Pictures of a cloud: everything one depends on, and the finished one."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from graphos_core.rendering.camera import ViewCamera

if TYPE_CHECKING:
    from graphos_core.rendering import Frame, Lines, PreparedCloud, Quads

RENDER_THREADS = 2


@dataclass(frozen=True)
class Picture:
    """Everything one picture depends on."""

    prepare: Callable[[], PreparedCloud]
    camera: ViewCamera
    width: int
    height: int
    ratio: float
    point_size: float
    world_size: float
    shading: float
    background: tuple[int, int, int]
    lines: list[Lines] = field(default_factory=list)
    quads: Quads | None = None
    step: int = 1
    serial: int = 0


@dataclass(frozen=True)
class Shown:
    """A finished picture."""

    frame: Frame
    picture: Picture
    seconds: float


def draw(picture: Picture) -> Shown:
    """Draw a picture; the first call compiles for some seconds."""
    from graphos_core.rendering import render_frame

    warm_up()
    cloud = picture.prepare()
    began = time.perf_counter()
    width, height = round(picture.width * picture.ratio), round(picture.height * picture.ratio)
    frame = render_frame(
        cloud, picture.camera, width, height, picture.point_size * picture.ratio, world_size=picture.world_size,
        lines=picture.lines, quads=picture.quads, background=picture.background, shading=picture.shading,
        step=picture.step, threads=RENDER_THREADS,
    )  # fmt: skip
    return Shown(frame, picture, time.perf_counter() - began)


@cache
def warm_up() -> None:
    """Compile, or load, everything that draws; the window may call this in a thread after its first paint."""
    from graphos_core.rendering import Lines, Quads, prepare_cloud, render_frame

    line = Lines(np.zeros((1, 3)), np.ones((1, 3)), np.zeros((1, 3), np.uint8))
    photo = Quads(np.eye(3)[None], (np.zeros((2, 2, 3), np.uint8),))
    camera = ViewCamera.looking(np.array([0.0, 1.0, 0.0]))
    render_frame(
        prepare_cloud(np.zeros((1, 3))), camera, 8, 8, lines=[line], quads=photo, threads=RENDER_THREADS
    )
