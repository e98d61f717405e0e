"""Dense matching: the depth map of the selected photo and the fused cloud."""

from __future__ import annotations

from typing import Any

import numpy as np
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from graphos_core.data import Array, Cloud, DepthMap
from graphos_py.tabs.stage_tab import StageTab
from graphos_py.translation import tr
from graphos_py.views.block_cameras import show_cameras

CLOUD, DEPTH = 0, 1


def depth_range(maps: list[DepthMap] | tuple[DepthMap, ...]) -> tuple[float, float]:
    """Return the 1 % and 99 % quantiles of all known depths: the ends of the colour map."""
    some = [np.asarray(m.depth)[::4, ::4].ravel() for m in maps]
    known = np.concatenate([d[np.isfinite(d)] for d in some]) if some else np.zeros(0)
    if not len(known):
        return 0.0, 1.0
    low, high = np.percentile(known, (1, 99))
    return float(low), float(max(high, low + 1e-9))


class DenseTab(StageTab):
    """Depth maps appear while they are computed; the cloud when they are fused."""

    stage = "dense"
    empty = (
        "The surface, point by point",
        "Here you will see the depth of every pixel of each photo, and the coloured cloud that the depth maps "
        "agree on. Run computes them.",
    )

    def make_views(self) -> None:
        """Cloud and depth map."""
        from graphos_py.views.cloud_view import CloudView
        from graphos_py.views.depth_view import DepthView

        self.cloud = CloudView()
        self.cloud.show_cameras(False)  # they would hide the surface
        self.depth_view = DepthView()
        self._maps: dict[int, DepthMap] = {}
        self._unit = "model units"
        self.add_view(self.cloud, "Cloud")
        self.depth_text = QLabel()
        self.depth_text.setMargin(8)
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.depth_text)
        column.addWidget(self.depth_view, 1)
        self.add_view(page, "Depth map")

    def show_result(self, result: Any) -> None:
        """Fill both pages."""
        cloud: Cloud = result.cloud
        self._maps = {m.photo: m for m in result.maps}
        self._unit = cloud.unit
        normals = cloud.normals if len(cloud.normals) else None
        views = cloud.views if len(cloud.views) else None
        self.cloud.set_cloud(cloud.points, cloud.colours, normals, views, cloud.unit)
        oriented = self.session.results.get("adjustment")
        if oriented is not None and oriented.adjustment.block.unit == cloud.unit:
            show_cameras(self.cloud, oriented.adjustment.block)
        self._range = depth_range(tuple(result.maps))
        self.show_photo(self.session.photo)

    def show_partial(self, key: str, values: list[Any]) -> None:
        """Show each depth map as it is finished."""
        maps = [value for value in values if isinstance(value, DepthMap)]
        if key == "depth_map" and maps:
            self.need_views()
            self._maps.update({m.photo: m for m in maps})
            self._range = depth_range(maps)
            self.views.setCurrentIndex(DEPTH)
            self._show_map(maps[-1])

    def show_photo(self, index: int) -> None:
        """Show the depth map of another photo, if that page is in sight."""
        if self.views.currentIndex() != DEPTH:
            return
        if index in self._maps:
            self._show_map(self._maps[index])
        elif self.result is not None:
            self.depth_view.set_depth(None)
            self.depth_text.setText(
                tr("There is no depth map of this photo: it is not oriented or no neighbour sees the same.")
            )

    def view_shown(self, index: int) -> None:
        """Draw the depth map when its page comes into sight."""
        self.show_photo(self.session.photo)

    def _show_map(self, depth_map: DepthMap) -> None:
        project = self.session.project
        photos = project.photo_set.photos if project is not None else ()
        name = photos[depth_map.photo].name if depth_map.photo < len(photos) else ""
        depth: Array = np.asarray(depth_map.depth)
        share = float(np.isfinite(depth).mean()) if depth.size else 0.0
        neighbours = ", ".join(photos[n].name for n in depth_map.neighbours if n < len(photos))
        text = tr("{name} · {share} % known · matched with {neighbours}", name=name, share=f"{100 * share:.0f}",
                  neighbours=neighbours or "–")  # fmt: skip
        self.depth_text.setText(text)
        self.depth_view.set_depth(depth, self._unit, tr("depth"), limits=self._range)
