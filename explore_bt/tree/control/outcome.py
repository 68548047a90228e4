"""Nodes that change what a child's end means, and the one that leaves it as it is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from py_trees.common import Status

from explore_bt.tree.control.base import Decorator, Work

__all__ = ["ForceFailure", "ForceSuccess", "Invert", "Subtree"]


class Subtree(Decorator):
    """Another tree of the mission, over the same blackboard; its status is the tree's."""

    changes: ClassVar[Mapping[Status, Status]] = {}

    def work(self) -> Work:
        """Tick the child and translate its status."""
        status = yield from self.ticked(self.child)
        return self.changes.get(status, status)


class Invert(Subtree):
    """Success for failure and failure for success."""

    changes = {Status.SUCCESS: Status.FAILURE, Status.FAILURE: Status.SUCCESS}  # noqa: RUF012  # declared a ClassVar in the base


class ForceSuccess(Subtree):
    """Success, however the child ends."""

    changes = {Status.FAILURE: Status.SUCCESS}  # noqa: RUF012  # declared a ClassVar in the base


class ForceFailure(Subtree):
    """Failure, however the child ends."""

    changes = {Status.SUCCESS: Status.FAILURE}  # noqa: RUF012  # declared a ClassVar in the base
