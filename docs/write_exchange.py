"""Write the tables of ``docs/exchange.md`` from the engine's data: ``python docs/write_exchange.py``.

A test compares the page with what this would write, so that it cannot go stale.
"""

from __future__ import annotations

import re
from pathlib import Path

from graphos_core.exchange.attitudes import ORDERS
from graphos_core.exchange.camera_formats import CAMERA_FORMATS, OWN
from graphos_core.exchange.conventions import CONVENTIONS
from graphos_core.exchange.features_formats import FEATURE_FORMATS
from graphos_core.exchange.formulas import formulas
from graphos_core.exchange.orientation_formats import ORIENTATION_FORMATS
from graphos_core.exchange.tie_points import TIE_POINT_FORMATS

PAGE = Path(__file__).with_name("exchange.md")


def table(head: list[str], rows: list[list[str]]) -> str:
    """Return a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in lines)


def tables() -> dict[str, str]:
    """Return every table of the page by the name of its marker."""
    cameras = [[f"`{OWN}`", "this program (TOML)", "yes", "every camera model"]]
    for kind in CAMERA_FORMATS.values():
        models = ", ".join(n.split(" ", 1)[-1] for n in formulas() if n.split()[0] == kind.name)
        cameras.append([f"`{kind.name}`", kind.label, "yes" if kind.text else "no", models])
    orientations = [[f"`{k.name}`", k.label, "folder" if k.folder else "file", "yes" if k.cameras else "no", "yes" if k.points else "no", "yes" if k.written else "no"]
                    for k in ORIENTATION_FORMATS.values()]  # fmt: skip
    conventions = []
    for c in CONVENTIONS:
        origin = (
            "from the image centre"
            if c.first_pixel is None
            else f"({c.first_pixel[0]:g}, {c.first_pixel[1]:g})"
        )
        if c.direction == "none":
            origin = "–"
        conventions.append(
            [c.program, origin, "up" if c.y_up else "down", c.direction, c.units, c.signs, c.pose, c.source]
        )
    return {
        "cameras": table(["format", "program", "written", "models"], cameras),
        "orientations": table(["format", "program", "kind", "cameras", "points", "written"], orientations),
        "tiepoints": table(["format", "what"], [[f"`{n}`", label] for n, label in TIE_POINT_FORMATS.items()]),
        "features": table(["format", "what"], [[f"`{n}`", label] for n, label in FEATURE_FORMATS.items()]),
        "angles": table(["order", "meaning"], [[name, meaning] for name, meaning in ORDERS.items()]),
        "conventions": table(["program", "centre of the first pixel", "y", "distortion", "units", "coefficients", "pose", "source"], conventions),
    }  # fmt: skip


def page(text: str) -> str:
    """Return the page with its tables as they should be."""
    for name, content in tables().items():
        pattern = rf"(<!-- {name} -->\n).*?(<!-- end -->)"
        text = re.sub(pattern, lambda m, c=content: f"{m[1]}{c}\n{m[2]}", text, flags=re.DOTALL)
    return text


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text("utf-8")), "utf-8")
