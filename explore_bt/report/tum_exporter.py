"""Trajectories in the text format of the TUM RGB-D benchmark."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct
from explore_bt.types import Trajectory

__all__ = ["TumExporter", "tum_text"]


class TumExporter(Exporter):
    """Writes ``trajectory.tum``, and ``truth.tum`` where the driver knows the truth."""

    name = "tum"
    api_version = API_VERSION

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write the estimated and the true trajectory."""
        files = {"trajectory.tum": product.trajectory, "truth.tum": product.truth}
        return [
            write_whole(folder / name, tum_text(trajectory))
            for name, trajectory in files.items()
            if trajectory is not None
        ]


def tum_text(trajectory: Trajectory) -> str:
    """One line a pose: ``stamp x y z qx qy qz qw``, seconds and metres; z, qx and qy are 0 on a floor."""
    half = 0.5 * trajectory.poses[:, 2]
    rows = np.column_stack((trajectory.stamps_s, trajectory.poses[:, :2], np.sin(half), np.cos(half)))
    return "".join(f"{t:.6f} {x:.6f} {y:.6f} 0 0 0 {qz:.9f} {qw:.9f}\n" for t, x, y, qz, qw in rows.tolist())
