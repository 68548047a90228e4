"""Standing beside every node while it is ticked: what debuggers, breakpoints and forced answers build on."""

from __future__ import annotations

from abc import ABC, abstractmethod

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.tree.control.base import ControlNode, Work, ticked

__all__ = ["Probe", "attach", "detach", "tick"]


class Probe(ABC):
    """Asked before and after every tick of every node, in the thread that ticks the tree.

    It may take its time: mission time stands still inside a tick.
    """

    @abstractmethod
    def before(self, node: Behaviour) -> Status | None:
        """None lets the node be ticked; ``SUCCESS`` or ``FAILURE`` is the answer in its place.

        A running node that is answered for is cut off.
        """

    @abstractmethod
    def after(self, node: Behaviour) -> Status | None:
        """None lets ``node.status`` stand; ``SUCCESS`` or ``FAILURE`` takes its place."""


def attach(root: Behaviour, probe: Probe) -> None:
    """Have ``probe`` asked at every node of the tree, from its next tick on, in place of any other."""
    _set(root, probe)


def detach(root: Behaviour) -> None:
    """Have nobody asked any more."""
    _set(root, None)


def tick(root: Behaviour, probe: Probe | None = None) -> Work:
    """One tick of a whole tree: yields every node as its tick ends, returns the root's status.

    Args:
        root: of the tree.
        probe: asked for the root itself; ``attach`` has it asked for the nodes below.
    """
    return (yield from ticked(root, probe))


def _set(root: Behaviour, probe: Probe | None) -> None:
    for node in root.iterate():
        if isinstance(node, ControlNode):
            node.probe = probe
