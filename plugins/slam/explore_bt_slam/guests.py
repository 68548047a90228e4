"""Keyframes of other robots in one's own pose graph."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import Pose2

__all__ = ["Guests", "guest_key", "mate_of"]

_MATE_BITS = 32


class _Constraint(Protocol):
    """What ties two keyframes together."""

    @property
    def a(self) -> int:
        """The earlier end."""

    @property
    def b(self) -> int:
        """The later end."""


E = TypeVar("E", bound=_Constraint)


def guest_key(mate: int, number: int) -> int:
    """The graph's number for a keyframe of the ``mate``-th robot (from 0); one's own are their own number."""
    return (mate + 1) << _MATE_BITS | number


def mate_of(key: int) -> int:
    """Whose a keyframe is; -1 for one's own."""
    return (key >> _MATE_BITS) - 1


@dataclass
class Guests(Generic[E]):
    """Where they are, and every constraint that has one of them at an end.

    Attributes:
        poses: x, y (m), yaw (rad) by ``guest_key``, one's own ``map`` frame.
    """

    poses: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    edges: list[E] = field(default_factory=list)

    def admit(self, poses: Mapping[int, Pose2], edges: Iterable[E]) -> None:
        """More of them."""
        self.poses.update({key: pose.as_array() for key, pose in poses.items()})
        self.edges.extend(edges)

    def dismiss(self, is_going: Callable[[E], bool], mate: int | None = None) -> None:
        """Forget some constraints, and all keyframes of a mate."""
        self.edges = [edge for edge in self.edges if not is_going(edge)]
        if mate is not None:
            self.poses = {key: pose for key, pose in self.poses.items() if mate_of(key) != mate}

    def move(self, rows: NDArray[np.float64]) -> None:
        """New poses, (N, 3), in the order of their keys."""
        self.poses.update(zip(sorted(self.poses), rows, strict=True))
