"""Mission files: YAML text -> checked mission -> behaviour tree, and pictures of it."""

from explore_bt.errors import Fault, MissionError
from explore_bt.mission.build import BuiltTree, build_tree
from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.draw_dot import show_dot
from explore_bt.mission.draw_text import show_text
from explore_bt.mission.limits import LimitsSpec
from explore_bt.mission.load import load_mission, load_tree
from explore_bt.mission.mocks import with_mocks
from explore_bt.mission.model import Mission, PluginChoice, RobotSpec, Solo
from explore_bt.mission.nodes import CONTROL_NODES, MODIFIERS, Condition, Modifiers, NodeSpec
from explore_bt.mission.one_robot import only_robot
from explore_bt.mission.schema import mission_schema
from explore_bt.mission.wiring import RUNTIME_KEYS

__all__ = [
    "CONTROL_NODES",
    "MODIFIERS",
    "RUNTIME_KEYS",
    "BuiltTree",
    "Condition",
    "Fault",
    "LimitsSpec",
    "Mission",
    "MissionError",
    "Modifiers",
    "NodeSpec",
    "PluginCatalog",
    "PluginChoice",
    "RobotSpec",
    "Solo",
    "build_tree",
    "load_mission",
    "load_tree",
    "mission_schema",
    "only_robot",
    "show_dot",
    "show_text",
    "with_mocks",
]
