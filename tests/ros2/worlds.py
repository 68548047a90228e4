"""A simulated robot in a process of its own, and places for it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.ros2.processes import Process

__all__ = ["HALL", "paced", "robot_in"]

HALL = """\
format: explore-bt-world/1
name: hall
start: [8.0, 8.0, 0 deg]
rooms:
  - {name: hall, box: [0.0, 0.0, 16.0, 16.0]}
"""


@contextmanager
def robot_in(world: str | Path, *words: str | Path) -> Iterator[Process]:
    """``explore-bt ros2-sim`` with these words, ready."""
    with Process("ros2-sim", world, *words) as robot:
        robot.wait_for("is on ROS 2")
        yield robot
        robot.end()


def paced(speed: float) -> float:
    """How fast ``/clock`` may go, so that what is measured on it does not depend on other work here."""
    waiting = os.getloadavg()[0] / (os.cpu_count() or 1)
    return max(speed / max(waiting, 1.0), 0.1)
