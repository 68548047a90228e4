"""``explore-bt convert``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.loading import SetOption, load_checked
from explore_bt.cli.places import find_mission
from explore_bt.errors import UserError
from explore_bt.files import write_whole

if TYPE_CHECKING:
    from explore_bt.plugin import Registry

__all__ = ["convert"]


@guarded
def convert(
    source: Annotated[
        str, typer.Argument(metavar="SOURCE", help="A mission (or the name of a shipped one), or TREE.xml.")
    ],
    xml: Annotated[bool, typer.Option("--xml", help="To BehaviorTree.CPP 4 XML; for a mission.")] = False,
    yaml: Annotated[bool, typer.Option("--yaml", help="To a YAML file of trees; for TREE.xml.")] = False,
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A file to write; else it is printed.")
    ] = None,
    robot: Annotated[
        str, typer.Option(metavar="NAME", help="Whose tree, where a mission has several robots.")
    ] = "",
    mission: Annotated[
        str | None,
        typer.Option(metavar="BASE", help="A mission beside whose plugins TREE.xml is to be checked."),
    ] = None,
    set_: SetOption = None,
) -> None:
    """Turn a tree into BehaviorTree.CPP XML and back.

    Groot2 draws the XML. Both tick the same: modifiers become decorators and compositions, and come back
    as modifiers.
    What is not quite the same is said in words, in the file and on stderr.
    """
    is_xml = source.lower().endswith(".xml")
    if (xml and is_xml) or (yaml and not is_xml) or (xml and yaml):
        raise UserError(
            f"{source} goes {'to YAML' if is_xml else 'to XML'}; leave out --{'xml' if xml else 'yaml'}"
        )
    _check_out(out)
    if is_xml:
        _to_yaml(Path(source), mission, out)
    else:
        _to_xml(source, robot, set_ or [], out)


def _check_out(out: Path | None) -> None:
    if out is not None and not out.parent.is_dir():
        raise UserError(f"there is no folder {out.parent} to write {out.name} into; make it first")
    if out is not None and out.is_dir():
        raise UserError(f"{out} is a folder; name a file in it, for example {out / 'tree.xml'}")


def _to_xml(source: str, robot: str, settings: list[str], out: Path | None) -> None:
    checked, registry = load_checked(source, settings)
    from explore_bt.mission.btcpp import tree_xml

    robots = {each.name: each for each in checked.robots}
    if robot and robot not in robots:
        raise UserError(f'{checked.path} has no robot "{robot}"; its robots: {", ".join(robots)}')
    if not robot and len(robots) > 1:
        raise UserError(
            f"{checked.path} has {len(robots)} robots; say whose tree: --robot {next(iter(robots))}"
        )
    leaves = [registry.get("behaviour", name) for name in registry.names("behaviour")]
    chosen = robots[robot] if robot else checked.robots[0]
    _give(tree_xml(chosen.tree, leaves), out)


def _to_yaml(source: Path, mission: str | None, out: Path | None) -> None:
    from explore_bt.mission import load_tree
    from explore_bt.mission.btcpp import read_tree_xml

    registry = _registry_beside(source if mission is None else find_mission(mission))
    tree = read_tree_xml(source, registry)
    for remark in tree.remarks:
        typer.echo(remark, err=True)
    _give(tree.text, out)
    if out is not None:
        load_tree(out, [tree.name], registry)
        typer.echo(f"put it into a mission with include: [{out}] and tree: {tree.name}")


def _registry_beside(path: Path) -> Registry:
    from explore_bt.plugin import load_plugins

    return load_plugins(inline_dir=path.parent).registry


def _give(text: str, out: Path | None) -> None:
    if out is None:
        typer.echo(text, nl=False)
    else:
        write_whole(out, text)
        typer.echo(f"{out} written")
