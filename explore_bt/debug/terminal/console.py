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
    Step,
    View,
)
from explore_bt.debug.history import History
from explore_bt.debug.session import DebugSession
from explore_bt.debug.terminal.focus import Focus
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
        self._focus = Focus(history)
        self._reader = reader
        self._screen = screen
        self._news = threading.Event()
        self._last = ""
        self._has_left = False
        self._interrupts = 0
        self._do: Mapping[str, Callable[[str], None]] = {
            "step": lambda rest: self._go(step_of(rest)),
            "continue": self._continue,
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
                try:
                    self._read_and_do()
                except Terminated:
                    raise
                except KeyboardInterrupt:  # whatever was being done or typed
                    self._interrupted()
                    if not self._session.state().paused:  # the run had just been let go
                        self._wait()
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

    # --- the run -----------------------------------------------------------------------------------------

    def _go(self, command: Command[None]) -> None:
        self._focus.return_to_present()
        before = self._session.state()
        if before.over:
            raise DebugError("the run is over; tree, print, where, map and back still show it")
        self._ask(command)
        if isinstance(command, Step) and command.robot in before.held and not before.paused:
            return  # the others have gone on all the time
        if isinstance(command, Resume) and self._reader.is_interactive:
            self._say("running; Ctrl-C pauses, other commands are heard meanwhile")
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
                    if (state := self._session.state()).paused or state.over:
                        return  # what was done has told so
            except Terminated:
                raise
            except KeyboardInterrupt:
                self._interrupted()
        self._interrupts = 0
        if self._session.state().over and not self._focus.has_begun:
            self._has_left = True  # it never began; the command tells why
        elif not self._has_left:
            self._say(*state_lines(self._session.state(), len(self._focus.robots)))

    def _interrupted(self) -> None:
        """Ctrl-C: pause; the second one in a row stops the robots."""
        self._interrupts += 1
        state = self._session.state()
        if self._interrupts > 1 or state.over:
            self._quit("")
            return
        if not state.paused:
            self._session.submit(Pause())
        what = "" if state.paused else "pausing; "
        self._say("", f"{what}Ctrl-C once more stops the robots and saves the results")

    def _continue(self, rest: str) -> None:
        if rest:
            self._ask(Resume(rest))
            self._say(f"{rest} goes on")
        else:
            self._go(Resume())

    def _pause(self, rest: str) -> None:
        state = self._session.state()
        if rest and len(self._focus.robots) > 1 and not state.over:
            self._ask(Pause(rest))
            self._say(f"{rest} stands; the others go on. continue {rest} lets it go on")
        elif state.paused or state.over:
            self._say(*state_lines(state, len(self._focus.robots)))
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
        number = 0 if rest == "all" else number_of(rest, "a breakpoint")
        if not number and rest != "all":
            raise DebugError("breakpoints are numbered from 1; breaks lists them")
        self._ask(RemoveBreakpoint(number))
        self._say(f"breakpoint {number} is deleted" if number else "all breakpoints are deleted")

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
        board = self._view().blackboard
        entry = rest.removeprefix("$")
        if not rest:
            self._say(*board_lines(board))
        elif entry.isidentifier() and entry in board:
            self._say(value_text(board[entry]))
        elif not self._focus.is_present:
            raise DebugError("an expression has a value only now; look at entries here, or say now")
        else:
            self._say(value_text(self._ask(Evaluate(rest, self._focus.chosen))))

    def _tree(self, rest: str) -> None:
        pattern = next(iter(words_of(rest)), "")
        infos = self._focus.infos(self._robot())
        lines = list(tree_lines(infos, self._view().nodes, pattern, self._paused_at()))
        if not lines:
            hint = did_you_mean(pattern, {info.name for info in infos}, "nodes")
            raise DebugError(f'no node is called "{pattern}"; {hint}')
        self._say(*lines)

    def _where(self, _: str) -> None:
        tick, robot = self._focus.tick(), self._robot()
        infos, nodes = self._focus.infos(robot), self._view().nodes
        self._say(*where_lines(tick, self._focus.snapshot(robot), infos, nodes, self._paused_at()))

    def _map(self, _: str) -> None:
        robot = self._robot()
        self._say(*map_lines(self._focus.snapshot(robot), self._focus.trail(robot), self._screen.width))

    def _log(self, rest: str) -> None:
        for event in self._history.events(number_of(rest, "a number of events") if rest else 10):
            robot = f"{event.robot} " if len(self._focus.robots) > 1 else ""
            self._say(f"{event.stamp_s:8.2f} s  {robot}{event.source}: {event.message}")

    def _travel(self, rest: str, direction: int) -> None:
        ago_s = self._focus.travel(span_of(rest), direction)
        is_present = self._focus.is_present
        self._say(
            "this is the present" if is_present else f"looking back {ago_s:.1f} s; now leads to the present"
        )
        self._where("")

    def _now(self, _: str) -> None:
        self._focus.return_to_present()
        self._say(*state_lines(self._session.state(), len(self._focus.robots)))

    def _choose_robot(self, rest: str) -> None:
        if rest:
            self._focus.choose(rest)
        for name in self._focus.robots:
            self._say(f"{'> ' if name == self._robot() else '  '}{name}")

    def _robot(self) -> str:
        return self._focus.robot(self._session.state().robot)

    def _paused_at(self) -> str:
        """Path of the node the run is paused at, if that is what is looked at."""
        state = self._session.state()
        return state.path if self._focus.is_present and state.robot == self._robot() else ""

    def _view(self) -> View:
        """Tree and blackboard: as they were, or as they are in the middle of a tick."""
        if self._focus.is_present and not self._session.state().over:
            return self._ask(Look(self._robot()))
        return self._focus.view(self._robot())

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
