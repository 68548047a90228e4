"""Finding out whether ROS 2 is there, without importing it."""

from __future__ import annotations

import importlib.util

__all__ = ["LINE", "require"]

LINE = 'type pip install "explore-bt[ros2]", or source /opt/ros/jazzy/setup.bash before'


def require(module: str) -> None:
    """Refuse to be loaded without a module of ROS 2.

    Raises:
        ModuleNotFoundError: it is not there; the message names the line to type.
    """
    if importlib.util.find_spec(module) is None:
        raise ModuleNotFoundError(
            f"it needs the module {module}, which is not installed; {LINE}", name=module
        )
