"""What the leaves that drive back along the way driven have in common."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explore_bt.interfaces import ControlStatus
from explore_bt.tree import Input, Leaf, Status
from explore_bt.types import Path
from explore_bt.units import Duration

__all__ = ["Retrace", "path_along"]


class Retrace(Leaf):
    """Base of leaves that hand the controller a piece of the robot's own track, newest place first."""

    patience: Input[float] = Input(
        Duration, default=4.0, ge=0.0, doc="how long the safety gate may hold the robot"
    )

    def follow(self, path: Path) -> None:
        """Hand it to the controller."""
        self.robot.pilot.follow(path)
        self.say(f"{path.length_m:.1f} m back along the way driven")

    def watch(self) -> Status:
        """SUCCESS at its end, FAILURE if the safety gate holds the robot on it."""
        output = self.robot.pilot.output
        if output.status is ControlStatus.ARRIVED:
            here = self.robot.estimate().T_map_base
            self.say(f"back at ({here.x:.1f}, {here.y:.1f})")
            return Status.SUCCESS
        if output.status is ControlStatus.STUCK or self.robot.pilot.blocked_s > self.patience:
            self.say(f"held on the way back: {output.reason or self.robot.pilot.gate_reason}")
            return Status.FAILURE
        return Status.RUNNING

    def terminate(self, new_status: Status) -> None:
        """A way back that is cut off comes to rest."""
        if new_status is not Status.SUCCESS:
            self.robot.pilot.hold()


def path_along(track: NDArray[np.float64], clearance_m: NDArray[np.float32]) -> Path:
    """A path over places of a track.

    Args:
        track: (N, 2) float64, metres, in the order to drive; N >= 2.
        clearance_m: (N,) float32, metres, of these places.
    """
    smooth = track.copy()
    smooth[1:-1] = (track[:-2] + track[1:-1] + track[2:]) / 3.0
    heading = np.arctan2(*np.diff(smooth, axis=0).T[::-1])
    poses = np.column_stack((smooth, np.append(heading, heading[-1])))
    return Path(poses, clearance_m.astype(np.float64))
