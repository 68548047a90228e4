"""Writes checkpoints while a run goes on, beside the control loop."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

from explore_bt.checkpoint import (
    Checkpoint,
    CheckpointStore,
    Codec,
    CodecError,
    Draft,
    Recent,
    RobotMemory,
    RunMemory,
    write_recent,
)
from explore_bt.files import sync_files
from explore_bt.interfaces import Event
from explore_bt.runtime.kept_values import RUN_FILE, codec_for, robot_file, run_codec, slam_folder
from explore_bt.runtime.robot import Robot
from explore_bt.tree import Leaf

__all__ = ["PERIOD_S", "CheckpointKeeper"]

PERIOD_S = 5.0
"""Mission time between two checkpoints."""
RECENT_PERIOD_S = 1.0
"""Mission time between two looks at what the robots have in mind."""
LARGE_PARTS = ("scores",)
"""Left out of what is written every second; the recording has the scores."""

_log = logging.getLogger("explore_bt")


class CheckpointKeeper:
    """Takes hold of a run's state in the tick thread, and has another thread write it.

    In simulated time the next checkpoint waits for the one before: the clock stands meanwhile. In wall time
    a checkpoint that is due while the last is still being written comes one tick later.

    Args:
        store: where they go.
        robots: whose state is kept.
        tell: takes an event when a checkpoint could not be written.
    """

    def __init__(
        self, store: CheckpointStore, robots: Sequence[Robot], tell: Callable[[Event], None]
    ) -> None:
        self._store = store
        self._robots = robots
        self._tell = tell
        self._codecs = {
            robot.name: codec_for(type(node) for node in robot.tree.nodes if isinstance(node, Leaf))
            for robot in robots
        }
        self._waits = all(robot.driver.clock.is_simulated for robot in robots)
        self._writer = ThreadPoolExecutor(max_workers=1, thread_name_prefix="checkpoint")
        self._writing: Future[Checkpoint] | None = None
        self._last: Checkpoint | None = None
        self._now_s = self._due_s = self._note_due_s = 0.0
        self._left_out: set[str] = set()
        self._seconds: list[float] = []
        """Wall time that each took of the tick thread, waiting for the one before aside."""

    def look(self, run: RunMemory, *, waits: bool = False) -> None:
        """A tick has ended: write a checkpoint if one is due; ``waits``: until it is on the disk."""
        self._now_s = run.stamp_s
        if run.stamp_s < self._due_s or (self._is_busy and not self._waits):
            self._note(run)
            return
        self._due_s = run.stamp_s + PERIOD_S
        self._take(run)
        if waits:
            self._finish()

    def close(self, run: RunMemory) -> None:
        """The run is over: a last checkpoint, whole on the disk when this returns."""
        self._now_s = run.stamp_s
        self._take(run)
        self._finish()
        self._writer.shutdown()
        if self._seconds:
            most, whole = max(self._seconds), sum(self._seconds)
            _log.debug(
                "%d checkpoints took %.0f ms of the control loop's time in all, at most %.1f ms each",
                len(self._seconds),
                1000.0 * whole,
                1000.0 * most,
            )

    def _note(self, run: RunMemory) -> None:
        """Write down what the robots have in mind, if a second has passed."""
        if run.stamp_s < self._note_due_s:
            return
        self._note_due_s = run.stamp_s + RECENT_PERIOD_S
        try:
            texts = {robot.name: self._text(robot.name, _small(robot.memory())) for robot in self._robots}
            write_recent(self._store.folder, Recent(run.tick, texts))
        except Exception as fault:
            self._complain(fault)

    @property
    def _is_busy(self) -> bool:
        return self._writing is not None and not self._writing.done()

    def _take(self, run: RunMemory) -> None:
        self._finish()
        begun_s = time.perf_counter()  # of the wall: a figure, never an input of the run
        try:
            draft = self._store.begin(run.tick, self._last)
            memories = {robot.name: robot.memory() for robot in self._robots}
            saves = [
                robot.slam.begin_save(
                    draft.folder / slam_folder(robot.name), draft.before(slam_folder(robot.name))
                )
                for robot in self._robots
            ]
        except Exception as fault:  # a plugin that cannot save, a full disk: the mission goes on
            self._complain(fault)
            return
        self._writing = self._writer.submit(self._write, draft, run, memories, saves)
        self._seconds.append(time.perf_counter() - begun_s)

    def _write(
        self,
        draft: Draft,
        run: RunMemory,
        memories: Mapping[str, RobotMemory],
        saves: Iterable[Callable[[], None]],
    ) -> Checkpoint:
        """In the writer's thread."""
        for save in saves:
            save()
        draft.write(RUN_FILE, run_codec().dumps(run))
        for name, memory in memories.items():
            draft.write(robot_file(name), self._text(name, memory))
        checkpoint = draft.commit()
        sync_files(self._store.folder.parent)
        return checkpoint

    def _text(self, robot: str, memory: RobotMemory) -> str:
        codec = self._codecs[robot]
        kept = {
            key: value for key, value in memory.blackboard.items() if self._is_kept(codec, robot, key, value)
        }
        return codec.dumps(replace(memory, blackboard=kept))

    def _is_kept(self, codec: Codec, robot: str, key: str, value: object) -> bool:
        try:
            codec.encode(value)
        except CodecError as fault:
            if f"{robot}/{key}" not in self._left_out:
                self._left_out.add(f"{robot}/{key}")
                _log.warning("robot %s: checkpoints leave $%s out: %s", robot, key, fault)
            return False
        return True

    def _finish(self) -> None:
        """Wait for the checkpoint that is being written."""
        writing, self._writing = self._writing, None
        if writing is None:
            return
        try:
            self._last = writing.result()
        except Exception as fault:
            self._complain(fault)

    def _complain(self, fault: Exception) -> None:
        words = f"no checkpoint was written: {fault!r}"
        if words not in self._left_out:
            self._left_out.add(words)
            _log.error("%s", words, exc_info=fault)
            self._tell(Event(self._now_s, "", "warning", "checkpoint", words))


def _small(memory: RobotMemory) -> RobotMemory:
    parts = {name: part for name, part in memory.parts.items() if name not in LARGE_PARTS}
    return replace(memory, parts=parts)
