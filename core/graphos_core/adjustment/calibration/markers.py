"""Coded boards: ArUco and AprilTag markers, alone or in the white squares of a chessboard (ChArUco)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from graphos_core.adjustment.calibration.corners import WINDOW_SHARE, neighbour_distance, refine_corners
from graphos_core.adjustment.calibration.target import TargetParams
from graphos_core.data.record import Array
from graphos_core.errors import UserError
from graphos_core.params import unknown_name

DETECTION_SHARE = 0.5
"""Share of the markers that must fit a plane for the board's layout to be believed."""
RECOGNISE_SIDE = 1200
"""Longer side of the picture in which the dictionary is recognised, px."""
FIT_SHARE = 0.25
"""How far a marker's centre may lie from its place on the board, in sides of a square."""


@dataclass(frozen=True)
class CodedBoard:
    """A coded board as OpenCV knows it.

    Attributes
    ----------
    dictionary : str
    markers_only : bool
    marker_mm : float
    legacy : bool
        Whether the first square is a white one with a marker also where the number of rows is even (OpenCV before
        4.6).
    """

    dictionary: str
    markers_only: bool
    marker_mm: float
    legacy: bool = False

    def grid(self, target: TargetParams) -> cv2.aruco.GridBoard:
        """Return OpenCV's grid of markers, in mm."""
        dictionary = cv2.aruco.getPredefinedDictionary(dictionaries()[self.dictionary])
        return cv2.aruco.GridBoard(
            target.shape, self.marker_mm, target.square_mm - self.marker_mm, dictionary
        )

    def charuco(self, target: TargetParams) -> cv2.aruco.CharucoBoard:
        """Return OpenCV's chessboard with markers, in mm."""
        dictionary = cv2.aruco.getPredefinedDictionary(dictionaries()[self.dictionary])
        squares = (target.columns + 1, target.rows + 1)
        board = cv2.aruco.CharucoBoard(squares, target.square_mm, self.marker_mm, dictionary)
        board.setLegacyPattern(self.legacy)
        return board


def dictionaries() -> dict[str, int]:
    """Return OpenCV's predefined dictionaries by name."""
    names = [n for n in dir(cv2.aruco) if n.startswith("DICT_")]
    names = sorted(
        n for n in names if not (n != n.upper() and n.upper() in names)
    )  # OpenCV has some names twice
    return {name: getattr(cv2.aruco, name) for name in names}


def needed_markers(target: TargetParams) -> int:
    """Return how many markers the board has."""
    if target.markers_only:
        return target.columns * target.rows
    return (target.columns + 1) * (target.rows + 1) // 2


def recognise(greys: Sequence[Array], target: TargetParams) -> CodedBoard | None:
    """Find out dictionary, side of the markers and pattern of a board from photos of it; None where nothing fits.

    Parameters
    ----------
    greys : sequence of uint8 (h, w)
        A few photos.
    target : TargetParams
        What is given in it is not changed.

    Raises
    ------
    UserError
        When the dictionary does not exist.
    """
    name = _dictionary(greys, target)
    if name is None:
        return None
    best: tuple[float, CodedBoard] | None = None
    for legacy in (False,) if target.markers_only else (False, True):
        trial = CodedBoard(name, target.markers_only, target.marker_mm or 0.5 * target.square_mm, legacy)
        fits = [fit for grey in greys if (fit := _fit(grey, target, trial)) is not None]
        if fits:
            share, side = float(np.mean([f[0] for f in fits])), float(np.median([f[1] for f in fits]))
            side = min(side, 0.98 * target.square_mm)
            found = CodedBoard(name, target.markers_only, target.marker_mm or side, legacy)
            if best is None or share > best[0] + 0.02:
                best = (share, found)
    return best[1] if best is not None and best[0] > DETECTION_SHARE else None


def find_markers(grey: Array, target: TargetParams, coded: CodedBoard) -> tuple[Array, Array, Array] | None:
    """Measure what is seen of a coded board.

    Markers are found and decoded by OpenCV (Garrido-Jurado et al. 2014, Automatic generation and detection of highly
    reliable fiducial markers under occlusion). Of a ChArUco board the corners of the chessboard are predicted from the
    markers beside them and measured by `refine_corners`; of a grid of markers the marker's own corners are.

    Returns
    -------
    (point int32 (m,), xy float64 (m, 2), sigma float64 (m,)) or None
    """
    measured = _centres(grey, target, coded) if coded.markers_only else _corners(grey, target, coded)
    if measured is None:
        return None
    point, xy, sigma = measured
    order = np.argsort(point, kind="stable")
    point, xy, sigma = point[order], xy[order], sigma[order]
    keep = np.isfinite(sigma) & np.r_[True, np.diff(point) > 0]
    return point[keep].astype(np.int32), xy[keep], sigma[keep]


def _centres(grey: Array, target: TargetParams, coded: CodedBoard) -> tuple[Array, Array, Array] | None:
    """Return points of the board, places and standard deviations of the centres of markers.

    A centre is where the diagonals cross: the corners of a dark square are all drawn inwards or outwards alike by blur
    and the camera's tone curve, by a quarter of a pixel easily, and the centre is not.
    """
    corners, ids = _detect(grey, coded.dictionary)
    mine = ids < target.columns * target.rows
    corners, ids = corners[mine], ids[mine]
    if len(ids) == 0:
        return None
    side = np.repeat(np.hypot(*(corners[:, 1] - corners[:, 0]).T), 4)
    cells = cv2.aruco.getPredefinedDictionary(dictionaries()[coded.dictionary]).markerSize + 2
    refined, sigma = refine_corners(grey, corners.reshape(-1, 2), 0.9 / cells / WINDOW_SHARE * side)
    four = refined.reshape(-1, 4, 2)
    return ids, np.array([crossing(c) for c in four]), 0.5 * np.sqrt((sigma.reshape(-1, 4) ** 2).mean(axis=1))


