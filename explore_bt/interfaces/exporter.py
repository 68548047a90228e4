"""Contract of exporters: files made from a finished run."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field
from pathlib import Path

from explore_bt.interfaces.plugin import Plugin
from explore_bt.types import MapStructure, OccupancyGrid, Result, Trajectory

__all__ = ["Exporter", "RobotProduct"]


@dataclass(frozen=True, slots=True, eq=False)
class RobotProduct:
    """What one robot brings home; ``truth`` where the driver knows it."""

    robot: str
    grid: OccupancyGrid
    trajectory: Trajectory
    truth: Trajectory | None
    result: Result
    structure: MapStructure = field(default_factory=MapStructure)


class Exporter(Plugin):
    """Writes files of one format."""

    kind = "exporter"

    @abstractmethod
    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write into ``folder`` and return the files; whole files or none."""
