"""The sections ``limits`` and ``tick``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from pydantic import Field

from explore_bt.interfaces import PluginOptions
from explore_bt.mission.checking import check_model
from explore_bt.mission.document import Entries
from explore_bt.mission.faults import Faults
from explore_bt.types import MotionLimits
from explore_bt.units import (
    Acceleration,
    AngularAcceleration,
    AngularJerk,
    AngularRate,
    Duration,
    Frequency,
    Jerk,
    Length,
    Share,
    Speed,
)

__all__ = ["LimitsModel", "LimitsSpec", "TickModel", "read_limits", "read_tick"]


@dataclass(frozen=True, slots=True)
class LimitsSpec:
    """What the mission asks for; None where it asks for nothing."""

    speed_mps: float | None = None
    acceleration_mps2: float | None = None
    jerk_mps3: float | None = None
    turn_rate_rps: float | None = None
    turn_acceleration_rps2: float | None = None
    turn_jerk_rps3: float | None = None
    time_s: float | None = None
    distance_m: float | None = None
    battery_reserve: float | None = None
    braking_mps2: float | None = None
    braking_jerk_mps3: float | None = None

    def apply(self, limits: MotionLimits) -> MotionLimits:
        """The body's limits, capped by the mission's."""
        return MotionLimits(
            _capped(limits.speed_mps, self.speed_mps),
            _capped(limits.acceleration_mps2, self.acceleration_mps2),
            _capped(limits.jerk_mps3, self.jerk_mps3),
            _capped(limits.turn_rate_rps, self.turn_rate_rps),
            _capped(limits.turn_acceleration_rps2, self.turn_acceleration_rps2),
            _capped(limits.turn_jerk_rps3, self.turn_jerk_rps3),
        )

    def of_brake(self, limits: MotionLimits) -> MotionLimits:
        """What the safety gate may brake with: as the robot drives, or harder where the mission says so."""
        return replace(
            self.apply(limits),
            acceleration_mps2=_capped(limits.acceleration_mps2, self.braking_mps2 or self.acceleration_mps2),
            jerk_mps3=_capped(limits.jerk_mps3, self.braking_jerk_mps3 or self.jerk_mps3),
        )


def _capped(body: float, mission: float | None) -> float:
    return body if mission is None else min(body, mission)


class LimitsModel(PluginOptions):
    """``limits:`` as it is written."""

    speed: Speed | None = Field(None, gt=0, description="top speed")
    acceleration: Acceleration | None = Field(None, gt=0, description="along the path")
    jerk: Jerk | None = Field(None, gt=0, description="change of acceleration")
    turn_rate: AngularRate | None = Field(None, gt=0, description="top turn rate")
    turn_acceleration: AngularAcceleration | None = Field(None, gt=0, description="of the turn rate")
    turn_jerk: AngularJerk | None = Field(None, gt=0, description="change of turn acceleration")
    time: Duration | None = Field(None, gt=0, description="mission time after which the mission ends")
    distance: Length | None = Field(None, gt=0, description="distance driven after which the mission ends")
    battery: Share | None = Field(None, ge=0, lt=1, description="charge that shall be left at home")
    braking: Acceleration | None = Field(
        None, gt=0, description="of the safety gate's brake; as acceleration by default"
    )
    braking_jerk: Jerk | None = Field(None, gt=0, description="of that brake; as jerk by default")


class TickModel(PluginOptions):
    """``tick:`` as it is written."""

    tree: Frequency = Field(10.0, gt=0, le=1000, description="how often the tree is ticked")
    control: Frequency = Field(20.0, gt=0, le=1000, description="how often the controller is asked")


def read_limits(entries: Entries, folder: Path, faults: Faults) -> LimitsSpec:
    """The checked section."""
    model = check_model(LimitsModel, entries, "limits", "key", folder, faults, entries.place)
    if model is None:
        return LimitsSpec()
    return LimitsSpec(
        model.speed,
        model.acceleration,
        model.jerk,
        model.turn_rate,
        model.turn_acceleration,
        model.turn_jerk,
        model.time,
        model.distance,
        model.battery,
        model.braking,
        model.braking_jerk,
    )


def read_tick(entries: Entries, folder: Path, faults: Faults) -> tuple[float, float]:
    """Rates of tree and control, Hz; control is a whole multiple of tree."""
    model = check_model(TickModel, entries, "tick", "key", folder, faults, entries.place)
    if model is None:
        return (10.0, 20.0)
    ratio = model.control / model.tree
    if round(ratio) < 1 or abs(ratio - round(ratio)) > 1e-6:
        entry = entries.by_key.get("control") or entries.by_key.get("tree")
        faults.add(
            entry.value.place if entry else entries.place,
            f"control runs at {model.control:g} Hz, the tree at {model.tree:g} Hz",
            f"control has to be a whole multiple of tree, for example {model.tree * 2:g} Hz",
        )
    return (model.tree, model.control)
