"""The tick loop: time, senses, decisions, motion, observers, in this order."""

from __future__ import annotations

import enum
from collections.abc import Callable, Sequence

from explore_bt.interfaces import Event, TickSnapshot
from explore_bt.mission import Mission
from explore_bt.runtime.attendant import Attendant
from explore_bt.runtime.observers import Observers
from explore_bt.runtime.requests import Requests
from explore_bt.runtime.resumption import CutRun
from explore_bt.runtime.robot import OVER_BUDGET_KEY, REASON_KEY, Robot
from explore_bt.runtime.stop_flag import StopFlag
from explore_bt.runtime.tree_news import leaves_that_ended
from explore_bt.tree import Status
from explore_bt.types import Doing, Outcome, Scan2D

__all__ = ["Runner"]

FIRST_SCAN_TIMEOUT_S = 5.0
REST_TIMEOUT_S = 5.0
LONGEST_PERIOD_S = 0.25
"""After so long without a command a driver in real time has halted its robot."""
_LEVELS = {Outcome.FAILED: "error", Outcome.BUDGET: "warning"}


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
        requests: what people ask for through the robots.
        stop: raised by anyone who wants an end.
        attendant: stands beside the tick loop.
        resumed: where the run goes on, None for one that begins.
        after_tick: called when a tick has ended, and everybody has been shown it.

    Attributes:
        now_s: mission time, on the robots' clocks.
        tick: index of the coming ``TickSnapshot``.
        paused: robot -> why it stands while the others go on; whoever pauses it lets it go on.
    """

    def __init__(
        self,
        mission: Mission,
        robots: Sequence[Robot],
        observers: Observers,
        requests: Requests,
        stop: StopFlag,
        attendant: Attendant,
        *,
        resumed: CutRun | None = None,
        after_tick: Callable[[Runner], None] = lambda _: None,
    ) -> None:
        self._mission = mission
        self.robots = robots
        self._observers = observers
        self._requests = requests
        self.stop = stop
        self._attendant = attendant
        self._dt_s = 1.0 / mission.control_rate_hz
        self._steps_per_tick = round(mission.control_rate_hz / mission.tree_rate_hz)
        self._phase = _Phase.WAKING
        self._after_tick = after_tick
        self.ended: dict[str, Status] = {}
        self.paused: dict[str, str] = {}
        self._rest_until_s = 0.0
        self._acted_s: dict[str, float] = {}
        self._held_s = 0.0
        self.tick = 0
        if resumed is not None:
            self.tick = resumed.tick
            ended = resumed.memory.ended if not resumed.memory.outcome else {}
            self.ended = {name: Status(status) for name, status in ended.items()}
        self._step = self.tick * self._steps_per_tick
        self._begin_s = self.now_s = self._step * self._dt_s
        self.outcome = Outcome.FAILED
        self.reason = "the run broke down inside explore-bt"

    @property
    def is_over(self) -> bool:
        """Whether everything stands still for good."""
        return self._phase is _Phase.OVER

    def run(self) -> None:
        """Until everything stands still; ``outcome`` and ``reason`` then tell why."""
        for robot in self.robots:
            if robot.name in self.ended:
                robot.team.say_doing(Doing.OVER)
        self._attendant.begin(self)
        self._begin_s = max(self._begin_s, *(robot.driver.clock.now_s() for robot in self.robots))
        while self._phase is not _Phase.OVER:
            self._advance()
            is_tick = self._is_tick
            if is_tick:
                self._requests.heed(self.hold, self.paused)
                self._attendant.on_period()
                self._decide()
            for robot in self.robots:
                self._act(robot)
            if is_tick:
                self._show()
                self._after_tick(self)

    def hold(self, reason: str) -> None:
        """One control period at rest, in the middle of a tick or before one: for an attendant in real time.

        Everything goes on but the trees and what they are told the time is: sensors, SLAM, safety gate,
        observers. The robots brake to rest and stand, and will go on where they were.
        """
        for robot in self.robots:
            robot.hold(reason, *self._period_of(robot))
        self._advance()
        self._attendant.on_hold()
        self._held_s += self._dt_s
        if self._is_tick:
            self._show()

    def _act(self, robot: Robot) -> None:
        if reason := self.paused.get(robot.name):
            robot.hold(reason, *self._period_of(robot))
        else:
            robot.act(*self._period_of(robot))

    def tell(self, event: Event) -> None:
        """Pass an event on to the observers."""
        self._observers.event(event)

    @property
    def is_simulated(self) -> bool:
        """Whether time stands still while nobody waits for it."""
        return all(robot.driver.clock.is_simulated for robot in self.robots)

    @property
    def stands_with_time(self) -> bool:
        """Whether time can stand still: not where it is real, nor where the fleet goes on elsewhere."""
        return self.is_simulated and self._mission.solo is None

    @property
    def _is_tick(self) -> bool:
        return self._step % self._steps_per_tick == 0

    def _advance(self) -> None:
        """Go on to the next control period, in real time to the one that is due: none is made up for."""
        missed = self._ticks_missed
        self.tick += missed
        self._step += 1 + missed * self._steps_per_tick
        self.now_s = self._step * self._dt_s
        for robot in self.robots:
            robot.driver.clock.wait_until(self.now_s)
        for robot in self.robots:
            robot.sense()

    def _period_of(self, robot: Robot) -> tuple[float, float]:
        """The time at which a robot is commanded, and how long ago that was done last.

        In simulated time both are nominal; in real time a late loop has let the last command drive on.
        """
        if self.is_simulated:
            return self.now_s, self._dt_s
        now_s = max(robot.driver.clock.now_s(), self.now_s)
        since_s = now_s - self._acted_s.get(robot.name, self.now_s)
        self._acted_s[robot.name] = now_s
        return now_s, min(max(since_s, self._dt_s), LONGEST_PERIOD_S)

    @property
    def _ticks_missed(self) -> int:
        """Whole ticks that have gone by since this period began; commands for the past help nobody."""
        late_s = max(robot.driver.clock.now_s() for robot in self.robots) - self.now_s
        return 0 if self.is_simulated else max(int(late_s / self._dt_s) // self._steps_per_tick, 0)

    def _decide(self) -> None:
        if self._phase is _Phase.WAKING:
            self._wake()
        elif self._phase is _Phase.DECIDING:
            self._tick_trees()
        elif all(robot.pilot.is_at_rest for robot in self.robots) or self.now_s > self._rest_until_s:
            self._phase = _Phase.OVER

    def _wake(self) -> None:
        blind = [robot for robot in self.robots if _is_blind(robot.scan())]
        if not blind:
            self._phase = _Phase.DECIDING
        elif self.stop.is_raised:
            self._end(Outcome.STOPPED, self.stop.reason)
        elif self.now_s > self._begin_s + FIRST_SCAN_TIMEOUT_S:
            robot = blind[0]
            found = "no scan" if robot.scan() is None else "only scans without a valid beam"
            complaint = f"driver {robot.driver.name} gave {found} in {FIRST_SCAN_TIMEOUT_S:.0f} s"
            hint = robot.driver.hindrance() or "check the lidar"
            self._end(Outcome.FAILED, f"robot {robot.name}: {complaint}; {hint}")

    def _tick_trees(self) -> None:
        self._attendant.before_tick()
        if self.stop.is_raised:
            self._end(Outcome.STOPPED, self.stop.reason)
            return
        if spent := self._budget_spent():
            self._end(Outcome.BUDGET, spent)
            return
        for robot in self.robots:
            # a tree that is ticked again after its end would begin anew
            if robot.name not in self.ended and robot.name not in self.paused:
                self._tick_tree(robot)
        if len(self.ended) < len(self.robots):
            return
        for robot in self.robots:
            if self.ended[robot.name] is not Status.SUCCESS:
                self._end(Outcome.FAILED, _last_words(robot, Status.FAILURE))
                return
        short = [
            str(robot.blackboard.get(OVER_BUDGET_KEY))
            for robot in self.robots
            if OVER_BUDGET_KEY in robot.blackboard
        ]
        if short:
            self._end(Outcome.BUDGET, "; ".join(short))
        else:
            self._end(Outcome.EXPLORED, _last_words(self.robots[0], Status.SUCCESS))

    def _tick_tree(self, robot: Robot) -> None:
        status = robot.decide()
        if status is not Status.RUNNING:
            self.ended[robot.name] = status
            robot.team.claim(())
            robot.team.say_doing(Doing.OVER)
            robot.pilot.hold()

    def _budget_spent(self) -> str:
        limits = self._mission.limits
        if limits.time_s is not None and self.now_s - self._held_s >= limits.time_s:
            return f"the time budget of {limits.time_s:.0f} s is spent"
        for robot in self.robots:
            if limits.distance_m is not None and robot.distance_m >= limits.distance_m:
                return f"robot {robot.name}: the distance budget of {limits.distance_m:.0f} m is spent"
        return ""

    def _end(self, outcome: Outcome, reason: str) -> None:
        self.outcome, self.reason = outcome, reason
        self._phase = _Phase.RESTING
        self._rest_until_s = self.now_s + REST_TIMEOUT_S
        level = _LEVELS.get(outcome, "info")
        self._observers.event(Event(self.now_s, "", level, "mission", f"{outcome}: {reason}"))
        for robot in self.robots:
            robot.rest()

    def _show(self) -> None:
        final = self._phase is _Phase.OVER
        for robot in self.robots:
            robot.scores.map_step(robot.team_map.grid(), self.now_s, final=final)
        snapshots = tuple(robot.snapshot() for robot in self.robots)
        self._observers.tick(TickSnapshot(self.tick, self.now_s, snapshots))
        self.tick += 1


def _is_blind(scan: Scan2D | None) -> bool:
    """No scan, or one in which no beam tells anything."""
    return scan is None or bool(scan.is_invalid.all())


def _last_words(robot: Robot, status: Status) -> str:
    """What the tree wrote as its reason; where it failed, also what the leaves said that made it fail."""
    words = [str(robot.blackboard[REASON_KEY])] if REASON_KEY in robot.blackboard else []
    if status is Status.FAILURE or not words:
        ended = [leaf for leaf in leaves_that_ended(robot.tree.root, status) if leaf.feedback_message]
        spoken = ended if status is Status.FAILURE else ended[-1:]
        words += [f"{leaf.name}: {leaf.feedback_message}" for leaf in spoken]
    return "; ".join(dict.fromkeys(words)) or f"the tree of robot {robot.name} ended with {status.value}"
