"""What somebody may ask of a mission through the robot itself."""

from __future__ import annotations

import enum

__all__ = ["Request"]


class Request(enum.StrEnum):
    """A button on the robot, a service of its middleware; honoured at the next tick of the trees."""

    STOP = "stop"
    """The paper's stop flag: brake, save, end."""
    PAUSE = "pause"
    """Brake to rest and stand until ``GO_ON``; the trees' time stands still."""
    GO_ON = "go on"
    SAVE_MAP = "save the map"
    """Write the map as it is now, beside where the mission's last one will lie."""
