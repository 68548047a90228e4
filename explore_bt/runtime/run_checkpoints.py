"""The checkpoints of one run, from its first tick to its end."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from explore_bt.checkpoint import CheckpointStore, Origin, RunMemory
from explore_bt.interfaces import Event
from explore_bt.mission import Mission, Solo
from explore_bt.runtime.checkpoint_keeper import CheckpointKeeper
from explore_bt.runtime.resumption import CutRun
from explore_bt.runtime.robot import Robot
from explore_bt.runtime.runner import Runner
from explore_bt.types import Outcome
from explore_bt.version import __version__

__all__ = ["CHECKPOINTS", "RunCheckpoints"]

CHECKPOINTS = "checkpoint"
"""Folder of the run folder with the last two checkpoints."""


class RunCheckpoints:
    """Tells the keeper where the run stands.

    Args:
        mission: as it runs.
        robots: set up.
        seed: of the run.
        out: the run folder.
        tell: takes events.
        began_s: wall clock's reading at which the run would have begun, had it never been cut.
        resumed: where it goes on.
    """

    def __init__(
        self,
        mission: Mission,
        robots: Sequence[Robot],
        seed: int,
        out: Path,
        tell: Callable[[Event], None],
        began_s: float,
        resumed: CutRun | None,
    ) -> None:
        self._folder = out / CHECKPOINTS
        self._origin = resumed.memory.origin if resumed else _origin(mission, seed)
        self._parts = resumed.memory.parts + 1 if resumed else 1
        self._began_s = began_s
        self._keeper = CheckpointKeeper(CheckpointStore(self._folder), robots, tell)

    def begin(self, runner: Runner) -> None:
        """Before the first tick: from now on there is something to go on from."""
        self._keeper.look(self._memory(runner), waits=True)

    def after_tick(self, runner: Runner) -> None:
        """A tick has ended."""
        if not runner.is_over:
            self._keeper.look(self._memory(runner))

    def close(self, runner: Runner) -> None:
        """The run is over, or has broken down inside."""
        self._keeper.close(self._memory(runner))

    def clear(self, outcome: Outcome) -> None:
        """Nothing is left to go on with: the map itself is among the results."""
        if outcome is Outcome.EXPLORED:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _memory(self, runner: Runner) -> RunMemory:
        return RunMemory(
            origin=self._origin,
            tick=runner.tick,
            stamp_s=runner.now_s,
            wall_time_s=time.perf_counter() - self._began_s,
            ended={name: status.value for name, status in runner.ended.items()},
            outcome=runner.outcome.value if runner.is_over else "",
            reason=runner.reason if runner.is_over else "",
            parts=self._parts,
        )


def _origin(mission: Mission, seed: int) -> Origin:
    solo = mission.solo or Solo("")
    return Origin(
        mission=os.path.realpath(mission.path),
        files={str(path): text for path, text in mission.texts.items()},
        settings=mission.settings,
        folder=str(mission.settings_folder),
        sha256=mission.sha256,
        seed=seed,
        version=__version__,
        robot=solo.robot,
        pace=solo.pace,
    )
