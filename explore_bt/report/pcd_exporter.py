"""The occupied voxels as a point cloud in the format of the Point Cloud Library."""

from __future__ import annotations

from pathlib import Path

from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct

__all__ = ["PcdExporter"]


class PcdExporter(Exporter):
    """Writes ``cloud.pcd``, version 0.7, binary, where SLAM has a 3D map."""

    name = "pcd"
    api_version = API_VERSION

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write the centres of the occupied voxels: float32 x, y, z, metres, ``map`` frame."""
        voxels = product.structure.voxels
        if voxels is None:
            return []
        points = voxels.occupied_centres
        header = (
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n"
            f"TYPE F F F\nCOUNT 1 1 1\nWIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
            f"POINTS {len(points)}\nDATA binary\n"
        )
        return [write_whole(folder / "cloud.pcd", header.encode() + points.astype("<f4").tobytes())]
