"""The contracts: one abstract class per plugin kind, and the values only they exchange."""

from explore_bt.interfaces.allocator import Allocator, Offers
from explore_bt.interfaces.bridge import Bridge
from explore_bt.interfaces.commons import Commons
from explore_bt.interfaces.controller import Controller, ControlOutput, ControlStatus
from explore_bt.interfaces.driver import Driver
from explore_bt.interfaces.exporter import Exporter, RobotProduct
from explore_bt.interfaces.filming import Filming
from explore_bt.interfaces.finding import Finding
from explore_bt.interfaces.graph_share import GraphShare
from explore_bt.interfaces.held_by import HeldBy
from explore_bt.interfaces.planner import Planner, never
from explore_bt.interfaces.playback import Playback, Recorded
from explore_bt.interfaces.plugin import API_VERSION, Plugin, PluginOptions, Resumption, RobotContext
from explore_bt.interfaces.request import Request
from explore_bt.interfaces.services import MapMemory, MapView, Pilot, RobotServices
from explore_bt.interfaces.sink import Sink
from explore_bt.interfaces.slam import Slam
from explore_bt.interfaces.snapshot import (
    Event,
    MateFrame,
    NodeInfo,
    NodeState,
    PortInfo,
    RobotSnapshot,
    RunInfo,
    TickSnapshot,
)
from explore_bt.interfaces.surroundings import Surroundings
from explore_bt.interfaces.team import Letter, Team
from explore_bt.interfaces.team_services import TeamServices
from explore_bt.interfaces.truth import GroundTruth

__all__ = [
    "API_VERSION",
    "Allocator",
    "Bridge",
    "Commons",
    "ControlOutput",
    "ControlStatus",
    "Controller",
    "Driver",
    "Event",
    "Exporter",
    "Filming",
    "Finding",
    "GraphShare",
    "GroundTruth",
    "HeldBy",
    "Letter",
    "MapMemory",
    "MapView",
    "MateFrame",
    "NodeInfo",
    "NodeState",
    "Offers",
    "Pilot",
    "Planner",
    "Playback",
    "Plugin",
    "PluginOptions",
    "PortInfo",
    "Recorded",
    "Request",
    "Resumption",
    "RobotContext",
    "RobotProduct",
    "RobotServices",
    "RobotSnapshot",
    "RunInfo",
    "Sink",
    "Slam",
    "Surroundings",
    "Team",
    "TeamServices",
    "TickSnapshot",
    "never",
]
