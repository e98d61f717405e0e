"""What a person chooses about a calibration: a kind of camera with the settings that suit it, or single parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Preset:
    """A kind of camera.

    Attributes
    ----------
    name, label : str
    summary : str
        What is special about it.
    values : tuple of (str, value)
        Parameters of the bundle adjustment that differ from their defaults.
    """

    name: str
    label: str
    summary: str
    values: tuple[tuple[str, Any], ...]


PRESETS = (
    Preset("phone", "Phone",
           "Small lens with strong, already corrected distortion, focus by a moving lens: decentring matters.",
           (("calibration", "complete"),)),
    Preset("compact", "Compact",
           "Zoom lens that moves: one calibration holds for one focal length only; two radial coefficients suffice.",
           (("calibration", "basic"),)),
    Preset("reflex", "Reflex",
           "Stable body and lens: the complete model is worth its parameters when the photos are rolled.",
           (("calibration", "complete"), ("principal_point", "free"))),
    Preset("drone", "Drone",
           "Strips of nadir photos: the principal distance goes with the flying height, the principal point with the "
           "tilt; cross strips and oblique photos tell them apart.",
           (("calibration", "brown"), ("principal_point", "automatic"))),
    Preset("fish-eye", "Fish-eye",
           "A projection of its own: the equisolid-angle model; the central projection cannot describe it.",
           (("calibration", "fisheye-equisolid"),)),
)  # fmt: skip


def preset_values(preset: Preset, sheet: Any) -> dict[str, Any]:
    """Return the values of a preset that a parameter sheet knows and accepts; the others are left out."""
    declarations = type(sheet).declarations()
    found = {}
    for name, value in preset.values:
        declaration = declarations.get(name)
        if declaration is not None and (not declaration.options or value in declaration.options):
            found[name] = value
    return found


def matching_preset(sheet: Any) -> str:
    """Return the name of the preset whose values a sheet has, the most specific one; empty for a default sheet."""
    best, most = "", 0
    for preset in PRESETS:
        values = dict(preset.values)
        if all(getattr(sheet, name, None) == value for name, value in values.items()) and len(values) > most:
            best, most = preset.name, len(values)
    return "" if sheet == type(sheet)() else best


def single_settings(text: str) -> dict[tuple[int, str], str]:
    """Return what a text such as ``"k2=fixed, 2.k1=free, p1=0.001"`` says: by camera (from 1, 0 for all) and name."""
    found: dict[tuple[int, str], str] = {}
    for item in text.replace(";", ",").split(","):
        left, equals, right = (part.strip() for part in item.partition("="))
        number, _, name = left.rpartition(".")
        if equals and name and right and (not number or number.isdigit()):
            found[int(number or 0), name] = right
    return found


def settings_text(settings: dict[tuple[int, str], str]) -> str:
    """Return the text of settings, those of all cameras first."""
    return ", ".join(
        f"{f'{camera}.' if camera else ''}{name}={value}"
        for (camera, name), value in sorted(settings.items())
        if value
    )
