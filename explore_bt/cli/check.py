"""``explore-bt check``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.human import count
from explore_bt.cli.loading import MissionArgument, MockOption, SetOption, load_checked

if TYPE_CHECKING:
    from explore_bt.mission import Mission

__all__ = ["check"]


@guarded
def check(mission: MissionArgument, set_: SetOption = None, mock: MockOption = None) -> None:
    """Find every fault of a mission; no robot is needed."""
    checked, _ = load_checked(mission, set_, mock)
    typer.echo(f"{checked.path} is fine: {_contents(checked)}")


def _contents(mission: Mission) -> str:
    """``1 robot, 23 nodes, plugins sim2d, kiss_gtsam, skeleton, pursuit``."""
    nodes = sum(1 for robot in mission.robots for _ in robot.tree.walk())
    used = [
        choice.name
        for robot in mission.robots
        for choice in (robot.driver, robot.slam, robot.planner, robot.controller)
    ]
    plugins = ", ".join(dict.fromkeys(used))
    return f"{count(len(mission.robots), 'robot')}, {count(nodes, 'node')}, plugins {plugins}"
