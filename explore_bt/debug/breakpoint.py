"""Where a run is to stop by itself."""

from __future__ import annotations

import enum
from dataclasses import dataclass

__all__ = ["STATUSES", "Breakpoint", "Moment"]

STATUSES = ("success", "failure", "running", "idle")
"""A node's status in words, as in recordings."""


class Moment(enum.StrEnum):
    """Before a node is ticked, or after."""

    BEFORE = "before"
    AFTER = "after"


@dataclass(frozen=True, slots=True)
class Breakpoint:
    """Where to stop.

    Attributes:
        path: of the node; ``*`` stands for anything, slashes too. ``drive_to`` means every node of that
            name, ``explore/drive_to`` every one below an ``explore``.
        moment: before or after the node's tick.
        status: one of ``STATUSES``: as it stands before the tick, or as the tick gave it; empty for any.
        condition: an expression (see ``Expression``) that has to hold; empty for none.
        robot: only this one; ``*`` as in ``path``.
        ignore: how many hits to let pass before the first stop.
        once: gone after the first stop.
        enabled: a disabled one neither stops nor counts.
    """

    path: str
    moment: Moment = Moment.AFTER
    status: str = ""
    condition: str = ""
    robot: str = "*"
    ignore: int = 0
    once: bool = False
    enabled: bool = True

    def __str__(self) -> str:
        parts = [self.path, str(self.moment), self.status.upper()]
        parts += [f"if {self.condition}"] if self.condition else []
        parts += [f"robot {self.robot}"] if self.robot != "*" else []
        return " ".join(filter(None, parts))
