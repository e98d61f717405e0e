"""The truth of a simulated photo block, read back from its folder."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from graphos_core.cameras import camera_model
from graphos_core.data.cameras import Camera
from graphos_core.data.cloud import Mesh
from graphos_core.data.record import Array, record
from graphos_core.errors import UserError
from graphos_core.exchange.ply import read_ply
from graphos_core.text import Text


@record
class Truth:
    """What is true about a simulated photo block.

    Attributes
    ----------
    folder : str
        Of the block.
    names : tuple of str
        File names of the photos.
    cameras : tuple of Camera
    camera_of_photo : int32 (n,)
    rotations : float64 (n, 3, 3)
        ``cam_from_world``.
    centres : float64 (n, 3)
        Projection centres, m.
    mesh : Mesh
        The surface, m.
    object_distance_m : float
        Mean over the photos of the median true depth.
    gsd_m : float
        Ground sampling distance: object distance / principal distance.
    """

    folder: str
    names: tuple[str, ...]
    cameras: tuple[Camera, ...]
    camera_of_photo: Array
    rotations: Array
    centres: Array
    mesh: Mesh
    object_distance_m: float
    gsd_m: float

    def depth(self, photo: int) -> Array:
        """Return the true depth of every pixel of a photo: z in the camera frame, m, float32 (h, w); NaN for sky."""
        path = Path(self.folder) / "truth" / "depth" / f"{Path(self.names[photo]).stem}.npz"
        with np.load(path, allow_pickle=False) as stored:
            result: Array = stored["depth"]
        return result


def load_truth(folder: Path) -> Truth:
    """Read the truth that `graphos_core.simulation.photo_block.simulate_photos` wrote.

    Raises
    ------
    UserError
        When the folder holds no complete simulated block.
    """
    path = folder / "truth" / "cameras.json"
    try:
        index = json.loads(path.read_text("utf-8"))
        mesh = read_ply(folder / "truth" / "mesh.ply")
        if not isinstance(mesh, Mesh):
            raise ValueError("the surface is not a mesh")
        photos = index["photos"]
        return Truth(
            folder=str(folder),
            names=tuple(str(photo["name"]) for photo in photos),
            cameras=tuple(_camera(entry) for entry in index["cameras"]),
            camera_of_photo=np.array([photo["camera"] for photo in photos], np.int32),
            rotations=np.array([photo["cam_from_world"] for photo in photos], np.float64),
            centres=np.array([photo["centre_m"] for photo in photos], np.float64),
            mesh=mesh,
            object_distance_m=float(index["object_distance_m"]),
            gsd_m=float(index["gsd_m"]),
        )
    except (OSError, ValueError, KeyError, TypeError) as problem:
        raise UserError(
            Text("{folder} holds no complete simulated block.", folder=folder),
            str(problem),
            "Simulate it again.",
        ) from problem


def _camera(entry: dict[str, object]) -> Camera:
    model = camera_model(str(entry["model"]))
    values = entry["parameters"]
    if not isinstance(values, dict):
        raise TypeError("camera parameters are missing")
    pitch = entry.get("pixel_pitch_mm")
    return Camera(
        model=model.name,
        width=int(str(entry["width"])),
        height=int(str(entry["height"])),
        values=np.array([values[name] for name in model.names], np.float64),
        label=str(entry.get("label", "")),
        pixel_pitch_mm=float(str(pitch)) if pitch is not None else None,
        focal_source="true value of the simulation",
    )
