from __future__ import annotations

import pytest

from explore_bt.plugin import Registry
from explore_bt.tree import REQUIRED, Input, Key, Leaf, Output, Status
from explore_bt.types import Waypoint
from explore_bt.units import Angle, Duration, Length


class Look(Leaf):
    """Looks for a waypoint."""

    type_key = "look"
    half_planes: Input[int | str] = Input(int | str, default="all", doc="how many")
    stride: Input[float] = Input(Length, default=1.5, ge=0.1, le=10.0, doc="distance to the next waypoint")
    turn: Input[float] = Input(Angle, default=0.0, doc="extra turn")
    eager: Input[bool] = Input(bool, default=False, doc="take the first")
    label: Input[str] = Input(str, default="", doc="shown")
    weights: Input[tuple[float, ...]] = Input(tuple[float, ...], default=(1.0, 2.0), doc="of the ways")
    patience: Input[float | None] = Input(Duration | None, default=None, doc="how long")
    nothing: Input[tuple[float, ...]] = Input(tuple[float, ...], default=(), doc="no attribute can say it")
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="where to")

    def update(self) -> Status:
        return Status.FAILURE


class Drive(Leaf):
    """Drives."""

    type_key = "drive"
    goal: Input[Waypoint] = Input(Waypoint, default=REQUIRED, doc="where to")
    failure: Output[str] = Output(str, default=Key("failure"), doc="why not")

    def update(self) -> Status:
        return Status.SUCCESS


class Home(Leaf):
    """Chooses home."""

    type_key = "home"
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="home")

    def update(self) -> Status:
        return Status.SUCCESS


@pytest.fixture(scope="session")
def leaves() -> Registry:
    registry = Registry()
    for leaf in (Look, Drive, Home):
        registry.add(leaf, origin="test")
    return registry
