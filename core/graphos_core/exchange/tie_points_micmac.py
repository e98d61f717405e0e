"""MicMac's tie points: ``Homol/PastisA/B.txt`` per pair of photos, ``x y`` in A and ``x y`` in B on every line."""

from __future__ import annotations

from pathlib import Path

from graphos_core.errors import UserError
from graphos_core.exchange.text_files import bad_line, finite, read_lines
from graphos_core.exchange.tie_point_records import Key, TiePoints, flat_name, join, pairs_of
from graphos_core.store import write_text
from graphos_core.text import Text

PREFIX = "Pastis"


def read_micmac_points(folder: Path) -> TiePoints:
    """Read a folder ``Homol``; errors as `graphos_core.exchange.tie_points.read_tie_points`."""
    files = sorted(folder.glob(f"{PREFIX}*/*.txt"))
    if not files:
        raise UserError(
            Text("{name} holds no tie points of MicMac in text form.", name=folder.name),
            "There is no file PastisPHOTO/PHOTO.txt in it; binary .dat files are not read.",
            "Write them as text: option ExpTxt=1 of Tapioca.",
        )  # fmt: skip
    names = sorted(
        {f.parent.name.removeprefix(PREFIX) for f in files} | {f.name.removesuffix(".txt") for f in files}
    )
    place = {name: i for i, name in enumerate(names)}
    pairs: list[tuple[Key, Key]] = []
    for file in files:
        first, second = place[file.parent.name.removeprefix(PREFIX)], place[file.name.removesuffix(".txt")]
        for n, line in enumerate(read_lines(file), 1):
            if not line.strip():
                continue
            try:
                xa, ya, xb, yb = finite(line.split()[:4])
            except ValueError:
                raise bad_line(
                    file, n, line, "four numbers: x y in the first photo, x y in the second"
                ) from None
            pairs.append(((first, xa, ya), (second, xb, yb)))
    return join(tuple(names), pairs)


def write_micmac_points(points: TiePoints, folder: Path) -> tuple[Path, ...]:
    """Write both directions of every pair, as MicMac does."""
    files = []
    xy = points.tracks.xy.tolist()
    for (a, b), rows in sorted(pairs_of(points).items()):
        for first, second, turned in ((a, b, False), (b, a, True)):
            path = (
                folder
                / f"{PREFIX}{flat_name(points.photos[first])}"
                / f"{flat_name(points.photos[second])}.txt"
            )
            lines = [(xy[j] + xy[i]) if turned else (xy[i] + xy[j]) for i, j in rows]
            write_text(path, "".join(" ".join(repr(v) for v in line) + "\n" for line in lines))
            files.append(path)
    return tuple(files)
