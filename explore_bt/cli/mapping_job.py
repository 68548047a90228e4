"""From a log and a SLAM to the files of a map, with a progress bar."""

from __future__ import annotations

import logging
import resource
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from explore_bt.cli.guard import Crash
from explore_bt.cli.stopping import stopping_by_signal
from explore_bt.errors import LogError, UserError
from explore_bt.evaluation import Relation, relation_errors
from explore_bt.interfaces import Driver, Playback, RobotContext, Slam
from explore_bt.plugin import Registry
from explore_bt.report.mapping_files import write_mapping
from explore_bt.runtime import Mapping, StopFlag, map_log
from explore_bt.types import MappingResult, Outcome, Trajectory, way_along
from explore_bt.version import __version__

__all__ = ["MappingJob", "run_job"]

_log = logging.getLogger("explore_bt")

_REDRAW_S = 0.1


class PlaybackDriver(Driver, Playback):
    """A driver that is a playback too: what the command ``slam`` needs."""


@dataclass(frozen=True, slots=True, eq=False)
class MappingJob:
    """What was asked for, checked; nothing is set up yet."""

    log: Path
    registry: Registry
    driver: PlaybackDriver
    slam: Slam
    odometry: bool
    relations: Sequence[Relation]


def run_job(job: MappingJob, folder: Path) -> MappingResult:
    """Map the log and write the files; nothing is written if the log cannot be read.

    Raises:
        UserError: a log without a scan or with something that cannot be understood, or relations of another
            log.
        Crash: a fault of ours.
    """
    began_s = time.perf_counter()  # wall time is a figure of the report, never an input
    stop = StopFlag()
    with stopping_by_signal(stop, then="what has been mapped so far is saved"):
        try:
            job.driver.setup(RobotContext())
            limits, radius_m = job.driver.limits, job.driver.footprint_radius_m
            start = job.driver.start
            job.slam.setup(RobotContext(start=start, footprint_radius_m=radius_m, limits=limits))
            with _progress(job) as on_scan:
                mapping = map_log(job.driver, job.slam, odometry=job.odometry, stop=stop, on_scan=on_scan)
            result = _result(job, mapping, stop, began_s)
            write_mapping(job.registry, mapping, job.slam, result, folder, radius_m)
            if mapping.fault is not None:  # only now there is a folder for the log
                _log.warning("the mapping ended early", exc_info=mapping.fault)
        except UserError:
            raise
        except Exception as fault:
            raise Crash(folder) from fault
        finally:
            job.driver.close()
    return result


@contextmanager
def _progress(job: MappingJob) -> Iterator[Callable[[Mapping], None]]:
    """A bar on a terminal, nothing in a pipe."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[scans]} scans · {task.fields[health]}"),
        TimeRemainingColumn(),
    )
    console = Console(highlight=False)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(job.log.name, total=1.0, scans=0, health="")
        due_s = 0.0

        def on_scan(mapping: Mapping) -> None:
            nonlocal due_s
            now_s = time.perf_counter()
            if now_s >= due_s:
                due_s = now_s + _REDRAW_S
                state = str(mapping.health[-1].state)
                bar.update(task, completed=job.driver.progress, scans=mapping.scans, health=state)

        yield on_scan


def _result(job: MappingJob, mapping: Mapping, stop: StopFlag, began_s: float) -> MappingResult:
    way = job.slam.trajectory()
    figures = dict(job.slam.figures())
    outcome, reason = _outcome(mapping, stop)
    return MappingResult(
        outcome=outcome,
        reason=reason,
        mission=job.log.name,
        coverage=None,
        contacts=None,
        ate_rmse_m=None,
        path_length_m=float(way_along(way.poses)[-1]) if len(way.poses) else 0.0,
        mission_time_s=mapping.duration_s,
        wall_time_s=time.perf_counter() - began_s,
        min_clearance_m=None,
        mean_clearance_m=None,
        distance_to_home_m=_from_home_m(way),
        seed=0,
        mission_sha256="",
        version=__version__,
        slam=figures,
        log=str(job.log),
        relations=_relations(job, mapping.in_log_time(way), outcome),
        scans=mapping.scans,
        loop_closures=int(figures.get("loop_closures", 0)),
        ms_per_scan_median=mapping.percentile_ms(50.0),
        ms_per_scan_p99=mapping.percentile_ms(99.0),
        peak_memory_mb=_peak_memory_mb(),
        health=tuple(
            {"t": change.stamp_s, "state": str(change.state), "reason": change.reason}
            for change in mapping.health
        ),
        notes=tuple(job.driver.notes),
    )


def _relations(job: MappingJob, way: Trajectory, outcome: Outcome) -> dict[str, float] | None:
    """The error over the relations; a map that was broken off may not have come to any of them yet."""
    if not job.relations:
        return None
    try:
        return relation_errors(way, job.relations).as_dict()
    except LogError:
        if outcome is Outcome.MAPPED:
            raise
        return None


def _outcome(mapping: Mapping, stop: StopFlag) -> tuple[Outcome, str]:
    if stop.is_raised:
        return Outcome.STOPPED, stop.reason
    if mapping.damage:
        return Outcome.FAILED, mapping.damage
    return Outcome.MAPPED, "the log has come to its end"


def _from_home_m(way: Trajectory) -> float:
    return float(np.hypot(*(way.poses[-1, :2] - way.poses[0, :2]))) if len(way.poses) else 0.0


def _peak_memory_mb() -> float:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # kilobytes, on macOS bytes
    return peak / (2**20 if sys.platform == "darwin" else 2**10)