def _corners(grey: Array, target: TargetParams, coded: CodedBoard) -> tuple[Array, Array, Array] | None:
    """Return the same of the corners of a chessboard; the window must not reach the markers, half a gap away."""
    found, ids, _, _ = cv2.aruco.CharucoDetector(coded.charuco(target)).detectBoard(grey)
    if ids is None or len(ids) < 4:
        return None
    places = np.asarray(found, dtype=np.float64).reshape(-1, 2)
    gap = 1.0 - coded.marker_mm / target.square_mm
    reach = neighbour_distance(places) * min(1.0, 1.4 * gap)
    return np.asarray(ids).ravel(), *refine_corners(grey, places, reach)


def _detect(grey: Array, dictionary: str) -> tuple[Array, Array]:
    """Return corners float64 (k, 4, 2) and numbers (k,) of all markers of a dictionary."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    known = cv2.aruco.getPredefinedDictionary(dictionaries()[dictionary])
    corners, ids, _ = cv2.aruco.ArucoDetector(known, parameters).detectMarkers(grey)
    if ids is None:
        return np.zeros((0, 4, 2)), np.zeros(0, dtype=np.int64)
    return np.array(corners, dtype=np.float64).reshape(-1, 4, 2), np.array(ids, dtype=np.int64).ravel()


def _families() -> list[list[str]]:
    """Return the names of the dictionaries by family, the smallest first: the smaller are the start of the larger."""
    families: dict[str, list[str]] = {}
    for name in dictionaries():
        stem, _, count = name.rpartition("_")
        families.setdefault(stem if count.isdigit() else name, []).append(name)
    return [
        sorted(names, key=lambda n: int(n.rpartition("_")[2]) if len(names) > 1 else 0)
        for names in families.values()
    ]


def _dictionary(greys: Sequence[Array], target: TargetParams) -> str | None:
    """Return the dictionary whose family has the most markers in the photos: the smallest that is large enough."""
    known = dictionaries()
    if target.dictionary:
        if target.dictionary.upper() not in known:
            raise UserError(unknown_name(target.dictionary, list(known), "dictionary of markers"))
        return target.dictionary.upper()
    wanted = needed_markers(target)
    best, most = None, 3
    for names in _families():
        large = [n for n in names if len(cv2.aruco.getPredefinedDictionary(known[n]).bytesList) >= wanted]
        if not large:
            continue
        numbers = [_numbers(grey, large[-1]) for grey in greys]
        count = sum(len(n[n < wanted]) for n in numbers)
        if count > most:
            best, most = large[0], count
    return best


def _numbers(grey: Array, dictionary: str) -> Array:
    """Return the different numbers of the markers in a photo, without measuring them."""
    scale = max(1.0, max(grey.shape) / RECOGNISE_SIDE)
    if scale > 1.0:
        size = (round(grey.shape[1] / scale), round(grey.shape[0] / scale))
        grey = cv2.resize(grey, size, interpolation=cv2.INTER_AREA)
    known = cv2.aruco.getPredefinedDictionary(dictionaries()[dictionary])
    _, ids, _ = cv2.aruco.ArucoDetector(known).detectMarkers(grey)
    return np.unique(np.array([] if ids is None else ids, dtype=np.int64))


def _fit(grey: Array, target: TargetParams, coded: CodedBoard) -> tuple[float, float] | None:
    """Return the share of markers whose centres fit a plane board, and the side of a marker, mm.

    The centres do not depend on the side, so a homography through them tells the side from the corners.
    """
    corners, ids = _detect(grey, coded.dictionary)
    board = coded.grid(target) if coded.markers_only else coded.charuco(target)
    known = {
        int(number): np.asarray(place)[:, :2].mean(axis=0)
        for number, place in zip(np.asarray(board.getIds()).ravel(), board.getObjPoints(), strict=True)
    }
    mine = np.array([int(number) in known for number in ids], dtype=bool)
    if mine.sum() < 4:
        return None
    corners, centres = corners[mine], np.array([known[int(number)] for number in ids[mine]])
    # the image of the centre of a square is where its diagonals cross
    seen = np.array([crossing(four) for four in corners])
    homography, _ = cv2.findHomography(seen, centres, cv2.RANSAC, FIT_SHARE * target.square_mm)
    if homography is None:
        return None
    fitted = cv2.perspectiveTransform(seen[:, None], homography)[:, 0]
    good = np.hypot(*(fitted - centres).T) < FIT_SHARE * target.square_mm
    on_board = cv2.perspectiveTransform(corners.reshape(-1, 1, 2), homography).reshape(-1, 4, 2)[good]
    if len(on_board) < 4:
        return None
    sides = np.hypot(*np.moveaxis(on_board - np.roll(on_board, 1, axis=1), -1, 0))
    return float(good.mean()), float(np.median(sides))


def crossing(corners: Array) -> Array:
    """Return where the diagonals of a quadrangle (4, 2) cross."""
    a, b, c, d = corners
    share = np.linalg.solve(np.column_stack([c - a, b - d]), b - a)[0]
    result: Array = a + share * (c - a)
    return result
