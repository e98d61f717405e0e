"""Tiles for the kind of camera: one click sets the calibration that suits it."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QHBoxLayout, QLabel, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from graphos_core.adjustment.calibration_choices import PRESETS, Preset, matching_preset, preset_values
from graphos_core.params import Params
from graphos_py.icons import bind_icon
from graphos_py.session import Session
from graphos_py.theme import theme
from graphos_py.translation import tr


def bundle_sheet(session: Session) -> tuple[str, Params] | None:
    """Return the name and the parameters of the bundle adjustment in use; None before the engine is loaded."""
    if session.recipe is None:
        return None
    name = session.recipe.chosen("adjustment", "bundle")[0]
    return name, session.recipe.params("adjustment", name)


class CameraTiles(QWidget):
    """Phone, compact, reflex, drone, fish-eye."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.tiles: dict[str, QToolButton] = {}
        column = QVBoxLayout(self)
        column.setContentsMargins(12, 10, 12, 6)
        column.setSpacing(6)
        title = QLabel(tr("Which kind of camera took the photos?"))
        title.setProperty("role", "heading")
        column.addWidget(title)
        row = QHBoxLayout()
        row.setSpacing(8)
        for preset in PRESETS:
            tile = QToolButton()
            tile.setText(tr(preset.label))
            tile.setToolTip(tr(preset.summary))
            tile.setCheckable(True)
            tile.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
            tile.setIconSize(QSize(theme().px(26), theme().px(26)))
            tile.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            tile.setMaximumWidth(theme().px(140))
            bind_icon(tile, preset.name, "text")
            tile.clicked.connect(lambda _=False, p=preset: self.choose(p))
            self.tiles[preset.name] = tile
            row.addWidget(tile)
        row.addStretch(1)
        column.addLayout(row)
        self.said = QLabel()
        self.said.setProperty("role", "caption")
        self.said.setWordWrap(True)
        column.addWidget(self.said)
        session.recipe_changed.connect(self.refresh)
        self.refresh()

    def choose(self, preset: Preset) -> None:
        """Set the calibration of a kind of camera in the recipe."""
        found = bundle_sheet(self.session)
        if found is not None:
            name, sheet = found
            self.session.set_params("adjustment", name, sheet.replace(**preset_values(preset, sheet)))
        self.refresh()

    def refresh(self, _: str = "") -> None:
        """Mark the tile whose settings the recipe has."""
        found = bundle_sheet(self.session)
        chosen = matching_preset(found[1]) if found is not None else ""
        for name, tile in self.tiles.items():
            tile.setChecked(name == chosen)
            tile.setEnabled(found is not None)
        preset = next((p for p in PRESETS if p.name == chosen), None)
        self.said.setText(
            tr("A tile sets the calibration on the left; run the adjustment to see what it does.")
            if preset is None
            else tr(preset.summary)
        )
