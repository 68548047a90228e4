"""``explore-bt check``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import FAILED, guarded
from explore_bt.cli.human import count
from explore_bt.cli.loading import MissionArgument, MockOption, SetOption, load_checked

if TYPE_CHECKING:
    from explore_bt.mission import Mission, RobotSpec

__all__ = ["check"]


@guarded
def check(
    mission: MissionArgument,
    set_: SetOption = None,
    mock: MockOption = None,
    robot: Annotated[
        bool, typer.Option("--robot", help="Listen to the robots too: topics, rates, frames. No wheel turns.")
    ] = False,
    listen: Annotated[float, typer.Option(min=0.5, metavar="SECONDS", help="For how long.")] = 3.0,
) -> None:
    """Find every fault of a mission; no robot is needed.

    Exit code: 0 fine, 1 something about a robot is not as the mission needs it, 2 the mission has faults.
    """
    checked, _ = load_checked(mission, set_, mock)
    typer.echo(f"{checked.path} is fine: {_contents(checked)}")
    faults = [_faults_of(each, listen) for each in checked.robots if robot]
    if any(faults):
        raise typer.Exit(FAILED)


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


def _faults_of(spec: RobotSpec, listen_s: float) -> int:
    """Say what is heard of a robot; how much of it has to be mended."""
    from explore_bt.interfaces import RobotContext

    driver = spec.driver.make()
    typer.echo(f"\nrobot {spec.name}, driver {driver.name}: listening for {listen_s:g} s")
    try:
        driver.setup(RobotContext(robot=spec.name, start=spec.start))
        findings = driver.survey(listen_s)
    finally:
        driver.close()
    width = max((len(each.name) for each in findings), default=0)
    for each in findings:
        mark = "fault" if each.is_fault else "  ok " if not each.hint else " note"
        typer.echo(f"{mark}  {each.name:<{width}}  {each.heard}")
        if each.hint:
            typer.echo(f"       {'':<{width}}  → {each.hint}")
    faults = sum(each.is_fault for each in findings)
    if not findings:
        typer.echo(f"driver {driver.name} has nothing to listen to")
    else:
        typer.echo(
            f"{count(faults, 'fault')}, no wheel was turned" if faults else "all that is needed is heard"
        )
    return faults
