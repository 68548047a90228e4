"""The pose graph in the text format of g2o."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct
from explore_bt.types import PoseGraph2

__all__ = ["G2oExporter", "g2o_text"]

_UPPER = np.triu_indices(3)


class G2oExporter(Exporter):
    """Writes ``graph.g2o`` where SLAM has a pose graph."""

    name = "g2o"
    api_version = API_VERSION

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write keyframes and edges, metres and radians."""
        graph = product.structure.graph
        return [] if graph is None else [write_whole(folder / "graph.g2o", g2o_text(graph))]


def g2o_text(graph: PoseGraph2) -> str:
    """``VERTEX_SE2 id x y yaw`` and ``EDGE_SE2 a b dx dy dyaw`` with the information's upper triangle."""
    vertices = [
        f"VERTEX_SE2 {k} {x:.9g} {y:.9g} {yaw:.9g}" for k, (x, y, yaw) in enumerate(graph.poses.tolist())
    ]
    fixed = ["FIX 0"] if vertices else []
    rows = zip(graph.ends.tolist(), graph.relatives.tolist(), graph.information, strict=True)
    edges = [
        " ".join(
            ["EDGE_SE2", str(a), str(b), *(f"{value:.9g}" for value in (*relative, *information[_UPPER]))]
        )
        for (a, b), relative, information in rows
    ]
    return "".join(line + "\n" for line in (*vertices, *fixed, *edges))
