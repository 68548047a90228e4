"""What a tree's ticks are worth telling: what leaves say, and why another branch is tried."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from py_trees.behaviour import Behaviour

from explore_bt.mission import BuiltTree
from explore_bt.tree import EntryCondition, Fallback, Leaf, ReactiveFallback, Retry, Status

__all__ = ["News", "TreeNews", "leaves_that_ended"]

_CALM_S = 1.0
_NUMBER = re.compile(r"\d+(?:\.\d+)?")


class News(NamedTuple):
    """A line for the log: level, source and message of an ``Event``."""

    level: str
    source: str
    message: str


class TreeNews:
    """Listens to one robot's tree, node by node as their ticks end.

    Leaves are told (level ``debug``, source: the node's path) when they end, and while they run when they say
    something new; one that only counts says nothing new. What takes over where something failed, or is tried
    again, is a recovery (level ``info``). A failure without words is an answer, not a failure: ``fallback``
    is also how trees ask questions. What is told every tick is told once.
    """

    def __init__(self, tree: BuiltTree) -> None:
        self._paths = {id(node): info.path for node, info in zip(tree.nodes, tree.infos, strict=True)}
        self._told: dict[tuple[str, str], tuple[str, float]] = {}

    def of(self, node: Behaviour, now_s: float) -> Iterator[News]:
        """What there is to tell when a node's tick has ended."""
        path = self._paths[id(node)]
        if isinstance(node, Leaf) and node.feedback_message:
            words = node.feedback_message
            told = f"failed: {words}" if node.status is Status.FAILURE else words
            gist = _NUMBER.sub("#", words) if node.status is Status.RUNNING else told
            if self._is_new((path, "leaf"), gist, now_s):
                yield News("debug", path, told)
        if node.status is Status.FAILURE:
            recovery = _recovery_from(node)
            if recovery and self._is_new((path, "recovery"), recovery, now_s):
                yield News("info", "recovery", recovery)

    def _is_new(self, speaker: tuple[str, str], gist: str, now_s: float) -> bool:
        """Whether the speaker did not say the same within the last second: what goes on is not new."""
        before, before_s = self._told.get(speaker, ("", 0.0))
        self._told[speaker] = (gist, now_s)
        return gist != before or now_s - before_s > _CALM_S


def _recovery_from(failed: Behaviour) -> str:
    """What is done about a failure and why; empty if nothing is, or nothing new, or nobody said a word."""
    parent = failed.parent
    what = ""
    if isinstance(parent, Retry) and parent.tries_left:
        what = f"{failed.name} once more, {parent.tries_left} left"
    elif isinstance(parent, Fallback | ReactiveFallback):
        after = parent.children.index(failed) + 1
        following = parent.children[after] if after < len(parent.children) else None
        if following is not None and following.status is not Status.RUNNING:
            what = following.name
    words = _last_words(failed) if what else ""
    return f"{what}, for {words}" if words else ""


def _last_words(failed: Behaviour) -> str:
    """What those said that made a node fail; empty if nobody did. A condition's no is an answer."""
    ended = leaves_that_ended(failed, Status.FAILURE)
    spoken = (leaf for leaf in ended if leaf.feedback_message and not isinstance(leaf, EntryCondition))
    return "; ".join(dict.fromkeys(f"{leaf.name}: {leaf.feedback_message}" for leaf in spoken))


def leaves_that_ended(node: Behaviour, status: Status) -> Iterator[Behaviour]:
    """The lowest nodes with this status below nodes with this status.

    A failure that was recovered from is left out; a ``timeout`` fails though its child had not ended.
    """
    if node.status is not status:
        return
    below = [leaf for child in node.children for leaf in leaves_that_ended(child, status)]
    yield from below or [node]
