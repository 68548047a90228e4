"""One run of a mission, from the checked model to the files it leaves."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from explore_bt.checkpoint import CheckpointStore
from explore_bt.errors import UserError
from explore_bt.files import write_whole
from explore_bt.fleet import merged_map
from explore_bt.interfaces import Commons, Event, RobotProduct, RunInfo, Sink
from explore_bt.maps import write_map
from explore_bt.mission import Mission
from explore_bt.plugin import Registry
from explore_bt.runtime.attendant import Attendant
from explore_bt.runtime.exports import export
from explore_bt.runtime.observers import Observers
from explore_bt.runtime.requests import Requests
from explore_bt.runtime.resumption import CutRun
from explore_bt.runtime.robot import OVER_BUDGET_KEY, REASON_KEY, Robot
from explore_bt.runtime.run_checkpoints import CHECKPOINTS, RunCheckpoints
from explore_bt.runtime.runner import Runner
from explore_bt.runtime.stop_flag import StopFlag
from explore_bt.types import OccupancyGrid, Result
from explore_bt.version import __version__

__all__ = ["ENDING_KEYS", "run_mission"]

RESULT = "result.json"
LEFT_OPEN_KEY = "left_open"
"""Blackboard entry in which a tree lists what it could not explore, one sentence each."""
ENDING_KEYS = (REASON_KEY, OVER_BUDGET_KEY, LEFT_OPEN_KEY)
"""Entries in which a tree says how it ended: a run that is resumed after its end has not."""


def run_mission(
    mission: Mission,
    *,
    registry: Registry,
    out: Path,
    seed: int,
    sinks: Sequence[Sink],
    stop: StopFlag,
    attendant: Attendant | None = None,
    resumed: CutRun | None = None,
) -> Result:
    """Run a mission to its end and leave its results in ``out``.

    Args:
        mission: as loaded and checked.
        registry: where the exporters come from.
        out: folder for the results; made once every robot is ready, so that wrong input leaves nothing.
        seed: of every random draw in the run.
        sinks: observers, in the order they are called.
        stop: raised by anyone who wants the robots to stop.
        attendant: stands beside the tick loop, a debugger for example.
        resumed: where the run in ``out`` broke off; None begins one.

    Returns:
        What ``result.json`` says.

    Raises:
        UserError: the mission asks for something that cannot be had; nothing was written.
    """
    # wall time is a figure of the report, never an input of the run
    began_s = time.perf_counter() - (resumed.memory.wall_time_s if resumed else 0.0)
    observers = Observers(sinks)
    attendant = attendant or Attendant()
    commons = Commons()
    robots = [Robot(spec, mission, seed, stop, observers.event, commons) for spec in mission.robots]
    try:
        for robot in robots:
            robot.setup(resumed.robots[robot.name] if resumed else None)
            observers.add(robot.driver.observers())
        _make_folder(out)
        with CheckpointStore(out / CHECKPOINTS).locked():
            return _run(
                mission, robots, observers, stop, registry, _Run(out, seed, began_s, resumed, attendant)
            )
    finally:
        try:
            for robot in robots:
                robot.close()
        finally:
            attendant.end()


@dataclass(frozen=True, slots=True)
class _Run:
    """Where the results go, and since when; ``began_s`` is a reading of ``time.perf_counter``."""

    out: Path
    seed: int
    began_s: float
    resumed: CutRun | None
    attendant: Attendant

    @property
    def wall_time_s(self) -> float:
        return time.perf_counter() - self.began_s


def _run(
    mission: Mission,
    robots: Sequence[Robot],
    observers: Observers,
    stop: StopFlag,
    registry: Registry,
    run: _Run,
) -> Result:
    """From the first tick to the files."""
    out, resumed = run.out, run.resumed
    info = _run_info(mission, robots, run)
    observers.open(info)
    if resumed is not None:
        (out / RESULT).unlink(missing_ok=True)  # of the part before: it does not tell of this one
        observers.past(resumed.past(info))
        observers.event(_going_on(resumed, info))
    checkpoints = RunCheckpoints(mission, robots, run.seed, out, observers.event, run.began_s, resumed)
    runner = Runner(
        mission,
        robots,
        observers,
        Requests(robots, stop, out),
        stop,
        run.attendant,
        resumed=resumed,
        after_tick=checkpoints.after_tick,
    )
    try:
        checkpoints.begin(runner)
        runner.run()
    finally:  # nothing mapped is lost, even if the run breaks down inside
        result = _result(mission, robots, runner, run.seed, run.wall_time_s)
        checkpoints.close(runner)
        _export(registry, mission, robots, result, out)
        observers.close(result)
        write_whole(out / RESULT, json.dumps(result.as_dict(), indent=2) + "\n")
    checkpoints.clear(result.outcome)
    return result


def _make_folder(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"{out} cannot be made: {error.strerror}; name another folder with --out") from None


def _run_info(mission: Mission, robots: Sequence[Robot], run: _Run) -> RunInfo:
    return RunInfo(
        mission=mission.name,
        mission_text=mission.text,
        mission_sha256=mission.sha256,
        seed=run.seed,
        version=__version__,
        folder=run.out,
        trees={robot.name: robot.tree.infos for robot in robots},
        footprint_radius_m={robot.name: robot.footprint_radius_m for robot in robots},
        sources=mission.sources,
        resumed_s=None if run.resumed is None else run.resumed.stamp_s,
    )


def _going_on(resumed: CutRun, info: RunInfo) -> Event:
    """What the record says about the seam."""
    memory, stamp_s = resumed.memory, info.resumed_s or 0.0
    words = f"part {memory.parts + 1} begins, from the checkpoint at {memory.stamp_s:.1f} s"
    return Event(stamp_s, "", "info", "mission", words)


def _result(
    mission: Mission, robots: Sequence[Robot], runner: Runner, seed: int, wall_time_s: float
) -> Result:
    """Contacts, touches and closest place of all robots; the other figures are the first one's."""
    robot = robots[0]
    scores = [each.scores.score() for each in robots]
    closest_m = [each.min_clearance_m for each in scores if each.min_clearance_m is not None]
    score = scores[0]
    left_open = robot.blackboard.get(LEFT_OPEN_KEY, ())
    return Result(
        outcome=runner.outcome,
        reason=runner.reason,
        mission=mission.name,
        coverage=score.coverage,
        contacts=_sum_of_known(each.contacts for each in scores),
        touched_by_people=_sum_of_known(each.touched_by_people for each in scores),
        ate_rmse_m=robot.scores.ate_rmse_m(robot.trajectory()),
        path_length_m=score.distance_m,
        mission_time_s=runner.now_s,
        wall_time_s=wall_time_s,
        min_clearance_m=min(closest_m, default=None),
        mean_clearance_m=score.mean_clearance_m,
        distance_to_home_m=score.distance_to_home_m,
        seed=seed,
        mission_sha256=mission.sha256,
        version=__version__,
        left_open=tuple(str(sentence) for sentence in left_open) if isinstance(left_open, tuple) else (),
        slam=dict(robot.slam.figures()),
        mocked=_mocked(robots),
        not_merged=tuple(f"robot {name}: {why}" for name, why in robot.team.not_merged().items()),
    )


