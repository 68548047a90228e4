"""``explore-bt ros2-sim``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from explore_bt.cli.driving import SeedOption
from explore_bt.cli.guard import guarded
from explore_bt.cli.loading import SetOption, load_checked
from explore_bt.cli.places import find_mission
from explore_bt.cli.stopping import stopping_by_signal
from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.interfaces import Bridge, Driver, RobotContext
    from explore_bt.plugin import Registry

__all__ = ["ros2_sim"]

_WORLD = "format: explore-bt-world/"


@guarded
def ros2_sim(
    mission: Annotated[
        str,
        typer.Argument(
            metavar="MISSION_OR_WORLD", help="Whose simulator to run, or a world to put sim2d in."
        ),
    ],
    set_: SetOption = None,
    seed: SeedOption = 0,
    speed: Annotated[float, typer.Option(min=0.01, max=100.0, help="Simulated seconds per second.")] = 1.0,
    domain: Annotated[
        int | None, typer.Option(min=0, max=232, help="ROS domain; else ROS_DOMAIN_ID.")
    ] = None,
    namespace: Annotated[str, typer.Option(help="Before every relative topic name.")] = "",
    wall_time: Annotated[
        bool, typer.Option("--wall-time", help="Stamps are the system's time, there is no /clock; speed 1.")
    ] = False,
    stamped: Annotated[bool, typer.Option("--stamped", help="Commands are TwistStamped.")] = False,
    tf_topic: Annotated[
        str, typer.Option(help="Else /tf, and of several robots tf in the namespace of each.")
    ] = "",
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write at the end what only a simulator knows, as JSON."),
    ] = None,
) -> None:
    """Put a mission's simulated robots behind ROS 2 topics.

    A mission with driver: {use: ros2, use_sim_time: true} then drives them from another process. Of several
    robots each has its name as namespace. It runs until Ctrl-C.
    """
    robots, registry = _robots(mission, set_, seed)
    bridge: type[Bridge] = registry.get("bridge", "ros2")
    settings = {
        "domain": domain,
        "namespace": namespace,
        "wall_time": wall_time,
        "stamped": stamped,
        "tf_topic": tf_topic,
    }
    pace = "the system's time" if wall_time else f"/clock at {speed:g} times the speed of real time"
    truths = _serve(bridge(bridge.Options.model_validate(settings)), robots, speed, pace)
    if out is not None:
        known = truths if len(truths) > 1 else next(iter(truths.values()))
        out.write_text(json.dumps(known, indent=2) + "\n", encoding="utf-8")
    for name, truth in truths.items():
        contacts, touches = truth["contacts"], truth["touched_by_people"]
        typer.echo(f"{name}: {truth['time_s']:.0f} s, {contacts} contacts, {touches} touches by people")


def _serve(
    bridge: Bridge, robots: list[tuple[Driver, RobotContext]], speed: float, pace: str
) -> dict[str, dict[str, Any]]:
    """Until Ctrl-C; what only the simulators know then, by robot."""
    from explore_bt.runtime import StopFlag

    drivers = {context.robot: driver for driver, context in robots}
    what = ", ".join(dict.fromkeys(driver.name for driver in drivers.values()))
    typer.echo(f"{what}: getting ready")
    stop = StopFlag()
    try:
        for driver, context in robots:
            driver.setup(context)
        with stopping_by_signal(stop, then="the robot brakes"):
            typer.echo(f"{what} is on ROS 2, with {pace}; Ctrl-C ends it")
            bridge.serve(drivers, speed, lambda: stop.is_raised)
    finally:
        for driver in drivers.values():
            driver.close()
    return {name: _truth(driver) for name, driver in drivers.items()}


def _robots(
    mission: str, settings: list[str] | None, seed: int
) -> tuple[list[tuple[Driver, RobotContext]], Registry]:
    """The robots' drivers, not set up yet.

    Raises:
        UserError: neither mission nor world, or a driver that is no simulator.
    """
    from explore_bt.interfaces import Commons, RobotContext

    path = Path(mission)
    if path.is_file() and _WORLD in path.read_text(encoding="utf-8", errors="replace"):
        from explore_bt.plugin import load_plugins

        registry = load_plugins().registry
        sim2d: type[Driver] = registry.get("driver", "sim2d")
        options: Any = sim2d.Options.model_validate({"world": path.resolve()})
        return [(sim2d(options), RobotContext(seed=seed))], registry
    checked, registry = load_checked(str(find_mission(mission)), settings)
    commons, robots = Commons(), []
    for robot in checked.robots:
        driver = robot.driver.make()
        if driver.name in ("ros2", "replay"):
            raise UserError(
                f"{checked.path}: robot {robot.name}'s driver is {driver.name}; ros2-sim needs a simulator, "
                "for example driver: {use: sim2d, world: FILE}"
            )
        context = RobotContext(robot=robot.name, seed=seed, start=robot.start, commons=commons)
        robots.append((driver, context))
    return robots, registry


def _truth(driver: Driver) -> dict[str, Any]:
    """What only the simulator knows."""
    truth = driver.truth()
    pose = truth.pose() if truth else None
    return {
        "time_s": driver.clock.now_s(),
        "contacts": truth.contacts() if truth else None,
        "touched_by_people": truth.touched_by_people() if truth else None,
        "start": list(driver.start.as_array()),
        "pose": None if pose is None else list(pose.as_array()),
    }
