"""What a leaf saw when it decided, as marks to be drawn on the map."""

from __future__ import annotations

import enum
from dataclasses import dataclass, fields

__all__ = ["Drawing", "FrontierMark", "HalfPlaneMark", "SectorMark", "Verdict", "ViewMark"]


class Verdict(enum.StrEnum):
    """What was decided about something that was looked at."""

    TAKEN = "taken"
    REJECTED = "rejected"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class SectorMark:
    """A free sector seen from (x, y), counter-clockwise between two directions of the ``map`` frame.

    Attributes:
        range_m: so far no return bounds it.
        reason: why it was taken or rejected; empty while it is open.
    """

    x: float
    y: float
    from_rad: float
    to_rad: float
    range_m: float
    state: Verdict = Verdict.OPEN
    reason: str = ""


@dataclass(frozen=True, slots=True)
class HalfPlaneMark:
    """The half-plane through (x, y) that the unit normal points into; metres, ``map`` frame."""

    x: float
    y: float
    normal_x: float
    normal_y: float


@dataclass(frozen=True, slots=True)
class FrontierMark:
    """A frontier: its middle, metres, ``map`` frame, and its extent."""

    x: float
    y: float
    size_m: float
    state: Verdict = Verdict.OPEN
    reason: str = ""


@dataclass(frozen=True, slots=True)
class ViewMark:
    """A place to look from and the new area expected in view; ``map`` frame."""

    x: float
    y: float
    yaw_rad: float
    gain_m2: float
    state: Verdict = Verdict.OPEN
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Drawing:
    """Layers of marks, the weightiest mark first; None is a layer that nobody asked about.

    ``()`` is a layer that was asked about and is empty: no free sector, say.
    """

    sectors: tuple[SectorMark, ...] | None = None
    half_planes: tuple[HalfPlaneMark, ...] | None = None
    frontiers: tuple[FrontierMark, ...] | None = None
    views: tuple[ViewMark, ...] | None = None

    def layers(self) -> dict[str, tuple[object, ...]]:
        """Those that there are, by name."""
        named = ((each.name, getattr(self, each.name)) for each in fields(self))
        return {name: marks for name, marks in named if marks is not None}

    def over(self, below: Drawing) -> Drawing:
        """This drawing, and what only the other has."""
        return Drawing(**{**below.layers(), **self.layers()})  # type: ignore[arg-type]  # layers by their own names
