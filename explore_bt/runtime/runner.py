"""The tick loop: time, senses, decisions, motion, observers, in this order."""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator, Sequence

from py_trees.behaviour import Behaviour

from explore_bt.interfaces import Event, TickSnapshot
from explore_bt.mission import Mission
from explore_bt.runtime.observers import Observers
from explore_bt.runtime.resumption import CutRun
from explore_bt.runtime.robot import OVER_BUDGET_KEY, REASON_KEY, Robot
from explore_bt.runtime.stop_flag import StopFlag
from explore_bt.tree import Status
from explore_bt.types import Outcome, Scan2D

__all__ = ["Runner"]

FIRST_SCAN_TIMEOUT_S = 5.0
REST_TIMEOUT_S = 5.0


class _Phase(enum.Enum):
    """Waiting for the first scan, exploring, coming to rest, at rest."""

    WAKING = enum.auto()
    DECIDING = enum.auto()
    RESTING = enum.auto()
    OVER = enum.auto()


class Runner:
    """Drives all robots of a mission in lock-step until the trees, the user or a budget end it.

    Args:
        mission: as loaded and checked.
        robots: set up.
        observers: who is shown every tick.
        stop: raised by anyone who wants an end.
        resumed: where the run goes on, None for one that begins.
        after_tick: called when a tick has ended, and everybody has been shown it.
    """

    def __init__(
        self,
        mission: Mission,
        robots: Sequence[Robot],
        observers: Observers,
        stop: StopFlag,
        *,
        resumed: CutRun | None = None,
        after_tick: Callable[[Runner], None] = lambda _: None,
    ) -> None:
        self._mission = mission
        self._robots = robots
        self._observers = observers
        self._stop = stop
        self._dt_s = 1.0 / mission.control_rate_hz
        self._steps_per_tick = round(mission.control_rate_hz / mission.tree_rate_hz)
        self._phase = _Phase.WAKING
        self._after_tick = after_tick
        self.ended: dict[str, Status] = {}
        self._rest_until_s = 0.0
        self._tick = 0
        if resumed is not None:
            self._tick = resumed.tick
            ended = resumed.memory.ended if not resumed.memory.outcome else {}
            self.ended = {name: Status(status) for name, status in ended.items()}
        self._begin_s = self.now_s = self._tick * self._steps_per_tick * self._dt_s
        self.outcome = Outcome.FAILED
        self.reason = "the run broke down inside explore-bt"

    @property
    def ticks(self) -> int:
        """Of the tree, the whole run so far: the number of the next one."""
        return self._tick

    @property
    def is_over(self) -> bool:
        """Whether everything stands still for good."""
        return self._phase is _Phase.OVER

    def run(self) -> None:
        """Until everything stands still; ``outcome`` and ``reason`` then tell why."""
        step = self._tick * self._steps_per_tick
        while self._phase is not _Phase.OVER:
            step += 1
            self._advance(step * self._dt_s)
            for robot in self._robots:
                robot.sense()
            if step % self._steps_per_tick == 0:
                self._decide()
            for robot in self._robots:
                robot.act(self.now_s, self._dt_s)
            if step % self._steps_per_tick == 0:
                self._show()

    def _advance(self, time_s: float) -> None:
        for robot in self._robots:
            robot.driver.clock.wait_until(time_s)
        self.now_s = time_s

    def _decide(self) -> None:
        if self._phase is _Phase.WAKING:
            self._wake()
        elif self._phase is _Phase.DECIDING:
            self._tick_trees()
        elif all(robot.pilot.is_at_rest for robot in self._robots) or self.now_s > self._rest_until_s:
            self._phase = _Phase.OVER

    def _wake(self) -> None:
        blind = [robot for robot in self._robots if _is_blind(robot.scan())]
        if not blind:
            self._phase = _Phase.DECIDING
        elif self._stop.is_raised:
            self._end(Outcome.STOPPED, self._stop.reason)
        elif self.now_s > self._begin_s + FIRST_SCAN_TIMEOUT_S:
            robot = blind[0]
            found = "no scan" if robot.scan() is None else "only scans without a valid beam"
            complaint = f"driver {robot.driver.name} gave {found} in {FIRST_SCAN_TIMEOUT_S:.0f} s"
            self._end(Outcome.FAILED, f"robot {robot.name}: {complaint}; check the lidar")

    def _tick_trees(self) -> None:
        if self._stop.is_raised:
            self._end(Outcome.STOPPED, self._stop.reason)
            return
        if spent := self._budget_spent():
            self._end(Outcome.BUDGET, spent)
            return
        for robot in self._robots:
            if robot.name not in self.ended:  # a tree that is ticked again would begin anew
                self._tick_tree(robot)
        if len(self.ended) < len(self._robots):
            return
        for robot in self._robots:
            if self.ended[robot.name] is not Status.SUCCESS:
                self._end(Outcome.FAILED, _last_words(robot, Status.FAILURE))
                return
        short = [
            str(robot.blackboard.get(OVER_BUDGET_KEY))
            for robot in self._robots
            if OVER_BUDGET_KEY in robot.blackboard
        ]
        if short:
            self._end(Outcome.BUDGET, "; ".join(short))
        else:
            self._end(Outcome.EXPLORED, _last_words(self._robots[0], Status.SUCCESS))

    def _tick_tree(self, robot: Robot) -> None:
        status = robot.decide()
        if status is not Status.RUNNING:
            self.ended[robot.name] = status
            robot.pilot.hold()

    def _budget_spent(self) -> str:
        limits = self._mission.limits
        if limits.time_s is not None and self.now_s >= limits.time_s:
            return f"the time budget of {limits.time_s:.0f} s is spent"
        for robot in self._robots:
            if limits.distance_m is not None and robot.distance_m >= limits.distance_m:
                return f"robot {robot.name}: the distance budget of {limits.distance_m:.0f} m is spent"
        return ""

    def _end(self, outcome: Outcome, reason: str) -> None:
        self.outcome, self.reason = outcome, reason
        self._phase = _Phase.RESTING
        self._rest_until_s = self.now_s + REST_TIMEOUT_S
        self._observers.event(Event(self.now_s, "", "info", "mission", f"{outcome}: {reason}"))
        for robot in self._robots:
            robot.rest()

    def _show(self) -> None:
        final = self._phase is _Phase.OVER
        for robot in self._robots:
            robot.scores.map_step(robot.slam.grid(), self.now_s, final=final)
        snapshots = tuple(robot.snapshot() for robot in self._robots)
        self._observers.tick(TickSnapshot(self._tick, self.now_s, snapshots))
        self._tick += 1
        self._after_tick(self)


def _is_blind(scan: Scan2D | None) -> bool:
    """No scan, or one in which no beam tells anything."""
    return scan is None or bool(scan.is_invalid.all())


def _last_words(robot: Robot, status: Status) -> str:
    """What the tree wrote as its reason; where it failed, also what the leaves said that made it fail."""
    words = [str(robot.blackboard[REASON_KEY])] if REASON_KEY in robot.blackboard else []
    if status is Status.FAILURE or not words:
        ended = [leaf for leaf in _leaves_that_ended(robot.tree.root, status) if leaf.feedback_message]
        spoken = ended if status is Status.FAILURE else ended[-1:]
        words += [f"{leaf.name}: {leaf.feedback_message}" for leaf in spoken]
    return "; ".join(dict.fromkeys(words)) or f"the tree of robot {robot.name} ended with {status.value}"


def _leaves_that_ended(node: Behaviour, status: Status) -> Iterator[Behaviour]:
    """Leaves with this status below nodes with this status: a failure that was recovered from is left out."""
    if node.status is not status:
        return
    if not node.children:
        yield node
    for child in node.children:
        yield from _leaves_that_ended(child, status)
