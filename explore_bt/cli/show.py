"""``explore-bt show``."""

from __future__ import annotations

from typing import Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.loading import MissionArgument, SetOption, load_checked

__all__ = ["show"]


@guarded
def show(
    mission: MissionArgument,
    set_: SetOption = None,
    dot: Annotated[bool, typer.Option("--dot", help="As a Graphviz graph.")] = False,
) -> None:
    """Draw a mission's behaviour tree; no robot is needed."""
    checked, _ = load_checked(mission, set_)
    from explore_bt.mission import show_dot, show_text

    typer.echo((show_dot if dot else show_text)(checked))
