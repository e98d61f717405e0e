"""The conventions of other programs, each with its source: data for the documents, the dialogs and the tests."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Convention:
    """What a program means by its numbers.

    Attributes
    ----------
    program : str
    formats : tuple of str
        Names in `graphos_core.exchange.camera_formats` and `graphos_core.exchange.orientation_formats`.
    first_pixel : tuple of float or None
        Coordinates of the centre of the top-left pixel in the program; None where the origin is the image centre.
    y_up : bool
        Whether y of image points points up.
    direction : str
        Direction of the distortion formula.
    units : str
        Of the interior orientation and the coefficients.
    signs : str
        Order and signs of the coefficients.
    pose : str
        Exterior orientation: which rotation, which camera frame.
    source : str
    """

    program: str
    formats: tuple[str, ...]
    first_pixel: tuple[float, float] | None
    y_up: bool
    direction: str
    units: str
    signs: str
    pose: str
    source: str


FORWARD, BACKWARD = "ideal → measured", "measured → ideal"

CONVENTIONS = (
    Convention(
        "GRAPHOS", ("graphos",), (0.0, 0.0), False, "by the model", "px; coefficients in units of f",
        "P1 (r² + 2x²) + 2 P2 xy", "cam_from_world R, centre C; x right, y down, z forward", "this program",
    ),
    Convention(
        "COLMAP", ("colmap", "colmap-text", "colmap-binary"), (0.5, 0.5), False, FORWARD, "px; coefficients in units of f",
        "OpenCV's: 2 p1 xy + p2 (r² + 2x²)", "cam_from_world quaternion (w, x, y, z) and t = −R C; x right, y down, z forward",
        "COLMAP, doc/format.rst and src/colmap/sensor/models.h",
    ),
    Convention(
        "OpenCV", ("opencv",), (0.0, 0.0), False, FORWARD, "px; coefficients in units of f",
        "2 p1 xy + p2 (r² + 2x²): p1 and p2 stand the other way round than Brown's", "none in the calibration file",
        "OpenCV documentation, calib3d and fisheye",
    ),
    Convention(
        "Agisoft Metashape", ("metashape",), (0.5, 0.5), False, FORWARD,
        "px; cx, cy from the image centre; K and P in units of f, b1 and b2 in px",
        "P1 (r² + 2x²) + 2 P2 xy; u = w/2 + cx + x' f + x' b1 + y' b2", "chunk_from_cam (4, 4); x right, y down, z forward; "
        "the chunk's transform is the similarity to the world",
        "Agisoft Metashape user manual 1.5 and later, appendix “Camera models”",
    ),
    Convention(
        "PhotoModeler", ("photomodeler",), (0.5, 0.5), False, BACKWARD,
        "mm from the corner of the format; K mm⁻², mm⁻⁴, mm⁻⁶; P mm⁻¹",
        "corrected = measured + correction, y up in the correction; P1 (r² + 2x²) + 2 P2 xy",
        "omega, phi, kappa: world_from_image = Rx Ry Rz; image frame x right, y up, z backward",
        "PhotoModeler help, “Lens Distortion Formulation”; order and signs proved by DBAT's camcaldemo (sigma0 0.16148 px)",
    ),
    Convention(
        "DBAT", ("dbat",), (0.5, 0.5), False, BACKWARD, "mm from the corner of the format; K mm⁻², …; P mm⁻¹",
        "model 3: x scaled by 1 + b1 (b1 = 1 − aspect) before the correction, y up", "omega, phi, kappa as PhotoModeler",
        "Börlin, Murtiyoso and Grussenmeyer 2019; proved by camcaldemo",
    ),
    Convention(
        "Australis, iWitness", ("australis",), None, True, BACKWARD,
        "mm from the image centre; K mm⁻², mm⁻⁴, mm⁻⁶; P mm⁻¹",
        "corrected = measured − principal point + correction; P1 (r² + 2x²) + 2 P2 xy + B1 x + B2 y", "none in the calibration text",
        "Fraser 1997, Digital camera self-calibration, ISPRS Journal 52",
    ),
    Convention(
        "MicMac", ("micmac",), (0.0, 0.0), False, FORWARD, "px; coefficients px⁻², px⁻⁴ … about CDist",
        "P1 (2x² + r²) + 2 P2 xy; b1 x + b2 y in x", "world_from_cam by rows (CodageMatr), X = R P + C; x right, y down, z forward",
        "MicMac, src/photogram/phgr_ebner_brown_dist.cpp and CPP_Bundler.cpp; the origin of pixels is that of eLiSe's "
        "interpolation and is not stated in its manual",
    ),
    Convention(
        "Bundler", ("bundler",), None, True, FORWARD, "px; k1, k2 in units of f",
        "no decentring, no principal point: image points count from it", "p = −P / P_z, P = R X + t; x right, y up, z backward",
        "Snavely, Bundler v0.4 user's manual, section 5",
    ),
    Convention(
        "VisualSFM (NVM)", ("nvm",), None, False, BACKWARD, "px; r in units of f",
        "ideal = measured (1 + r |measured|²)", "cam_from_world quaternion (w, x, y, z) and C; x right, y down, z forward",
        "Wu, VisualSFM documentation; Wu et al. 2011, Multicore bundle adjustment (measurement distortion)",
    ),
    Convention(
        "PAT-B", ("patb",), None, True, "none", "mm or µm in its image file, which is not read", "none",
        "world_from_image by rows (some programs write the transpose); image frame x right, y up, z backward",
        "PCI Geomatics, “Using Pat-B in OrthoEngine”",
    ),
    Convention(
        "Tables", ("table",), None, True, "none", "as the table says", "none",
        "omega phi kappa, phi omega kappa or yaw pitch roll in deg, gon or rad", "Kraus 2007, section 2.1.2; ARINC 705",
    ),
)  # fmt: skip
