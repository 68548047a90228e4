"""The commands put together, and the page shown by ``explore-bt`` alone."""

from __future__ import annotations

from typing import Annotated

import typer

from explore_bt.cli.check import check
from explore_bt.cli.compare import compare
from explore_bt.cli.convert import convert
from explore_bt.cli.debug import debug
from explore_bt.cli.export import export
from explore_bt.cli.new_plugin import new_plugin
from explore_bt.cli.plugins import plugins
from explore_bt.cli.recover import recover
from explore_bt.cli.replay import replay
from explore_bt.cli.resume import resume
from explore_bt.cli.ros2_sim import ros2_sim
from explore_bt.cli.router import router
from explore_bt.cli.run import run
from explore_bt.cli.schema import schema
from explore_bt.cli.show import show
from explore_bt.cli.slam import slam
from explore_bt.cli.stats import stats
from explore_bt.cli.world import world
from explore_bt.version import __version__

__all__ = ["app", "main"]

_START = f"""\
explore-bt {__version__}: a robot explores a building it has never seen

  explore-bt run 01_apartment           drive a mission; map, report and recording land in runs/
  explore-bt check missions/mine.yaml   find every fault of a mission, run nothing
  explore-bt show 01_apartment          draw a mission's behaviour tree
  explore-bt plugins                    list what a mission can use
  explore-bt new-plugin slam my_slam    write a plugin of your own

Example: explore-bt run 01_apartment --seed 3 --out runs/first
All commands: explore-bt --help
"""

# plain help: text in brackets is a pose here, not markup
app = typer.Typer(
    name="explore-bt",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    epilog="Example: explore-bt run 01_apartment --seed 3 --out runs/first",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"explore-bt {__version__}")
        raise typer.Exit()


@app.callback(invoke_without_command=True)
def start(
    context: typer.Context,
    version: Annotated[  # noqa: ARG001  # its callback does the work
        bool, typer.Option("--version", is_eager=True, callback=_show_version, help="Say the version.")
    ] = False,
) -> None:
    """Explore buildings with robots: missions in YAML over swappable plugins."""
    if context.invoked_subcommand is None:
        typer.echo(_START, nl=False)


app.command(epilog="Example: explore-bt run 01_apartment --set stride=1.2 --seed 3 --headless")(run)
app.command(epilog="Example: explore-bt debug 01_apartment --terminal")(debug)
app.command(epilog="Example: explore-bt replay runs/first --open")(replay)
app.command(epilog="Example: explore-bt resume runs/apartment-20250101-120000")(resume)
app.command(epilog="Example: explore-bt recover runs/apartment-20250101-120000")(recover)
app.command(epilog="Example: explore-bt compare runs/a runs/b --out a-b.html")(compare)
app.command(epilog="Example: explore-bt check missions/mine.yaml --set clearance='0.30 m'")(check)
app.command(epilog="Example: explore-bt show 01_apartment --dot | dot -Tsvg -o tree.svg")(show)
app.command(epilog="Example: explore-bt convert 01_apartment --xml --out apartment.xml")(convert)
app.command(epilog="Example: explore-bt slam intel.clf.bz2 --out runs/intel --odometry")(slam)
app.command(epilog="Example: explore-bt export runs/first --csv tables")(export)
app.command(epilog="Example: explore-bt stats runs/* --never")(stats)
app.command(epilog="Example: explore-bt world --kind apartment --seed 3 --out flat.yaml")(world)
app.command("ros2-sim", epilog="Example: explore-bt ros2-sim 01_apartment --speed 3")(ros2_sim)
app.command(epilog="Example: explore-bt router --listen tcp/0.0.0.0:7447")(router)
app.command(epilog="Example: explore-bt schema --out missions/schema.json")(schema)
app.command(epilog="Example: explore-bt plugins --kind planner --options")(plugins)
app.command("new-plugin", epilog="Example: explore-bt new-plugin slam my_slam")(new_plugin)


def main() -> None:
    """What the script ``explore-bt`` calls."""
    app()
