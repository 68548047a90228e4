"""A node's status in words."""

from __future__ import annotations

from py_trees.common import Status

__all__ = ["status_word"]


def status_word(status: Status) -> str:
    """``success``, ``failure``, ``running`` or ``idle``."""
    return "idle" if status is Status.INVALID else str(status.value).lower()
