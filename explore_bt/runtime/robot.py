"""One robot's stack: driver, SLAM, planner, controller, safety gate, and the tree that decides."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import replace

from explore_bt.checkpoint import RobotMemory
from explore_bt.errors import ComponentFailure, PlanningFailure, UserError
from explore_bt.exploration import warm_up
from explore_bt.fleet import TeamMap
from explore_bt.interfaces import Commons, Event, MapMemory, MapView, RobotContext, RobotSnapshot
from explore_bt.mission import Mission, RobotSpec, build_tree
from explore_bt.runtime.centred import centred
from explore_bt.runtime.fault_log import FaultLog
from explore_bt.runtime.origin import context_with, origin_of
from explore_bt.runtime.pilot import Pilot
from explore_bt.runtime.purse import Purse
from explore_bt.runtime.resumption import Cut, check_clock
from explore_bt.runtime.robot_keeping import Remembering, RobotKeeping
from explore_bt.runtime.robot_news import RobotNews
from explore_bt.runtime.safety_gate import SafetyGate
from explore_bt.runtime.scorekeeper import Scorekeeper
from explore_bt.runtime.senses import Senses
from explore_bt.runtime.sketch import Sketch
from explore_bt.runtime.squeeze import SQUEEZES_M, plan_or_squeeze
from explore_bt.runtime.stop_flag import StopFlag
from explore_bt.runtime.team_mate import first_path, grids_to_try, standing
from explore_bt.runtime.team_place import give_word, presence_of, team_place
from explore_bt.runtime.tick_counts import TickCounts
from explore_bt.runtime.tight_places import TightPlaces
from explore_bt.runtime.upright import Upright
from explore_bt.runtime.way_finder import WayFinder
from explore_bt.tree import Blackboard, PortUnsetError, Probe, Status, attach, halt, tick
from explore_bt.types import (
    Battery,
    Budget,
    Drawing,
    Estimate,
    Measurement,
    MovingObstacle,
    Path,
    Pose2,
    Scan2D,
    Trajectory,
)

__all__ = ["Robot"]

REASON_KEY = "reason"
"""Blackboard entry in which a tree may say why it ended."""
OVER_BUDGET_KEY = "over_budget"
"""Blackboard entry in which a tree says that it broke off for want of time, distance or battery."""

_log = logging.getLogger("explore_bt")


class Robot:
    """Owns its plugins and serves the leaves of its tree (see ``interfaces.RobotServices``)."""

    def __init__(
        self,
        spec: RobotSpec,
        mission: Mission,
        seed: int,
        stop: StopFlag,
        tell: Callable[[Event], None],
        commons: Commons | None = None,
    ) -> None:
        """Construct every plugin; nothing is opened yet. ``commons`` is what all robots of the run share."""
        self.name = spec.name
        self._spec = spec
        self._mission = mission
        self._seed = seed
        self._stop = stop
        self._tell = tell
        self._commons = commons or Commons()
        self.driver = spec.driver.make()
        self.slam = spec.slam.make()
        self.team_map = TeamMap(self.slam)
        self.team = team_place(mission, self.name, self.slam, self.driver, self.tell)
        self._planner = spec.planner.make()
        self._controller = spec.controller.make()
        self.blackboard = Blackboard()
        self.tree = build_tree(spec.tree, self, self.blackboard)
        self._probe: Probe | None = None
        self._counts = TickCounts(self.tree.nodes)
        self._sketch = Sketch()
        self._view: MapView | None = None
        self._map_memory = MapMemory()
        self._way_finder = WayFinder(self._planner, self.team_map, stop)
        self._tight = TightPlaces()
        self._purse = Purse(mission.limits)
        self._faults = FaultLog(self.name, self.tell)
        self._senses = Senses(self.slam, Upright(self.driver, self.slam), self._faults)
        self._held_s = 0.0
        self._news = RobotNews(self.tree, self.tell)

    def setup(self, cut: Cut | None = None) -> None:
        """Open the driver, warm everything up; ``cut`` is where a resumed run broke off.

        Raises:
            UserError: whatever the mission asked for cannot be had.
        """
        resumed = cut.resumption if cut else None
        context = RobotContext(
            robot=self.name,
            seed=self._seed,
            start=self._spec.start,
            resumed=resumed,
            knows_start=self._spec.knows_start,
            commons=self._commons,
        )
        self.driver.setup(context)
        check_clock(self.driver, resumed)
        self._origin = origin_of(self.driver, self._spec.knows_start)
        limits = self._mission.limits.apply(self.driver.limits)
        context = context_with(context, self.driver, self._origin, limits)
        self.home = cut.memory.home if cut else self._origin.start
        warm_up()
        self.slam.setup(replace(context, start=cut.memory.pose) if cut else context)
        saved_map = cut.slam_folder if cut else self._spec.saved_map
        if saved_map is not None:
            self.slam.load(saved_map)
        self._poses_before = cut.memory.poses_before if cut else len(self.slam.trajectory().stamps_s)
        self.team.setup(context, self.team_map)
        self._planner.setup(context)
        self._controller.setup(context)
        self._senses.setup(self.driver.shape)
        self._limits = limits
        brake = self._mission.limits.of_brake(self.driver.limits)
        gate = SafetyGate(self.driver.footprint_radius_m, brake, self.driver.command_delay_s)
        self.pilot = Pilot(self._controller, gate, self.driver, limits)
        self.scores = Scorekeeper(self.home, context.truth)
        parts: dict[str, Remembering] = {
            "scores": self.scores,
            "purse": self._purse,
            "tight places": self._tight,
            "team": self.team,
        }
        self._keeping = RobotKeeping(self.tree, self.blackboard, parts)
        if cut is not None:
            self._restore(cut)

    @property
    def footprint_radius_m(self) -> float:
        """Radius of the circular footprint."""
        return self.driver.footprint_radius_m

    @property
    def least_margin_m(self) -> float:
        """The first squeeze that ``plan`` allows itself: the safety gate decides on the spot."""
        return -SQUEEZES_M[0]

    @property
    def lidar_range_m(self) -> float:
        """How far the lidar sees."""
        return self._senses.range_m

    @property
    def moving(self) -> tuple[MovingObstacle, ...]:
        """What moves around the robot, as the newest scan tells."""
        return self._senses.moving

    @property
    def stop_requested(self) -> bool:
        """The paper's ``stop_exploration``."""
        return self._stop.is_raised

    @property
    def distance_m(self) -> float:
        """Driven since the start, metres."""
        return self.scores.score().distance_m

    def now_s(self) -> float:
        """Mission time as the tree is to know it, seconds: while the robot is held it stands still."""
        return self._clock_s() - self._held_s

    def budgets(self) -> tuple[Budget, ...]:
        """What the mission's limits leave to spend."""
        return self._purse.budgets(self.now_s(), self.distance_m)

    def estimate(self) -> Estimate:
        """The newest pose, ``lost`` if the SLAM plugin itself broke down."""
        return self._senses.estimate()

    def trajectory(self) -> Trajectory:
        """The way driven in this mission; what a loaded map brings along is left out."""
        whole = self.slam.trajectory()
        return Trajectory(whole.stamps_s[self._poses_before :], whole.poses[self._poses_before :])

    def view(self) -> MapView:
        """The newest map, completed by the team's, with the places that proved too tight closed."""
        grid = self._tight.mark(self.team_map.grid())
        if self._view is None or self._view.grid is not grid:
            self._view = MapView(grid, self._map_memory)
        return self._view

    def scan(self) -> Scan2D | None:
        """The newest scan, None before the first."""
        return self._senses.scan

    def plan(self, goal: Pose2, via: Sequence[tuple[float, float]] = ()) -> Path:
        """A path from where the robot is now, over the places of ``via`` that can be come to.

        Raises:
            PlanningFailure: the planner's typed no.
            ComponentFailure: the planner broke down.
        """
        straight_m = self.estimate().T_map_base.distance_to(goal)
        try:
            here = self.pilot.predict(self.estimate(), self.now_s()).T_map_base
            around = standing(self.team.mates, here, goal, self.team.right_of_way)
            grids = grids_to_try(self.view().grid, around, here, self.footprint_radius_m)
            grid, path = first_path(
                grids,
                lambda grid: plan_or_squeeze(
                    lambda radius_m: self._way_finder.path(grid, here, goal, via, radius_m),
                    self.footprint_radius_m,
                    straight_m,
                ),
            )
            return centred(path, self._senses.seen_points(self.pilot), grid, self.footprint_radius_m)
        except (PlanningFailure, UserError):
            raise
        except Exception as error:
            failure = ComponentFailure(f"planner {self._planner.name}", repr(error))
            self._faults.note(failure.component, error)
            raise failure from error

    def draw(self, drawing: Drawing) -> None:
        """Show observers what a leaf looked at."""
        self._sketch.add(drawing)

    def avoid(self, position: tuple[float, float]) -> None:
        """Close a place that proved too tight for the safety gate."""
        self._tight.add(position)
        x, y = position
        self.tell("warning", "tight place", f"({x:.2f}, {y:.2f}) is closed: the gate held the robot there")

    def clear_map(self, radius_m: float) -> bool:
        """Have SLAM forget the obstacles around the robot until it sees them again; whether it can."""
        return self.slam.forget_near(self.estimate().T_map_base.xy, radius_m)

    def reopen(self, chances: int) -> int:
        """Open such places again, unless that was done ``chances`` times before; how many."""
        return self._tight.reopen(chances)

    def sense(self) -> None:
        """Take in what the driver measured since the last time."""
        before = self.scan()
        measurements = self._read()
        self._hear_team()
        for measurement in measurements:
            self._take(measurement)
        if (scan := self.scan()) is not None and scan is not before:
            self.pilot.see(*self._senses.look(scan, self.pilot))
            self.team.see(scan, self._senses.scan_pose or self.home)
        self._news.of_health(self.estimate(), self._clock_s())

    def act(self, now_s: float, dt_s: float) -> None:
        """One control period; a controller that breaks down is braked for."""
        self._hear_team()  # those who have acted in this period already
        try:
            self.pilot.step(self.estimate(), self.scan(), now_s, dt_s)
        except Exception as error:  # any plugin's failure ends in a controlled stop, never in a crash
            self._faults.note(f"controller {self._controller.name}", error)
            self.pilot.brake(f"controller {self._controller.name} failed: {error!r}", now_s, dt_s)
        if self.scan() is not None:  # before the first one there is nothing to drive by, nor to drive to
            self._news.of_gate(self.pilot, self._clock_s())
        self._keep_score(now_s, dt_s)
        self._tell_team(now_s, dt_s)

    def hold(self, reason: str, now_s: float, dt_s: float) -> None:
        """One control period at rest, in place of ``act``; the tree's time stands still for as long."""
        self.pilot.pause(reason, now_s, dt_s)
        self._held_s += dt_s
        self._keep_score(now_s, dt_s)
        self._hear_team()
        self._tell_team(now_s, dt_s, is_paused=True)

    def watch_ticks(self, probe: Probe) -> None:
        """Have ``probe`` asked before and after every tick of every node of the tree."""
        self._probe = probe
        attach(self.tree.root, probe)

    def decide(self) -> Status:
        """Tick the tree once."""
        self._sketch.begin_tick()
        try:
            for node in tick(self.tree.root, self._probe):
                self._counts.note(node)
                self._news.of_node(node, self.now_s())
        except Exception as error:  # a leaf is a plugin too: its failure ends the mission, not the process
            reason = str(error) if isinstance(error, PortUnsetError) else repr(error)
            self.blackboard.write(REASON_KEY, f"a leaf failed: {reason}")
            self.tell("error", "tree", reason)
            _log.exception("robot %s: a leaf raised", self.name)
            halt(self.tree.root)
            return Status.FAILURE
        return self.tree.root.status

    def rest(self) -> None:
        """Cut the tree off and come to rest; a resumed run goes on where it stood."""
        self._keeping.rest()
        self.team.sum_up()
        halt(self.tree.root)
        self.pilot.hold()

    def close(self) -> None:
        """Stop the body and let go of it."""
        self.driver.close()
        self.team.close()

    # --- for observers and checkpoints --------------------------------------------------------------

    def memory(self) -> RobotMemory:
        """See ``RobotKeeping.memory``."""
        pose, true_pose = self.slam.estimate().T_map_base, self._origin.in_world(self.scores.true_pose)
        return self._keeping.memory(self.home, pose, true_pose, self._poses_before)

    def _restore(self, cut: Cut) -> None:
        self._keeping.restore(cut.memory)
        for measurement in cut.measured:
            self._take(measurement)
        self._senses.begin()
        self.slam.pick_up()
        if cut.score is not None:
            self.scores.catch_up(cut.score, cut.true_way)

    def snapshot(self) -> RobotSnapshot:
        """What observers are shown after a tick; what was measured and who was ticked is shown once."""
        senses = self._senses
        nodes = self._counts.states()
        self._counts.forget()
        return RobotSnapshot(
            robot=self.name,
            estimate=self.estimate(),
            grid=self.slam.grid(),
            scan=senses.scan,
            scan_pose=senses.scan_pose,
            scan_twist=senses.scan_twist,
            path=self.pilot.path,
            motion=self.pilot.motion,
            gate_reason=self.pilot.gate_reason,
            nodes=nodes,
            blackboard=dict(self.blackboard),
            score=self.scores.score(),
            true_pose=self.scores.true_pose,
            measured=tuple(senses.drain()),
            held_by=self.pilot.held_by,
            drawing=self._sketch.drawing,
            moving=self.moving,
            budgets=self.budgets(),
            charge=self._purse.charge,
            doing=self.team.doing,
            claims=self.team.claims,
            mates=self.team.frames(),
        )

    def tell(self, level: str, source: str, message: str) -> None:
        """Pass an event on to the observers."""
        self._tell(Event(self._clock_s(), self.name, level, source, message))

    # --- inside -------------------------------------------------------------------------------------

    def _clock_s(self) -> float:
        """Mission time as measurements are stamped."""
        return self.driver.clock.now_s()

    def _keep_score(self, now_s: float, dt_s: float) -> None:
        pose = self.pilot.predict(self.estimate(), now_s).T_map_base
        self.scores.control_step(pose, self.pilot.motion, now_s, dt_s)

    def _take(self, measurement: Measurement) -> None:
        if isinstance(measurement, Battery):
            self._purse.take(measurement)
        elif self._senses.take(measurement, self.pilot):
            self._keeping.hear(measurement)

    def _hear_team(self) -> None:
        self.team.receive(self._clock_s())
        self.pilot.mates = self._senses.mates = self.team.near

    def _tell_team(self, now_s: float, dt_s: float, *, is_paused: bool = False) -> None:
        self.team.is_paused = is_paused
        give_word(self.pilot, self.team, now_s)
        about = (self.footprint_radius_m, self._limits.speed_mps, now_s, dt_s)
        self.team.send(now_s, lambda: presence_of(self.pilot, self.estimate(), *about), self.slam.grid())

    def _read(self) -> Sequence[Measurement]:
        try:
            return self.driver.read()
        except Exception as error:  # silence is handled: a stale scan brakes the robot
            self._faults.note(f"driver {self.driver.name}", error)
            return ()
