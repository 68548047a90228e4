"""What every plugin has: a name, a version of this contract, and checked options."""

from __future__ import annotations

import zlib
from abc import ABC
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict

from explore_bt.interfaces.commons import Commons
from explore_bt.interfaces.truth import GroundTruth
from explore_bt.types import BodyShape, MotionLimits, Pose2

__all__ = ["API_VERSION", "Plugin", "PluginOptions", "Resumption", "RobotContext"]

API_VERSION = 1
"""Version of the contracts in this package; a plugin states the one it was written for."""


class PluginOptions(BaseModel):
    """Base of a plugin's options: typed, with units and defaults; unknown names are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


class Plugin(ABC):
    """Base of every plugin kind.

    Construction only keeps the options: it touches no hardware and reads no file, so that a mission can
    be checked and drawn without a robot.

    Attributes:
        kind: set by the contract (``driver``, ``slam``, ...).
        name: how missions call it (``{use: name}``).
        api_version: the ``API_VERSION`` it was written for.
        Options: its options; each field has a type from ``explore_bt.units``, a default, a description.
    """

    kind: ClassVar[str]
    name: ClassVar[str]
    api_version: ClassVar[int]
    Options: ClassVar[type[PluginOptions]] = PluginOptions

    def __init__(self, options: PluginOptions) -> None:
        self.options = options


@dataclass(frozen=True, slots=True)
class Resumption:
    """A run goes on that another process began.

    Attributes:
        stamp_s: the mission time at which it goes on; clocks show it at set-up, stamps count from there.
        pose: where the robot was last believed to be, ``map`` frame.
        true_pose: where the simulator last had it; None on hardware. It stands there now.
        part: how many processes have worked on the run, this one included.
    """

    stamp_s: float
    pose: Pose2
    true_pose: Pose2 | None = None
    part: int = 2


@dataclass(frozen=True, slots=True)
class RobotContext:
    """What a plugin learns about its robot when it is set up.

    Attributes:
        robot: the robot's name in the mission.
        seed: the run's seed; draw from ``rng`` only, so that runs repeat.
        start: pose of ``base_link`` in ``map`` when the mission starts; None if nobody said so.
        knows_start: whether ``start`` is a place in the frame that the robots of the mission share; else the
            robot's ``map`` is its own, and begins where it stands.
        footprint_radius_m: the robot's circular footprint.
        limits: the driver's limits, capped by the mission's.
        shape: of the body, for who makes use of a 3D lidar.
        truth: the simulator's truth, None on hardware.
        resumed: where the run goes on, None for one that begins. ``start`` is still where the mission began.
        connection: what the driver shares with plugins of its own family, None where it shares nothing.
        commons: what the robots of the mission share in this process.
    """

    robot: str = "robot"
    seed: int = 0
    start: Pose2 | None = None
    footprint_radius_m: float = 0.25
    limits: MotionLimits = MotionLimits()
    shape: BodyShape = BodyShape()
    truth: GroundTruth | None = None
    resumed: Resumption | None = None
    connection: object = None
    knows_start: bool = True
    commons: Commons = field(default_factory=Commons, compare=False, repr=False)

    def rng(self, stream: str) -> np.random.Generator:
        """An independent generator for one named use; the same seed, robot and name give the same."""
        return np.random.default_rng([self.seed, zlib.crc32(f"{self.robot}/{stream}".encode())])
