"""``--groot`` of the commands that drive a mission."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.errors import UserError

if TYPE_CHECKING:
    from explore_bt.debug import DebugSession
    from explore_bt.interfaces import Sink
    from explore_bt.mission import Mission

__all__ = ["GrootHostOption", "GrootOption", "GrootPortOption", "groot_sinks"]

GrootOption = Annotated[
    bool, typer.Option("--groot", help="Let Groot2 and btview watch, break and inject; on loopback.")
]
GrootPortOption = Annotated[
    int,
    typer.Option(min=1, max=65000, metavar="PORT", help="Of --groot, and the next; two more for each robot."),
]
GrootHostOption = Annotated[
    str, typer.Option(metavar="ADDRESS", help="Of --groot; whoever reaches it can command the tree.")
]

_LOOPBACK = ("127.0.0.1", "localhost", "::1")


def groot_sinks(wanted: bool, mission: Mission, session: DebugSession, host: str, port: int) -> list[Sink]:
    """A Groot2 server that has its ports and answers once the run begins; nothing where none is wanted.

    Raises:
        UserError: the extra is not installed, or a port cannot be had.
    """
    if not wanted:
        return []
    try:
        from explore_bt.groot import GrootSink
    except ModuleNotFoundError as missing:
        raise UserError(f'--groot needs {missing.name}; type pip install "explore-bt[groot]"') from None

    sink = GrootSink(mission, session, host, port)
    sink.bind()
    for robot, taken in sink.ports.items():
        typer.echo(f"Groot2: robot {robot} at {host}:{taken}")
    if host not in _LOOPBACK:
        warning = f"warning: whoever reaches {host} can stop and command the robots; Groot2 knows no token"
        typer.secho(warning, fg=typer.colors.YELLOW, err=True)
    return [sink]
