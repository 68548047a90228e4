"""The occupied voxels as a point cloud in the Stanford polygon format."""

from __future__ import annotations

from pathlib import Path

from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct

__all__ = ["PlyExporter"]


class PlyExporter(Exporter):
    """Writes ``cloud.ply``, binary, where SLAM has a 3D map."""

    name = "ply"
    api_version = API_VERSION

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write the centres of the occupied voxels: float32 x, y, z, metres, ``map`` frame."""
        voxels = product.structure.voxels
        if voxels is None:
            return []
        points = voxels.occupied_centres
        header = (
            "ply\nformat binary_little_endian 1.0\n"
            f"element vertex {len(points)}\n"
            "property float x\nproperty float y\nproperty float z\nend_header\n"
        )
        return [write_whole(folder / "cloud.ply", header.encode() + points.astype("<f4").tobytes())]
