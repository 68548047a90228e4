"""``explore-bt run``."""

from __future__ import annotations

import typer

from explore_bt.cli.driving import (
    GETTING_READY,
    HeadlessOption,
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
from explore_bt.cli.filming import VideoOption, film_of
from explore_bt.cli.groot import GrootHostOption, GrootOption, GrootPortOption, groot_sinks
from explore_bt.cli.guard import guarded
from explore_bt.cli.loading import MissionArgument, MockOption, SetOption, load_checked
from explore_bt.cli.places import new_run_folder
from explore_bt.cli.run_log import run_log
from explore_bt.cli.sinks import watched_sinks
from explore_bt.cli.stopping import stopping_by_signal

__all__ = ["run"]


@guarded
def run(
    mission: MissionArgument,
    set_: SetOption = None,
    seed: SeedOption = 0,
    out: OutOption = None,
    headless: HeadlessOption = False,
    sink: SinkOption = None,
    groot: GrootOption = False,
    groot_port: GrootPortOption = 1667,
    groot_host: GrootHostOption = "127.0.0.1",
    video: VideoOption = None,
    mock: MockOption = None,
    robot: RobotOption = None,
    pace: PaceOption = 1.0,
    verbose: VerboseOption = False,
) -> None:
    """Run a mission; map, recording and report land in a folder.

    Exit code: 0 explored, 1 failed or budget spent, 2 wrong input, 130 stopped by hand.
    Ctrl-C stops the robot safely and saves the results; explore-bt resume goes on from there.
    """
    checked, registry = load_checked(mission, set_, mock, robot, pace)
    attendants = film_of(checked, video)
    folder = new_run_folder(out, checked.path.stem)
    sinks = watched_sinks(registry, sink or (), headless=headless)
    if groot:
        from explore_bt.debug import DebugSession

        session = DebugSession()
        attendants.append(session)
        sinks += groot_sinks(groot, checked, session, groot_host, groot_port)
    typer.echo(f"{checked.path}, seed {seed}: {GETTING_READY}")
    from explore_bt.runtime import Attendants, StopFlag, pace_of

    attendants.append(pace_of(checked))
    stop = StopFlag()
    with run_log(folder / "run.log", verbose=verbose), stopping_by_signal(stop):
        result = drive(checked, registry, folder, seed, sinks, stop, Attendants(attendants))
    show_result(result, folder)
    if video is not None and video.exists():
        typer.echo(f"video      {video}")
    raise typer.Exit(exit_code(result.outcome))
