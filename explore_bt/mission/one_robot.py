"""One robot of a mission, for a process of its own."""

from __future__ import annotations

from dataclasses import replace

from explore_bt.errors import UserError
from explore_bt.mission.model import Mission, Solo
from explore_bt.mission.words import did_you_mean

__all__ = ["only_robot"]

_IN_PROCESS = "local"


def only_robot(mission: Mission, name: str, pace: float = 1.0) -> Mission:
    """The mission as that robot's process drives it; the others are heard of through the team.

    Args:
        mission: of all.
        name: the robot's.
        pace: simulated seconds a second.

    Raises:
        UserError: no such robot, a team that ends with the process, robots whose starts nobody has given.
    """
    names = [robot.name for robot in mission.robots]
    if name not in names:
        raise UserError(f'{mission.path}: there is no robot "{name}"; {did_you_mean(name, names, "robots")}')
    if mission.team is None or mission.team.team.name == _IN_PROCESS:
        raise UserError(
            f"{mission.path}: a robot in a process of its own hears the others over a network; write "
            "team: {use: zenoh}"
        )
    lost = [robot.name for robot in mission.robots if robot.start is None and robot.knows_start]
    if len(names) > 1 and lost:
        raise UserError(
            f"{mission.path}: nobody knows where {', '.join(lost)} begins; robots in processes of their own "
            "need a start each, in one frame: start: [1 m, 2 m, 0 deg]; or start: unknown"
        )
    robots = tuple(robot for robot in mission.robots if robot.name == name)
    return replace(mission, robots=robots, solo=Solo(name, pace))
