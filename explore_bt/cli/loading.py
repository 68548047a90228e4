"""From what a person typed to a checked mission; used by every command that takes one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.places import find_mission
from explore_bt.errors import MissionError

if TYPE_CHECKING:
    from explore_bt.mission import Mission
    from explore_bt.plugin import Host, Registry

__all__ = ["MissionArgument", "MockOption", "SetOption", "load_checked"]

_EXTRA = 'pip install "explore-bt['

MissionArgument = Annotated[
    str, typer.Argument(metavar="MISSION", help="A mission file, or the name of a shipped mission.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated."),
]


MockOption = Annotated[
    Path | None,
    typer.Option("--mock", metavar="FILE", help="Dry run: scripts play the leaves that this file names."),
]


def load_checked(
    mission: str,
    settings: Sequence[str] | None,
    mocks: Path | None = None,
    robot: str | None = None,
    pace: float = 1.0,
) -> tuple[Mission, Registry]:
    """Find the mission, load the plugins and the file beside it, check everything.

    Args:
        mission: what was typed.
        settings: ``name=value``.
        mocks: scripts that play leaves.
        robot: the only one that this process drives; None for all.
        pace: simulated seconds a second, of that robot.

    Raises:
        UserError: no such mission, a broken inline plugin, or the faults of the mission or the mock file, all
            of them.
    """
    path = find_mission(mission)
    from explore_bt.mission import load_mission, only_robot, with_mocks
    from explore_bt.plugin import load_plugins

    host = load_plugins(inline_dir=path.parent)
    try:
        checked = load_mission(path, host.registry, settings or ())
    except MissionError as faulty:
        raise MissionError(str(faulty) + _left_out(faulty, host), faulty.faults) from None
    if robot is not None:
        checked = only_robot(checked, robot, pace)
    return (checked if mocks is None else with_mocks(checked, mocks)), host.registry


def _left_out(faulty: MissionError, host: Host) -> str:
    """Where a plugin is missing, those that could not be loaded may be the reason.

    One that only lacks its extra is no reason where a name was mistyped.
    """
    missing = [fault.hint for fault in faulty.faults if "explore-bt plugins" in fault.hint]
    if not missing:
        return ""
    mistyped = all("did you mean" in hint for hint in missing)
    reasons = [each for each in host.broken if not (mistyped and _EXTRA in each.reason)]
    return "".join(f"\nleft out: {each.name}, {each.origin}: {each.reason}" for each in reasons)
