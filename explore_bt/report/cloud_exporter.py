"""The occupied voxels as a point cloud, in the binary formats that are a header, then points."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import ClassVar

from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct

__all__ = ["CloudExporter", "PcdExporter", "PlyExporter"]


class CloudExporter(Exporter):
    """Writes the centres of the occupied voxels where SLAM has a 3D map."""

    api_version = API_VERSION
    file_name: ClassVar[str]

    @abstractmethod
    def header(self, count: int) -> str:
        """What stands before so many points of three little-endian float32."""

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write float32 x, y, z, metres, ``map`` frame."""
        voxels = product.structure.voxels
        if voxels is None:
            return []
        points = voxels.occupied_centres
        content = self.header(len(points)).encode() + points.astype("<f4").tobytes()
        return [write_whole(folder / self.file_name, content)]


class PlyExporter(CloudExporter):
    """Writes ``cloud.ply``, binary, where SLAM has a 3D map."""

    name = "ply"
    file_name = "cloud.ply"

    def header(self, count: int) -> str:
        """The Stanford polygon format's."""
        return (
            "ply\nformat binary_little_endian 1.0\n"
            f"element vertex {count}\n"
            "property float x\nproperty float y\nproperty float z\nend_header\n"
        )


class PcdExporter(CloudExporter):
    """Writes ``cloud.pcd``, version 0.7, binary, where SLAM has a 3D map."""

    name = "pcd"
    file_name = "cloud.pcd"

    def header(self, count: int) -> str:
        """The Point Cloud Library's."""
        return (
            "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\n"
            f"TYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
            f"POINTS {count}\nDATA binary\n"
        )
