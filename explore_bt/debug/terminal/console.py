"""Reads commands, has them done, shows where the run stands."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import TypeVar

from rich.console import Console as Screen
from rich.text import Text

from explore_bt.debug.commands import (
    AddBreakpoint,
    Command,
    EnableBreakpoint,
    Evaluate,
    Look,
    Pause,
    Quit,
    Release,
    RemoveBreakpoint,
    Resume,
    SetParam,
    View,
)
from explore_bt.debug.history import History
from explore_bt.debug.session import DebugSession
from explore_bt.debug.terminal.parsing import (
    breakpoint_of,
    force_of,
    number_of,
    span_of,
    step_of,
    words_of,
)
from explore_bt.debug.terminal.reader import LineReader
from explore_bt.debug.terminal.verbs import find_verb, help_lines
from explore_bt.debug.terminal.views import (
    board_lines,
    map_lines,
    state_lines,
    tree_lines,
    value_text,
    where_lines,
)
from explore_bt.errors import DebugError
from explore_bt.interfaces import NodeInfo, RobotSnapshot, RunInfo, TickSnapshot
from explore_bt.mission.words import did_you_mean

__all__ = ["Console", "Terminated"]

T = TypeVar("T")

PROMPT = "debug> "
_ANSWER_S = 30.0
_LOOK_S = 0.1


class Terminated(KeyboardInterrupt):
    """Raised in the main thread by whoever ends the program from outside."""


class Console:
    """The debugger's command line; the mission runs in another thread.

    Args:
        session: that the run is attended by.
        history: that the run is watched by.
        reader: where commands come from.
        screen: where answers go.
    """

    def __init__(self, session: DebugSession, history: History, reader: LineReader, screen: Screen) -> None:
        self._session = session
        self._history = history
        self._reader = reader
        self._screen = screen
        self._news = threading.Event()
        self._last = ""
        self._robot = ""
        self._past: int | None = None
        self._has_left = False
        self._interrupts = 0
        self._do: Mapping[str, Callable[[str], None]] = {
            "step": lambda rest: self._go(step_of(rest)),
            "continue": lambda _: self._go(Resume()),
            "pause": self._pause,
            "break": self._break,
            "breaks": self._breaks,
            "delete": self._delete,
            "enable": lambda rest: self._enable(rest, enabled=True),
            "disable": lambda rest: self._enable(rest, enabled=False),
            "force": self._force,
            "release": self._release,
            "print": self._print,
            "tree": self._tree,
            "where": self._where,
            "map": self._map,
            "log": self._log,
            "back": lambda rest: self._travel(rest, -1),
            "forward": lambda rest: self._travel(rest, +1),
            "now": self._now,
            "param": self._param,
            "robot": self._choose_robot,
            "help": lambda rest: self._say(*help_lines(rest.strip())),
            "quit": self._quit,
        }

    def run(self) -> None:
        """Until the person leaves; the run is then over, or stopping."""
        unsubscribe = self._session.subscribe(lambda _: self._news.set())
        try:
            self._wait()
            while not self._has_left:
                self._read_and_do()
        except Terminated:
            pass
        finally:
            unsubscribe()

    # --- reading ---------------------------------------------------------------------------------------

    def _read_and_do(self) -> None:
        try:
            line = self._reader.read(PROMPT)
        except EOFError:
            self._quit("")
            return
        except Terminated:
            raise
        except KeyboardInterrupt:
            self._interrupted_at_prompt()
            return
        self._interrupts = 0
        self.do(line)

    def do(self, line: str) -> None:
        """Do what a line says; an empty one says the last one again."""
        line = line.strip() or self._last
        if not line or line.startswith("#"):
            return
        self._last = line
        word, _, rest = line.partition(" ")
        if word == "n":
            word, rest = "step", f"{rest} node"
        try:
            self._do[find_verb(word).name](rest.strip())
        except DebugError as refusal:
            self._say(Text(str(refusal), "yellow"))

    def _interrupted_at_prompt(self) -> None:
        self._interrupts += 1
        if self._interrupts > 1 or self._session.state().over:
            self._quit("")
        else:
            self._say("", "Ctrl-C once more, or quit, stops the robots and saves the results")

    # --- the run -----------------------------------------------------------------------------------------

    def _go(self, command: Command[None]) -> None:
        self._past = None
        if self._session.state().over:
            raise DebugError("the run is over; tree, print, where, map and back still show it")
        self._ask(command)
        self._wait()

    def _wait(self) -> None:
        """Until the run stands still; what is typed meanwhile is done."""
        self._interrupts = 0
        while not self._has_left:
            self._news.clear()
            state = self._session.state()
            if state.paused or state.over:
                break
            try:
                self._news.wait(_LOOK_S)
                if (line := self._reader.typed_meanwhile()) is not None:
                    self.do(line)
                    return
            except Terminated:
                raise
            except KeyboardInterrupt:
                self._interrupt()
        if not self._has_left:
            self._say(*state_lines(self._session.state(), len(self._robots())))

    def _interrupt(self) -> None:
        self._interrupts += 1
        if self._interrupts > 1:
            self._quit("")
        else:
            self._say("", "pausing; Ctrl-C once more stops the robots and saves the results")
            self._session.submit(Pause())

    def _pause(self, _: str) -> None:
        state = self._session.state()
        if state.paused or state.over:
            self._say(*state_lines(state, len(self._robots())))
        else:
            self._ask(Pause())
            self._wait()

    def _quit(self, _: str) -> None:
        self._has_left = True
        if not self._session.state().over:
            self._say("stopping: the robots brake, then the results are saved")
            self._session.submit(Quit())

    # --- breakpoints, forced nodes, parameters -------------------------------------------------------------

    def _break(self, rest: str) -> None:
        wanted = breakpoint_of(rest)
        number = self._ask(AddBreakpoint(wanted))
        found = next(each for each in self._session.state().breakpoints if each.number == number)
        self._say(f"breakpoint {number}: {wanted}  at {_counted(found.nodes, 'node')}")

    def _breaks(self, _: str) -> None:
        state = self._session.state()
        for each in state.breakpoints:
            off = "" if each.breakpoint.enabled else "  (disabled)"
            ignore = f", ignores {each.breakpoint.ignore}" if each.breakpoint.ignore else ""
            once = ", once" if each.breakpoint.once else ""
            hits = f"{_counted(each.nodes, 'node')}, {_counted(each.hits, 'hit')}{ignore}{once}"
            self._say(f"{each.number:>3}  {each.breakpoint}  {hits}{off}")
            if each.fault:
                self._say(Text(f"     its condition does not hold: {each.fault}", "yellow"))
        for forced in state.forced:
            until = "once" if forced.once else f"until released, {_counted(forced.answers, 'answer')}"
            self._say(f"forced to {forced.status.upper()} {until}: {forced.robot} {forced.path}")
        if not state.breakpoints and not state.forced:
            self._say("no breakpoints, no forced nodes")

    def _delete(self, rest: str) -> None:
        if not rest:
            raise DebugError("delete which? For example: delete 1, or delete all")
        self._ask(RemoveBreakpoint(0 if rest == "all" else number_of(rest, "a breakpoint") or -1))
        self._say("all breakpoints are deleted" if rest == "all" else f"breakpoint {rest} is deleted")

    def _enable(self, rest: str, *, enabled: bool) -> None:
        self._ask(EnableBreakpoint(number_of(rest, "a breakpoint"), enabled))
        self._say(f"breakpoint {rest} is {'enabled' if enabled else 'disabled'}")

    def _force(self, rest: str) -> None:
        wanted = force_of(rest)
        count = self._ask(wanted)
        until = "the first of them to be ticked, once" if wanted.once else "until released"
        self._say(f"{_counted(count, 'node')} forced to {wanted.status.upper()}, {until}")

    def _release(self, rest: str) -> None:
        words = words_of(rest)
        count = self._ask(Release(words[0] if words else "*"))
        self._say(f"{_counted(count, 'node')} released")

    def _param(self, rest: str) -> None:
        if not rest:
            params = self._session.state().params
            for param in params:
                self._say(f"{param.name} = {param.value}  ({param.type}) {param.doc}".rstrip())
            if not params:
                self._say("the mission has no parameters")
            return
        name, equals, text = rest.partition("=")
        if not equals or not name.strip():
            raise DebugError("write param NAME=VALUE, for example: param stride=1.2 m")
        self._say(self._ask(SetParam(name.strip(), text.strip())))

    # --- looking -----------------------------------------------------------------------------------------

    def _print(self, rest: str) -> None:
        if not rest:
            self._say(*board_lines(self._view().blackboard))
        elif rest.isidentifier() and rest in self._view().blackboard:
            self._say(value_text(self._view().blackboard[rest]))
        elif rest.startswith("$") and rest[1:].isidentifier() and rest[1:] in self._view().blackboard:
            self._say(value_text(self._view().blackboard[rest[1:]]))
        elif self._past is not None:
            raise DebugError("an expression has a value only now; look at entries here, or say now")
        else:
            self._say(value_text(self._ask(Evaluate(rest, self._robot))))

    def _tree(self, rest: str) -> None:
        words = words_of(rest)
        state = self._session.state()
        here = state.path if self._past is None and state.robot in ("", self._view().robot) else ""
        self._say(*tree_lines(self._infos(), self._view().nodes, words[0] if words else "", here))

    def _where(self, _: str) -> None:
        tick, robot = self._snapshot()
        self._say(*where_lines(tick, robot, self._infos(), self._view().nodes))

    def _map(self, _: str) -> None:
        tick, robot = self._snapshot()
        trail = self._history.trail(robot.robot, tick.index)
        self._say(*map_lines(robot, trail, self._screen.width))

    def _log(self, rest: str) -> None:
        for event in self._history.events(number_of(rest, "a number of events") if rest else 10):
            robot = f"{event.robot} " if len(self._robots()) > 1 else ""
            self._say(f"{event.stamp_s:8.2f} s  {robot}{event.source}: {event.message}")

    def _travel(self, rest: str, direction: int) -> None:
        span = span_of(rest)
        tick, _ = self._snapshot()
        if span.seconds:
            found = self._history.at_time(tick.stamp_s + direction * span.seconds)
        else:
            found = self._history.at(tick.index + direction * span.ticks)
        assert found is not None  # the snapshot is one of them
        newest, _ = self._newest()
        self._past = None if found.index >= newest.index else found.index
        if self._past is None:
            self._say("this is the present")
        else:
            ago_s = newest.stamp_s - found.stamp_s
            self._say(f"looking back {ago_s:.1f} s; now leads to the present")
        self._where("")

    def _now(self, _: str) -> None:
        self._past = None
        self._say(*state_lines(self._session.state(), len(self._robots())))

    def _choose_robot(self, rest: str) -> None:
        names = self._robots()
        if rest and rest not in names:
            raise DebugError(f'there is no robot "{rest}"; {did_you_mean(rest, names, "robots")}')
        self._robot = rest or self._robot
        for name in names:
            self._say(f"{'> ' if name == self._shown_robot() else '  '}{name}")

    def _robots(self) -> tuple[str, ...]:
        return tuple(self._history.run.trees) if self._history.run else ()

    def _shown_robot(self) -> str:
        return self._robot or self._session.state().robot or next(iter(self._robots()), "")

    def _infos(self) -> tuple[NodeInfo, ...]:
        return self._run_info().trees[self._shown_robot()]

    def _run_info(self) -> RunInfo:
        if self._history.run is None:
            raise DebugError("the run has not begun yet")
        return self._history.run

    def _newest(self) -> tuple[TickSnapshot, RobotSnapshot]:
        return self._of_robot(self._history.at(10**12))

    def _snapshot(self) -> tuple[TickSnapshot, RobotSnapshot]:
        """The tick that is looked at: an earlier one, or the last that was shown to observers."""
        return self._newest() if self._past is None else self._of_robot(self._history.at(self._past))

    def _of_robot(self, tick: TickSnapshot | None) -> tuple[TickSnapshot, RobotSnapshot]:
        if tick is None:
            raise DebugError("no tick has passed yet; step makes one")
        name = self._shown_robot()
        return tick, next(robot for robot in tick.robots if robot.robot == name)

    def _view(self) -> View:
        """Tree and blackboard: as they were, or as they are in the middle of a tick."""
        if self._past is None and not self._session.state().over:
            return self._ask(Look(self._shown_robot()))
        _, robot = self._snapshot()
        return View(robot.robot, robot.nodes, robot.blackboard)

    # --- talking to the session and the person -----------------------------------------------------------

    def _ask(self, command: Command[T]) -> T:
        future: Future[T] = self._session.submit(command)
        try:
            return future.result(_ANSWER_S)
        except TimeoutError:
            future.cancel()
            raise DebugError(f"no answer for {_ANSWER_S:.0f} s: the run is busy; ask again") from None

    def _say(self, *lines: Text | str) -> None:
        for line in lines:
            self._screen.print(line, highlight=False, markup=False, soft_wrap=True)


def _counted(number: int, noun: str) -> str:
    return f"1 {noun}" if number == 1 else f"{number} {noun}s"
