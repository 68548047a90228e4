"""``explore-bt show``."""

from __future__ import annotations

from typing import Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.overrides import parse_overrides
from explore_bt.cli.places import find_mission

__all__ = ["show"]


@guarded
def show(
    mission: Annotated[str, typer.Argument(help="A mission file, or the name of a shipped mission.")],
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated.")
    ] = None,
    dot: Annotated[bool, typer.Option("--dot", help="As a Graphviz graph.")] = False,
) -> None:
    """Draw a mission's behaviour tree; no robot is needed."""
    from explore_bt.mission import load_mission, show_dot, show_text
    from explore_bt.plugin import load_plugins

    path, overrides = find_mission(mission), parse_overrides(set_ or ())
    checked = load_mission(path, load_plugins(inline_dir=path.parent).registry, overrides)
    typer.echo((show_dot if dot else show_text)(checked))
