"""What an explorer decided."""

from __future__ import annotations

from dataclasses import dataclass

from explore_bt.types import Path, Pose2

__all__ = ["Decision"]


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """Where to go next, or that the exploration is over.

    Attributes:
        goal: where the robot is sent, ``map`` frame; None once done.
        path: the way there from the pose that was given; a path of one pose is a turn in place.
        done: whether the exploration is over.
        reason: why this goal, or why it is over.
        remaining: once done, what was left and why, one sentence for each reason.
    """

    goal: Pose2 | None
    path: Path | None
    done: bool
    reason: str
    remaining: tuple[str, ...] = ()
