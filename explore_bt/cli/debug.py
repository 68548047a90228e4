"""``explore-bt debug``."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.driving import (
    GETTING_READY,
    OutOption,
    PaceOption,
    RobotOption,
    SeedOption,
    SinkOption,
    VerboseOption,
    drive,
    exit_code,
    show_result,
)
from explore_bt.cli.groot import GrootHostOption, GrootOption, GrootPortOption, groot_sinks
from explore_bt.cli.guard import guarded
from explore_bt.cli.loading import MissionArgument, MockOption, SetOption, load_checked
from explore_bt.cli.page_options import (
    HostOption,
    OpenOption,
    PageOptions,
    PortOption,
    TokenOption,
    show_page,
    wait_for_ctrl_c,
)
from explore_bt.cli.places import new_run_folder
from explore_bt.cli.run_log import run_log
from explore_bt.cli.sinks import make_sinks
from explore_bt.cli.stopping import stopping_by_signal

if TYPE_CHECKING:
    from explore_bt.debug import DebugSession
    from explore_bt.interfaces import Sink
    from explore_bt.mission import Mission
    from explore_bt.plugin import Registry
    from explore_bt.runtime import Attendant, StopFlag
    from explore_bt.types import Result

__all__ = ["debug"]

PAGE_SHARE = 0.2
"""Of one core that answering pages may take from the robot's ticks."""


@guarded
def debug(
    mission: MissionArgument,
    set_: SetOption = None,
    seed: SeedOption = 0,
    out: OutOption = None,
    terminal: Annotated[
        bool, typer.Option("--terminal", help="Commands in the terminal; also over ssh, or from a pipe.")
    ] = False,
    host: HostOption = "127.0.0.1",
    port: PortOption = 0,
    token: TokenOption = "",
    open_: OpenOption = False,
    run_on: Annotated[
        bool, typer.Option("--run-on", help="Begin at once; else the page has to say so.")
    ] = False,
    sink: SinkOption = None,
    groot: GrootOption = False,
    groot_port: GrootPortOption = 1667,
    groot_host: GrootHostOption = "127.0.0.1",
    mock: MockOption = None,
    robot: RobotOption = None,
    pace: PaceOption = 1.0,
    verbose: VerboseOption = False,
) -> None:
    """Run a mission under a debugger: step, break, look back.

    It stands still before the first tick. On the page, Ctrl-C stops the robot safely, and once the
    mission is over ends the page. In the terminal, type help; Ctrl-C pauses, a second one stops the
    robot safely. Results and exit codes are those of explore-bt run.
    """
    checked, registry = load_checked(mission, set_, mock, robot, pace)
    folder = new_run_folder(out, checked.path.stem)
    session = new_session(checked, registry, set_ or (), mock, paused=not run_on)
    sinks = [
        *make_sinks(registry, sink or ()),
        *groot_sinks(groot, checked, session, groot_host, groot_port),
    ]
    with run_log(folder / "run.log", verbose=verbose):
        if terminal:
            typer.echo(f"{checked.path}, seed {seed}: {GETTING_READY}")
            result = _in_terminal(session, checked, registry, folder, seed, sinks)
            show_result(result, folder)
        else:
            page = PageOptions(host, port, token, open_)
            result = _on_page(session, checked, registry, folder, seed, sinks, page)
    raise typer.Exit(exit_code(result.outcome))


def new_session(
    mission: Mission, registry: Registry, settings: Sequence[str], mocks: Path | None, *, paused: bool = True
) -> DebugSession:
    """A session that stands still before the first tick, if ``paused``, and can change parameters."""
    from explore_bt.debug import DebugSession, Params
    from explore_bt.mission import load_mission, only_robot, with_mocks

    def load(again: Sequence[str]) -> Mission:
        read = load_mission(mission.path, registry, again)
        if mission.solo is not None:
            read = only_robot(read, mission.solo.robot, mission.solo.pace)
        return read if mocks is None else with_mocks(read, mocks)

    return DebugSession(Params(mission, load, settings), paused=paused)


def _paced(session: DebugSession, mission: Mission) -> Attendant:
    """A robot of a fleet that runs elsewhere is held to real time."""
    from explore_bt.runtime import Attendants, pace_of

    return Attendants([session, pace_of(mission)])


def _on_page(
    session: DebugSession,
    mission: Mission,
    registry: Registry,
    folder: Path,
    seed: int,
    more_sinks: Sequence[Sink],
    page: PageOptions,
) -> Result:
    from explore_bt.debug.web import Controls, Desk, LiveSink, PageServer
    from explore_bt.runtime import StopFlag

    live, stop = LiveSink(), StopFlag()
    sinks = [*more_sinks, live]
    desk = Desk(live.feed, Controls(session))
    with PageServer(desk, host=page.host, port=page.port, token=page.token, share=PAGE_SHARE) as server:
        show_page(server, open_it=page.open_it)
        with stopping_by_signal(stop):
            typer.echo(f"{mission.path}, seed {seed}: {GETTING_READY}")
            result = drive(mission, registry, folder, seed, sinks, stop, _paced(session, mission))
        show_result(result, folder)
        if "SIGTERM" not in stop.reason:
            wait_for_ctrl_c("the page stays to look at; Ctrl-C ends it")
    return result


def _in_terminal(
    session: DebugSession,
    mission: Mission,
    registry: Registry,
    folder: Path,
    seed: int,
    more_sinks: Sequence[Sink],
) -> Result:
    from rich.console import Console as Screen

    from explore_bt.debug import History
    from explore_bt.debug.terminal import Console, LineReader
    from explore_bt.runtime import StopFlag

    history, stop = History(), StopFlag()
    sinks = [*more_sinks, history]
    ended: Future[Result] = Future()

    def run() -> None:
        try:
            ended.set_result(drive(mission, registry, folder, seed, sinks, stop, _paced(session, mission)))
        except BaseException as fault:  # it is raised again where the command can tell it
            ended.set_exception(fault)

    screen = Screen(highlight=False)
    console = Console(session, history, LineReader(lambda line: screen.print(line, markup=False)), screen)
    threading.Thread(target=run, name="the run", daemon=True).start()
    with _ended_by_signal(stop):
        try:
            console.run()
        finally:  # however the console ended: no robot drives on without it
            stop.raise_flag("stopped by hand (debugger)")
            result = _result(ended, stop)
        return result


def _result(ended: Future[Result], stop: StopFlag) -> Result:
    """What the run ended with; who interrupts the waiting wants it to stop."""
    while True:
        try:
            return ended.result()
        except KeyboardInterrupt:
            stop.raise_flag("stopped by hand (Ctrl-C)")
            _tell(b"\nstill stopping; Ctrl-\\ ends the program at once\n")


@contextmanager
def _ended_by_signal(stop: StopFlag) -> Iterator[None]:
    """While inside, SIGTERM and a lost terminal stop the run safely and end the reading of commands."""
    from explore_bt.debug.terminal import Terminated

    def on_signal(number: int, _frame: FrameType | None) -> None:
        _tell(b"\nstopping: the robot brakes, then the results are saved\n")
        if not stop.is_raised:  # else the reading has ended already
            stop.raise_flag(f"stopped by hand ({signal.Signals(number).name})")
            raise Terminated

    before = {number: signal.signal(number, on_signal) for number in (signal.SIGTERM, signal.SIGHUP)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _tell(words: bytes) -> None:
    """``os.write``: print is not safe in a handler; and the terminal may be gone."""
    with suppress(OSError):
        os.write(2, words)
