"""The lessons a report points to: title and opening sentences, so that a page read alone explains itself."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import resources

_SYMBOLS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "kappa": "κ", "lambda": "λ", "mu": "μ", "phi": "φ",
    "omega": "ω", "rho": "ρ", "sigma": "σ", "tau": "τ", "chi": "χ", "Delta": "Δ", "Sigma": "Σ", "sum": "Σ",
    "pm": "±", "cdot": "·", "times": "×", "leq": "≤", "geq": "≥", "approx": "≈", "sqrt": "√", "to": "→",
    "rightarrow": "→", "infty": "∞", "circ": "°", "quad": " ", "min": "min", "max": "max",
}  # fmt: skip


@dataclass(frozen=True)
class Explanation:
    """A lesson in short: its key, title, and opening sentences."""

    key: str
    title: str
    text: str

    @property
    def anchor(self) -> str:
        """Anchor on the page."""
        return "learn-" + self.key.replace("/", "-")


def explanations(keys: Iterable[str]) -> dict[str, Explanation]:
    """Return the lessons by key, without those that do not exist."""
    found = {}
    for key in keys:
        path = resources.files("graphos_resources").joinpath(f"lessons/{key}.md")
        if re.fullmatch(r"[a-z]+/[a-z0-9-]+", key) and path.is_file():
            found[key] = _explanation(key, path.read_text("utf-8"))
    return found


def _explanation(key: str, lesson: str) -> Explanation:
    _, front, body = lesson.split("+++", 2)
    paragraphs = (p.strip() for p in body.split("\n\n"))
    opening = next((p for p in paragraphs if p and not p.startswith(("$$", ":::", "#", "-", "|"))), "")
    return Explanation(key, str(tomllib.loads(front)["title"]), plain_text(opening))


def plain_text(markdown: str) -> str:
    r"""Return a paragraph of a lesson without marks; formulas in a line become letters and signs.

    >>> plain_text(r"A **ray** of [length](lesson:a/b) $\hat{\sigma}_0 \leq 1$ ends.")
    'A ray of length σ0 ≤ 1 ends.'
    """
    text = re.sub(r"\$([^$]+)\$", lambda m: _formula(m[1]), markdown)
    text = re.sub(r"\[([^\]]+)\]\([^)]*\)", r"\1", text)
    text = text.replace("**", "").replace("*", "").replace("`", "")
    text = " ".join(text.split())
    return text[:-1] + "." if text.endswith(":") else text


def _formula(tex: str) -> str:
    tex = re.sub(r"\\(?:hat|bar|mathrm|text|tilde|vec)\b", "", tex)
    tex = re.sub(r"\\([A-Za-z]+)", lambda m: _SYMBOLS.get(m[1], m[1]), tex)
    tex = re.sub(r"\^\{?([0-9])\}?", lambda m: "⁰¹²³⁴⁵⁶⁷⁸⁹"[int(m[1])], tex)
    return re.sub(r"[{}_\\,;]|\^(?=T)", "", tex)
