"""A checked mission: everything resolved, nothing built yet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Generic, TypeVar

from explore_bt.interfaces import Allocator, Controller, Driver, Planner, Plugin, PluginOptions, Slam, Team
from explore_bt.mission.limits import LimitsSpec
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.params import Param
from explore_bt.types import Pose2

__all__ = ["Mission", "PluginChoice", "RobotSpec", "Solo", "TeamSpec"]

P = TypeVar("P", bound=Plugin)


@dataclass(frozen=True, slots=True)
class PluginChoice(Generic[P]):
    """A plugin with its checked options."""

    kind: str
    name: str
    cls: type[P]
    options: PluginOptions

    def make(self) -> P:
        """A new plugin; it touches nothing before its ``setup``."""
        return self.cls(self.options)


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """One robot's stack.

    Attributes:
        start: pose of ``base_link`` in ``map``; None leaves it to the driver.
        knows_start: False where the mission says ``start: unknown``: the robot's map is its own until
            closures with its mates tell how the maps lie.
        saved_map: folder with the state that SLAM saved in an earlier run; None begins a new map.
        tree: root of its behaviour tree.
    """

    name: str
    start: Pose2 | None
    saved_map: Path | None
    driver: PluginChoice[Driver]
    slam: PluginChoice[Slam]
    planner: PluginChoice[Planner]
    controller: PluginChoice[Controller]
    tree: NodeSpec
    knows_start: bool = True


@dataclass(frozen=True, slots=True)
class TeamSpec:
    """How the robots of a mission hear one another, and who divides the work."""

    team: PluginChoice[Team]
    allocator: PluginChoice[Allocator]


@dataclass(frozen=True, slots=True)
class Solo:
    """One robot of a fleet, in a process of its own; ``pace``: simulated seconds a second."""

    robot: str
    pace: float = 1.0


@dataclass(frozen=True, slots=True)
class Mission:
    """What a mission file says, checked.

    Attributes:
        path: the file; ``text`` is its content.
        included: the other files it brought in.
        sha256: over its text, the included texts and the resolved parameters (files by their name
            relative to the mission's folder): the same wherever the mission lies.
        params: parameter -> value in SI; None where it is not given.
        declared: the parameters' declarations: type, bounds, doc.
        sources: file as its places name it -> its text, for the mission and what it includes.
        texts: real path -> text, of the file and the included ones.
        settings: the overrides, ``name=value``; relative files in them are relative to ``settings_folder``.
        control_rate_hz: a whole multiple of ``tree_rate_hz``.
        team: None for a robot that is alone.
        solo: the one robot of it that this process drives; None for all.
    """

    name: str
    doc: str
    path: Path
    text: str
    sha256: str
    params: Mapping[str, object]
    robots: tuple[RobotSpec, ...]
    tree_rate_hz: float
    control_rate_hz: float
    limits: LimitsSpec
    included: tuple[Path, ...] = ()
    declared: tuple[Param, ...] = ()
    sources: Mapping[str, str] = field(default_factory=dict)
    texts: Mapping[Path, str] = field(default_factory=dict)
    settings: tuple[str, ...] = ()
    settings_folder: Path = Path()
    team: TeamSpec | None = None
    solo: Solo | None = None
