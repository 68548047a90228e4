"""``explore-bt router``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.stopping import stopping_by_signal
from explore_bt.clock import WallClock

if TYPE_CHECKING:
    from explore_bt.interfaces import Team

__all__ = ["router"]

_HERE = "tcp/127.0.0.1:7447"
_LOOK_S = 0.1


@guarded
def router(
    listen: Annotated[
        list[str] | None,
        typer.Option(metavar="ENDPOINT", help=f"Where robots come to; else {_HERE}. May be repeated."),
    ] = None,
    team: Annotated[str, typer.Option(metavar="NAME", help="The team plugin of the robots.")] = "zenoh",
) -> None:
    """Pass on what robots of a fleet say to one another.

    Robots in processes of their own reach it with team: {use: zenoh, mode: client, connect: [ENDPOINT]}. It
    runs until Ctrl-C and keeps nothing: one that dies may be started again, and the robots find it. There
    is no token: who reaches it is heard.
    """
    from explore_bt.plugin import load_plugins
    from explore_bt.runtime import StopFlag

    cls: type[Team] = load_plugins().registry.get("team", team)
    endpoints, stop, clock = tuple(listen or (_HERE,)), StopFlag(), WallClock()
    with stopping_by_signal(stop, then="the robots lose one another"), cls.router(endpoints):
        typer.echo(f"team {team} is passed on at {', '.join(endpoints)}; Ctrl-C ends it")
        while not stop.is_raised:
            clock.wait_until(clock.now_s() + _LOOK_S)
