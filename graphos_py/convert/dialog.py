"""The converter as a window of its own, which stays open beside the work."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QTabWidget, QVBoxLayout, QWidget

from graphos_py.convert.camera_page import CameraPage
from graphos_py.convert.orientation_page import OrientationPage
from graphos_py.theme import theme
from graphos_py.translation import tr


class ConvertDialog(QDialog):
    """Cameras and orientations from and to other programs."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(tr("Convert"))
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.resize(theme().px(860), theme().px(640))
        self.camera, self.orientation = CameraPage(), OrientationPage()
        tabs = QTabWidget()
        tabs.setDocumentMode(True)
        tabs.tabBar().setDrawBase(False)
        tabs.addTab(self.camera, tr("Camera"))
        tabs.addTab(self.orientation, tr("Orientations"))
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        buttons.rejected.connect(self.close)
        column = QVBoxLayout(self)
        column.addWidget(tabs, 1)
        column.addWidget(buttons)