def _mocked(robots: Sequence[Robot]) -> tuple[str, ...]:
    paths = (info.path for robot in robots for info in robot.tree.infos if info.is_mocked)
    return tuple(dict.fromkeys(paths))


def _sum_of_known(counts: Iterable[int | None]) -> int | None:
    known = [count for count in counts if count is not None]
    return sum(known) if known else None


def _export(registry: Registry, mission: Mission, robots: Sequence[Robot], result: Result, out: Path) -> None:
    """Every exporter for every robot: alone into the folder itself, those of a fleet into their own.

    The map of all lies in the folder itself; of a robot in a process of its own, as far as it has heard.
    """
    is_fleet = len(robots) > 1 or mission.solo is not None
    for robot in robots:
        folder = out / robot.name if is_fleet else out
        folder.mkdir(exist_ok=True)
        product = RobotProduct(
            robot.name,
            robot.slam.grid(),
            robot.trajectory(),
            robot.scores.true_trajectory(),
            result,
            robot.slam.structure(),
        )
        export(registry, product, robot.slam, folder)
    if is_fleet:
        write_map(_map_of_all(robots), out)


def _map_of_all(robots: Sequence[Robot]) -> OccupancyGrid:
    """In the frame of the first robot; those whose maps are not merged with its own are left out."""
    first, *others = robots
    if not others:
        return first.team_map.grid()
    return merged_map(first.slam, [(robot.slam, first.team.chart(robot.name)) for robot in others])
