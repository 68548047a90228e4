"""The words that the terminal understands, and its help."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from explore_bt.debug.breakpoint import STATUSES
from explore_bt.debug.sight import NAMES
from explore_bt.errors import DebugError
from explore_bt.mission.words import did_you_mean

__all__ = ["VERBS", "Verb", "find_verb", "help_lines"]


@dataclass(frozen=True, slots=True)
class Verb:
    """One word: how it is written, how it may be shortened, what it does, and more for ``help WORD``."""

    name: str
    usage: str
    does: str
    short: str = ""
    more: tuple[str, ...] = ()


VERBS = (
    Verb(
        "step",
        "[N] [tick|node|change] [robot NAME]",
        "go on a tick, to after the next node, or to the next change of a status",
        "s",
        (
            "step            one tick",
            "step 5 node     five nodes",
            "n 5             the same",
            "step robot ada  one tick of ada: the others stand, or go on if ada alone was paused",
        ),
    ),
    Verb(
        "continue", "[NAME]", "go on to the next breakpoint, or to the end; or one robot that was paused", "c"
    ),
    Verb(
        "pause", "[NAME]", "stand still before the next tick, as Ctrl-C; or one robot, while the others go on"
    ),
    Verb(
        "break",
        "PATH [before|after] [STATUS] [ignore N] [once] [robot NAME] [if EXPRESSION]",
        "stop at a node",
        "b",
        (
            "break drive_to failure             when a drive_to fails",
            "break find_* before                before any leaf whose name begins so is ticked",
            'break "go there*" running if $goal.expected_gain_m2 < 1 and time > 60',
            f"STATUS is {', '.join(STATUSES)}; * in a path stands for anything; quote a path with spaces",
            "an expression has numbers, 'text', $entries of the blackboard with .field and [index],",
            "+ - * / // %, comparisons, in, and, or, not, .size, and these names:",
            *(f"  {name:<10} {meaning}" for name, meaning in NAMES.items()),
        ),
    ),
    Verb("breaks", "", "list breakpoints and forced nodes"),
    Verb("delete", "N|all", "forget a breakpoint", "d"),
    Verb("enable", "N", "let a breakpoint stop the run again"),
    Verb("disable", "N", "let a breakpoint stop nothing for a while"),
    Verb(
        "force",
        "PATH success|failure [once] [robot NAME]",
        "answer in a node's place, without ticking it",
        "f",
        (
            "force drive_to failure once    the next drive_to fails, whichever comes first",
            "force budget_left failure      until: release budget_left",
        ),
    ),
    Verb("release", "[PATH]", "let forced nodes be ticked again"),
    Verb(
        "print",
        "[ENTRY|EXPRESSION]",
        "show a value; alone, the whole blackboard",
        "p",
        ("print goal", "print $goal.pose.x - x", "print coverage"),
    ),
    Verb("tree", "[PATH]", "the tree with statuses and reasons", "t"),
    Verb("where", "", "tick, time, pose, the active branch and its lines in the mission", "w"),
    Verb("map", "", "the map with the way driven", "m"),
    Verb("log", "[N]", "the newest events"),
    Verb(
        "back",
        "[N|N s]",
        "look at an earlier tick: tree, print, where and map show it as it was",
        more=("back            one tick", "back 20         twenty ticks", "back 30 s       half a minute"),
    ),
    Verb("forward", "[N|N s]", "look at a later tick"),
    Verb("now", "", "look at the present again"),
    Verb("param", "[NAME=VALUE]", "list the parameters, or change one as --set does"),
    Verb("robot", "[NAME]", "list the robots, or look at another one"),
    Verb("help", "[WORD]", "this list, or more about one word", "h"),
    Verb("quit", "", "stop the robots safely, save the results, leave", "q"),
)
_SHORT = {verb.short: verb.name for verb in VERBS if verb.short}
_BY_NAME = {verb.name: verb for verb in VERBS}


def find_verb(word: str) -> Verb:
    """The verb that is meant: its name, its letter, or a beginning that no other has.

    Raises:
        DebugError: none, or several.
    """
    name = _SHORT.get(word, word)
    if name in _BY_NAME:
        return _BY_NAME[name]
    begun = [verb for verb in VERBS if verb.name.startswith(word)]
    if len(begun) == 1:
        return begun[0]
    if begun:
        raise DebugError(f'"{word}" may be {" or ".join(verb.name for verb in begun)}')
    raise DebugError(f'there is no command "{word}"; {did_you_mean(word, _BY_NAME, "commands")}')


def help_lines(word: str = "") -> Iterator[str]:
    """All verbs, or one with its examples."""
    if word:
        verb = find_verb(word)
        yield f"{verb.name} {verb.usage}".rstrip()
        yield f"  {verb.does}"
        yield from (f"  {line}" for line in verb.more)
        return
    for verb in VERBS:
        usage = f"{verb.name} {verb.usage}".rstrip()
        short = f"{verb.short:<2}" if verb.short else "  "
        first = f"  {short} {usage}"
        yield f"{first:<38} {verb.does}" if len(first) <= 38 else first
        if len(first) > 38:
            yield f"{'':<38} {verb.does}"
    yield "an empty line repeats the last command"
