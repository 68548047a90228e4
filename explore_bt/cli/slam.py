"""``explore-bt slam``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from explore_bt.cli.guard import DONE, FAILED, STOPPED, guarded
from explore_bt.cli.human import count, duration
from explore_bt.cli.places import new_run_folder
from explore_bt.cli.run_log import run_log
from explore_bt.errors import LogError, PluginError

if TYPE_CHECKING:
    from explore_bt.cli.mapping_job import MappingJob
    from explore_bt.types import MappingResult

__all__ = ["slam"]


@guarded
def slam(
    log: Annotated[
        Path,
        typer.Argument(
            metavar="LOG", help="CARMEN log (also .gz, .bz2), recording.mcap, ROS 1 bag, ROS 2 bag folder."
        ),
    ],
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder for the results, new or empty.")],
    relations: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Verified relations to measure the error by: t1 t2 x y z r p y."),
    ] = None,
    odometry: Annotated[
        bool, typer.Option("--odometry", help="Tell SLAM what the wheels say; else lidar and IMU only.")
    ] = False,
    name: Annotated[str, typer.Option("--slam", metavar="NAME", help="The SLAM plugin.")] = "kiss_gtsam",
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set an option of the SLAM; may be repeated."),
    ] = None,
    log_option: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="Set an option of the driver replay; may be repeated."),
    ] = None,
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="Show the log of the program.")] = False,
) -> None:
    """Make a map from a recorded log, without a robot.

    The log is read in file order, as fast as SLAM can take it. With relations, result.json holds the error
    over them (the Freiburg metric, Kuemmerle et al. 2009).

    Exit code: 0 done, 1 the log is cut off or SLAM failed (what came before is saved), 2 wrong input,
    130 stopped by hand.
    Ctrl-C ends the mapping and saves what there is.
    """
    from explore_bt.cli.mapping_job import run_job

    folder = new_run_folder(out, log.stem)
    job = _prepare(log, name, odometry, set_ or [], log_option or [], relations)
    typer.echo(f"{log}, slam {name}: getting ready (the first time takes longer, it compiles)")
    with run_log(folder / "run.log", verbose=verbose):
        result = run_job(job, folder)
    _show(result, folder)
    raise typer.Exit({"mapped": DONE, "stopped": STOPPED}.get(str(result.outcome), FAILED))


def _prepare(
    log: Path, name: str, odometry: bool, settings: list[str], log_settings: list[str], relations: Path | None
) -> MappingJob:
    from explore_bt.cli.mapping_job import MappingJob, PlaybackDriver
    from explore_bt.evaluation import read_relations
    from explore_bt.interfaces import Playback, Slam
    from explore_bt.mission.settings import options_from_settings
    from explore_bt.plugin import load_plugins

    registry = load_plugins(inline_dir=Path()).registry
    slam_class: type[Slam] = registry.get("slam", name)
    driver_class: type[PlaybackDriver] = registry.get("driver", "replay")
    if odometry and "use_odometry" not in slam_class.Options.model_fields:
        raise PluginError(f"--odometry: slam {name} has no option use_odometry; it cannot hear the wheels")
    if not log.exists():
        raise LogError(f"{log}: there is no such log; give a log file or the folder of a ROS 2 bag")
    heard = {"use_odometry": True} if odometry else {}
    options = options_from_settings(slam_class.Options, name, "--set", settings, heard)
    driver = driver_class(
        options_from_settings(driver_class.Options, "replay", "--log-option", log_settings, {"log": str(log)})
    )
    assert isinstance(driver, Playback)
    verified = read_relations(relations) if relations else ()
    return MappingJob(log, registry, driver, slam_class(options), odometry, verified)


def _show(result: MappingResult, folder: Path) -> None:
    figures = [
        count(result.scans, "scan"),
        f"{result.path_length_m:.1f} m",
        duration(result.mission_time_s),
        count(result.loop_closures, "closure"),
        f"{result.ms_per_scan_median:.1f} ms a scan",
    ]
    typer.echo(f"{result.outcome:<10} {' · '.join(figures)}")
    if result.reason:
        typer.echo(f"reason     {result.reason}")
    for note in result.notes:
        typer.echo(f"note       {note}")
    if result.relations:
        shown = (
            "{translation_mean_m:.4f} ± {translation_sd_m:.4f} m · {rotation_mean_deg:.3f} ± "
            "{rotation_sd_deg:.3f} deg over {count:.0f} relations"
        )
        typer.echo(f"error      {shown.format(**result.relations)}")
    for label, file in (("map", "map.yaml"), ("report", "report.html"), ("figures", "result.json")):
        typer.echo(f"{label:<10} {folder / file}")
