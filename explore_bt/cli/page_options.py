"""Options of the commands that show a page, and the line that says where it is."""

from __future__ import annotations

import threading
import webbrowser
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from explore_bt.debug.web import PageServer

__all__ = [
    "HostOption",
    "OpenOption",
    "PageOptions",
    "PortOption",
    "TokenOption",
    "show_page",
    "wait_for_ctrl_c",
]

HostOption = Annotated[
    str,
    typer.Option("--host", metavar="ADDRESS", help="Where to listen; all but this machine need a token."),
]
PortOption = Annotated[int, typer.Option("--port", min=0, max=65535, metavar="N", help="0: any free port.")]
TokenOption = Annotated[
    str, typer.Option("--token", metavar="TEXT", help="What the page has to know; else made up when needed.")
]
OpenOption = Annotated[bool, typer.Option("--open", help="Open the page in the browser.")]


@dataclass(frozen=True, slots=True)
class PageOptions:
    """What was asked for, together."""

    host: str
    port: int
    token: str
    open_it: bool


def show_page(server: PageServer, *, open_it: bool) -> None:
    """Say where the page is, in a way that terminals make clickable; open it if wanted."""
    typer.secho(f"page       {server.url}", bold=True)
    if open_it and not webbrowser.open(server.url):
        typer.echo("no browser could be opened here; open that address yourself")


def wait_for_ctrl_c(words: str) -> None:
    """Say what is being waited for, and wait."""
    typer.echo(words)
    with suppress(KeyboardInterrupt):
        threading.Event().wait()
