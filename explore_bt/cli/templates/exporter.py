"""An exporter that writes the trajectory as a table."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from explore_bt import hookimpl
from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct


class MyPlugin(Exporter):
    """Writes the estimated trajectory as CSV: seconds, metres, radians."""

    name = "my_plugin"
    api_version = API_VERSION

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """One line per pose."""
        way = product.trajectory
        rows = [
            f"{stamp_s:.3f},{x:.4f},{y:.4f},{yaw:.5f}"
            for stamp_s, (x, y, yaw) in zip(way.stamps_s, way.poses, strict=True)
        ]
        text = "\n".join(["stamp_s,x_m,y_m,yaw_rad", *rows]) + "\n"
        return [write_whole(folder / "my_plugin.csv", text)]


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]
