"""A debugger's session with one run: the tree is touched in the tick thread alone."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from typing import Any, TypeVar

from py_trees.behaviour import Behaviour

from explore_bt.debug.breakpoint import Moment
from explore_bt.debug.breakpoints import Breakpoints
from explore_bt.debug.commands import (
    AddBreakpoint,
    Command,
    EnableBreakpoint,
    Evaluate,
    Force,
    Look,
    Pause,
    Quit,
    Release,
    RemoveBreakpoint,
    Resume,
    SetParam,
    Step,
    StepKind,
    View,
)
from explore_bt.debug.expression import Expression
from explore_bt.debug.forced_answers import ForcedAnswers
from explore_bt.debug.held import HeldRobots
from explore_bt.debug.herald import Listener
from explore_bt.debug.params import Params
from explore_bt.debug.places import Place, Places
from explore_bt.debug.queue import CommandQueue
from explore_bt.debug.sight import Sight
from explore_bt.debug.state import DebugState
from explore_bt.debug.stride import Stride
from explore_bt.errors import DebugError
from explore_bt.interfaces import Event, NodeState
from explore_bt.runtime import Attendant, Robot, Runner
from explore_bt.tree import Probe, Status, status_word

__all__ = ["DebugSession"]

T = TypeVar("T")

_COMMANDS_A_TICK = 64
"""So many are answered while the run goes on; a flood waits its turn, not the robots."""
_LOOK_UP_S = 0.1
"""How often a paused session looks whether somebody has raised the stop flag."""
_OVER = "the run is over"


class DebugSession(Attendant):
    """Pauses, steps, breaks, forces; thread-safe from outside by ``submit``, ``state`` and ``subscribe``.

    Give it to ``run_mission`` as its attendant. While nothing is to be watched it costs two calls a node.
    A run that is stopped by its stop flag is let go at once, whatever the debugger was about.

    Args:
        params: reads the mission again for ``SetParam``; without it no parameter can be changed.
        paused: whether to stand still before the first tick.

    Attributes:
        is_alert: whether nodes are looked at one by one.
    """

    def __init__(self, params: Params | None = None, *, paused: bool = False) -> None:
        self._params = params or Params()
        self._queue = CommandQueue()
        self._listeners: dict[Listener[DebugState], None] = {}
        self._listeners_lock = threading.Lock()
        self._stride = Stride()
        self._held = HeldRobots()
        self._pausing = "before the first tick" if paused else ""
        self._state = DebugState(params=self._params.states)
        self._runner: Runner | None = None
        self.is_alert = False

    # --- for clients, from any thread -------------------------------------------------------------------

    def submit(self, command: Command[T]) -> Future[T]:
        """Have a command done in the tick thread; its future gives the answer, or a ``DebugError``."""
        return self._queue.submit(command)

    def state(self) -> DebugState:
        """The debugger as it is now."""
        runner = self._runner
        if runner is None:
            return self._state
        return replace(self._state, tick=runner.tick, stamp_s=runner.now_s)

    def subscribe(self, callback: Callable[[DebugState], None]) -> Callable[[], None]:
        """Have ``callback`` told of changes, in a thread of its own; returns what ends that.

        It is told the present state first. While it is busy only the newest state is kept for it. Ticks
        that pass are no change.
        """
        listener = Listener(callback)
        with self._listeners_lock:
            self._listeners[listener] = None
            listener.tell(self._state)

        def unsubscribe() -> None:
            with self._listeners_lock:
                self._listeners.pop(listener, None)
            listener.close()

        return unsubscribe

    # --- for the runner, in the tick thread -------------------------------------------------------------

    def begin(self, runner: Runner) -> None:
        """Stand beside every node of every tree."""
        self._places = Places(runner.robots)
        self._breakpoints = Breakpoints(self._places, lambda: (runner.tick, runner.now_s))
        self._forced = ForcedAnswers(self._places, self._warn)
        self._runner = runner
        for robot in runner.robots:
            robot.watch_ticks(_Beside(self))
        self._show(why="running", is_simulated=runner.stands_with_time)

    def on_period(self) -> None:
        """Answer what was asked meanwhile."""
        self._look_up()
        if self._breakpoints.have_news:
            self._show()
        for _ in range(_COMMANDS_A_TICK):
            if not self._queue.serve(self._do):
                break

    def before_tick(self) -> None:
        """Pause here if that was asked for."""
        if why := self._stride.next_tick():
            self._pausing = why
        if self._pausing:
            self._stand_still(self._pausing)
        runner = self._attended()
        self._held.before_tick(runner.paused, self._stride.who_stands(self._places.robots))

    def end(self) -> None:
        """Let everybody know."""
        runner = self._runner
        why = f"{runner.outcome}: {runner.reason}" if runner else "it never began"
        self._show(paused=False, over=True, why=why, robot="", path="", moment="", status="")
        self._queue.close(_OVER)
        with self._listeners_lock:
            listeners, self._listeners = list(self._listeners), {}
        for listener in listeners:
            listener.close()

    def before(self, node: Behaviour) -> Status | None:
        """Before a node is ticked: stop at a breakpoint, then answer in its place if that is wanted."""
        if why := self._breakpoints.hit(node, Moment.BEFORE):
            self._stand_still(why, self._places.of(node), Moment.BEFORE)
        return self._forced.answer(self._places.of(node)) if self._forced else None

    def after(self, node: Behaviour) -> None:
        """After a node's tick: stop where a step ends, or at a breakpoint."""
        why = self._stride.next_node(self._places.of(node)) if self._stride.watches_nodes else ""
        why = self._breakpoints.hit(node, Moment.AFTER) or why
        if why:
            self._stand_still(why, self._places.of(node), Moment.AFTER)

    # --- standing still ---------------------------------------------------------------------------------

    def _stand_still(self, why: str, place: Place | None = None, moment: Moment | None = None) -> None:
        runner = self._attended()
        self._stride.end()
        if self._is_to_stop():
            self._pausing = ""
            return
        self._pausing = why
        self._show(
            paused=True,
            why=why,
            robot=place.robot.name if place else "",
            path=place.info.path if place else "",
            moment=str(moment) if moment else "",
            status=place.status if place else "",
        )
        begun_s = runner.now_s
        if not runner.stands_with_time:
            self._note(f"the robots are held: {why}")
        while self._pausing and not self._is_to_stop():
            self._answer_while_paused(_LOOK_UP_S if runner.stands_with_time else 0.0)
            if self._pausing and not runner.stands_with_time:
                runner.hold(f"held by the debugger: {why}")
        if self._pausing:
            self._go_on(Stride())
        if not runner.stands_with_time:
            self._note(f"the robots go on after {runner.now_s - begun_s:.1f} s")

    def _is_to_stop(self) -> bool:
        return self._attended().stop.is_raised

    def _answer_while_paused(self, patience_s: float) -> None:
        """What waits behind a step is meant for the place it leads to."""
        for _ in range(_COMMANDS_A_TICK):
            if not self._pausing or not self._queue.serve(self._do, patience_s):
                break

    def _attended(self) -> Runner:
        assert self._runner is not None  # commands are only done, and nodes only ticked, in a run
        return self._runner

    def _show(self, **changes: Any) -> None:
        """Publish the state with these changes."""
        runner = self._runner
        if runner is not None:
            self._look_up()
            changes |= {
                "breakpoints": self._breakpoints.states(),
                "forced": self._forced.states,
                "held": self._held.names,
                "params": self._params.states,
                "tick": runner.tick,
                "stamp_s": runner.now_s,
            }
        with self._listeners_lock:
            self._state = replace(self._state, **changes)
            for listener in self._listeners:
                listener.tell(self._state)

    def _look_up(self) -> None:
        """See anew whether nodes are to be looked at one by one."""
        self.is_alert = bool(self._stride.watches_nodes or self._breakpoints or self._forced)

    def _note(self, message: str, robot: str = "", level: str = "info") -> None:
        runner = self._attended()
        runner.tell(Event(runner.now_s, robot, level, "debugger", message))

    def _warn(self, message: str, robot: str = "") -> None:
        """Note what makes this run another one than the mission's."""
        self._note(message, robot, "warning")

    # --- commands ---------------------------------------------------------------------------------------

    def _do(self, command: Command[Any]) -> object:
        answer = self._answer(command)
        if not isinstance(command, Look | Evaluate):
            self._show()
        return answer

    def _answer(self, command: Command[Any]) -> object:
        match command:
            case Pause(robot=robot) if robot and len(self._places.robots) > 1:
                self._hold(self._places.robot(robot).name)
            case Pause():
                self._pause()
            case Resume(robot=robot) if robot and len(self._places.robots) > 1:
                self._let_go(self._places.robot(robot).name)
            case Resume():
                self._go_on(Stride())
            case Step():
                self._step(command)
            case Quit():
                self._attended().stop.raise_flag("stopped by hand (debugger)")
            case AddBreakpoint():
                return self._breakpoints.add(command.breakpoint)
            case RemoveBreakpoint():
                self._breakpoints.remove(command.number)
            case EnableBreakpoint():
                self._breakpoints.enable(command.number, command.enabled)
            case Force():
                return self._forced.force(command.path, command.robot, command.status, once=command.once)
            case Release():
                return self._forced.release(command.path, command.robot)
            case SetParam():
                return self._set_param(command)
            case Evaluate():
                return self._evaluate(command)
            case Look():
                return self._look(command)
            case _:
                raise DebugError(f"{type(command).__name__} is not a command of the debugger")
        return None

    def _pause(self) -> None:
        if not self._state.paused:
            self._pausing = "paused by hand"
            self._show(why="pausing before the next tick")

    def _hold(self, robot: str) -> None:
        self._held.hold(robot)
        self._note("stands, and the others go on", robot)

    def _let_go(self, robot: str) -> None:
        if robot not in self._held:
            raise DebugError(f"robot {robot} is not paused alone")
        self._held.let_go(robot)
        self._note("goes on", robot)

    def _step(self, step: Step) -> None:
        stride = Stride.of(step, self._places)
        is_alone, goes_on = step.robot in self._held, not self._state.paused
        if is_alone and goes_on and step.kind is not StepKind.TICK:
            raise DebugError(
                "in the middle of a tick all robots stand: pause the run first, or step by ticks"
            )
        if is_alone and step.kind is StepKind.TICK:
            self._held.step(step.robot, step.count)
        if not (is_alone and goes_on):
            self._go_on(stride.after(self._stride))

    def _go_on(self, stride: Stride) -> None:
        self._stride, self._pausing = stride, ""
        # shown before the command is answered: who then sees a pause sees the next one
        self._show(paused=False, why=stride.why, robot="", path="", moment="", status="")

    def _set_param(self, command: SetParam) -> str:
        if not self._state.paused:
            raise DebugError("a parameter can be changed while the run is paused; pause first")
        changed = self._params.change(command.name, command.text, self._places)
        self._warn(changed)
        return changed

    def _evaluate(self, command: Evaluate) -> object:
        runner, robot = self._attended(), self._robot(command.robot)
        state = self._state
        place = None
        if state.path and state.robot == robot.name:
            (place,) = (p for p in self._places if p.robot is robot and p.info.path == state.path)
        expression = Expression(command.expression)
        expression.check(robot)
        return expression.value(Sight(robot, runner.tick, runner.now_s, place))

    def _look(self, command: Look) -> View:
        robot = self._robot(command.robot)
        nodes = tuple(NodeState(status_word(node.status), node.feedback_message) for node in robot.tree.nodes)
        return View(robot.name, nodes, dict(robot.blackboard))

    def _robot(self, name: str) -> Robot:
        return self._places.robot(name or self._state.robot or next(iter(self._places.robots)))


class _Beside(Probe):
    """Asks the session only while it is alert."""

    def __init__(self, session: DebugSession) -> None:
        self._session = session

    def before(self, node: Behaviour) -> Status | None:
        return self._session.before(node) if self._session.is_alert else None

    def after(self, node: Behaviour) -> Status | None:
        if self._session.is_alert:
            self._session.after(node)
        return None
