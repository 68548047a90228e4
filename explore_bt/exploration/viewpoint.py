"""Where to stand to see behind a frontier, or why nobody need go there: the values."""

from __future__ import annotations

from dataclasses import dataclass

from explore_bt.exploration.frontier import Frontier

__all__ = ["LeftOpen", "Viewpoint", "ViewpointChoice", "reachable_frontiers"]


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """A reachable place that sees a frontier.

    Attributes:
        xy: metres, ``map`` frame; the centre of a cell.
        heading_rad: towards the part of the frontier that is seen.
        travel_m: way from the robot.
        gain_m2: unknown area in view behind the frontier.
        frontier: what it looks at.
    """

    xy: tuple[float, float]
    heading_rad: float
    travel_m: float
    gain_m2: float
    frontier: Frontier


@dataclass(frozen=True, slots=True, eq=False)
class LeftOpen:
    """A frontier that nobody need go to, and in words why not.

    Attributes:
        is_closed: whether it could be looked at but shows too little: then nothing of use is left out.
    """

    frontier: Frontier
    reason: str
    is_closed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class ViewpointChoice:
    """Every frontier asked for, either with a viewpoint or with a reason; both in the frontiers' order."""

    viewpoints: tuple[Viewpoint, ...]
    left_open: tuple[LeftOpen, ...]


def reachable_frontiers(choice: ViewpointChoice) -> tuple[Frontier, ...]:
    """The frontiers that a reachable place sees and that still show new area, the nearest first."""
    nearest = sorted(choice.viewpoints, key=lambda viewpoint: viewpoint.travel_m)
    return tuple(viewpoint.frontier for viewpoint in nearest)
