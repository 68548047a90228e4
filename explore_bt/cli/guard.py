"""How a command ends when something goes wrong: one message, one exit code, no traceback."""

from __future__ import annotations

import functools
import platform
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import ParamSpec

import typer

from explore_bt.errors import UserError

__all__ = ["DONE", "FAILED", "STOPPED", "WRONG_INPUT", "Crash", "guarded"]

DONE, FAILED, WRONG_INPUT, STOPPED = 0, 1, 2, 130

P = ParamSpec("P")


class Crash(Exception):
    """A fault of ours while a run was writing into ``folder``; the cause is the fault itself."""

    def __init__(self, folder: Path) -> None:
        super().__init__(str(folder))
        self.folder = folder


def guarded(command: Callable[P, None]) -> Callable[P, None]:
    """The command, with every exception turned into a message on stderr and an exit code."""

    @functools.wraps(command)
    def guarded_command(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except UserError as fault:
            _say(str(fault))
            raise typer.Exit(WRONG_INPUT) from None
        except KeyboardInterrupt:
            raise typer.Exit(STOPPED) from None
        except Crash as crash:
            folder = crash.folder if crash.folder.is_dir() else _elsewhere()
            raise _apologise(crash.__cause__ or crash, folder) from None
        except (typer.Exit, typer.Abort, BrokenPipeError):
            raise
        except Exception as fault:
            raise _apologise(fault, _elsewhere()) from None

    return guarded_command


def _apologise(fault: BaseException, folder: Path) -> typer.Exit:
    log = folder / "crash.log"
    log.write_text(_report(fault))
    _say(
        f"Sorry, explore-bt itself failed ({type(fault).__name__}: {fault}).\n"
        f"Please report it to the project, with {log}"
    )
    return typer.Exit(FAILED)


def _elsewhere() -> Path:
    return Path(tempfile.mkdtemp(prefix="explore-bt-"))


def _report(fault: BaseException) -> str:
    from explore_bt.version import __version__

    head = f"explore-bt {__version__}, Python {platform.python_version()}, {platform.platform()}"
    return f"{head}\n{' '.join(sys.argv)}\n\n{''.join(traceback.format_exception(fault))}"


def _say(message: str) -> None:
    typer.secho(message, fg=typer.colors.RED, err=True)
