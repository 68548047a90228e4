"""``explore-bt replay``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from explore_bt.cli.guard import guarded
from explore_bt.cli.human import duration
from explore_bt.cli.page_options import (
    HostOption,
    OpenOption,
    PortOption,
    TokenOption,
    show_page,
    wait_for_ctrl_c,
)
from explore_bt.cli.recordings import open_recording

__all__ = ["replay"]


@guarded
def replay(
    run: Annotated[
        Path | None,
        typer.Argument(
            metavar="RUN", help="A run's folder, or its recording.mcap; else the newest in runs/."
        ),
    ] = None,
    host: HostOption = "127.0.0.1",
    port: PortOption = 0,
    token: TokenOption = "",
    open_: OpenOption = False,
) -> None:
    """Look at any moment of a run that is over, in a browser.

    Tree, map and timeline are on one page. A recording that was cut off is shown as far as it goes.
    Ctrl-C ends it.
    """
    from explore_bt.debug.web import Desk, PageServer, RunFeed

    recording = open_recording(run)
    if recording.damage:
        typer.echo(f"{recording.path}: {recording.damage}")
    with PageServer(Desk(RunFeed.of(recording)), host=host, port=port, token=token) as server:
        typer.echo(f"{recording.path}: {duration(recording.duration_s)} of mission time")
        show_page(server, open_it=open_)
        wait_for_ctrl_c("Ctrl-C ends it")
