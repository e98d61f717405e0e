"""The row of choices above the 3D view."""

from __future__ import annotations

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QSlider, QToolButton, QWidget

from graphos_py.views.cloud_scene import RGB, CloudScene


class CloudBar(QWidget):
    """Colour mode, point size, what is shown, measuring.

    Signals
    -------
    changed()
        The picture has to be drawn again.
    mode_chosen(mode)
    fit_wanted()
    """

    changed = Signal()
    mode_chosen = Signal(str)
    fit_wanted = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._row = QHBoxLayout(self)
        self._row.setContentsMargins(8, 4, 8, 4)
        self._row.setSpacing(8)
        self.modes = QComboBox()
        self.modes.setToolTip(self.tr("What the colour of a point says"))
        self.modes.currentIndexChanged.connect(lambda _: self.mode_chosen.emit(str(self.modes.currentData())))
        self._row.addWidget(self.modes)
        self._add_size()
        self.shading = self._toggle(self.tr("Shading"), self.tr("Darken edges in depth"), False)
        self.cameras = self._toggle(self.tr("Cameras"), self.tr("Show where the photos were taken"), True)
        self.photos = self._toggle(self.tr("Photos"), self.tr("Show the photos at their cameras"), True)
        self.grid = self._toggle(self.tr("Grid"), self.tr("Show a grid below the object"), True)
        self._row.addStretch(1)
        tip = self.tr("Click points: coordinates, then distance, then angle (M)")
        self.measure = self._toggle(self.tr("Measure"), tip, False)
        fit = QToolButton()
        fit.setText(self.tr("Fit"))
        fit.setToolTip(self.tr("Show everything (F)"))
        fit.setAutoRaise(True)
        fit.clicked.connect(self.fit_wanted)
        self._row.addWidget(fit)

    def _add_size(self) -> None:
        label = self._size_label = QLabel(self.tr("Point size"))
        self.size_slider = QSlider(Qt.Orientation.Horizontal)
        self.size_slider.setRange(1, 10)
        self.size_slider.setValue(2)
        self.size_slider.setFixedWidth(96)
        tip = self.tr("Side of a point, px; points close to you grow to close the surface")
        self.size_slider.setToolTip(tip)
        self.size_slider.valueChanged.connect(lambda _: self.changed.emit())
        label.setBuddy(self.size_slider)
        self._row.addWidget(label)
        self._row.addWidget(self.size_slider)

    def minimumSizeHint(self) -> QSize:
        """Allow narrow views: what matters least is hidden there."""
        return QSize(160, super().minimumSizeHint().height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Hide what there is no room for, the point size first."""
        super().resizeEvent(event)
        self._fit_width()

    def _fit_width(self) -> None:
        spare = (self._size_label, self.size_slider, self.grid, self.shading)
        for widget in spare:
            widget.show()
        for widget in spare:
            if self._row.minimumSize().width() <= self.width():
                break
            widget.hide()

    def _toggle(self, text: str, tip: str, on: bool) -> QToolButton:
        button = QToolButton()
        button.setText(text)
        button.setToolTip(tip)
        button.setCheckable(True)
        button.setChecked(on)
        button.setAutoRaise(True)
        button.toggled.connect(lambda _: self.changed.emit())
        self._row.addWidget(button)
        return button

    def offer_modes(self, scene: CloudScene, mode: str) -> str:
        """Offer the colour modes for which there are data; return the one that is chosen now."""
        names = {
            "rgb": self.tr("Colour of the photos"),
            "height": self.tr("Height"),
            "views": self.tr("Number of photos"),
            "normals": self.tr("Normals"),
            "values": scene.value_legend.title if scene.value_legend else "",
        }
        chosen = mode if mode in scene.modes() else RGB
        self.modes.blockSignals(True)
        self.modes.clear()
        for offered in scene.modes():
            self.modes.addItem(names[offered], offered)
        self.modes.setCurrentIndex(max(self.modes.findData(chosen), 0))
        self.modes.blockSignals(False)
        self.cameras.setVisible(bool(len(scene.centres)))
        self.photos.setVisible(bool(scene.thumbnails))
        self._fit_width()
        return chosen
