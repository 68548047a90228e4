"""The map as ROS map_server reads it."""

from __future__ import annotations

from pathlib import Path

from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct
from explore_bt.maps import write_map

__all__ = ["MapServerExporter"]


class MapServerExporter(Exporter):
    """Writes ``map.pgm`` and ``map.yaml``."""

    name = "map_server"
    api_version = API_VERSION

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write the final map."""
        return write_map(product.grid, folder, stem="map")
